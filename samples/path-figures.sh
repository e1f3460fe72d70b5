#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Draws figures 1 and 3 of the paper for a video or a motion file, as SVG, with gnuplot. Builds the tree first.
#   Fig. 1  the camera's path, the L1 path with weights 10, 1, 100 (Grundmann et al. 2011), and ours with lambda 0.5
#   Fig. 3  ours with lambda 0.1, 0.5, 1 and 2
# usage: samples/path-figures.sh [IN [DIRECTORY]]
#   IN          a video, or a text file from measure-shake --motion; default: the clip of render-shaky
#   DIRECTORY   the folder for fig1.svg and fig3.svg; default: out, at the top of the tree
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

case ${1:-} in
  '') "$build/samples/render-shaky" "$work/shaky.mp4" "$work/motion.txt" ;;
  *.txt) cp "$1" "$work/motion.txt" ;;
  *) "$build/samples/measure-shake" --motion="$work/motion.txt" "$1" >"$work/log" ;;
esac
frames=$(grep -vc '^#' "$work/motion.txt")
[[ $frames -ge 4 ]] || die "the video is too short: $frames frames, 4 are needed"

# path NAME OPTION...: writes the smoothed path to $work/NAME.txt
path() {
  local name=$1
  shift
  "$build/samples/smooth-path" "$work/motion.txt" crop-ratio=0.8 "$@" >"$work/$name.txt"
}
# Grundmann's path is that of the whole clip with lambda 0. A small lambda picks one of the many optimal paths.
path l1 lambda=0.001 weights=10,1,100 window=$((frames < 900 ? frames : 900)) overlap=3
for lambda in 0.1 0.5 1 2; do
  path "lambda-$lambda" lambda=$lambda
done

# plot FILE LAYOUT PANELS: draws the panels, which are gnuplot commands
plot() {
  gnuplot <<END
set terminal svg size 900,640 background rgb 'white' font 'sans,12'
set output '$out/$1'
set multiplot layout $2
set xlabel 'frame'
set ylabel 'px'
set key top left
$3
END
}
camera() { echo "'$work/l1.txt' using 1:$1 with lines lc rgb '#c0c0c0' title 'camera'"; }
smooth() { echo "'$work/$2.txt' using 1:$1 with lines lw 1.5 lc rgb '$3' title '$4'"; }

grundmann='L1, weights 10, 1, 100'
ours='L1-L2, lambda 0.5'
plot fig1.svg 2,1 "
set title 'x of the path'
plot $(camera 2), $(smooth 4 l1 '#d95f02' "$grundmann"), $(smooth 4 lambda-0.5 '#1b6ca8' "$ours")
set title 'y of the path'
plot $(camera 3), $(smooth 5 l1 '#d95f02' "$grundmann"), $(smooth 5 lambda-0.5 '#1b6ca8' "$ours")"
panels=
for lambda in 0.1 0.5 1 2; do
  panels+="
set title 'lambda = $lambda'
plot $(camera 2), $(smooth 4 "lambda-$lambda" '#1b6ca8' 'smoothed')"
done
plot fig3.svg 2,2 "$panels"
echo "figures  $out/fig1.svg, $out/fig3.svg"
