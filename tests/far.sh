# SPDX-License-Identifier: MIT
# Sourced: suites that are far from most changes. Each names the folders that its result rests on. In CI it runs only where
# one of them differs from the commit of its last recorded pass (tests/last_passes.txt, which tests/nightly.sh writes);
# elsewhere, and with THERMORIG_EVERYTHING=1, always.

# far NAME FOLDER... -- COMMAND...
far() {
  local name=$1 folders=()
  shift
  while [ "$1" != -- ]; do
    folders+=("$1")
    shift
  done
  shift
  echo "== $name"
  local passed
  passed=$(sed -n "s/^$name //p" tests/last_passes.txt)
  if [ "${CI:-}" = true ] && [ -z "${THERMORIG_EVERYTHING:-}" ] && [ -n "$passed" ] &&
    git diff --quiet "$passed" -- "${folders[@]}" 2>/dev/null; then
    echo "passed at $passed, and ${folders[*]} are as they were: not run (THERMORIG_EVERYTHING=1 runs it)"
    return
  fi
  "$@"
}
