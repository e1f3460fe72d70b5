#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds the tree (installing what is missing) and runs all tests. The last line has the totals.
# usage: tests/run.sh [MESON_TEST_OPTION...]     such as: tests/run.sh --suite lib
#        BUILD_DIR=dir tests/run.sh              another build directory than build
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${BUILD_DIR:-$top/build}
log=$build/meson-logs/testlog.json

"$top/.ci/prepare.sh" "$build"

rm -f "$log"
status=0
meson test -C "$build" --no-rebuild --print-errorlogs "$@" </dev/null || status=$?
python3 "$top/tests/totals.py" "$log" || status=1
exit "$status"
