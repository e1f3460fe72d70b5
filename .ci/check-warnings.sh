#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Compiles the tree with gcc and with clang, where every warning is an error, and checks it with cppcheck.
# usage: .ci/check-warnings.sh [BUILD_DIR]      (default: build, at the top of the tree)
# It builds in BUILD_DIR-gcc and BUILD_DIR-clang.
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$(realpath -m "${1:-$top/build}")
status=0

for compiler in gcc:g++ clang:clang++; do
  name=${compiler%:*}
  env CC="$name" CXX="${compiler#*:}" "$top/.ci/prepare.sh" "$build-$name" --werror || status=1
done

# cppcheck's own choice of checks, without those of style. It does not know the macros of GLib.
cppcheck --quiet --error-exitcode=1 --std=c11 --enable=warning,performance,portability \
  --suppress=missingIncludeSystem --suppress=unknownMacro -I "$top/lib/include" -I "$top/lib/src" \
  "$top/lib/src" "$top/plugin/gstreamer" "$top/samples/l1l2stab" || status=1
exit "$status"
