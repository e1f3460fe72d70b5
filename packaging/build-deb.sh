#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds Debian packages of the last commit, on this system or in a clean root of Debian, and checks them with lintian.
# It installs what the build needs, as root or with sudo.
# usage: packaging/build-deb.sh [OUT_DIR]            on this system (default: build-deb, at the top of the tree)
#        packaging/build-deb.sh OUT_DIR ROOT         in a root directory that packaging/new-root.sh has made
# OUT_DIR is made anew. DEB_BUILD_OPTIONS=nocheck leaves out the library's tests.
set -euo pipefail

packaging=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
top=${packaging%/*}
out=$(realpath -m "${1:-$top/build-deb}")
root=${2:-}
name=l1l2stab
tools=(build-essential debhelper devscripts fakeroot lintian)
# For the tarball: git, and what subprojects/fetch-osqp.sh downloads OSQP's source with.
tarball_tools=(ca-certificates git python3-pip python3-setuptools python3-setuptools-scm python3-wheel xz-utils)

say() { echo "build-deb: $*" >&2; }
as_root() { if [[ $(id -u) -eq 0 ]]; then "$@"; else sudo "$@"; fi; }

# here COMMAND..., in_root COMMAND...: runs a command as root in a folder, on this system or in the root directory.
here() { (cd "$packaging" && as_root "$@"); }
in_root() { as_root chroot "$root" env LC_ALL=C.UTF-8 sh -c 'cd "/build/$0" && exec "$@"' "${tree##*/}" "$@"; }
# install WHERE PACKAGE...: these packages, and those that the folder's debian/control needs for the build
install() {
  local apt=("$1" env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o DPkg::Lock::Timeout=300 --no-install-recommends)
  shift
  { { "${apt[@]}" install "$@" || { "${apt[@]}" update && "${apt[@]}" install "$@"; }; } &&
    "${apt[@]}" build-dep .; } >>"$out/apt.log" 2>&1 || {
    tail -n 5 "$out/apt.log" >&2
    say "apt-get failed: see $out/apt.log"
    exit 1
  }
}
# Runs a command in the unpacked tree, on this system or in the root directory.
in_tree() {
  if [[ -n $root ]]; then
    in_root env "DEB_BUILD_OPTIONS=${DEB_BUILD_OPTIONS:-}" "$@"
  else
    (cd "$tree" && "$@")
  fi
}

rm -rf "$out"
mkdir -p "$out"
say "installing what the build needs"
install here "${tools[@]}" "${tarball_tools[@]}"

tarball=$("$top/.ci/make-tarball.sh" "$out/tarball")
version=${tarball##*/"$name"-}
version=${version%.tar.xz}
tree=$out/$name-$version
cp "$tarball" "$out/${name}_$version.orig.tar.xz"
tar -xf "$tarball" -C "$out"
"$packaging/lay-over.sh" "$tree"
rm -rf "$out/tarball"
if [[ -n $root ]]; then
  as_root rm -rf "$root/build"
  as_root cp -r "$out" "$root/build"
  install in_root "${tools[@]}"
fi

say "building, see $out/build.log"
in_tree dpkg-buildpackage -us -uc >"$out/build.log" 2>&1 || {
  tail -n 30 "$out/build.log" >&2
  exit 1
}
say "checking with lintian"
in_tree sh -c 'lintian --fail-on error --suppress-tags bad-distribution-in-changes-file ../*.changes' |
  tee "$out/lintian.log"
[[ -z $root ]] || as_root sh -c "cp $root/build/*.deb $root/build/*.dsc $root/build/*.debian.tar.xz $out/"
ls "$out"/*.deb
