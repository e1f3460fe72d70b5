#!/bin/sh
# SPDX-License-Identifier: MIT
# A header, or each header in a directory, compiles on its own and without warnings.
# usage: check_headers.sh HEADER_OR_DIRECTORY COMPILER [OPTION...]
set -eu

path=$1
shift
headers=$(find "$path" -name '*.h' | sort)

status=0
IFS='
'
for header in $headers; do
  case $header in
    */x86/*) simd=-mavx2 ;;
    *) simd=-Wundef ;; # no more options are needed
  esac
  "$@" -Wall -Wextra -Wpedantic -Wundef -Werror "$simd" -fsyntax-only "$header" || status=1
done
exit $status
