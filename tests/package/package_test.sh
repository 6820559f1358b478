#!/bin/sh
# Usage: package_test.sh BUILD SOURCE. Installs the build into a new folder and builds and runs a
# program against it, the way a user's own project would.
set -e
build=$1
source=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --prefix "$work/prefix" >/dev/null
cmake -S "$source/tests/package" -B "$work/program" -DCMAKE_PREFIX_PATH="$work/prefix" >/dev/null
cmake --build "$work/program" >/dev/null
"$work/program/package_test" "$work/prefix/share/mujoco_torso/mjcf/human.xml" | grep -x '23 discs'
# The installed command finds the installed tables and models.
"$work/prefix/bin/torso" build -o "$work/models" >/dev/null
cmp "$work/models/human.xml" "$work/prefix/share/mujoco_torso/mjcf/human.xml"
