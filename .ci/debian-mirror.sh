#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Prints the mirror of Debian that this system uses; nothing if there is none.
set -euo pipefail

find /etc/apt/sources.list /etc/apt/sources.list.d \( -name '*.sources' -o -name '*.list' \) 2>/dev/null | sort |
  xargs -r cat | grep -v '^ *#' | grep -oE '[a-z+]+:/[^ ]*/debian/?( |$)' | head -n 1 | tr -d ' ' || true
