#!/bin/sh
# Usage: viewer_test.sh TORSO MODEL moves|plays [PNG]. Opens MODEL with `torso view` on a virtual
# display, the stock viewer with the plugin in it, and looks at two screenshots, one second apart.
# moves: the simulated body moves, they differ by more than a clock or a cursor would.
# plays: with a motion in which nothing moves they are the same, though the simulated body would
# have moved; with one in which the head turns and an arm swings they differ.
# The last screenshot is kept as PNG. Exit status 77 (skipped) where there is no Xvfb or no xwd.
torso=$1
model=$2
what=$3
picture=$4
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

shot() { xwd -silent -root | xwdtopnm 2>/dev/null >"$1"; }

# changed moves|still [OPTIONS]: opens the viewer, waits until its window is drawn, compares pictures one
# second apart until more than $limit bytes of the screen differ (still: until no more do), for some
# seconds at most, closes it, and says in $bytes how many differed last.
limit=20000
changed() {
  wanted=$1
  shift
  shot "$work/empty.pnm"
  "$torso" view "$model" "$@" >"$work/viewer.txt" 2>&1 &
  viewer=$!
  tries=0
  drawn=0
  while [ $tries -lt 30 ] && [ "$drawn" -lt 100000 ]; do
    sleep 1
    shot "$work/one.pnm"
    drawn=$(cmp -l "$work/empty.pnm" "$work/one.pnm" 2>/dev/null | wc -l)
    tries=$((tries + 1))
  done
  kill -0 $viewer || { echo "viewer_test: the viewer has ended"; cat "$work/viewer.txt"; exit 1; }
  grep -q libmujoco_torso "/proc/$viewer/maps" ||
    { echo "viewer_test: the plugin is not loaded"; exit 1; }
  sleep 2
  tries=0
  while [ $tries -lt 6 ]; do
    shot "$work/one.pnm"
    sleep 1
    shot "$work/two.pnm"
    bytes=$(cmp -l "$work/one.pnm" "$work/two.pnm" | wc -l)
    [ "$bytes" -gt $limit ] && now=moves || now=still
    [ $now = "$wanted" ] && break
    tries=$((tries + 1))
  done
  [ -z "$picture" ] || pnmtopng "$work/two.pnm" >"$picture" 2>/dev/null
  kill $viewer
  wait $viewer 2>/dev/null
  cat "$work/viewer.txt"
  if [ -s MUJOCO_LOG.TXT ]; then
    echo "viewer_test: MuJoCo warned:"
    cat MUJOCO_LOG.TXT
    exit 1
  fi
}

# motion TURN FILE: 0.65 s each way, no whole number of which is a second; TURN [rad] of head and arm
# at the far end.
motion() {
  awk -v turn="$1" 'BEGIN {
    print "# torso motion 1, rate_hz=23"
    printf "time_s"
    n = split("head:qw head:qx head:qy head:qz left_glenohumeral:qw left_glenohumeral:qx " \
              "left_glenohumeral:qy left_glenohumeral:qz", names, " ")
    for (i = 1; i <= n; ++i) printf ",%s", names[i]
    print ""
    for (frame = 0; frame <= 30; ++frame) {
      half = turn / 2 * (1 - cos(frame / 30 * 6.283185307)) / 2
      printf "%.6f,%.9f,0,0,%.9f,%.9f,0,%.9f,0\n", frame / 23, cos(half), sin(half), cos(half), -sin(half)
    }
  }' >"$2"
}

case $what in
  moves)
    changed moves
    echo "viewer_test: $bytes bytes of the screen changed in a second"
    [ "$bytes" -gt $limit ]
    ;;
  plays)
    motion 0 still.csv
    motion 1 swing.csv
    changed still --motion still.csv
    still=$bytes
    changed moves --motion swing.csv
    echo "viewer_test: $still bytes changed in a second of a still motion, $bytes in one that moves"
    [ "$still" -le $limit ] && [ "$bytes" -gt $limit ]
    ;;
  *)
    echo "viewer_test: moves or plays?"
    exit 1
    ;;
esac
