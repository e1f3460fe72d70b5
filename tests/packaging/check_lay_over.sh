#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The Debian packaging belongs to this version and soname, and packaging/lay-over.sh notices if it does not.
# usage: check_lay_over.sh SOURCE_DIR
set -euo pipefail

top=$1
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
header=$tree/lib/include/l1l2stab/l1l2stab.h

# lays_over EXPECTED_MESSAGE: it has to fail with this message
fails_with() {
  local said
  if said=$("$top/packaging/lay-over.sh" "$tree" 2>&1); then
    echo "lay-over.sh accepts a tree that it has to refuse"
    exit 1
  fi
  [[ $said == *"$1"* ]] || {
    echo "lay-over.sh says '$said', not '$1'"
    exit 1
  }
}

fails_with 'is not the tree of l1l2stab'
mkdir -p "${header%/*}"
cp "$top/lib/include/l1l2stab/l1l2stab.h" "$header"
"$top/packaging/lay-over.sh" "$tree"
[[ -x $tree/debian/rules ]]

sed -i 's/\(#define L1L2STAB_VERSION_PATCH\).*/\1 99/' "$header"
fails_with 'add an entry'
