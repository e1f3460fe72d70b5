#!/bin/sh
# SPDX-License-Identifier: MIT
# Wrong arguments, interruptions and unusual files: the samples say what is wrong and destroy nothing.
# usage: check_samples_faults.sh STABILIZE_FILE RENDER_SHAKY MEASURE_SHAKE STABILIZE_SH BUILD_DIR
set -eu
export LC_ALL=C

stabilize_file=$(realpath "$1")
render_shaky=$(realpath "$2")
measure_shake=$(realpath "$3")
stabilize_sh=$(realpath "$4")
build=$(realpath "$5")
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"
mkdir out # everything that may have to be left empty

fail() {
  echo "failed: $*"
  exit 1
}

# leaves_nothing WHAT: there is no file in out
leaves_nothing() {
  [ -z "$(ls -A out)" ] || fail "$1 left a file: $(ls -A out)"
}

# refuses WORDS ARGUMENT...: stabilize-file says WORDS in one line and leaves no file
refuses() {
  words=$1
  shift
  status=0
  "$stabilize_file" "$@" 2>said || status=$?
  [ "$status" -eq 1 ] || [ "$status" -eq 2 ] || fail "exit status $status: $*"
  grep -q "$words" said || fail "said of $*: $(cat said)"
  [ "$(wc -l <said)" -eq 1 ] || fail "more than one line on $*: $(cat said)"
  leaves_nothing "$*"
}

# wait_for SECONDS COMMAND...: waits until the command succeeds
wait_for() {
  tries=$(($1 * 20))
  shift
  while ! "$@"; do
    tries=$((tries - 1))
    [ "$tries" -gt 0 ] || return 1
    sleep 0.05
  done
}
temporary_exists() { [ -n "$(find out -name '.stabilize*')" ]; }
has_ended() { ! kill -0 "$pid" 2>/dev/null; }

# slowly IN OUT: starts stabilize-file with settings that take long, and waits until its temporary file exists
slowly() {
  # A test that runs under nohup would pass on that SIGHUP is ignored.
  env --default-signal=HUP "$stabilize_file" --interpolation=lanczos --window=20 --overlap=19 "$1" "$2" 2>said &
  pid=$!
  wait_for 20 temporary_exists || fail "no temporary file for $2: $(cat said)"
}

"$render_shaky" 'a clip.mp4'

# Arguments and files that are wrong
echo 'this is no video' >text.mp4
head -c 300000 'a clip.mp4' >cut.mp4
refuses 'no such file' absent.mp4 out/refused.mp4
refuses 'cannot be read' "$dir" out/refused.mp4
refuses 'type' text.mp4 out/refused.mp4
refuses 'cut.mp4' cut.mp4 out/refused.mp4
refuses 'has to end with' 'a clip.mp4' out/refused.avi
refuses 'out of range' --crop-ratio=3 'a clip.mp4' out/refused.mp4
refuses 'not a valid value' --lambda=much 'a clip.mp4' out/refused.mp4
refuses 'Unknown option' --novelty=1 'a clip.mp4' out/refused.mp4
refuses 'cannot be written' 'a clip.mp4' absent/refused.mp4
mkdir folder.mp4
refuses 'not a regular file' 'a clip.mp4' folder.mp4

# The output is the input, by its name, another spelling, a symbolic link and a hard link
ln -s 'a clip.mp4' symbolic.mp4
ln 'a clip.mp4' hard.mp4
cp 'a clip.mp4' original
for name in 'a clip.mp4' "$dir/a clip.mp4" './out/../a clip.mp4' symbolic.mp4 hard.mp4; do
  refuses 'the input too' 'a clip.mp4' "$name"
done
cmp 'a clip.mp4' original || fail "the input changed"
for option in motion picture; do
  ! "$measure_shake" --$option="$dir/a clip.mp4" 'a clip.mp4' symbolic.mp4 >said 2>&1 || fail "measure-shake: $option"
  cmp 'a clip.mp4' original || fail "measure-shake --$option destroyed its input"
done

# The input, or another file, has the name of the output with .part behind it
cp original b.mp4.part
echo 'not yours' >out/b.mkv.part
"$stabilize_file" b.mp4.part b.mp4 2>said || fail "$(cat said)"
cmp b.mp4.part original || fail "the input b.mp4.part changed"
"$stabilize_file" b.mp4.part out/b.mkv 2>said || fail "$(cat said)"
[ "$(cat out/b.mkv.part)" = 'not yours' ] || fail "a file that was there before changed"
[ "$(ls -A out | tr '\n' ' ')" = 'b.mkv b.mkv.part ' ] || fail "out has $(ls -A out)"
mv out/b.mkv .
rm out/b.mkv.part

# The output has the permissions of any new file
touch plain
[ "$(stat -c %a b.mp4)" = "$(stat -c %a plain)" ] || fail "the permissions are $(stat -c %a b.mp4)"

# The last step fails, because a folder has the output's name by then
slowly original out/e.mp4
mkdir out/e.mp4
status=0
wait "$pid" || status=$?
[ "$status" -eq 1 ] || fail "exit status $status when the output cannot be renamed: $(cat said)"
grep -q 'e.mp4: cannot be written' said || fail "said when the output cannot be renamed: $(cat said)"
rmdir out/e.mp4
leaves_nothing "a failed rename"

# Signals
for signal in TERM HUP; do
  slowly original out/s.mp4
  kill -$signal "$pid"
  status=0
  wait "$pid" || status=$?
  [ "$status" -eq 1 ] || fail "exit status $status after SIG$signal"
  leaves_nothing "SIG$signal"
done
slowly original out/s.mp4
kill -PIPE "$pid"
wait "$pid" || fail "SIGPIPE ended it: $(cat said)"
[ "$(ls -A out)" = s.mp4 ] || fail "after SIGPIPE out has $(ls -A out)"
rm out/s.mp4

# A FIFO as input: can be interrupted while nobody writes to it, and can be read
mkfifo fifo
slowly fifo out/f.mp4
kill -TERM "$pid"
wait_for 10 has_ended || { kill -KILL "$pid"; fail "SIGTERM does not end it while it waits for a FIFO"; }
leaves_nothing "SIGTERM while waiting for a FIFO"
slowly fifo out/f.mp4
cat b.mkv >fifo
wait "$pid" || fail "a FIFO cannot be read: $(cat said)"
grep -q '300 frames' said || fail "frames from a FIFO are missing: $(cat said)"

# stabilize.sh reports the shake of a file whose name contains a newline. It runs in a tree of its own, where nothing
# has to be built.
mkdir -p tree/samples tree/.ci
cp "$stabilize_sh" tree/samples/stabilize.sh
printf '#!/bin/sh\n' >tree/.ci/prepare.sh
chmod +x tree/.ci/prepare.sh
name='two
lines: 1.000 px.mp4'
cp original "$name"
BUILD_DIR=$build tree/samples/stabilize.sh "$name" "new$name" >report 2>said || fail "$(cat said)"
grep -Eqx 'shake    [0-9.]+ px before, [0-9.]+ px after: [0-9.]+ % of it is left .*' report ||
  fail "the report is $(cat report)"
[ "$(wc -l <report)" -eq 4 ] || fail "the report has not four lines: $(cat report)"
