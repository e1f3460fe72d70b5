#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Puts OSQP's source distribution, as pinned in osqp.wrap, into packagefiles/. Does nothing if it is there.
# usage: subprojects/fetch-osqp.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

# Debian's own: its setuptools and wheel are what pip needs to look into a source distribution.
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

# In the target's own directory, so that the last step is an atomic rename.
temporary=$(mktemp -d packagefiles/.fetch.XXXXXX 2>/dev/null) || die "cannot write into $PWD/packagefiles"
trap 'rm -rf "$temporary"' EXIT

name=${file%.tar.gz}
echo "${name%%-*}==${name#*-} --hash=sha256:$hash" >"$temporary/requirements.txt"
echo "fetch-osqp: getting $file from the Python package index"
"$python" -m pip download --quiet --disable-pip-version-check --no-input --no-cache-dir --retries 2 --timeout 20 \
  --no-deps --no-build-isolation --no-binary "${name%%-*}" --require-hashes -r "$temporary/requirements.txt" \
  -d "$temporary" >"$temporary/log" 2>&1 </dev/null || {
  reason=$(sed -n 's/^ *ERROR: //p' "$temporary/log" | tail -n 1)
  ! grep -q 'Retrying' "$temporary/log" || reason="the package index cannot be reached (no network?)"
  die "could not get $file: ${reason:-pip failed}. It can be put into $PWD/packagefiles by hand, too"
}
hash_fits "$temporary/$file" || die "$file came with another sha256 than $hash: not used"
mv -f "$temporary/$file" "$target"
