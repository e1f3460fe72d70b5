#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Makes the tree ready to use: installs missing Debian packages, downloads OSQP's source, configures and builds. It can
# be repeated, and takes a second or two when there is nothing to do. tests/run.sh and samples/stabilize.sh call it.
# usage: .ci/prepare.sh [BUILD_DIR [MESON_SETUP_OPTION...]]     (default: build, at the top of the tree)
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$(realpath -m "${1:-$top/build}")
options=("${@:2}")
overlay=$top/subprojects/packagefiles/osqp

# Free disk space that is needed, in megabytes. A minimal Debian lacks about 590 packages, and apt keeps their archives.
packages_need=2250
archives_need=610
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
  [[ $free -ge $2 ]] || die "not enough disk space for $3: $1 has $free MB free, about $2 MB are needed"
}

missing_packages() {
  local installed package
  installed=" $(dpkg-query -W -f '${Package}=${db:Status-Status}\n' | sed -n 's/=installed$//p' | tr '\n' ' ')"
  sed 's/#.*//' "$top/.ci/packages" | while read -r package; do
    [[ -z $package || $installed == *" $package "* ]] || echo "$package"
  done
}

# Runs a command as root, with sudo if needed. Without a terminal sudo must not ask for a password.
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
    say "this is not a Debian system: install what .ci/packages lists in your system's own way"
    return
  fi
  mapfile -t missing < <(missing_packages)
  [[ ${#missing[@]} -gt 0 ]] || return 0

  by_hand="apt-get install --no-install-recommends ${missing[*]}"
  if [[ $(id -u) -ne 0 ]]; then
    { command -v sudo >/dev/null && as_root true; } ||
      die "packages are missing and can only be installed as root. Run as root: $by_hand"
  fi
  need_space /usr "$packages_need" "the packages"
  need_space /var "$archives_need" "the packages"

  say "installing missing packages, which may take some minutes: ${missing[*]}"
  log=$(mktemp)
  # Update apt's lists only if the first attempt fails: then they may be missing or outdated.
  if ! apt install --no-install-recommends "${missing[@]}" >"$log" 2>&1 &&
    ! { apt update && apt install --no-install-recommends "${missing[@]}"; } >"$log" 2>&1; then
    sed -n 's/^[EW]: /  /p' "$log" | head -n 3 >&2
    die "apt-get could not install the packages (no network?). Its output is in $log. Run as root: $by_hand"
  fi
  rm -f "$log"
}

# Meson copies our files into OSQP's source only when it unpacks the source. This does it when one of them has changed.
refresh_overlay() {
  local file unpacked
  unpacked=$top/subprojects/$(sed -n 's/^directory *= *//p' "$top/subprojects/osqp.wrap")
  [[ -d $unpacked ]] || return 0
  for file in "$overlay"/*; do
    cmp -s "$file" "$unpacked/${file##*/}" || cp "$file" "$unpacked/"
  done
}

# Prints the tree that the build directory was configured for. It is another one if the tree was moved or copied.
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
  meson setup "${wipe[@]}" "${options[@]}" "$build" "$top" >&2 ||
    die "meson could not configure (see above). If $build is damaged, remove it and try again"
}

install_packages
"$top/subprojects/fetch-osqp.sh" >&2
refresh_overlay
mkdir -p "$build" 2>/dev/null || die "cannot write into ${build%/*}"
[[ -f $build/build.ninja ]] || need_space "$build" "$build_need" "the build"
configure
ninja --quiet -C "$build" | sed '/^ninja: no work to do/d' >&2 || die "the build failed (see above)"
