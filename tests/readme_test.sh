#!/bin/sh
# Usage: readme_test.sh SOURCE. The C program in README.md is tests/plugin/readme.c (less its licence
# line), which process_test compiles and runs; and the pictures that README.md shows exist.
cd "$1" || exit 1
program=$(mktemp)
trap 'rm -f "$program"' EXIT
tail -n +2 tests/plugin/readme.c >"$program"
awk '/^```c$/ {on = 1; next} /^```$/ {on = 0} on' README.md | diff - "$program" ||
  { echo "README.md: its C program is not tests/plugin/readme.c"; exit 1; }
missing=0
for picture in $(grep -o '](docs/[^)]*)' README.md | tr -d ']()'); do
  [ -s "$picture" ] || { echo "README.md: $picture is missing"; missing=1; }
done
exit $missing
