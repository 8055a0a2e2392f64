#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# app/release.sh in a small clone, with a check that fails and one that passes: what it makes, tags and refuses.
# Usage: bash tests/release_test.sh
set -euo pipefail
export LC_ALL=C
unset $(git rev-parse --local-env-vars) # a hook sets GIT_DIR
cd "$(dirname "$0")/.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
clone=$folder/clone
mkdir -p "$clone"/{app,docs,tests,build-package/packages}
cp app/release.sh "$clone/app"
cd "$clone"
echo 'project(thermorig VERSION 1.2.0 LANGUAGES CXX)' >CMakeLists.txt
printf '%s\n' '# Change log' '' '## 1.2.0 (2027-01-31)' '' '# not a comment' '- new ([how](a.md), [wiring](../b/README.md))' '' '## 1.1.0 (2026-01-31)' '' '- old' >docs/CHANGELOG.md
echo 'exit 1' >tests/release_check.sh
echo built >build-package/packages/thermorig_1.2.0_amd64.deb
echo earlier >build-package/packages/thermorig_1.1.0_amd64.deb
export GIT_CONFIG_GLOBAL=/dev/null GIT_CONFIG_NOSYSTEM=1 GIT_{AUTHOR,COMMITTER}_NAME=n GIT_{AUTHOR,COMMITTER}_EMAIL=n@example.org
git init -q
git add app docs tests CMakeLists.txt
git commit -qm first

wrong() { echo "$1" >&2; exit 1; }
release() { bash app/release.sh "$@" >"$folder/said" 2>&1; }
release && wrong "released although the check failed"
[ ! -e build-package/release ] || wrong "files were made although the check failed"
release --rehearse || wrong "no rehearsal: $(cat "$folder/said")"
[ -z "$(git tag)" ] || wrong "a rehearsal made a tag"
[ ! -e build-package/release ] || wrong "a rehearsal wrote into the folder of a release"

echo 'exit 0' >tests/release_check.sh
release || wrong "no release: $(cat "$folder/said")"
grep -q 'git push origin v1.2.0' "$folder/said" || wrong "it does not say what is next: $(cat "$folder/said")"
(cd build-package/release && sha256sum --quiet --check SHA256SUMS)
[ "$(ls build-package/release | tr '\n' ' ')" = "SHA256SUMS notes.md thermorig-1.2.0.tar.gz thermorig_1.2.0_amd64.deb " ] ||
  wrong "other files: $(ls build-package/release)"
[ "$(cat build-package/release/notes.md)" = "$(printf '%s\n' '# not a comment' '- new (how (docs/a.md), wiring (b/README.md))')" ] ||
  wrong "other notes: $(cat build-package/release/notes.md)"
git cat-file tag v1.2.0 | grep -q "^# not a comment$" || wrong "another tag"

sums=$(cat build-package/release/SHA256SUMS) tag=$(git rev-parse v1.2.0)
release || wrong "no second release: $(cat "$folder/said")"
[ "$(cat build-package/release/SHA256SUMS)" = "$sums" ] || wrong "a second run made other files"
[ "$(git rev-parse v1.2.0)" = "$tag" ] || wrong "a second run made another tag"

printf '%s\n' '## 1.2.0 (2027-01-31)' '' '## 1.1.0 (2026-01-31)' '- old' >docs/CHANGELOG.md
release && wrong "released without notes"
[ "$(cat build-package/release/SHA256SUMS)" = "$sums" ] || wrong "a run without notes took the release away"
