#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Makes the release tarball, with OSQP's source in it, from the last commit. The last line of output is its name.
# usage: .ci/make-tarball.sh BUILD_DIR      (made anew: the tarball is BUILD_DIR/meson-dist/*.tar.xz)
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$(realpath -m "${1:?usage: .ci/make-tarball.sh BUILD_DIR}")

git -C "$top" rev-parse --git-dir >/dev/null 2>&1 || {
  echo "make-tarball: a tarball can only be made in a git repository" >&2
  exit 1
}
rm -rf "$build"
"$top/subprojects/fetch-osqp.sh" >&2
meson setup -Dplugin=false -Dsamples=false -Dtests=false "$build" "$top" >/dev/null
meson dist -C "$build" --include-subprojects --no-tests --allow-dirty >/dev/null
ls "$build"/meson-dist/*.tar.xz
