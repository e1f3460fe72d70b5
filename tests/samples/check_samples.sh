#!/bin/sh
# SPDX-License-Identifier: MIT
# The sample programs from end to end: a shaky clip with sound becomes a steady one.
# usage: check_samples.sh STABILIZE_FILE RENDER_SHAKY MEASURE_SHAKE SMOOTH_PATH
set -eu
export LC_ALL=C

stabilize_file=$(realpath "$1")
render_shaky=$(realpath "$2")
measure_shake=$(realpath "$3")
smooth_path=$(realpath "$4")
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"

fail() {
  echo "failed: $*"
  exit 1
}

# refuses WORDS ARGUMENT...: stabilize-file says WORDS in one line and leaves nothing behind.
refuses() {
  words=$1
  shift
  ! "$stabilize_file" "$@" 2>said || fail "accepted: $*"
  grep -q "$words" said || fail "said of $*: $(cat said)"
  [ "$(wc -l <said)" -eq 1 ] || fail "more than a line on $*: $(cat said)"
  [ ! -e refused.mp4 ] && [ ! -e refused.mp4.part ] || fail "left a file behind: $*"
}

# The shake of a 640x360 clip by its known motion: the root mean square of the corners' second difference, pixels.
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

# within A B R: A is B give or take the part R of it.
within() {
  awk -v a="$1" -v b="$2" -v r="$3" 'BEGIN { exit !(a != "" && b > 0 && (a - b) ^ 2 <= (r * b) ^ 2) }'
}

"$render_shaky" 'a clip.mp4' truth.txt
[ "$(grep -vc '^#' truth.txt)" -eq 300 ] || fail "truth.txt has not one line a frame"

"$stabilize_file" --lambda=0.5 'a clip.mp4' 'steady clip.mp4' 2>said || fail "$(cat said)"
grep -q '100 %, 300 frames' said || fail "not all frames came out: $(cat said)"
[ ! -e 'steady clip.mp4.part' ] || fail "a half-written file is left"
grep -aq mp4a 'steady clip.mp4' || fail "the sound is lost"

"$measure_shake" --picture=picture.png 'a clip.mp4' 'steady clip.mp4' >measured
cat measured
[ -s picture.png ] || fail "there is no picture"
before=$(sed -n '1s/.*: \([0-9.]*\) px$/\1/p' measured)
ratio=$(sed -n 's/^ratio: //p' measured)
within "$before" "$(true_shake truth.txt)" 0.05 || fail "the clip's true shake is $(true_shake truth.txt) px"
awk -v ratio="$ratio" 'BEGIN { exit !(ratio != "" && ratio < 0.15) }' || fail "the shake did not fall to 15 %"

# The path alone, from the motion that was measured: as long as the clip, and nearer to the camera with more lambda.
"$measure_shake" --motion=motion.txt 'a clip.mp4' >said || fail "$(cat said)"
distance() {
  "$smooth_path" motion.txt "$@" | awk '{ sum += ($2 - $4) ^ 2 + ($3 - $5) ^ 2 } END { print NR, sqrt(sum / NR) }'
}
free=$(distance lambda=0.1)
close=$(distance lambda=2)
[ "${free% *}" = 300 ] && [ "${close% *}" = 300 ] || fail "smooth-path gave $free and $close"
awk -v a="${free#* }" -v b="${close#* }" 'BEGIN { exit !(b > 0 && b < a) }' || fail "lambda: $free, $close"
"$smooth_path" motion.txt lambda=much >said 2>&1 && fail "accepted: lambda=much"

echo 'this is no video' >text.mp4
head -c 300000 'a clip.mp4' >cut.mp4
refuses 'no such file' absent.mp4 refused.mp4
refuses 'cannot be read' "$dir" refused.mp4
refuses 'type' text.mp4 refused.mp4
refuses 'cut.mp4' cut.mp4 refused.mp4
refuses 'the input too' 'a clip.mp4' "$dir/a clip.mp4"
refuses 'has to end with' 'a clip.mp4' refused.avi
refuses 'out of range' --crop-ratio=3 'a clip.mp4' refused.mp4
refuses 'not a value' --lambda=much 'a clip.mp4' refused.mp4
refuses 'Unknown option' --novelty=1 'a clip.mp4' refused.mp4
