#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds a small ffmpeg with the filter l1l2stab from Debian's source package, and prints the folder that it is in: its
# programs are in bin, its libraries in lib. It has only what the tests need. The first build takes minutes. Later
# ones find the source and the objects in a cache, and compile the filter alone if it has changed.
# usage: build-ffmpeg.sh BUILD_DIR [VERSION [FLAVOR]]
# VERSION: 5.1, Debian 12's (the default), or 7.1, Debian 13's
# FLAVOR:  lgpl (the default), or vidstab: with vid.stab and deshake for comparisons, and thereby under the GPL
# Environment: L1L2STAB_CACHE, the folder of the cache, by default ~/.cache/l1l2stab; JOBS, compilers at a time
# The exit code is 77 if the source or vid.stab cannot be had. Nothing of the system is changed: the source package is
# fetched with lists of apt that are in the cache.
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
build=$(realpath "$1")
version=${2:-5.1}
flavor=${3:-lgpl}
cache=${L1L2STAB_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/l1l2stab}
home=$cache/ffmpeg-$version-$flavor
tree=$home/tree
log=$home/log

say() { echo "build-ffmpeg: $*" >&2; }
skip() {
  say "skipped: $*"
  exit 77
}
die() {
  say "$* (its output is in $log)"
  tail -n 5 "$log" >&2
  exit 1
}

case $version in
  5.1) suite=bookworm ;;
  7.1) suite=trixie ;;
  *) say "no version $version: 5.1 or 7.1"; exit 2 ;;
esac

options=(
  --disable-everything --disable-autodetect --disable-doc --disable-debug --disable-stripping --disable-network
  --enable-pthreads --enable-shared --disable-static --disable-ffplay
  --enable-protocol=file,pipe --enable-indev=lavfi
  --enable-demuxer=avi,h264,matroska,mov,nut,rawvideo,yuv4mpegpipe
  --enable-muxer=framemd5,matroska,mov,mp4,null,nut,rawvideo,yuv4mpegpipe
  --enable-parser=aac,h264,mpeg4video
  --enable-decoder=aac,alac,ffv1,h264,mpeg4,msmpeg4v2,pcm_s16le,rawvideo,wrapped_avframe
  --enable-encoder=aac,ffv1,mpeg4,pcm_s16le,rawvideo,wrapped_avframe
  --enable-filter=addroi,anull,aformat,aresample,atrim,concat,crop,fifo,format,fps,hstack,null,overlay,pad,reverse
  --enable-filter=scale,select,sendcmd,setdar,setparams,setpts,setsar,settb,showinfo,split,testsrc2,trim
  --enable-libl1l2stab --enable-filter=l1l2stab
)
if [[ $flavor == vidstab ]]; then
  options+=(--enable-gpl --enable-libvidstab --enable-filter=deshake,vidstabdetect,vidstabtransform)
fi
command -v nasm >/dev/null || options+=(--disable-x86asm)

fetch() {
  local fetched=$home/fetched
  [[ ! -d $tree ]] || return 0
  command -v dpkg-source >/dev/null || skip "dpkg-source is not installed (package dpkg-dev)"
  say "fetching the source of FFmpeg $version"
  rm -rf "$fetched"
  mkdir -p "$fetched"
  "$top/.ci/apt-source.sh" ffmpeg "$suite" "$home/apt" "$fetched" >"$log" 2>&1 ||
    skip "the source of FFmpeg $version cannot be had: $(grep -m 1 '^[EW]: ' "$log" || echo "see $log")"
  mv "$fetched"/ffmpeg-"$version"*/ "$tree"
  rm -rf "$fetched" "$home/apt"
}

# The library as FFmpeg finds it: installed under $home/stage, with a pkg-config file.
stage() {
  meson install -C "$build" --no-rebuild --quiet --destdir "$home/stage" --tags runtime,devel >"$log" 2>&1 ||
    die "the library could not be installed for the build"
  PKG_CONFIG_SYSROOT_DIR=$home/stage
  PKG_CONFIG_PATH=$(dirname "$(find "$home/stage" -name l1l2stab.pc)")
  export PKG_CONFIG_SYSROOT_DIR PKG_CONFIG_PATH
}

# Configures the tree if that was not done with these options already.
configure() {
  local wanted
  wanted=$(cksum "$tree/configure"; printf '%s\n' "${options[@]}")
  [[ ! -f $home/configured || $(<"$home/configured") != "$wanted" ]] || return 0
  say "configuring FFmpeg $version"
  rm -f "$home/configured"
  (cd "$tree" && ./configure --prefix=/ "${options[@]}") >"$log" 2>&1 || die "FFmpeg could not be configured"
  echo "$wanted" >"$home/configured"
}

make_all() {
  say "building FFmpeg $version"
  nice make -C "$tree" -j"${JOBS:-$(nproc)}" >"$log" 2>&1 || die "FFmpeg could not be built"
  make -C "$tree" install-progs install-libs DESTDIR="$1" >>"$log" 2>&1 || die "FFmpeg could not be installed"
}

key=$({ cat "$top/plugin/ffmpeg/"* "$top/lib/include/l1l2stab/l1l2stab.h"; printf '%s\n' "${options[@]}"; } | sha256sum)
made=$home/made/${key:0:16}
if [[ ! -d $made ]]; then
  if [[ $flavor == vidstab ]]; then
    pkg-config --exists vidstab || skip "vid.stab is not installed (package libvidstab-dev)"
  fi
  mkdir -p "$home/made"
  exec 9>"$home/lock"
  flock 9
fi
if [[ ! -d $made ]]; then
  fetch
  "$top/plugin/ffmpeg/add-to-ffmpeg.sh" "$tree"
  stage
  configure
  rm -rf "$home/new"
  make_all "$home/new"
  mv "$home/new" "$made"
  # Each version of the filter has a folder. The oldest are removed.
  find "$home/made" -mindepth 1 -maxdepth 1 -printf '%T@ %p\n' | sort -rn | sed -e 1,4d -e 's/^[^ ]* //' |
    xargs -r rm -rf
fi
echo "$made"
