#!/bin/sh
# SPDX-License-Identifier: MIT
# A shared object exports names of one prefix alone; with a header: exactly those that it declares L1L2STAB_API.
# usage: check_symbols.sh FILE PREFIX [HEADER]
set -eu

exported=$(nm -D --defined-only "$1" | awk '{ print $3 }' | sort -u)
strangers=$(echo "$exported" | grep -v "^$2" || true)
if [ -z "$exported" ]; then
  echo "$1 exports nothing"
  exit 1
fi
if [ -n "$strangers" ]; then
  echo "$1 exports what does not begin with $2:"
  echo "$strangers"
  exit 1
fi

if [ $# -gt 2 ]; then
  declared=$(sed -n 's/^L1L2STAB_API.*[ *]\(l1l2stab_[a-z0-9_]*\)(.*/\1/p' "$3" | sort -u)
  if [ "$declared" != "$exported" ]; then
    echo "declared in $3:" $declared
    echo "exported by $1:" $exported
    exit 1
  fi
fi
echo "$exported"
