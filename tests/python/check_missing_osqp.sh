#!/bin/sh
# SPDX-License-Identifier: MIT
# Without OSQP's source, pip says which script to run. An sdist has it, and is installed without it being fetched.
# usage: check_missing_osqp.sh PYTHON
# The exit code is 77 without network.
set -eu

tree=$(realpath "$(dirname "$0")/../..")
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
"$1" -m venv "$dir/venv"
PATH=$dir/venv/bin:$PATH
pip install --quiet --disable-pip-version-check --retries 2 --timeout 20 build meson-python 'meson>=1.3' ninja cffi ||
  exit 77

git clone --quiet "$tree" "$dir/tree" 2>"$dir/log" || { cat "$dir/log"; exit 77; }
status=0
pip install --quiet --disable-pip-version-check --no-build-isolation "$dir/tree" >"$dir/log" 2>&1 || status=$?
if [ "$status" -eq 0 ] || ! grep -q 'ERROR: .*Run subprojects/fetch-osqp.sh first' "$dir/log"; then
  echo "pip without OSQP: exit status $status"
  tail -n 20 "$dir/log"
  exit 1
fi

cp "$tree"/subprojects/packagefiles/*.tar.gz "$dir/tree/subprojects/packagefiles/"
python -m build --no-isolation --sdist --outdir "$dir" "$dir/tree" >"$dir/log" 2>&1 || { cat "$dir/log"; exit 1; }
rm -rf "$dir/tree"
pip install --quiet --disable-pip-version-check --no-build-isolation "$dir"/l1l2stab-*.tar.gz
cd "$dir"
python -c 'import l1l2stab; print("installed from the sdist:", l1l2stab.__version__)'
