#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# A release of this commit, in build-package/release/: source, packages, notes and checksums; then its tag. Before that all that
# tests/release_check.sh checks has to hold (docs/release.md). It publishes nothing: it prints the commands that do.
# Usage: bash app/release.sh [--rehearse]   (--rehearse: goes on where a check fails, and makes no tag)
set -euo pipefail
cd "$(dirname "$0")/.."
umask 022
export LC_ALL=C TZ=UTC
rehearse=${1-}
case $#:$rehearse in
  0: | 1:--rehearse) ;;
  *) echo "Usage: bash app/release.sh [--rehearse]" >&2; exit 2 ;;
esac
version=$(sed -nE 's/^project\(thermorig VERSION ([0-9.]+) .*/\1/p' CMakeLists.txt)
name=thermorig-$version work=$PWD/build-package/release
if ! bash tests/release_check.sh; then
  echo "Mend each line with NOT OK, in the order of docs/release.md, then repeat: bash app/release.sh" >&2
  [ "$rehearse" ] || { echo "To see how far it goes before that: bash app/release.sh --rehearse" >&2; exit 1; }
fi

rm -rf "$work"
mkdir -p "$work"
awk -v version="$version" '/^## /{ inside = $2 == version } inside' docs/CHANGELOG.md | sed -n '3,$p' >"$work/notes.md"
[ -s "$work/notes.md" ] || { echo "the change log has nothing on $version" >&2; exit 1; }
git archive --format=tar.gz --prefix="$name/" -o "$work/$name.tar.gz" HEAD
packages=(build-package/packages/thermorig*_"${version}"_*.deb)
[ ! -e "${packages[0]}" ] || cp -p "${packages[@]}" "$work"
(cd "$work" && sha256sum -- thermorig* >SHA256SUMS && sha256sum --quiet --check SHA256SUMS && ls -l)

if [ "$rehearse" ]; then
  echo "This was a rehearsal: there is no tag, and nothing of this is to be given away."
  exit
fi
git rev-parse -q --verify "v$version" >/dev/null ||
  { echo "thermorig $version" && echo && cat "$work/notes.md"; } | git tag -a "v$version" --cleanup=verbatim -F -
cat <<END
Version $version is tagged as v$version in this clone; nothing is published. Next:
1. Unpack the source elsewhere and try it:  tar xf $work/$name.tar.gz && cd $name && bash app/quickstart.sh
   If it fails, take the tag back:  git tag -d v$version
2. Publish the tag:  git push origin v$version
3. Upload all files of $work, with notes.md as the text of the release.
4. Begin the next version: docs/release.md, "After it".
END
