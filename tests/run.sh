#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds the tree, after installing missing packages, and runs the tests. The last line has the totals.
# usage: tests/run.sh [MESON_TEST_OPTION...]               all tests, or some: tests/run.sh --suite lib
#        tests/run.sh --sanitize [MESON_TEST_OPTION...]    the library's and the element's tests under AddressSanitizer
#                                                          and UndefinedBehaviorSanitizer, built in build-sanitize
#        tests/run.sh --threads [MESON_TEST_OPTION...]     the tests with several threads under ThreadSanitizer, built
#                                                          by clang in build-threads
#        tests/run.sh --valgrind [MESON_TEST_OPTION...]    the library's tests, but the slow ones, under valgrind: also
#                                                          values that were never set
#        tests/run.sh --long [MESON_TEST_OPTION...]        only the long tests, which the others leave out: the filter
#                                                          in an ffmpeg that they build, half an hour at first; Debian
#                                                          packages, built and installed in a clean root; the Python
#                                                          wheel with an OpenCV that they build; the library for ARM
#                                                          and other processors under an emulator; soaks, 1,000
#                                                          damaged files
# The environment variable BUILD_DIR names another build directory. CC and CXX choose the compiler of a new one.
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
setup=()
test_options=()
build=$top/build
if [[ ${1:-} == --sanitize ]]; then
  shift
  build=$top/build-sanitize
  # clang does not link a sanitizer's runtime into a shared library, so undefined symbols have to be allowed there.
  setup=(-Db_sanitize=address,undefined -Db_lundef=false -Dbuildtype=debugoptimized)
  test_options=(--timeout-multiplier 10)
  export CK_TIMEOUT_MULTIPLIER=10 # for the timeout that Check has for each test of a program
  [[ $# -gt 0 ]] || test_options+=(--suite lib --suite plugin)
  export ASAN_OPTIONS=${ASAN_OPTIONS:-detect_leaks=1:strict_string_checks=1:detect_stack_use_after_return=1}
  export UBSAN_OPTIONS=${UBSAN_OPTIONS:-halt_on_error=1:print_stacktrace=1}
elif [[ ${1:-} == --threads ]]; then
  shift
  build=$top/build-threads
  setup=(-Dsamples=false -Db_sanitize=thread -Db_lundef=false -Dbuildtype=debugoptimized)
  # One at a time: the sanitizer makes each of them slow. A codec's own threads are none of this project's.
  test_options=(--timeout-multiplier 10 --num-processes 1 --no-suite codecs)
  export CC=clang CXX=clang++ CK_TIMEOUT_MULTIPLIER=10
  [[ $# -gt 0 ]] || test_options+=(--suite threads --suite plugin)
elif [[ ${1:-} == --valgrind ]]; then
  shift
  wrapper='valgrind --quiet --error-exitcode=9 --leak-check=full --errors-for-leak-kinds=definite'
  test_options=(--timeout-multiplier 40 --wrapper "$wrapper --suppressions=$top/tests/valgrind.supp")
  export CK_TIMEOUT_MULTIPLIER=40
  [[ $# -gt 0 ]] || test_options+=(--suite lib --no-suite slow --no-suite threads)
elif [[ ${1:-} == --long ]]; then
  shift
  test_options=(--suite long)
fi
build=${BUILD_DIR:-$build}
log=$build/meson-logs/testlog.json

"$top/.ci/prepare.sh" "$build" "${setup[@]}"

rm -f "$log"
status=0
meson test -C "$build" --no-rebuild --print-errorlogs "${test_options[@]}" "$@" </dev/null || status=$?
python3 "$top/tests/totals.py" "$log" || status=1
exit "$status"
