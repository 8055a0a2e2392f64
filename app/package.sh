#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Debian packages of the present commit, in build-package/packages/: thermorig, and thermorig-avr, which is apart because it links
# simavr (GPL-3). The same commit gives the same bytes, whichever folder it lies in.
# Usage: bash app/package.sh
# SOURCE_DATE_EPOCH: the time of all files, seconds since 1970; default: that of the commit. THERMORIG_BUILD names another build
# folder than build-package/, THERMORIG_PRESET another preset than release: with `build` and `developer` what is built serves.
set -euo pipefail
cd "$(dirname "$0")/.."
umask 022
export LC_ALL=C TZ=UTC
bash app/setup.sh page package
if [ -z "${SOURCE_DATE_EPOCH:-}" ]; then
  SOURCE_DATE_EPOCH=$(git log -1 --format=%ct 2>/dev/null) || {
    echo "package.sh: this is no clone, so the commit's time is not known; try: SOURCE_DATE_EPOCH=SECONDS bash app/package.sh" >&2
    exit 2
  }
fi
export SOURCE_DATE_EPOCH
version=$(sed -nE 's/^project\(thermorig VERSION ([0-9.]+) .*/\1/p' CMakeLists.txt)
arch=$(dpkg --print-architecture)
build=${THERMORIG_BUILD:-build-package}
work=$PWD/build-package/packages
maintainer='The thermorig authors <thermorig@example.org>'

cmake --preset "${THERMORIG_PRESET:-release}" -B "$build" -DTHERMORIG_PAGE=ON -DTHERMORIG_REPORTS=ON >/dev/null
cmake --build "$build" -j "$(nproc)" --target thermorig thermorig-avr servo_firmware
"$build/bin/thermorig" help --man "$build/man" # with the commit's date, whenever it was built

# The licences of what is in the program itself: libraries of headers, and the scripts of its pages.
third_party() {
  local page=$build/src/io/web/page/node_modules charts=$build/src/learning/report/charts/node_modules file
  for file in /usr/share/doc/{libeigen3-dev,libcli11-dev,libtoml11-dev,nlohmann-json3-dev,libboost-dev}/copyright \
    "$page"/uplot/LICENSE "$charts"/echarts/{NOTICE,LICENSE,licenses/LICENSE-d3} "$charts"/zrender/LICENSE \
    "$charts"/tslib/{CopyrightNotice.txt,LICENSE.txt}; do
    printf '==== %s\n\n' "${file#"$build"/}"
    cat "$file"
    echo
  done
}

# package NAME COMPONENT DEPENDS: NAME_VERSION_ARCH.deb of what the component installs. Standard input: the rest of its
# control file.
package() {
  local name=$1 root=$work/$1 doc
  doc=$root/usr/share/doc/$name
  rm -rf "$root"
  DESTDIR=$root cmake --install "$build" --prefix /usr --component "$2" --strip >/dev/null
  mkdir -p "$doc" "$root/DEBIAN"
  rm -f "$doc/LICENSE"
  cp LICENSE "$doc/copyright"
  [ "$2" = avr ] || third_party | gzip -9n >"$doc/third_party_licences.gz"
  printf '%s (%s) unstable; urgency=medium\n\n  * What has changed: docs/CHANGELOG.md of the package thermorig.\n\n -- %s  %s\n' \
    "$name" "$version" "$maintainer" "$(date -u -R -d "@$SOURCE_DATE_EPOCH")" | gzip -9n >"$doc/changelog.gz"
  find "$root" -name '*.1' -exec gzip -9n {} +

  # Libraries that its programs are linked with, at the versions that they need.
  local programs needed
  mapfile -t programs < <(find "$root/usr" -type f -perm /111 | sort)
  mkdir -p "$work/debian"
  printf 'Source: thermorig\n\nPackage: %s\nArchitecture: %s\n' "$name" "$arch" >"$work/debian/control"
  needed=$(cd "$work" && dpkg-shlibdeps -O "${programs[@]}" | sed 's/^shlibs:Depends=//')
  {
    printf 'Package: %s\nVersion: %s\nArchitecture: %s\nMaintainer: %s\n' "$name" "$version" "$arch" "$maintainer"
    printf 'Depends: %s\nInstalled-Size: %s\n' "$needed${3:+, $3}" "$(find "$root/usr" -type f -printf '%s\n' | awk '{s += $1} END {print int(s / 1024)}')"
    cat
  } >"$root/DEBIAN/control"
  (cd "$root" && find usr -type f -print0 | sort -z | xargs -0 md5sum) >"$root/DEBIAN/md5sums"
  find "$root" -exec touch -h -d "@$SOURCE_DATE_EPOCH" {} +
  dpkg-deb --root-owner-group --build "$root" "$work/${name}_${version}_$arch.deb"
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
