#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Fuzzes the library and the element: builds the targets of tests/fuzz with clang, libFuzzer, AddressSanitizer and
# UndefinedBehaviorSanitizer, and runs each one.
# usage: tests/fuzz/run.sh [SECONDS [TARGET...]]     (default: 60 seconds each of all targets)
# What is found is kept in BUILD_DIR/corpus (default: build-fuzz, at the top of the tree), and the next run goes on from
# there. An input that breaks something is written to BUILD_DIR/findings; run tests/fuzz/fuzz_TARGET there with its name
# to see it again. BUILD_DIR/runs.txt gets a line for each run: date, target, seconds, executions, findings.
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
build=$(realpath -m "${BUILD_DIR:-$top/build-fuzz}")
seconds=${1:-60}
targets=("${@:2}")
[[ ${#targets[@]} -gt 0 ]] || targets=(api motions motion_file mask_file element)

# The longest time that an input may take. Under the sanitizers all is slower, and the element waits for threads.
longest=60

export CC=clang CXX=clang++
"$top/.ci/prepare.sh" "$build" -Dfuzz=true -Dsamples=false -Db_sanitize=address,undefined -Db_lundef=false \
  -Dbuildtype=debugoptimized
export ASAN_OPTIONS=detect_leaks=1:strict_string_checks=1:allocator_may_return_null=1
export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
mkdir -p "$build/findings"

status=0
for target in "${targets[@]}"; do
  corpus=$build/corpus/$target
  log=$build/fuzz_$target.log
  python3 "$top/tests/fuzz/make_corpus.py" "$target" "$corpus"
  # A thread of GLib that is ending while leaks are looked for seems to leak. fuzz_element.c counts buffers itself, and
  # the tests of the suite `leaks` find what else the element leaks.
  leaks=1
  [[ $target != element ]] || leaks=0
  result=0
  "$build/tests/fuzz/fuzz_$target" -max_total_time="$seconds" -timeout="$longest" -rss_limit_mb=4096 -max_len=400 \
    -detect_leaks=$leaks -print_final_stats=1 -artifact_prefix="$build/findings/$target-" "$corpus" \
    >"$log" 2>&1 || result=$?
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  if [[ $result -eq 0 ]]; then
    finding='no finding'
  else
    finding=$(sed -n "s/.*Test unit written to //p" "$log")
    tail -n 60 "$log" >&2
    status=1
  fi
  echo "$(date -u +%F) $target: $seconds s, ${executions:-0} executions, ${finding:-failed, see $log}" |
    tee -a "$build/runs.txt"
done
exit "$status"
