#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What a script can check of a release (docs/release.md); it names all that is not as it must be.
# Usage: bash tests/release_check.sh
set -euo pipefail
cd "$(dirname "$0")/.."
source tests/last_pass.sh
failed=0
wrong() { echo "NOT OK  $1" >&2; failed=1; }

changes=$(git status --porcelain)
[ -z "$changes" ] || wrong "there are changes that no commit has (git commit):
$changes"

version=$(sed -nE 's/^project\(thermorig VERSION ([0-9.]+) .*/\1/p' CMakeLists.txt)
citation=$(sed -n 's/^version: //p' CITATION.cff)
released=$(sed -n 's/^date-released: *//p' CITATION.cff | tr -d '"')
for file in app/python/pyproject.toml app/python/thermorig/__init__.py; do
  grep -qF "\"$version\"" "$file" || wrong "$file does not have version $version: correct it"
done
heading=$(sed -n 's/^## //p' docs/CHANGELOG.md | head -1) # "0.2.0 (2026-11-30)"
[ -n "$version" ] || wrong "CMakeLists.txt has no version"
[ "$citation" = "$version" ] || wrong "CITATION.cff has version $citation, CMakeLists.txt $version"
[ "${heading%% *}" = "$version" ] || wrong "the change log begins with $heading, CMakeLists.txt has version $version"
[[ $heading =~ \(([0-9]{4}-[0-9]{2}-[0-9]{2})\)$ ]] || wrong "the change log's first heading has no date: $heading"
[ "$released" = "${BASH_REMATCH[1]-none}" ] ||
  wrong "CITATION.cff was released on ${released:-no date}, by the change log on ${BASH_REMATCH[1]-no date}"
tagged=$(git rev-parse -q --verify "refs/tags/v$version^{commit}" || true)
[ -z "$tagged" ] || [ "$tagged" = "$(git rev-parse HEAD)" ] || wrong "the tag v$version is of another commit"

passed=$(last_pass)
shallow=$(git rev-parse --is-shallow-repository)
if [ "$shallow" = true ]; then
  wrong "this clone is shallow, which hides the commits of the last full pass and of the figures: git fetch --unshallow"
elif [ -z "$passed" ]; then
  wrong "no full pass is written down: bash tests/nightly.sh"
elif ! git rev-parse -q --verify "$passed^{commit}" >/dev/null; then
  wrong "the last full pass was at $passed, which this clone does not have: bash tests/nightly.sh"
else
  # What may differ: texts, results and pictures, and what a pass writes. Models may not: tests use them.
  changed=$(git diff --name-only "$passed" -- . ':!*.md' ':!*.png' ':!docs/study' ':!CITATION.cff' ':!tests/last_passes.txt')
  [ -z "$changed" ] || wrong "since the last full pass, at ${passed:0:12}, $(wc -l <<<"$changed") files have changed, such as
$(head -n 5 <<<"$changed")
        bash tests/nightly.sh"
fi

figures=$(grep -rhoE '^<!-- (table|figures) [a-z_]+, commit [0-9a-f]+' README.md docs | sed 's/.* //' | sort -u)
made=$(git rev-parse -q --verify "$figures^{commit}" 2>/dev/null || true) # nothing where there are several
if [ -z "$made" ]; then
  [ "$shallow" = true ] || wrong "the figures are not of one commit: bash tests/bench/figures.sh"
elif ! git diff --quiet "$made" -- src include app; then
  wrong "the program has changed since the figures were made: bash tests/bench/figures.sh"
fi
commit=$(git rev-parse --short=12 HEAD)
for arch in amd64 arm64; do
  for name in thermorig thermorig-avr; do
    package=build-package/packages/${name}_${version}_$arch.deb
    make="THERMORIG_MAINTAINER='Name <address>' bash app/package.sh --arch $arch"
    [ -e "$package" ] || { wrong "there is no $package: $make"; continue; }
    maintainer=$(dpkg-deb --field "$package" Maintainer)
    [[ $maintainer != *@example.org* ]] || wrong "nobody answers for $package, its maintainer is $maintainer: $make"
    [ $name = thermorig-avr ] || dpkg-deb --fsys-tarfile "$package" | tar -xO ./usr/bin/thermorig | grep -aF "$commit" >/dev/null ||
      wrong "$package is of another commit: $make"
  done
done
[ $failed = 0 ] || exit 1
echo "version $version is fit to be tagged, as far as a script can tell"
