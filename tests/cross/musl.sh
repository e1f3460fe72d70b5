#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Compiles all of the library's C files for musl, where every warning is an error, and links the benchmarks of the path
# and of the warp with nothing else. The C++ file is compiled for glibc and not linked: Debian has no C++ library for
# musl.
# usage: tests/cross/musl.sh BUILD_DIR      (uses BUILD_DIR/cross/musl)
# The exit code is 77 without musl-gcc.
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
build=$(realpath -m "${1:?usage: tests/cross/musl.sh BUILD_DIR}")/cross/musl
command -v musl-gcc >/dev/null || {
  echo "skipped: musl-gcc is missing (Debian's package musl-tools)"
  exit 77
}
unset MALLOC_PERTURB_ # set by meson for tests; it would slow the compiler down

mkdir -p "$build"
printf '[binaries]\nc = %s\n' "'musl-gcc'" >"$build/native.ini"
if [[ ! -f $build/build/build.ninja ]]; then
  env -u CC -u CXX meson setup --native-file "$build/native.ini" --werror -Dplugin=false -Dsamples=false \
    -Dpython=disabled -Dtests=false "$build/build" "$top" >"$build/setup.log"
fi
osqp=subprojects/$(sed -n 's/^directory *= *//p' "$top/subprojects/osqp.wrap")/libosqp.a
ninja --quiet -C "$build/build" lib/libl1l2stab-internal.a "$osqp"
cd "$build/build"
for name in bench_path bench_warp; do
  musl-gcc -static -std=c11 -D_GNU_SOURCE -I"$top/lib/include" -I"$top/lib/src" "$top/tests/bench/$name.c" \
    -o "$build/$name" lib/libl1l2stab-internal.a "$osqp" -lm
done
