#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Ports on the kernel's real usb-serial driver (ftdi_sio), with plugs pulled and put back, and a camera on a bus behind
# its driver of a USB bridge (hid-mcp2221), in a QEMU guest: about half a minute. Skips with a message where QEMU, busybox
# or a kernel image is missing.
# Usage: bash tests/usb/run.sh [build folder, default build]     THERMORIG_KERNEL_DEB=FILE: a linux-image package
set -euo pipefail
cd "$(dirname "$0")/../.."
build=${1:-build}

skip() {
  echo "skipped: $1"
  [ -z "${THERMORIG_EVERYTHING:-}" ] || exit 1 # a skip is no pass
  exit 0
}

for program in qemu-system-x86_64 busybox cpio gzip dpkg-deb python3; do
  command -v "$program" >/dev/null || skip "$program is not installed (bash app/setup.sh usb)"
done
guest=$build/bin/usb_guest
[ -x "$guest" ] || skip "$guest is not built (target usb_guest)"

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# The package is unpacked, never installed: this machine keeps its own kernel. Kept for the next run.
package=${THERMORIG_KERNEL_DEB:-}
if [ -z "$package" ]; then
  kept=${XDG_CACHE_HOME:-$HOME/.cache}/thermorig-usb
  mkdir -p "$kept"
  package=$(find "$kept" -name 'linux-image-*.deb' | head -n 1)
  if [ -z "$package" ]; then
    name=$(apt-cache depends linux-image-amd64 2>/dev/null | sed -n 's/.*Depends: //p' | head -n 1)
    [ -n "$name" ] || skip "no kernel package is known to apt"
    (cd "$kept" && apt-get download "$name" >/dev/null 2>&1) || skip "the kernel package cannot be fetched"
    package=$(find "$kept" -name 'linux-image-*.deb' | head -n 1)
  fi
fi
[ -f "$package" ] || skip "there is no kernel package"
mkdir "$folder/package"
dpkg-deb --fsys-tarfile "$package" |
  tar -x -C "$folder/package" --wildcards './boot/vmlinuz-*' './lib/modules/*/kernel/drivers/'{usb,hid,i2c}'/*'
kernel=$(find "$folder/package/boot" -name 'vmlinuz-*')

# A root folder of the guest: its modules in the order of their needs, busybox, the program and its libraries.
root=$folder/root
mkdir -p "$root"/{bin,dev,proc,sys,tmp,modules}
busybox=$(command -v busybox)
cp "$busybox" "$root/bin/busybox"
modules=(usb/common/usb-common usb/core/usbcore usb/host/uhci-hcd usb/serial/usbserial usb/serial/ftdi_sio
  hid/hid hid/uhid hid/hid-mcp2221 i2c/i2c-dev i2c/i2c-stub)
for module in "${modules[@]}"; do
  cp "$folder"/package/lib/modules/*/kernel/drivers/"$module".ko "$root/modules/"
done
cp "$guest" "$root/bin/usb_guest"
ldd "$guest" | grep -o '/[^ ]*' | while read -r library; do
  mkdir -p "$root$(dirname "$library")"
  cp -L "$library" "$root$library"
done
ldd "$busybox" >/dev/null 2>&1 && skip "busybox is not the static one (busybox-static)"
cat >"$root/init" <<'INIT'
#!/bin/busybox sh
/bin/busybox mount -t proc proc /proc
/bin/busybox mount -t sysfs sysfs /sys
/bin/busybox mount -t devtmpfs devtmpfs /dev
for module in usb-common usbcore uhci-hcd usbserial ftdi_sio hid uhid hid-mcp2221 i2c-dev; do
  /bin/busybox insmod /modules/$module.ko
done
/bin/busybox insmod /modules/i2c-stub.ko chip_addr=0x33
/bin/busybox stty -echo </dev/ttyS0
exec /bin/usb_guest </dev/ttyS0 >/dev/ttyS0 2>&1
INIT
chmod +x "$root/init"
(cd "$root" && find . | cpio -o -H newc --quiet | gzip -1) >"$folder/initramfs"

python3 tests/usb/host.py "$kernel" "$folder/initramfs" "$folder"
