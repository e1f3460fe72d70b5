#!/bin/sh
# SPDX-License-Identifier: MIT
# A header, or each header in a directory, compiles on its own and without warnings.
# usage: check_headers.sh HEADER_OR_DIRECTORY COMPILER [OPTION...]
set -eu

path=$1
shift
headers=$(find "$path" -name '*.h' | sort)

avx2=-Wundef # no more options are needed
if echo 'int a;' | "$@" -Werror -mavx2 -fsyntax-only -xc - 2>/dev/null; then
  avx2=-mavx2 # a compiler for x86
fi

status=0
IFS='
'
for header in $headers; do
  case $header in
    */x86/*) simd=$avx2 ;;
    *) simd=-Wundef ;;
  esac
  "$@" -Wall -Wextra -Wpedantic -Wundef -Werror "$simd" -fsyntax-only "$header" || status=1
done
exit $status
