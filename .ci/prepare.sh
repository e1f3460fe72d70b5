#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Makes the tree ready to use: installs the Debian packages that are missing, gets OSQP's source, configures and builds.
# Safe to repeat; a second or two when there is nothing to do. tests/run.sh and samples/stabilize.sh begin with it.
# usage: .ci/prepare.sh [BUILD_DIR]     (default: build, at the top of the tree)
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$(realpath -m "${1:-$top/build}")
overlay=$top/subprojects/packagefiles/osqp/meson.build

# Megabytes that have to be free: on a bare Debian some 540 packages, of which apt keeps the archives; and the build.
packages_need=1700
archives_need=450
build_need=100

say() { echo "prepare: $*" >&2; }
die() {
  say "$*"
  exit 1
}

# need_space DIRECTORY MEGABYTES WHAT
need_space() {
  local free
  free=$(df -Pm "$1" | awk 'NR == 2 { print $4 }')
  [[ $free -ge $2 ]] || die "too little disk space for $3: $1 has $free MB free, about $2 MB are needed"
}

missing_packages() {
  local installed package
  installed=" $(dpkg-query -W -f '${Package}=${db:Status-Status}\n' | sed -n 's/=installed$//p' | tr '\n' ' ')"
  sed 's/#.*//' "$top/.ci/packages" | while read -r package; do
    [[ -z $package || $installed == *" $package "* ]] || echo "$package"
  done
}

# As root, by sudo, or not at all; never waits for a password when there is nobody to type it.
as_root() {
  if [[ $(id -u) -eq 0 ]]; then
    "$@"
  elif [[ -t 0 ]]; then
    sudo "$@"
  else
    sudo -n "$@"
  fi
}

apt() {
  as_root env DEBIAN_FRONTEND=noninteractive \
    apt-get -q -y -o DPkg::Lock::Timeout=300 -o Acquire::Retries=2 "$@" </dev/null
}

install_packages() {
  local by_hand log missing
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    say "not a Debian system: the packages named in .ci/packages are taken to be there"
    return
  fi
  mapfile -t missing < <(missing_packages)
  [[ ${#missing[@]} -gt 0 ]] || return 0

  by_hand="apt-get install --no-install-recommends ${missing[*]}"
  if [[ $(id -u) -ne 0 ]]; then
    { command -v sudo >/dev/null && as_root true; } ||
      die "packages are missing, and there is no right to install them. As root: $by_hand"
  fi
  need_space /usr "$packages_need" "the packages"
  need_space /var "$archives_need" "the packages"

  say "installing what is missing, which may take some minutes: ${missing[*]}"
  log=$(mktemp)
  # The lists may be absent or out of date: refreshed only when the first attempt fails.
  if ! apt install --no-install-recommends "${missing[@]}" >"$log" 2>&1 &&
    ! { apt update && apt install --no-install-recommends "${missing[@]}"; } >"$log" 2>&1; then
    sed -n 's/^[EW]: /  /p' "$log" | head -n 3 >&2
    die "apt-get could not install them (no network?); all it said is in $log. By hand, as root: $by_hand"
  fi
  rm -f "$log"
}

# Meson lays our overlay over OSQP's source only when it unpacks it.
refresh_overlay() {
  local unpacked
  unpacked=$(sed -n 's/^directory *= *//p' "$top/subprojects/osqp.wrap")
  unpacked=$top/subprojects/$unpacked
  [[ ! -d $unpacked ]] || cmp -s "$overlay" "$unpacked/meson.build" || cp "$overlay" "$unpacked/meson.build"
}

# The tree that the build directory belongs to: another one if it was moved or copied.
configured_for() {
  python3 -c 'import json, sys; print(json.load(open(sys.argv[1]))["directories"]["source"])' \
    "$build/meson-info/meson-info.json" 2>/dev/null || true
}

configure() {
  local wipe=()
  if [[ -f $build/build.ninja ]]; then
    [[ $(configured_for) != "$top" ]] || return 0
    wipe=(--wipe)
  fi
  say "configuring $build"
  meson setup "${wipe[@]}" "$build" "$top" >&2 ||
    die "meson could not configure (see above); if $build is damaged, remove it and try again"
}

install_packages
"$top/subprojects/fetch-osqp.sh" >&2
refresh_overlay
mkdir -p "$build" 2>/dev/null || die "cannot write into ${build%/*}"
[[ -f $build/build.ninja ]] || need_space "$build" "$build_need" "the build"
configure
ninja --quiet -C "$build" | sed '/^ninja: no work to do/d' >&2 || die "the build failed (see above)"
