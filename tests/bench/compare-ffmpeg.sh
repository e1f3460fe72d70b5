#!/bin/sh
# SPDX-License-Identifier: MIT
# Compares the speed of the library with that of FFmpeg's vidstabdetect + vidstabtransform and deshake, with default
# settings, on the same file and cores. The library runs as the filter of the same ffmpeg, and as the GStreamer element.
# It prints CPU and wall time per frame less the time of decoding, in ms, medians. The programs take turns, so that all
# run under the same load. The cost of tracking is the difference to a run that reads the motion from a file.
# compare_quality.py compares the results.
# usage: compare-ffmpeg.sh BUILD [CLIP.mp4 [ROUNDS [CORES]]]
# Without a clip, or with an empty one: 1080p30 of the test scene. ROUNDS: by default 5. CORES: as taskset has them, by
# default 0,1.
# Needs GNU time. The ffmpeg is a small one that tests/ffmpeg/build-ffmpeg.sh builds, which takes minutes at first. It
# needs libvidstab-dev.
set -eu

build=$(realpath "$1")
rounds=${3:-5}
cores=${4:-0,1}
export GST_PLUGIN_PATH="$build/plugin/gstreamer"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

ffmpeg_folder=$("$(dirname "$0")/../ffmpeg/build-ffmpeg.sh" "$build" 5.1 vidstab)
by_small() {
  program=$ffmpeg_folder/bin/$1
  shift
  env LD_LIBRARY_PATH="$ffmpeg_folder/lib:$build/lib" "$program" "$@"
}

clip=${2:-}
if [ -z "$clip" ]; then
  clip=$work/clip.mp4
  "$build/samples/render-shaky" "$work/small.mp4" > "$work/log" 2>&1
  gst-launch-1.0 -q filesrc location="$work/small.mp4" ! decodebin ! identity eos-after=241 ! \
    videoscale method=lanczos ! video/x-raw,width=1920,height=1080 ! x264enc pass=qual quantizer=20 \
    speed-preset=veryfast ! h264parse ! mp4mux ! filesink location="$clip"
fi
frames=$(by_small ffprobe -v error -select_streams v -count_packets -show_entries stream=nb_read_packets -of csv=p=0 \
  "$clip" | tr -d ',')

measured() { /usr/bin/time -f "$what %U %S %e" -a -o "$work/measured" taskset -c "$cores" "$@"; }
by_ffmpeg() {
  measured env LD_LIBRARY_PATH="$ffmpeg_folder/lib:$build/lib" \
    "$ffmpeg_folder/bin/ffmpeg" -v error -nostdin -i "$clip" -an "$@" -f null -
}
by_gst() { measured gst-launch-1.0 -q filesrc location="$clip" ! parsebin ! avdec_h264 "$@" ! fakesink; }

run() {
  case $what in
    ffmpeg-decode) by_ffmpeg ;;
    vidstabdetect) by_ffmpeg -vf "vidstabdetect=result=$work/motion.trf" ;;
    vidstabtransform) by_ffmpeg -vf "vidstabtransform=input=$work/motion.trf" ;;
    deshake) by_ffmpeg -vf deshake ;;
    filter) by_ffmpeg -vf l1l2stab ;;
    filter-bilinear) by_ffmpeg -vf l1l2stab=interpolation=bilinear ;;
    gst-decode) by_gst ;;
    bicubic) by_gst ! l1l2stab motion-out="$work/motion.txt" ;;
    given) by_gst ! l1l2stab motion-in="$work/motion.txt" ;;
    bilinear) by_gst ! l1l2stab interpolation=bilinear ;;
  esac
}

all='ffmpeg-decode vidstabdetect vidstabtransform deshake filter filter-bilinear gst-decode bicubic given bilinear'
for round in $(seq "$rounds"); do
  for what in $all; do
    run > "$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }
  done
done

# median WHAT COLUMN: ms a frame; 1 is CPU, 2 is wall time
median() {
  awk -v what="$1" -v column="$2" -v frames="$frames" \
    '$1 == what { print (column == 1 ? $2 + $3 : $4) * 1000 / frames }' "$work/measured" | sort -g |
    awk '{ v[NR] = $1 } END { print NR % 2 ? v[(NR + 1) / 2] : (v[NR / 2] + v[NR / 2 + 1]) / 2 }'
}

above() { echo "$(median "$1" "$3") $(median "$2" "$3")" | awk '{ print $1 - $2 }'; }

{
  for column in 1 2; do
    for what in $all; do
      case $what in
        *-decode) echo "$column $what $(median "$what" "$column")" ;;
        bi* | given) echo "$column $what $(above "$what" gst-decode "$column")" ;;
        *) echo "$column $what $(above "$what" ffmpeg-decode "$column")" ;;
      esac
    done
  done
} | awk -v frames="$frames" -v rounds="$rounds" '
  { ms[$1, $2] = $3 }
  function line(name, what) { printf "%-42s %8.2f %8.2f\n", name, ms[1, what], ms[2, what] }
  function ratio(name, c, w) { printf "%-42s %8.1f %8.1f\n", name, c, w }
  END {
    for (c = 1; c <= 2; c++) vidstab[c] = ms[c, "vidstabdetect"] + ms[c, "vidstabtransform"]
    printf "%d frames, medians of %d; ms a frame              CPU     wall\n", frames, rounds
    line("decoding alone, ffmpeg", "ffmpeg-decode")
    line("decoding alone, gst-launch-1.0", "gst-decode")
    print "above decoding:"
    line("  vidstabdetect", "vidstabdetect")
    line("  vidstabtransform (bilinear)", "vidstabtransform")
    line("  deshake", "deshake")
    line("  l1l2stab (bicubic)", "filter")
    line("  l1l2stab interpolation=bilinear", "filter-bilinear")
    line("  the element (bicubic)", "bicubic")
    line("  the element, interpolation=bilinear", "bilinear")
    for (c = 1; c <= 2; c++) ms[c, "tracking"] = ms[c, "bicubic"] - ms[c, "given"]
    line("  the element, tracking alone", "tracking")
    print "times as fast:"
    two = "vidstabdetect + vidstabtransform"
    ratio("  l1l2stab over " two, vidstab[1] / ms[1, "filter"], vidstab[2] / ms[2, "filter"])
    ratio("  bilinear over " two, vidstab[1] / ms[1, "filter-bilinear"], vidstab[2] / ms[2, "filter-bilinear"])
    ratio("  the element over " two, vidstab[1] / ms[1, "bicubic"], vidstab[2] / ms[2, "bicubic"])
    ratio("  the element, bilinear, over " two, vidstab[1] / ms[1, "bilinear"], vidstab[2] / ms[2, "bilinear"])
    ratio("  tracking over vidstabdetect", ms[1, "vidstabdetect"] / ms[1, "tracking"],
          ms[2, "vidstabdetect"] / ms[2, "tracking"])
    ratio("  l1l2stab over deshake", ms[1, "deshake"] / ms[1, "filter"], ms[2, "deshake"] / ms[2, "filter"])
  }'
