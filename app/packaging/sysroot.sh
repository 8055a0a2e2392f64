#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Debian's packages of another architecture that thermorig is linked with, unpacked into a folder of their own with what
# dpkg-shlibdeps asks of them: nothing is installed on this computer or removed from it, and nobody needs to be root. Its
# packages come from this computer's archives. Does nothing where the folder has all of them.
# Usage: bash app/packaging/sysroot.sh ARCHITECTURE FOLDER
set -euo pipefail
arch=$1 root=$2
mapfile -t libraries < <(bash "$(dirname "$0")/../setup.sh" --list | grep -e '-dev$')
libraries+=(libc6-dev libstdc++-12-dev)
[ "$(cat "$root/complete" 2>/dev/null)" = "${libraries[*]}" ] && exit 0
rm -rf "$root"
info=$root/var/lib/dpkg/info
mkdir -p "$root"/{apt/lists/partial,apt/cache/archives/partial} "$info"
root=$(realpath "$root") info=$(realpath "$info")
status=$root/var/lib/dpkg/status
: >"$status"
options=(-qq -o "APT::Architecture=$arch" -o "APT::Architectures=$arch" -o "Dir::State=$root/apt" -o "Dir::State::lists=$root/apt/lists"
  -o "Dir::State::status=$status" -o "Dir::Cache=$root/apt/cache" -o APT::Install-Recommends=false -o Debug::NoLocking=true
  -o APT::Sandbox::User=)
# Other archives than Debian's may not have the architecture.
apt-get "${options[@]}" update
apt-get "${options[@]}" --yes --download-only install "${libraries[@]}"
for deb in "$root"/apt/cache/archives/*.deb; do
  name=$(dpkg-deb --field "$deb" Package)
  case $(dpkg-deb --field "$deb" Multi-Arch) in same) name=$name:$arch ;; esac
  dpkg-deb --extract "$deb" "$root"
  dpkg-deb --control "$deb" "$root/control"
  for file in shlibs symbols; do [ ! -e "$root/control/$file" ] || mv "$root/control/$file" "$info/$name.$file"; done
  { sed 's/^Package: .*/&\nStatus: install ok installed/' "$root/control/control"; echo; } >>"$status"
  # As dpkg-shlibdeps finds them: below this folder.
  dpkg-deb --fsys-tarfile "$deb" | tar -t | sed "s,^\.,$root,; s,/\$,," >"$info/$name.list"
  rm -r "$root/control"
done
echo 1 >"$info/format" # names of lists have the architecture
rm -r "$root/apt"
# Absolute ones would lead to this computer's own files.
find "$root" -type l -lname '/*' -printf '%p %l\n' | while read -r link target; do
  ln -sfn "$(realpath -m --relative-to "$(dirname "$link")" "$root$target")" "$link"
done
echo "${libraries[*]}" >"$root/complete"
