#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Prints how many instructions the inner loops take on 64-bit ARM, in plain C and by NEON, as a table
# (docs/portability.md).
# qemu counts them by its plugin `insn`, which Debian does not build: qemu is built from its source package, in ten
# minutes. An instruction is not a time; processors differ.
# usage: tests/cross/count-instructions.sh [BUILD_DIR]      (default: build, after tests/cross/run.sh arm64 BUILD_DIR)
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
cross=$(realpath -m "${1:-$top/build}")/cross
bench=$cross/arm64/build/tests/bench/bench_instructions
qemu=$cross/qemu/build

[[ -x $bench ]] || {
  echo "count-instructions: run tests/cross/run.sh arm64 first" >&2
  exit 1
}

build_qemu() {
  local log=$cross/qemu.log source
  echo "count-instructions: building qemu, see $log" >&2
  rm -rf "$cross/qemu"
  mkdir -p "$cross/qemu/source" "$qemu"
  "$top/.ci/apt-source.sh" qemu "$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)" "$cross/qemu/lists" \
    "$cross/qemu/source" >"$log" 2>&1
  source=$(find "$cross/qemu/source" -mindepth 1 -maxdepth 1 -type d)
  (cd "$qemu" && "$source/configure" --target-list=aarch64-linux-user --enable-plugins --disable-system \
    --disable-docs --disable-tools && ninja qemu-aarch64 tests/plugin/libinsn.so) >>"$log" 2>&1
}

# instructions WORK simd|plain COUNT: of the whole program
instructions() {
  "$qemu/qemu-aarch64" -L "$cross/arm64/root" -plugin "$qemu/tests/plugin/libinsn.so" -d plugin "$bench" "$@" 2>&1 |
    sed -n 's/.*insns: *//p' | tail -n 1
}

# The second round alone: without the program's start.
of_a_round() {
  echo $(($(instructions "$1" "$2" 2) - $(instructions "$1" "$2" 1)))
}

[[ -e $qemu/tests/plugin/libinsn.so ]] || build_qemu
echo '| | plain C | NEON | plain C / NEON |'
echo '|---|---|---|---|'
for work in bilinear bicubic lanczos bilinear-10 bicubic-10 lanczos-10 take compare scale; do
  plain=$(of_a_round "$work" plain)
  neon=$(of_a_round "$work" simd)
  echo "| $work | $plain | $neon | $(awk "BEGIN { printf \"%.1f\", $plain / $neon }") |"
done
