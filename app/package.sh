#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Debian packages of the present commit, in build-package/packages/: thermorig, and thermorig-avr, which is apart because it links
# simavr (GPL-3). The same commit gives the same bytes, whichever folder it lies in. For another processor it is
# cross-compiled: its libraries are unpacked into a folder, nothing is installed or removed for it, and the emulator runs what
# the build needs to run.
# Usage: bash app/package.sh [--arch amd64|arm64]   (default: this computer's)
# THERMORIG_MAINTAINER: "Name <address>" of who answers for the packages; the default is an address that nobody reads.
# SOURCE_DATE_EPOCH: the time of all files, seconds since 1970; default: that of the commit. THERMORIG_BUILD names another
# build folder of this computer's packages than build-package/, THERMORIG_PRESET another preset than release: with `build` and
# `developer` what is built serves.
set -euo pipefail
cd "$(dirname "$0")/.."
umask 022
export LC_ALL=C TZ=UTC
native=$(dpkg --print-architecture)
arch=$native
case $#:${1-} in
  0:) ;;
  2:--arch) arch=$2 ;;
  *) echo "Usage: bash app/package.sh [--arch amd64|arm64]" >&2; exit 2 ;;
esac
case $arch in
  "$native") parts=(page package) ;;
  arm64) parts=(page package cross) ;;
  *) echo "package.sh: no packages are made for $arch on $native; try: --arch $native, --arch arm64" >&2; exit 2 ;;
esac
bash app/setup.sh "${parts[@]}"
if [ -z "${SOURCE_DATE_EPOCH:-}" ]; then
  SOURCE_DATE_EPOCH=$(git log -1 --format=%ct 2>/dev/null) || {
    echo "package.sh: this is no clone, so the commit's time is not known; try: SOURCE_DATE_EPOCH=SECONDS bash app/package.sh" >&2
    exit 2
  }
fi
export SOURCE_DATE_EPOCH
version=$(sed -nE 's/^project\(thermorig VERSION ([0-9.]+) .*/\1/p' CMakeLists.txt)
work=$PWD/build-package/packages
maintainer=${THERMORIG_MAINTAINER:-The thermorig authors <thermorig@example.org>}
settings=(-DTHERMORIG_PAGE=ON -DTHERMORIG_REPORTS=ON)
if [ "$arch" = "$native" ]; then
  build=${THERMORIG_BUILD:-build-package} emulator=() roots=() root=''
else
  build=build-$arch root=$PWD/build-$arch/sysroot
  bash app/packaging/sysroot.sh "$arch" "$root"
  settings+=("-DCMAKE_TOOLCHAIN_FILE=$PWD/app/packaging/aarch64.cmake" "-DTHERMORIG_SYSROOT=$root" -DTHERMORIG_TESTS=OFF)
  emulator=(qemu-aarch64 -L "$root")
  roots=("--admindir=$root/var/lib/dpkg" "-l$root/usr/lib/aarch64-linux-gnu" "-l$root/lib/aarch64-linux-gnu")
fi

cmake --preset "${THERMORIG_PRESET:-release}" -B "$build" "${settings[@]}" >/dev/null
cmake --build "$build" -j "$(nproc)" --target thermorig thermorig-avr servo_firmware
"${emulator[@]}" "$build/bin/thermorig" help --man "$build/man" # with the commit's date, whenever it was built

# The licences of what is in the program itself: libraries of headers, and the scripts of its pages.
third_party() {
  local file name pages=$build/npm/node_modules
  for file in "$root"/usr/share/doc/{libeigen3-dev,libcli11-dev,libtoml11-dev,nlohmann-json3-dev,libboost-dev}/copyright \
    "$pages"/{uplot/LICENSE,echarts/{NOTICE,LICENSE,licenses/LICENSE-d3},zrender/LICENSE,tslib/{CopyrightNotice.txt,LICENSE.txt}}; do
    name=${file#"$build"/}
    printf '==== %s\n\n' "${name#"$root"}"
    cat "$file"
    echo
  done
}

# package NAME COMPONENT DEPENDS: NAME_VERSION_ARCH.deb of what the component installs. Standard input: the rest of its
# control file.
package() {
  local name=$1 tree=$work/$1 doc
  doc=$tree/usr/share/doc/$name
  rm -rf "$tree"
  DESTDIR=$tree cmake --install "$build" --prefix /usr --component "$2" --strip >/dev/null
  mkdir -p "$doc" "$tree/DEBIAN"
  rm -f "$doc/LICENSE"
  cp LICENSE "$doc/copyright"
  [ "$2" = avr ] || third_party | gzip -9n >"$doc/third_party_licences.gz"
  printf '%s (%s) unstable; urgency=medium\n\n  * What has changed: docs/CHANGELOG.md of the package thermorig.\n\n -- %s  %s\n' \
    "$name" "$version" "$maintainer" "$(date -u -R -d "@$SOURCE_DATE_EPOCH")" | gzip -9n >"$doc/changelog.gz"
  find "$tree" -name '*.1' -exec gzip -9n {} +

  # Libraries that its programs are linked with, at the versions that they need.
  local programs needed
  mapfile -t programs < <(find "$tree/usr" -type f -perm /111 | sort)
  mkdir -p "$work/debian"
  printf 'Source: thermorig\n\nPackage: %s\nArchitecture: %s\n' "$name" "$arch" >"$work/debian/control"
  needed=$(cd "$work" && DEB_HOST_ARCH=$arch dpkg-shlibdeps -O "${roots[@]}" "${programs[@]}" | sed 's/^shlibs:Depends=//')
  {
    printf 'Package: %s\nVersion: %s\nArchitecture: %s\nMaintainer: %s\n' "$name" "$version" "$arch" "$maintainer"
    printf 'Depends: %s\nInstalled-Size: %s\n' "$needed${3:+, $3}" "$(find "$tree/usr" -type f -printf '%s\n' | awk '{s += $1} END {print int(s / 1024)}')"
    cat
  } >"$tree/DEBIAN/control"
  (cd "$tree" && find usr -type f -print0 | sort -z | xargs -0 md5sum) >"$tree/DEBIAN/md5sums"
  find "$tree" -exec touch -h -d "@$SOURCE_DATE_EPOCH" {} +
  dpkg-deb --root-owner-group --build "$tree" "$work/${name}_${version}_$arch.deb"
}

package thermorig thermorig '' <<'END'
Recommends: librsvg2-bin
Suggests: thermorig-avr, avrdude
Section: science
Priority: optional
Description: record and train on a thermal camera, gyro and servo rig
 Records a low-cost rotational-odometry rig (a 24 x 32 thermal camera, a gyro
 and a servo on three USB serial ports) into labelled HDF5 sessions, trains and
 evaluates a fusion network on them, and shows it live. A simulated rig is
 built in, so that all of it works without hardware.
END
package thermorig-avr avr "thermorig (= $version)" <<'END'
Section: science
Priority: optional
Description: AVR simulator for thermorig's simulated rig
 With this package the simulated rig of thermorig runs the servo board's own
 program, an AVR image, in simavr; without it the same source compiled for this
 computer. It links simavr, so as a whole it is under the GPL, version 3.
END
