#!/bin/sh
# SPDX-License-Identifier: MIT
# A shared object exports only names with one prefix. With a header, it exports exactly the functions that the header
# declares L1L2STAB_API.
# usage: check_symbols.sh FILE PREFIX [HEADER]
set -eu

exported=$(nm -D --defined-only "$1" | awk '{ print $3 }' | sort -u)
others=$(echo "$exported" | grep -v "^$2" || true)
if [ -z "$exported" ]; then
  echo "$1 exports nothing"
  exit 1
fi
if [ -n "$others" ]; then
  echo "$1 exports names that do not begin with $2:"
  echo "$others"
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
