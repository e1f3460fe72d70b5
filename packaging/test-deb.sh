#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Installs the packages that build-deb.sh has made into a clean root of Debian, and runs their tests there: autopkgtest
# with packaging/debian/tests. Needs root or sudo.
# usage: packaging/test-deb.sh [DEB_DIR [SUITE]]      (default: build-deb, at the top of the tree; bookworm)
set -euo pipefail

packaging=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
debs=$(realpath "${1:-${packaging%/*}/build-deb}")
suite=${2:-bookworm}

say() { echo "test-deb: $*" >&2; }
as_root() { if [[ $(id -u) -eq 0 ]]; then "$@"; else sudo "$@"; fi; }

holder=$(mktemp -d)
trap 'as_root rm -rf --one-file-system "$holder"' EXIT
chmod 755 "$holder"
command -v autopkgtest >/dev/null || as_root env DEBIAN_FRONTEND=noninteractive \
  apt-get -q -y -o DPkg::Lock::Timeout=300 --no-install-recommends install autopkgtest apt-utils >/dev/null
say "making a clean root of $suite"
"$packaging/new-root.sh" "$holder/root" "$suite"

say "apt-get install of the packages, with what they need and recommend"
as_root mkdir "$holder/root/debs"
as_root cp "$debs"/*.deb "$holder/root/debs/"
as_root cp -a "$holder/root" "$holder/installed"
started=$SECONDS
as_root chroot "$holder/installed" sh -c '
  export DEBIAN_FRONTEND=noninteractive
  apt-get -q update && apt-get -q -y install $(ls /debs/*.deb | grep -v dbgsym) && l1l2stab --version' \
  >"$debs/install.log" 2>&1 || {
  tail -n 5 "$debs/install.log" >&2
  say "the packages could not be installed, see $debs/install.log"
  exit 1
}
say "installed in $((SECONDS - started)) s: $(tail -n 1 "$debs/install.log")"

started=$SECONDS
as_root autopkgtest --apt-upgrade --output-dir "$holder/results" "$debs"/*[!m]_*.deb "$debs"/*.dsc -- \
  chroot "$holder/root" || {
  status=$?
  say "autopkgtest failed with code $status"
  exit "$status"
}
say "the tests of the packages took $((SECONDS - started)) s"
