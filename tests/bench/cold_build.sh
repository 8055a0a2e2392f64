#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# How long `bash app/quickstart.sh` takes from a fresh clone of the last commit, without a compiler cache, to the inspected
# session; and the processor time of each target's compilers. Packages must be installed already (bash app/setup.sh).
# Usage: bash tests/bench/cold_build.sh [--json]
set -euo pipefail
cd "$(dirname "$0")/../.."
case ${1-} in "" | --json) ;; *) echo "unknown: $1; try: bash tests/bench/cold_build.sh [--json]" >&2; exit 2 ;; esac
export LC_ALL=C
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
git clone -q . "$folder/thermorig"

# Compilers that write down what they took: "target user system".
for compiler in gcc g++; do
  cat >"$folder/$compiler" <<WRAPPER
#!/usr/bin/env bash
/usr/bin/$compiler "\$@"
code=\$?
target=other
for word; do [[ \$word =~ CMakeFiles/([^/]+)\.dir/ ]] && target=\${BASH_REMATCH[1]}; done
times >"$folder/times.\$\$" # of this shell, then of what it ran; a pipe would be another shell
echo "\$target \$(tail -n 1 "$folder/times.\$\$")" >>"$folder/compilers.txt"
rm "$folder/times.\$\$"
exit \$code
WRAPPER
  chmod +x "$folder/$compiler"
done
: >"$folder/compilers.txt"

begin=$(date +%s.%N)
(cd "$folder/thermorig" && CCACHE_DISABLE=1 CC="$folder/gcc" CXX="$folder/g++" bash app/quickstart.sh) >"$folder/log" 2>&1 ||
  { tail -n 30 "$folder/log" >&2; exit 1; }
end=$(date +%s.%N)

python3 - "$folder/compilers.txt" "$begin" "$end" "$(nproc)" "$(git rev-parse --short=12 HEAD)" "${1-}" <<'PYTHON'
import collections
import json
import re
import sys

path, begin, end, cores, commit, form = sys.argv[1:]
seconds = collections.Counter()
for line in open(path):
    target, *spent = line.split()
    seconds[target] += sum(60 * int(m) + float(s) for m, s in (re.fullmatch(r"(\d+)m([\d.]+)s", t).groups() for t in spent))
figures = {"commit": commit, "cores": int(cores), "quickstart_s": round(float(end) - float(begin), 1),
           "compilers_cpu_s": round(sum(seconds.values()), 1),
           "targets_cpu_s": {target: round(s, 1) for target, s in seconds.most_common()}}
if form == "--json":
    print(json.dumps(figures))
else:
    print(f"commit {commit}: quickstart from a fresh clone, no compiler cache, {cores} cores: {figures['quickstart_s']} s")
    print(f"processor time of the compilers: {figures['compilers_cpu_s']} s")
    for target, s in figures["targets_cpu_s"].items():
        print(f"{s:8.1f} s  {target}")
PYTHON
