#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Makes a clean root directory of Debian by debootstrap, from the mirror that this system uses. Needs root or sudo.
# usage: packaging/new-root.sh DIRECTORY [SUITE]      (default: bookworm)
set -euo pipefail

root=$(realpath -m "${1:?usage: packaging/new-root.sh DIRECTORY [SUITE]}")
suite=${2:-bookworm}

as_root() { if [[ $(id -u) -eq 0 ]]; then "$@"; else sudo "$@"; fi; }
mirror=$("$(dirname "${BASH_SOURCE[0]}")/../.ci/debian-mirror.sh")

command -v debootstrap >/dev/null || as_root env DEBIAN_FRONTEND=noninteractive \
  apt-get -q -y -o DPkg::Lock::Timeout=300 --no-install-recommends install debootstrap >/dev/null
[[ ! -e $root ]] || {
  echo "new-root: $root exists already" >&2
  exit 1
}
as_root debootstrap --variant=minbase "$suite" "$root" ${mirror:+"$mirror"} >"$root.log" 2>&1 || {
  tail -n 3 "$root.log" >&2
  echo "new-root: debootstrap failed, see $root.log" >&2
  exit 1
}
rm -f "$root.log"
# The packages of a root for tests need not survive a power failure.
echo force-unsafe-io | as_root tee "$root/etc/dpkg/dpkg.cfg.d/unsafe-io" >/dev/null
