#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The packages of this commit are what Debian wants (lintian), and work on a clean Debian 12: installed there by apt, they record,
# show their manual and are removed again without a trace. Needs root, for the chroot, and Debian's archive. Those for arm64 are
# run by the emulator of its processor, beside the libraries that they were linked with: they record, inspect and train, and
# read the golden vectors as this computer's program does. (The AVR simulator is not run: the emulator starts no programs.)
# Usage: bash tests/package_test.sh [--arch arm64]   (THERMORIG_BUILD, THERMORIG_PRESET: as of app/package.sh)
set -euo pipefail
cd "$(dirname "$0")/.."
bash app/package.sh "$@"
packages=$PWD/build-package/packages arch=${2:-$(dpkg --print-architecture)}
lintian --allow-root --fail-on error,warning "$packages"/*_"$arch".deb
fail() { echo "$1" >&2; exit 1; }

# What a program makes of all golden vectors, as if the devices had sent them in one go.
decoded_vectors() {
  local file device
  for file in protocols/vectors/*.txt; do
    case $file in
      *_request.txt) continue ;;
      *camera*|*90640*|*i2c_stick*) device=camera ;;
      *servo*) device=servo ;;
      *) device=gyro ;;
    esac
    echo "== $file"
    sed '/^#/d' "$file" | cut -d'|' -f2 | tr -d ' \n' | xxd -r -p | "$@" decode --json --device $device - 2>&1 || true
  done | sed -E 's/([0-9]\.[0-9]{3})[0-9]+/\1/g' # other processors fuse products and sums: the last digits differ
}

if [ "$arch" != "$(dpkg --print-architecture)" ]; then
  unpacked=$(mktemp -d "${TMPDIR:-/tmp}/thermorig-$arch.XXXXXX")
  trap 'rm -rf "$unpacked"' EXIT
  for package in "$packages"/*_"$arch".deb; do dpkg-deb --extract "$package" "$unpacked"; done
  run=(qemu-aarch64 -L "build-$arch/sysroot" "$unpacked/usr/bin/thermorig")
  "${run[@]}" record --simulated=4 --fast --environment a --plan quick --output "$unpacked/recordings" >/dev/null
  "${run[@]}" inspect "$unpacked/recordings/a" | grep -E '^(session|frames|verdict)'
  "${run[@]}" train --epochs 1 -o "$unpacked/model.onnx" "$unpacked/recordings/a" | tail -3
  decoded_vectors "${run[@]}" >"$unpacked/there"
  decoded_vectors "${THERMORIG_BUILD:-build-package}/bin/thermorig" >"$unpacked/here"
  cmp "$unpacked/there" "$unpacked/here" || fail "the golden vectors are read otherwise on $arch"
  grep -c . "$unpacked/there" | sed 's/$/ lines of golden vectors are the same/'
  echo "the packages for $arch work in an emulator"
  exit
fi

root=$(mktemp -d "${TMPDIR:-/tmp}/thermorig-chroot.XXXXXX")
clean_up() {
  umount "$root/sys" "$root/proc" 2>/dev/null || true
  rm -rf --one-file-system "$root"
}
trap clean_up EXIT
mmdebstrap --quiet --variant=apt --include=man-db,bash-completion,udev bookworm "$root"
chmod 755 "$root" # apt has a user of its own
mount -t proc proc "$root/proc"
mount -t sysfs sysfs "$root/sys"
cp /etc/resolv.conf "$root/etc/" 2>/dev/null || true
cp "$packages"/*_"$arch".deb "$root/tmp"
inside() { chroot "$root" env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive bash -ec "$1"; }
files_of_it() { inside 'find / -xdev \( -path /proc -o -path /sys -o -path /tmp -o -path /var -o -path /root \) -prune -o -name "*thermorig*" -print'; }

begin=$SECONDS
inside 'cd /tmp && apt-get update -qq && apt-get install -qq --no-install-recommends ./thermorig_*.deb >/dev/null'
echo "installed in $((SECONDS - begin)) s"
inside 'cd /root && thermorig record --simulated --fast --environment a --plan quick && thermorig inspect recordings/a' |
  grep -E '^(session|frames|verdict)'
inside 'man --warnings thermorig-record | grep -q -e --frames-per-leg && man thermorig | grep -q thermorig-record' ||
  fail "there is no manual"
inside 'thermorig --version' | grep -q 'host build' || fail "without thermorig-avr the host build is not run"
inside 'cd /tmp && apt-get install -qq --no-install-recommends ./thermorig-avr_*.deb >/dev/null && thermorig --version' |
  grep -q 'AVR image' || fail "with thermorig-avr the AVR image is not run"
inside 'source /usr/share/bash-completion/bash_completion; _completion_loader thermorig || [ $? = 124 ]; complete -p thermorig' >/dev/null
# udev names file and line of a rule that it does not understand.
rules=$(inside 'udevadm test /sys/class/mem/null 2>&1 || true')
grep -q 'Reading rules file: .*/60-thermorig.rules' <<<"$rules" || fail "udev does not read the rules"
! grep -E 'thermorig[a-z-]*\.rules:[0-9]+' <<<"$rules" || fail "udev does not understand that rule"
inside 'apt-get purge -qq thermorig thermorig-avr >/dev/null'
left=$(files_of_it)
[ -z "$left" ] || fail "left behind: $left"
echo "the packages work on a clean Debian 12"
