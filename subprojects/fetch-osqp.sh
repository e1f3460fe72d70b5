#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Downloads OSQP's source distribution into packagefiles/. osqp.wrap pins it by its hash. Does nothing if it is there.
# usage: subprojects/fetch-osqp.sh
# Without network, copy the file into packagefiles/ from elsewhere.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

# The system's Python, because pip needs the setuptools and wheel packages installed for it.
python=/usr/bin/python3

wrap_value() { sed -n "s/^$1 *= *//p" osqp.wrap; }
file=$(wrap_value source_filename)
hash=$(wrap_value source_hash)
target=packagefiles/$file

hash_fits() { [[ -f $1 ]] && echo "$hash  $1" | sha256sum --check --status; }
die() {
  echo "fetch-osqp: $*" >&2
  exit 1
}

if hash_fits "$target"; then
  exit 0
fi
for module in pip setuptools wheel setuptools_scm; do
  "$python" -c "import $module" 2>/dev/null ||
    die "$python has no $module: apt-get install python3-pip python3-setuptools python3-setuptools-scm python3-wheel"
done

# The temporary directory is in the same folder as the target, so that the last step is an atomic rename.
temporary=$(mktemp -d packagefiles/.fetch.XXXXXX 2>/dev/null) || die "cannot write into $PWD/packagefiles"
trap 'rm -rf "$temporary"' EXIT

name=${file%.tar.gz}
echo "${name%%-*}==${name#*-} --hash=sha256:$hash" >"$temporary/requirements.txt"
echo "fetch-osqp: downloading $file from the Python package index"
"$python" -m pip download --quiet --disable-pip-version-check --no-input --no-cache-dir --retries 2 --timeout 20 \
  --no-deps --no-build-isolation --no-binary "${name%%-*}" --require-hashes -r "$temporary/requirements.txt" \
  -d "$temporary" >"$temporary/log" 2>&1 </dev/null || {
  reason=$(sed -n 's/^ *ERROR: //p' "$temporary/log" | tail -n 1)
  ! grep -q 'Retrying' "$temporary/log" || reason="the package index cannot be reached (no network?)"
  die "could not download $file: ${reason:-pip failed}. You can also copy it into $PWD/packagefiles"
}
hash_fits "$temporary/$file" || die "$file does not have the sha256 $hash: it was removed"
mv -f "$temporary/$file" "$target"
