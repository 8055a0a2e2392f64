#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# A release of this commit, in build-package/release: source, packages, notes and checksums; then its tag. Before that all that
# tests/release_check.sh checks has to hold (docs/release.md). It publishes nothing: it prints the commands that do.
# Usage: bash app/release.sh [--rehearse]   (--rehearse: in build-package/rehearsal; goes on where a check fails, makes no tag)
set -euo pipefail
cd "$(dirname "$0")/.."
umask 022
export LC_ALL=C TZ=UTC
unset $(git rev-parse --local-env-vars) # a hook sets GIT_DIR
rehearse=${1-}
case $#:$rehearse in
  0: | 1:--rehearse) ;;
  *) echo "Usage: bash app/release.sh [--rehearse]" >&2; exit 2 ;;
esac
version=$(sed -nE 's/^project\(thermorig VERSION ([0-9.]+) .*/\1/p' CMakeLists.txt)
name=thermorig-$version work=$PWD/build-package/$([ "$rehearse" ] && echo rehearsal || echo release)
if ! bash tests/release_check.sh; then
  echo "Mend each line with NOT OK, in the order of docs/release.md, then repeat: bash app/release.sh" >&2
  [ "$rehearse" ] || { echo "To see how far it goes before that: bash app/release.sh --rehearse" >&2; exit 1; }
fi

# A link of the change log leads nowhere in the text of a release: its file is named in brackets.
notes=$(awk -v version="$version" '/^## /{ inside = $2 == version; next } inside && (NF || begun) { begun = 1; print }' docs/CHANGELOG.md |
  sed -zE 's/\[([^]]+)\]\(([^):]+)\)/\1 (docs\/\2)/g; s/\(docs\/\.\.\//(/g')
[ "$notes" ] || { echo "the change log has nothing on $version" >&2; exit 1; }
rm -rf "$work"
mkdir -p "$work"
printf '%s\n' "$notes" >"$work/notes.md"
git archive --format=tar.gz --prefix="$name/" -o "$work/$name.tar.gz" HEAD
packages=(build-package/packages/thermorig*_"${version}"_*.deb)
[ ! -e "${packages[0]}" ] || cp -p "${packages[@]}" "$work"
(cd "$work" && sha256sum -- thermorig* >SHA256SUMS && sha256sum --quiet --check SHA256SUMS && ls -l)

if [ "$rehearse" ]; then
  echo "This was a rehearsal: it made no tag, and nothing of this is to be given away."
  exit
fi
git rev-parse -q --verify "refs/tags/v$version" >/dev/null ||
  { echo "thermorig $version" && echo && cat "$work/notes.md"; } | git tag -a "v$version" --cleanup=verbatim -F -
cat <<END
Version $version is tagged as v$version in this clone; nothing is published. Next:
1. Unpack the source elsewhere and try it, it works without git:  tar xf $work/$name.tar.gz && cd $name && bash app/quickstart.sh
   If it fails, take the tag back:  git tag -d v$version
2. Publish the tag:  git push origin v$version
3. Upload all files of $work, with notes.md as the text of the release.
4. Begin the next version: docs/release.md, "After it".
END
