#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds the Debian packages of the last commit, installs them in a clean root, and runs their tests there.
# usage: check_packages.sh SOURCE_DIR BUILD_DIR
set -euo pipefail

top=$1
build=$2/packaging
skip() {
  echo "skipped: $*"
  exit 77
}

command -v apt-get >/dev/null || skip "this is not a Debian system"
[[ $(id -u) -eq 0 ]] || sudo -n true 2>/dev/null || skip "packages can only be installed as root"
git -C "$top" rev-parse --git-dir >/dev/null 2>&1 || skip "a tarball can only be made in a git repository"
suite=$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)

# Meson sets these for tests. They would slow every program down, and change what is built.
unset MALLOC_PERTURB_ ASAN_OPTIONS UBSAN_OPTIONS MSAN_OPTIONS GST_PLUGIN_PATH GST_REGISTRY
"$top/packaging/build-deb.sh" "$build"
"$top/packaging/test-deb.sh" "$build" "$suite"
