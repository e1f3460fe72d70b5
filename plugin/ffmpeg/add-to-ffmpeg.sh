#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Adds the filter l1l2stab to a source tree of FFmpeg, from version 5.1 to 7.1. Afterwards configure the tree with
# --enable-libl1l2stab. Run again, it brings the filter and its documentation in the tree up to date.
# usage: add-to-ffmpeg.sh FFMPEG_SOURCE_TREE
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

die() {
  echo "add-to-ffmpeg: $*" >&2
  exit 1
}

[[ $# -eq 1 ]] || die "usage: add-to-ffmpeg.sh FFMPEG_SOURCE_TREE"
tree=$1
for file in configure libavfilter/Makefile libavfilter/allfilters.c doc/filters.texi; do
  [[ -w $tree/$file ]] || die "$tree is not a source tree of FFmpeg that can be changed: it has no writable $file"
done
new=$(mktemp)
trap 'rm -f "$new"' EXIT

# insert FILE NEIGHBOR LINE: puts a line after the only one that begins with NEIGHBOR, unless the file has it already.
insert() {
  local file=$tree/$1
  grep -qxF -- "$3" "$file" && return
  neighbor=$2 line=$3 awk '
    { print }
    index($0, ENVIRON["neighbor"]) == 1 { print ENVIRON["line"]; places++ }
    END { exit places != 1 }' "$file" >"$new" ||
    die "$1 has no place for the filter: exactly one line has to begin with '$2'. Is this FFmpeg older than 5.1 or" \
      "newer than 7.1?"
  cat "$new" >"$file"
}

# The documentation stands between two comments, so that it can be replaced.
add_documentation() {
  local file=$tree/doc/filters.texi
  text=$here/filters.texi awk '
    $0 == "@c l1l2stab: begin" { skipping = 1 }
    $0 == "@section lagfun" {
      print "@c l1l2stab: begin"
      while ((getline line < ENVIRON["text"]) > 0) print line
      print "@c l1l2stab: end"
      places++
    }
    !skipping { print }
    $0 == "@c l1l2stab: end" { skipping = 0 }
    END { exit places != 1 }' "$file" >"$new" || die "doc/filters.texi has no place for the filter"
  cmp -s "$new" "$file" || cat "$new" >"$file"
}

insert configure '  --enable-libkvazaar ' '  --enable-libl1l2stab     enable video stabilization using libl1l2stab [no]'
insert configure '    libkvazaar' '    libl1l2stab'
insert configure 'kerndeint_filter_deps=' 'l1l2stab_filter_deps="libl1l2stab"'
insert configure 'enabled libkvazaar ' \
  'enabled libl1l2stab       && require_pkg_config libl1l2stab "l1l2stab >= 0.2" l1l2stab/l1l2stab.h l1l2stab_create'
insert libavfilter/Makefile 'OBJS-$(CONFIG_KERNDEINT_FILTER)' \
  'OBJS-$(CONFIG_L1L2STAB_FILTER)               += vf_l1l2stab.o'
insert libavfilter/allfilters.c 'extern const AVFilter ff_vf_kerndeint;' 'extern const AVFilter ff_vf_l1l2stab;'
add_documentation
cmp -s "$here/vf_l1l2stab.c" "$tree/libavfilter/vf_l1l2stab.c" || cp "$here/vf_l1l2stab.c" "$tree/libavfilter/"
