#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Lays the Debian packaging over an unpacked release tarball, so that dpkg-buildpackage works in it.
# usage: packaging/lay-over.sh TREE
set -euo pipefail

packaging=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
tree=${1:?usage: packaging/lay-over.sh TREE}
header=$tree/lib/include/l1l2stab/l1l2stab.h

die() {
  echo "lay-over: $*" >&2
  exit 1
}
[[ -f $header ]] || die "$tree is not the tree of l1l2stab: it has no lib/include/l1l2stab/l1l2stab.h"

number() { sed -n "s/^#define L1L2STAB_VERSION_$1 *//p" "$header"; }
version=$(number MAJOR).$(number MINOR).$(number PATCH)
packaged=$(sed -n '1s/.*(\(.*\)-[^-]*).*/\1/p' "$packaging/debian/changelog")
[[ $packaged == "$version" ]] ||
  die "the tree has version $version, packaging/debian/changelog has $packaged: add an entry to it"

# The name of the library's package follows the soname, which lib/meson.build makes of the version.
soname=$(number MAJOR)
[[ $soname != 0 ]] || soname=0.$(number MINOR)
grep -qx "Package: libl1l2stab$soname" "$packaging/debian/control" ||
  die "the soname is libl1l2stab.so.$soname: rename the library's package in packaging/debian to libl1l2stab$soname"

rm -rf "$tree/debian"
cp -r "$packaging/debian" "$tree/debian"
