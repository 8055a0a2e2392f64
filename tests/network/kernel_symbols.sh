#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Kernels compiled for an instruction set that not every machine has must share no function with anybody: of an inline
# function or template with external linkage the linker keeps one copy for the whole program, maybe this one. So all
# that their objects define for others lies in the namespace of the set, and nothing in them may be merged.
# Usage: kernel_symbols.sh NAMESPACE OBJECT...
set -euo pipefail
namespace=$1
shift
[ $# -gt 0 ] || { echo "no objects of $namespace" >&2; exit 2; }
inside="N9thermorig7network${#namespace}${namespace}"
failed=0
for object in "$@"; do
  while read -r _ type name; do
    case "$type" in
      W | V | w | v | u) echo "$object: $name may be merged with another copy ($type)"; failed=1 ;;
      *) [[ $name == *"$inside"* ]] || { echo "$object: $name lies outside of $namespace"; failed=1; } ;;
    esac
  done < <(nm --defined-only --extern-only "$object")
done
exit $failed
