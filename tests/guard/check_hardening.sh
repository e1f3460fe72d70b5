#!/bin/sh
# SPDX-License-Identifier: MIT
# Shared objects check their stack, have no executable one, and resolve all addresses before they run, in a table that
# is read-only then.
# usage: check_hardening.sh FILE...
#        check_hardening.sh --self-test       an object without any of that fails. Uses $CC
set -eu

# faults FILE: what is missing, one line each
faults() {
  nm -D --undefined-only "$1" | grep -q '__stack_chk_fail' || echo "$1 does not check its stack"
  readelf -dW "$1" | grep -Eq 'BIND_NOW|FLAGS_1.*NOW' || echo "$1 resolves addresses late"
  readelf -lW "$1" | grep -q 'GNU_RELRO' || echo "$1 has a writable table of addresses"
  readelf -lW "$1" | grep -Eq 'GNU_STACK.* RW ' || echo "$1 has an executable stack"
}

if [ "$1" = --self-test ]; then
  folder=$(mktemp -d)
  trap 'rm -rf "$folder"' EXIT
  echo 'int nothing(void) { return 0; }' >"$folder/soft.c"
  $CC -shared -fPIC -fno-stack-protector -Wl,-z,lazy,-z,norelro,-z,execstack "$folder/soft.c" -o "$folder/soft.so"
  found=$(faults "$folder/soft.so" | wc -l)
  [ "$found" -eq 4 ] || {
    echo "an object without protection has $found of 4 faults"
    exit 1
  }
  exit 0
fi

all=$(for file; do faults "$file"; done)
[ -z "$all" ] || {
  echo "$all"
  exit 1
}
