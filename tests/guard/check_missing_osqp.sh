#!/bin/sh
# SPDX-License-Identifier: MIT
# Without OSQP's source, meson downloads nothing: it stops and says which script to run.
# usage: check_missing_osqp.sh TREE
set -eu

tree=$(realpath "$1")
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
mkdir -p "$dir/tree/subprojects/packagefiles"
cp -r "$tree/meson.build" "$tree/meson_options.txt" "$tree/lib" "$dir/tree"
cp "$tree/subprojects/osqp.wrap" "$tree/subprojects/fetch-osqp.sh" "$dir/tree/subprojects"
cp -r "$tree/subprojects/packagefiles/osqp" "$dir/tree/subprojects/packagefiles"

status=0
meson setup -Dplugin=false -Dsamples=false -Dtests=false "$dir/build" "$dir/tree" >"$dir/log" 2>&1 || status=$?
if [ "$status" -eq 0 ] || ! grep -q 'ERROR: .*Run subprojects/fetch-osqp.sh first' "$dir/log"; then
  echo "exit status $status"
  tail -n 5 "$dir/log"
  exit 1
fi
if [ -n "$(find "$dir/tree/subprojects" -name '*.tar.gz')" ]; then
  echo "meson downloaded OSQP"
  exit 1
fi
