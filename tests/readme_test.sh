#!/bin/sh
# Usage: readme_test.sh SOURCE. The C program in README.md is tests/plugin/readme.c, which is compiled
# and run by process_test, and the pictures that README.md shows exist.
cd "$1" || exit 1
awk '/^```c$/ {on = 1; next} /^```$/ {on = 0} on' README.md |
  diff - tests/plugin/readme.c >&2 || { echo "README.md: its C program is not tests/plugin/readme.c"; exit 1; }
grep -o '](docs/[^)]*)' README.md | tr -d ']()' | while read -r picture; do
  [ -s "$picture" ] || { echo "README.md: $picture is missing"; exit 1; }
done
