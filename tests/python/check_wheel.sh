#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds the wheel, and runs it in a virtual environment, where the process must not load a library of the system's
# OpenCV. Then it runs it in a new minimal Debian, which has no OpenCV.
# usage: check_wheel.sh PYTHON BUILD_DIR
# The exit code is 77 if the wheel cannot be built for want of a source or of the network.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
python=$1
folder=$2/wheel
rm -rf "$folder"
mkdir -p "$folder"
wheel=$("$here/../../plugin/python/build-wheel.sh" "$folder" "$python")
echo "size: $(stat -c %s "$wheel") bytes"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$wheel" "$here/use_wheel.py" "$work"

# in_venv COMMAND...: installs the wheel in a virtual environment, and runs the check there. The command runs a shell.
in_venv() {
  "$@" sh -euc "cd /work 2>/dev/null || cd '$work'
    \$PYTHON -m venv venv
    venv/bin/pip install --quiet --disable-pip-version-check --retries 2 --timeout 20 ./${wheel##*/} || exit 77
    venv/bin/python use_wheel.py"
}

export PYTHON=$python
in_venv env

# The same in a Debian of the release that the wheel's Python is from.
mirror=$(find /etc/apt/sources.list /etc/apt/sources.list.d -name '*.sources' -o -name '*.list' 2>/dev/null | sort |
  xargs -r cat | grep -v '^ *#' | grep -oE '[a-z+]+:/[^ ]*/debian/?( |$)' | head -n 1 || true)
release=$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)
if [[ $(id -u) -ne 0 || -z $mirror || $python != /usr/bin/python3* ]] || ! command -v debootstrap >/dev/null; then
  echo "not tried in a new Debian: it needs root, debootstrap and Debian's own Python"
  exit 0
fi
root=$work/root
debootstrap --variant=minbase --include=python3,python3-venv,ca-certificates "$release" "$root" "${mirror// /}" \
  >"$folder/debootstrap.log" 2>&1 || { tail -n 3 "$folder/debootstrap.log"; exit 1; }
mkdir "$root/work"
cp "$wheel" "$here/use_wheel.py" "$root/work"
cp /etc/resolv.conf "$root/etc/"
[[ ! -f /etc/pip.conf ]] || cp /etc/pip.conf "$root/etc/"
[[ -z $(find "$root/usr/lib" -name 'libopencv*' -o -name 'libX11*') ]] || { echo "the root is not minimal"; exit 1; }
in_venv chroot "$root" env
