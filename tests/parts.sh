# SPDX-License-Identifier: MIT
# Sourced by the scripts that run suites: says how long each part took.

# part NAME COMMAND...
part() {
  local name=$1 begin=$SECONDS
  shift
  echo "== $name"
  "$@"
  local line
  line=$(printf '%4d s  %s' $((SECONDS - begin)) "$name")
  echo "== took $line"
  [ -z "${THERMORIG_PARTS:-}" ] || echo "$line" >>"$THERMORIG_PARTS"
}
