#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Draws how the camera's path of a video is smoothed, as SVG, with gnuplot. Builds the tree first.
#   fig1.svg     Fig. 1 of the paper: the camera's path, the L1 path with weights 10, 1, 100 (Grundmann et al. 2011),
#                and ours with lambda 0.5
#   lambda.svg   Fig. 3 of the paper: lambda 0.1, 0.5, 1 and 2, with a crop ratio of 0.8
#   crop.svg     crop ratios 0.95, 0.9 and 0.8, with the limits that each sets to the path
#   window.svg   windows of 8, 30 and 150 frames
# usage: samples/path-figures.sh [IN [DIRECTORY]]
#   IN          a video; a text file from measure-shake --motion; or one of tests/reference/motion.
#               Default: the clip of render-shaky
#   DIRECTORY   the folder for the figures; default: out, at the top of the tree
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$(realpath -m "${BUILD_DIR:-$top/build}")

die() {
  echo "path-figures: $*" >&2
  exit 1
}

[[ $# -le 2 ]] || die "too many arguments. Usage: samples/path-figures.sh [IN [DIRECTORY]]"
[[ $# -eq 0 || -r $1 ]] || die "$1: cannot be read"
out=${2:-$top/out}

"$top/.ci/prepare.sh" "$build"
command -v gnuplot >/dev/null || die "gnuplot is missing: apt-get install gnuplot-nox"
export GST_PLUGIN_PATH=$build/plugin/gstreamer GST_REGISTRY=$build/plugin/gstreamer/registry.bin
mkdir -p "$out"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Writes a file of tests/reference/motion, which has similarities in parts of the diagonal, as measure-shake would.
in_pixels() {
  awk 'NR == 1 { diagonal = sqrt($2 ^ 2 + $3 ^ 2); printf "# %dx%d\n", $2, $3; next }
    { printf "%d %.9f %.9f %.9f %.9f %.9f %.9f 0 0 1\n", NR - 2, $1, -$2, $3 * diagonal, $2, $1, $4 * diagonal }' "$1"
}

case ${1:-} in
  '') "$build/samples/render-shaky" "$work/shaky.mp4" "$work/motion.txt" ;;
  *.txt)
    if head -n 1 "$1" | grep -q 'x[0-9]*$'; then
      cp "$1" "$work/motion.txt"
    else
      in_pixels "$1" >"$work/motion.txt"
    fi
    ;;
  *) "$build/samples/measure-shake" --motion="$work/motion.txt" "$1" >"$work/log" ;;
esac
frames=$(grep -vc '^#' "$work/motion.txt")
width=$(sed -n '1s/.* \([0-9]*\)x[0-9]*$/\1/p' "$work/motion.txt")
[[ $frames -ge 4 ]] || die "the video is too short: $frames frames, 4 are needed"

# path NAME OPTION...: writes the smoothed path to $work/NAME.txt
path() {
  local name=$1
  shift
  "$build/samples/smooth-path" "$work/motion.txt" "$@" >"$work/$name.txt"
}
# Grundmann's path is that of the whole clip with lambda 0. A small lambda picks one of the many optimal paths.
path l1 crop-ratio=0.8 lambda=0.001 weights=10,1,100 window=$((frames < 900 ? frames : 900)) overlap=3
lambdas=(0.1 0.5 1 2) crops=(0.95 0.9 0.8) windows=(8 30 150)
for lambda in "${lambdas[@]}"; do path "lambda-$lambda" crop-ratio=0.8 lambda="$lambda"; done
for crop in "${crops[@]}"; do path "crop-$crop" crop-ratio="$crop"; done
for window in "${windows[@]}"; do path "window-$window" window="$window"; done

# plot FILE ROWS,COLUMNS HEIGHT PANELS: draws the panels, which are gnuplot commands
plot() {
  gnuplot <<END
set terminal svg size 900,$3 background rgb 'white' font 'sans,12'
set output '$out/$1'
set multiplot layout $2
set tmargin 3
set xlabel 'frame'
set ylabel 'px'
set xrange [0:$((frames - 1))]
set key tmargin right horizontal samplen 2
$4
END
}
# Columns of the files: 2 and 3 are x and y of the camera's path, 4 and 5 those of the smoothed path.
camera() { echo "'$work/l1.txt' using 1:$1 with lines lc rgb '#909090' title 'camera'"; }
smooth() { echo "'$work/$2.txt' using 1:$1 with lines lw 1.5 lc rgb '$3' title '$4'"; }
# limits CROP: how far the path can be from the camera's, if the frame is neither turned nor zoomed
limits() {
  local room="((1 - $1) / 2 * $width)"
  echo "'$work/l1.txt' every 2 using 1:(\$2 - $room):(\$2 + $room) with filledcurves lc rgb '#fbe3cf' title 'room'"
}

grundmann='L1, weights 10, 1, 100'
ours='L1-L2, lambda 0.5'
plot fig1.svg 2,1 640 "
set label 1 'x of the path' at graph 0, 1.08
plot $(camera 2), $(smooth 4 l1 '#d95f02' "$grundmann"), $(smooth 4 lambda-0.5 '#1b6ca8' "$ours")
set label 1 'y of the path' at graph 0, 1.08
plot $(camera 3), $(smooth 5 l1 '#d95f02' "$grundmann"), $(smooth 5 lambda-0.5 '#1b6ca8' "$ours")"

# panels NAME TITLE VALUE...: the x of the camera and of the path NAME-VALUE, a panel for each value
panels() {
  local name=$1 title=$2 value band
  shift 2
  for value; do
    band=
    [[ $name != crop ]] || band="$(limits "$value"),"
    echo "set label 1 '$title = $value' at graph 0, 1.12"
    echo "plot $band $(camera 2), $(smooth 4 "$name-$value" '#1b6ca8' smoothed)"
  done
}
plot lambda.svg 2,2 640 "$(panels lambda lambda "${lambdas[@]}")"
# The scale of all is that of the last, which has the most room.
scale=$(awk -v crop="${crops[-1]}" -v width="$width" '
  NR == 1 || $2 < low { low = $2 }
  NR == 1 || $2 > high { high = $2 }
  END { room = (1 - crop) / 2 * width; print low - room ":" high + room }' "$work/l1.txt")
plot crop.svg 3,1 780 "set yrange [$scale]
$(panels crop 'crop-ratio' "${crops[@]}")"
plot window.svg 3,1 780 "$(panels window window "${windows[@]}")"
echo "figures  $out/fig1.svg, lambda.svg, crop.svg, window.svg"
