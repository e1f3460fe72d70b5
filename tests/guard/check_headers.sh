#!/bin/sh
# SPDX-License-Identifier: MIT
# A header, or each header of a directory, compiles alone and without a warning.
# usage: check_headers.sh HEADER_OR_DIRECTORY COMPILER [OPTION...]
set -eu

path=$1
shift
[ ! -d "$path" ] || path="$path/*.h"

status=0
IFS=
for header in $path; do
  "$@" -Wall -Wextra -Wpedantic -Wundef -Werror -fsyntax-only "$header" || status=1
done
exit $status
