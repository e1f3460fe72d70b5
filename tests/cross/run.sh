#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds the library for another processor and runs its tests under qemu's user mode, in a root of Debian that has the
# cross compiler and the packages of both architectures. The root (1.4 GB) and the build are kept for the next run.
# usage: tests/cross/run.sh ARCH [BUILD_DIR [MESON_TEST_OPTION...]]
#        tests/cross/run.sh arm64                        all of the library's tests but the slow ones
#        tests/cross/run.sh arm64 build --suite lib      all of them
#        tests/cross/run.sh s390x                        big-endian
# It uses BUILD_DIR/cross/ARCH (default: build, at the top of the tree), whose files belong to root. Needs root or sudo.
# The exit code is 77 if the root cannot be made for want of rights or of the network.
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
arch=${1:?usage: tests/cross/run.sh ARCH [BUILD_DIR [MESON_TEST_OPTION...]]}
work=$(realpath -m "${2:-$top/build}")/cross/$arch
test_options=("${@:3}")
[[ ${#test_options[@]} -gt 0 ]] || test_options=(--suite lib --no-suite slow)
root=$work/root

case $arch in
  arm64) cpu=aarch64 endian=little security=yes ;;
  s390x) cpu=s390x endian=big security=no ;; # Debian 12's security suite no longer has it
  *)
    echo "cross: unknown architecture $arch" >&2
    exit 1
    ;;
esac
triplet=$cpu-linux-gnu

# Meson sets these for tests. They would slow debootstrap and apt down.
unset MALLOC_PERTURB_ ASAN_OPTIONS UBSAN_OPTIONS MSAN_OPTIONS

say() { echo "cross: $*" >&2; }
die() {
  say "$*"
  exit 1
}
skip() {
  say "skipped: $*"
  exit 77
}

[[ $(id -u) -eq 0 ]] || {
  sudo -n true 2>/dev/null || skip "a root of Debian can only be made as root"
  exec sudo -n "${BASH_SOURCE[0]}" "$@"
}
unshare --mount true 2>/dev/null || skip "unshare --mount is not allowed here"
mirror=$("$top/.ci/debian-mirror.sh")
[[ -n $mirror ]] || skip "this is not a Debian system with a mirror"

# in_root COMMAND...: in a clean environment, with the tree in /tree and the build in /cross. The mounts end with it.
in_root() {
  # shellcheck disable=SC2016  # expanded by the inner shell
  unshare --mount --propagation private bash -euc '
    root=$1 tree=$2 work=$3
    shift 3
    mkdir -p "$root/tree" "$root/cross"
    mount -t proc proc "$root/proc"
    mount --bind "$tree" "$root/tree"
    mount --bind "$work" "$root/cross"
    exec chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/tmp LC_ALL=C.UTF-8 \
      DEBIAN_FRONTEND=noninteractive CK_TIMEOUT_MULTIPLIER=40 "$@"' - "$root" "$top" "$work" "$@"
}

# Both architectures need the same version of each package, so the suites with newer versions are used for both or not
# at all.
make_root() {
  local suite
  suite=$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)
  rm -rf --one-file-system "$root"
  mkdir -p "$work"
  say "making a root of $suite for $arch"
  "$top/packaging/new-root.sh" "$root" "$suite" || skip "debootstrap failed (no network?)"
  printf 'deb %s main\n' "$mirror $suite" "$mirror $suite-updates" >"$root/etc/apt/sources.list"
  [[ $security == no ]] ||
    echo "deb ${mirror%debian*}debian-security $suite-security main" >>"$root/etc/apt/sources.list"
  in_root dpkg --add-architecture "$arch"
  in_root apt-get -q -o APT::Update::Error-Mode=any update >"$work/apt.log" 2>&1 ||
    skip "apt-get update failed (no network?), see $work/apt.log"
  { in_root apt-get -q -y upgrade && in_root apt-get -q -y --no-install-recommends install \
      "crossbuild-essential-$arch" meson pkg-config qemu-user libsimde-dev \
      "libopencv-core-dev:$arch" "libopencv-imgproc-dev:$arch" "check:$arch"; } >>"$work/apt.log" 2>&1 ||
    die "the packages could not be installed, see $work/apt.log"
  touch "$root/ready"
}

configure() {
  cat >"$work/cross.ini" <<INI
[binaries]
c = '$triplet-gcc'
cpp = '$triplet-g++'
ar = '$triplet-ar'
strip = '$triplet-strip'
pkgconfig = 'pkg-config'
exe_wrapper = 'qemu-$cpu'
[properties]
pkg_config_libdir = ['/usr/lib/$triplet/pkgconfig', '/usr/share/pkgconfig']
[host_machine]
system = 'linux'
cpu_family = '$cpu'
cpu = '$cpu'
endian = '$endian'
INI
  in_root meson setup --cross-file /cross/cross.ini -Dplugin=false -Dsamples=false -Dpython=disabled \
    /cross/build /tree >"$work/setup.log" || die "meson could not configure, see $work/setup.log"
}

# clang is stricter than gcc with the intrinsics of NEON: an immediate operand must be a constant expression.
check_clang() {
  command -v clang >/dev/null || {
    say "clang is not installed: the NEON code was not checked with it"
    return
  }
  local file
  for file in "$top"/lib/src/*/x86/*.c; do
    clang --target=$triplet --sysroot="$root" -fsyntax-only -std=c11 -Wall -Wextra -Werror -Wno-unused-parameter \
      -DL1L2_HAVE_SIMD -isystem "$root/usr/include" -I"$top/lib/include" -I"$top/lib/src" "$file" ||
      die "clang does not compile $file for $arch"
  done
}

[[ -f $root/ready ]] || make_root
[[ -d $top/subprojects/$(sed -n 's/^directory *= *//p' "$top/subprojects/osqp.wrap") ]] ||
  "$top/subprojects/fetch-osqp.sh" >&2
[[ -f $work/build/build.ninja ]] || configure
in_root ninja --quiet -C /cross/build >&2 || die "the build for $arch failed"

[[ $arch != arm64 ]] || check_clang

log=$work/build/meson-logs/testlog.json
rm -f "$log"
status=0
in_root meson test -C /cross/build --no-rebuild --print-errorlogs --timeout-multiplier 40 "${test_options[@]}" \
  </dev/null || status=$?
python3 "$top/tests/totals.py" "$log" || status=1
exit "$status"
