#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Runs a test program in one process, with the leaks tracer: every object, buffer, event, caps ... that it made has to
# be gone at its end. What is left is printed.
# usage: no_leaks.sh PROGRAM
set -uo pipefail

log=$(mktemp)
trap 'rm -f "$log"' EXIT
status=0
CK_FORK=no GST_TRACERS=leaks GST_DEBUG=GST_TRACER:7 GST_DEBUG_NO_COLOR=1 GST_DEBUG_FILE=$log "$@" || status=$?
# The tracer describes its messages in any case, and writes one for each object that is left.
grep -q 'object-alive' "$log" || status=1
grep 'object-alive, type-name=(string)[^%]' "$log" && status=1
exit "$status"
