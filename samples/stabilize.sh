#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Stabilizes a video file with l1l2stab and reports the shake before and after. First builds the tree and installs
# missing packages.
# usage: samples/stabilize.sh [OPTION...] [IN [OUT]]
#   IN       a video; default: a shaky clip that it renders
#   OUT      default: IN's name with -stabilized.mp4, in the current directory; its suffix chooses the format
#   OPTION   an option of l1l2stab, as --name=value or --name: --lambda=1, --quiet; --help lists them
# The environment variable BUILD_DIR names the build directory; default: build, at the top of the tree
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$(realpath -m "${BUILD_DIR:-$top/build}")

die() {
  echo "stabilize: $*" >&2
  exit 1
}

options=()
while [[ ${1:-} == -?* ]]; do
  [[ $1 != -- ]] || { shift && break; }
  options+=("$1")
  shift
done
[[ $# -le 2 ]] || die "too many arguments. Usage: samples/stabilize.sh [--name=value...] [IN [OUT]]"

# Check the input before anything is installed or built.
if [[ $# -gt 0 ]]; then
  [[ -e $1 ]] || die "$1: no such file"
  [[ -f $1 && -r $1 ]] || die "$1: cannot be read"
fi

"$top/.ci/prepare.sh" "$build"
export GST_PLUGIN_PATH=$build/plugin/gstreamer${GST_PLUGIN_PATH:+:$GST_PLUGIN_PATH}
export GST_REGISTRY=$build/plugin/gstreamer/registry.bin

if [[ " ${options[*]} " == *" --help "* ]]; then
  exec "$build/samples/l1l2stab/l1l2stab" --help
fi

if [[ $# -eq 0 ]]; then
  mkdir -p "$top/out"
  in=$top/out/shaky.mp4
  out=$top/out/shaky-stabilized.mp4
  echo "rendering a shaky clip" >&2
  "$build/samples/render-shaky" "$in" "$top/out/shaky-motion.txt"
else
  in=$1
  name=${in##*/}
  out=${2:-${name%.*}-stabilized.mp4}
fi
[[ $in != -* ]] || in=./$in # for measure-shake
[[ $out != -* ]] || out=./$out
picture=${out%.*}-before-after.png

# A file name for a line of the report: control characters, such as a newline, become question marks.
printable() { echo "${1//[[:cntrl:]]/?}"; }

"$build/samples/l1l2stab/l1l2stab" "${options[@]}" -o "$out" -- "$in"

echo "measuring" >&2
result=$("$build/samples/measure-shake" --picture="$picture" "$in" "$out")
before=$(sed -n '1s/.*: \([0-9.]* px\)$/\1/p' <<<"$result")
after=$(sed -n '2s/.*: \([0-9.]* px\)$/\1/p' <<<"$result")
left=$(sed -n 's/^ratio: //p' <<<"$result" | LC_ALL=C awk '{ printf ": %.1f %% of it is left", 100 * $1 }')
cat <<END
input    $(printable "$in")
output   $(printable "$out")
picture  $(printable "$picture") (slit scan, before above after)
shake    $before before, $after after$left (rms jump of a frame's corner, at 640 px width)
END
