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

# in_venv FOLDER COMMAND...: installs the wheel of a folder in a virtual environment there, without network, and runs
# the check with it. The command runs a shell.
in_venv() {
  local folder=$1
  shift
  "$@" sh -euc "cd '$folder'
    '$python' -m venv venv
    venv/bin/pip install --quiet --disable-pip-version-check --no-index --find-links . l1l2stab
    venv/bin/python use_wheel.py"
}

# The wheel, and those of cffi and numpy
mkdir "$work/wheels"
"$python" -m venv "$work/pip"
"$work/pip/bin/pip" download --quiet --disable-pip-version-check --retries 2 --timeout 20 -d "$work/wheels" "$wheel"
cp "$here/use_wheel.py" "$work/wheels"
in_venv "$work/wheels" env

# The same in a Debian of the release that the wheel's Python is from.
mirror=$(find /etc/apt/sources.list /etc/apt/sources.list.d -name '*.sources' -o -name '*.list' 2>/dev/null | sort |
  xargs -r cat | grep -v '^ *#' | grep -oE '[a-z+]+:/[^ ]*/debian/?( |$)' | head -n 1 || true)
release=$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)
if [[ $(id -u) -ne 0 || -z $mirror || $python != /usr/bin/python3* ]] || ! command -v debootstrap >/dev/null; then
  echo "not tried in a new Debian: it needs root, debootstrap and Debian's own Python"
  exit 0
fi
root=$work/root
debootstrap --variant=minbase --include=python3,python3-venv "$release" "$root" "${mirror// /}" \
  >"$folder/debootstrap.log" 2>&1 || { tail -n 3 "$folder/debootstrap.log"; exit 1; }
mkdir "$root/wheels"
cp "$work/wheels"/*.whl "$here/use_wheel.py" "$root/wheels"
[[ -z $(find "$root/usr/lib" -name 'libopencv*' -o -name 'libX11*') ]] || { echo "the root is not minimal"; exit 1; }
echo "in a new Debian:"
in_venv /wheels chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin
