#!/bin/sh
# SPDX-License-Identifier: MIT
# Runs the sample programs from end to end: they turn a shaky clip with sound into a stabilized one.
# usage: check_samples.sh L1L2STAB RENDER_SHAKY MEASURE_SHAKE SMOOTH_PATH [STABILIZE_LIBAV]
# check_samples_faults.sh has the tests of wrong arguments; tests/command has those of l1l2stab.
set -eu
export LC_ALL=C

l1l2stab=$(realpath "$1")
render_shaky=$(realpath "$2")
measure_shake=$(realpath "$3")
smooth_path=$(realpath "$4")
stabilize_libav=${5:+$(realpath "$5")}
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"

fail() {
  echo "failed: $*"
  exit 1
}

# true_shake TRUTH: the shake of a 640x360 clip from its known motion, as measure-shake defines it, in pixels
true_shake() {
  awk '!/^#/ && $1 > 0 {
    for (i = 0; i < 4; i++) {
      x = i % 2 ? 320 : -320
      y = i < 2 ? 180 : -180
      vx = $2 * x + $3 * y + $4 - x
      vy = $5 * x + $6 * y + $7 - y
      if ($1 > 1) {
        sum += (vx - last_x[i]) ^ 2 + (vy - last_y[i]) ^ 2
        count++
      }
      last_x[i] = vx
      last_y[i] = vy
    }
  } END { print sqrt(sum / count) }' "$1"
}

# within A B R: A differs from B by at most R times B
within() {
  awk -v a="$1" -v b="$2" -v r="$3" 'BEGIN { exit !(a != "" && b > 0 && (a - b) ^ 2 <= (r * b) ^ 2) }'
}

"$render_shaky" 'a clip.mp4' truth.txt
[ "$(grep -vc '^#' truth.txt)" -eq 300 ] || fail "truth.txt does not have one line for each frame"

"$l1l2stab" --lambda=0.5 'a clip.mp4' -o 'steady clip.mp4' 2>said || fail "$(cat said)"
grep -q ' 300 frames' said || fail "frames are missing in the output: $(cat said)"
grep -aq mp4a 'steady clip.mp4' || fail "the sound is missing"

"$measure_shake" --picture=picture.png 'a clip.mp4' 'steady clip.mp4' >measured
cat measured
[ -s picture.png ] || fail "there is no picture"
before=$(sed -n '1s/.*: \([0-9.]*\) px$/\1/p' measured)
ratio=$(sed -n 's/^ratio: //p' measured)
within "$before" "$(true_shake truth.txt)" 0.05 || fail "the clip's true shake is $(true_shake truth.txt) px"
awk -v ratio="$ratio" 'BEGIN { exit !(ratio != "" && ratio < 0.15) }' || fail "the shake did not fall to 15 %"

# The path from the measured motion has one line for each frame. A larger lambda keeps it closer to the camera's path.
"$measure_shake" --motion=motion.txt 'a clip.mp4' >said || fail "$(cat said)"
distance() {
  "$smooth_path" motion.txt "$@" | awk '{ sum += ($2 - $4) ^ 2 + ($3 - $5) ^ 2 } END { print NR, sqrt(sum / NR) }'
}
free=$(distance lambda=0.1)
close=$(distance lambda=2)
[ "${free% *}" = 300 ] && [ "${close% *}" = 300 ] || fail "smooth-path gave $free and $close"
awk -v a="${free#* }" -v b="${close#* }" 'BEGIN { exit !(b > 0 && b < a) }' || fail "lambda: $free, $close"
! "$smooth_path" motion.txt lambda=much >said 2>&1 || fail "accepted: lambda=much"

# The sample on libavformat and libavcodec is built where they are installed.
if [ -n "$stabilize_libav" ]; then
  "$stabilize_libav" 'a clip.mp4' libav.mp4 2>said || fail "$(cat said)"
  "$measure_shake" --motion=libav.txt libav.mp4 >said || fail "$(cat said)"
  [ "$(grep -c '^[0-9]' libav.txt)" -eq 300 ] || fail "libav.mp4 does not have 300 frames"
  "$measure_shake" 'a clip.mp4' libav.mp4 >measured
  cat measured
  ratio=$(sed -n 's/^ratio: //p' measured)
  awk -v ratio="$ratio" 'BEGIN { exit !(ratio != "" && ratio < 0.15) }' || fail "libav: the shake did not fall to 15 %"
  ! "$stabilize_libav" truth.txt libav.mp4 2>said || fail "accepted: a file without video"
  grep -q '^stabilize-libav: ' said || fail "no reason: $(cat said)"
else
  echo 'skipped: stabilize-libav, without libavcodec-dev, libavformat-dev and libavutil-dev'
fi
