#!/bin/sh
# SPDX-License-Identifier: MIT
# Wrong arguments and unusual names: measure-shake and stabilize.sh destroy nothing, and report what they did.
# usage: check_samples_faults.sh RENDER_SHAKY MEASURE_SHAKE STABILIZE_SH BUILD_DIR
# tests/command has the tests of l1l2stab.
set -eu
export LC_ALL=C

render_shaky=$(realpath "$1")
measure_shake=$(realpath "$2")
stabilize_sh=$(realpath "$3")
build=$(realpath "$4")
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"

fail() {
  echo "failed: $*"
  exit 1
}

"$render_shaky" 'a clip.mp4'
cp 'a clip.mp4' original
ln -s 'a clip.mp4' symbolic.mp4
for option in motion picture; do
  ! "$measure_shake" --$option="$dir/a clip.mp4" 'a clip.mp4' symbolic.mp4 >said 2>&1 || fail "measure-shake: $option"
  cmp 'a clip.mp4' original || fail "measure-shake --$option destroyed its input"
done

# stabilize.sh in a tree of its own, where nothing has to be built
mkdir -p tree/samples tree/.ci
cp "$stabilize_sh" tree/samples/stabilize.sh
printf '#!/bin/sh\n' >tree/.ci/prepare.sh
chmod +x tree/.ci/prepare.sh

# reports WHAT ARGUMENT...: stabilize.sh reports the shake in four lines
reports() {
  what=$1
  shift
  BUILD_DIR=$build tree/samples/stabilize.sh "$@" >report 2>said || fail "$what: $(cat said)"
  grep -Eqx 'shake    [0-9.]+ px before, [0-9.]+ px after: [0-9.]+ % of it is left .*' report ||
    fail "$what: the report is $(cat report)"
  [ "$(wc -l <report)" -eq 4 ] || fail "$what: the report has not four lines: $(cat report)"
}

name='two
lines: 1.000 px.mp4'
cp original "$name"
reports 'a newline in the name' "$name" "new$name"
cp original ./-lambda.mp4
reports 'a dash before the name' --lambda=1 -- -lambda.mp4
[ -s ./-lambda-stabilized.mp4 ] || fail 'a dash before the name: there is no output'
