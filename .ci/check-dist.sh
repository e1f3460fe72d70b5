#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Makes the release tarball, unpacks it into an empty folder, and builds and tests it there without network.
# usage: .ci/check-dist.sh [BUILD_DIR]      (default: build-dist, at the top of the tree)
#        SUITES='guard lib' .ci/check-dist.sh      these suites of tests; default: lib
# The tarball has the last commit, not what is changed since. It is BUILD_DIR/tarball/meson-dist/*.tar.xz.
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$(realpath -m "${1:-$top/build-dist}")
read -ra suites <<<"${SUITES:-lib}"

say() { echo "check-dist: $*" >&2; }
die() {
  say "$*"
  exit 1
}

# Without network where the kernel allows it. Building needs none either way: nothing in meson.build downloads.
offline=()
for try in 'unshare --net' 'unshare --map-root-user --net'; do
  if $try true 2>/dev/null; then
    read -ra offline <<<"$try"
    break
  fi
done
[[ ${#offline[@]} -gt 0 ]] || say "unshare cannot turn the network off here: building with network"

rm -rf "$build"
mkdir -p "$build"
tarball=$("$top/.ci/make-tarball.sh" "$build/tarball")
say "made $tarball"

mkdir "$build/tree"
tar -xf "$tarball" -C "$build/tree" --strip-components=1
"${offline[@]}" meson setup "$build/new" "$build/tree" >/dev/null || die "the tarball could not be configured offline"
"${offline[@]}" ninja --quiet -C "$build/new" || die "the tarball could not be built offline"
status=0
"${offline[@]}" meson test -C "$build/new" --no-rebuild --print-errorlogs "${suites[@]/#/--suite=}" </dev/null ||
  status=$?
rm -rf "$build/meson-logs"
cp -r "$build/new/meson-logs" "$build/meson-logs"
python3 "$top/tests/totals.py" "$build/meson-logs/testlog.json" || status=1
exit "$status"
