#!/bin/sh
# Usage: viewer_test.sh TORSO MODEL [PNG]. Opens MODEL with `torso view` on a virtual display and
# checks that the stock viewer has the plugin loaded and that the body moves: two screenshots, one
# second apart, differ by more than a clock or a cursor would. The second is kept as PNG.
# Exit status 77 (skipped) where there is no Xvfb or no xwd.
torso=$1
model=$2
for tool in Xvfb xwd xwdtopnm pnmtopng mujoco-simulate; do
  command -v $tool >/dev/null || { echo "viewer_test: $tool is not installed"; exit 77; }
done
work=$(mktemp -d)
display=:$((100 + $$ % 400))
Xvfb $display -screen 0 1400x900x24 >"$work/xvfb.txt" 2>&1 &
xvfb=$!
DISPLAY=$display
export DISPLAY
cd "$work" || exit 1
trap 'kill $viewer $xvfb 2>/dev/null; rm -rf "$work"' EXIT
sleep 1
"$torso" view "$model" >"$work/viewer.txt" 2>&1 &
viewer=$!

shot() { xwd -silent -root | xwdtopnm 2>/dev/null >"$1"; }
sleep 3
kill -0 $viewer || { echo "viewer_test: the viewer has ended"; cat "$work/viewer.txt"; exit 1; }
grep -q libmujoco_torso "/proc/$viewer/maps" ||
  { echo "viewer_test: the plugin is not loaded"; exit 1; }
tries=0
while [ $tries -lt 12 ]; do
  shot "$work/one.pnm"
  sleep 1
  shot "$work/two.pnm"
  changed=$(cmp -l "$work/one.pnm" "$work/two.pnm" | wc -l)
  [ "$changed" -gt 20000 ] && break
  tries=$((tries + 1))
done
[ -z "$3" ] || pnmtopng "$work/two.pnm" >"$3" 2>/dev/null
if [ -s MUJOCO_LOG.TXT ]; then
  echo "viewer_test: MuJoCo warned:"
  cat MUJOCO_LOG.TXT
  exit 1
fi
echo "viewer_test: $changed bytes of the screen changed in a second"
[ "$changed" -gt 20000 ]
