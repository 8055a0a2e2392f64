#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Makes the figures in the documents anew, at one commit: before a release, on a quiet computer with two cores (about two
# hours, after a build). A table is written between its marks in its document (`<!-- table NAME, commit ... -->`). Of figures in
# sentences (`<!-- figures NAME, commit ... -->`) the output is kept in build/figures, and it is said which sentence to
# correct. Whatever fails leaves its table as it was; exit code 1 then. Nothing is trained: the study's tables are drawn from
# its result files. Refused while program or tests differ from their commit.
# Usage: bash tests/bench/figures.sh [--list] [NAME...]
set -euo pipefail
cd "$(dirname "$0")/../.."

# NAME | DOCUMENT | COMMAND. The script's first word may be run alone; its options are those of this table.
list() {
  cat <<'LIST'
thermal_likelihood  | docs/evidence/network_figures.md | tests/bench/thermal_likelihood.sh --first-seed 9001 --json
export_sizes        | docs/evidence/network_figures.md | tests/bench/export_sizes.sh
hard_typical        | docs/evidence/hard_table.md      | tests/bench/hard_table.sh --only typical --first-seed 10001
hard_honest         | docs/evidence/hard_table.md      | tests/bench/hard_table.sh --only honest --honest-seeds 60 --first-seed 10101
live_latency        | docs/evidence/speed.md           | tests/bench/live_latency.sh --json
live_process        | docs/evidence/speed.md           | tests/bench/live_process.sh --json
models              | docs/evidence/network_figures.md | tests/bench/models.sh --json
network_speeds      | docs/evidence/network_figures.md | tests/bench/network_peers.sh --json
network_differences | docs/evidence/network_figures.md | tests/bench/network_peers.sh --json
map_table           | docs/evidence/odometer.md        | tests/bench/map_table.sh --first-seed 901 --json
odometer            | docs/evidence/odometer.md        | tests/bench/odometer_table.sh --first-seed 94001
study_raw           | docs/evidence/paper_study.md     | tests/bench/paper_study.sh --draw raw
study_calibrated    | docs/evidence/paper_study.md     | tests/bench/paper_study.sh --draw calibrated
long_session        | docs/evidence/reliability.md     | tests/bench/long_session.sh 24
fault_table         | docs/evidence/reliability.md     | tests/bench/fault_table.sh --json
record_peers        | docs/evidence/speed.md           | tests/bench/record_peers.sh
timing              | docs/evidence/timing_table.md    | tests/bench/timing_table.sh
label_choice        | docs/evidence/hard_table.md      | tests/bench/label_choice.sh
LIST
}

case ${1-} in
  --list)
    list
    exit
    ;;
  -*)
    echo "unknown: $1; try: bash tests/bench/figures.sh [--list] [NAME...]" >&2
    exit 2
    ;;
esac
for name in "$@"; do
  list | grep -q "^$name " || { echo "no figures have the name $name; --list says which there are" >&2; exit 2; }
done
changes=$(git status --porcelain --untracked-files=no -- . ':!docs' ':!*.md')
[ -z "$changes" ] || { printf 'not every change is in a commit, so no table could name one:\n%s\n' "$changes" >&2; exit 1; }
commit=$(git rev-parse --short=12 HEAD)
mkdir -p build/figures
made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT

failed=0
while IFS='|' read -r name document command; do
  read -r name <<<"$name"
  read -r document <<<"$document"
  read -r -a words <<<"$command"
  [ $# -eq 0 ] || [[ " $* " == *" $name "* ]] || continue
  output=$made/$(cksum <<<"${words[*]}" | tr -d ' ') # two tables of one command: it is run once
  if [ ! -e "$output" ]; then
    echo "== ${words[*]}"
    begin=$SECONDS code=0
    bash "${words[@]}" </dev/null >"$output" || code=$?
    echo "$code" >"$output.code"
    echo "== took $((SECONDS - begin)) s, exit code $code"
  fi
  cp "$output" "build/figures/$name.txt"
  python3 tests/bench/figures.py "$name" "$document" "$commit" "$(<"$output.code")" "$output" || failed=1
done < <(list)
exit $failed
