#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What makes a mistake in the program hard to use for anything but a crash: read off the built program itself, since a
# flag that was given need not have arrived. Exit code 77 where the build cannot have it.
# Usage: hardening.sh UNHARDENED COMPILER PROGRAM LIBRARY...
#   UNHARDENED  why the build is not hardened: its sanitizers, or that it is not optimised; empty if it is
#   LIBRARY     static libraries of our own objects: in the program those of others are marked by their own flags
set -euo pipefail
unhardened=$1 compiler=$2 program=$3
shift 3
if [ -n "$unhardened" ]; then
  echo "skipped: calls are not checked in a build with sanitizers or without optimisation ($unhardened)"
  exit 77
fi
export LC_ALL=C
failed=0
holds() { # what command...
  if "${@:2}"; then echo "ok      $1"; else echo "MISSING $1: $program"; failed=1; fi
}
shows() { grep -qE "$2" <<< "${!1}"; }
lacks() { ! shows "$@"; }

header=$(readelf -hW "$program")
segments=$(readelf -lW "$program")
dynamic=$(readelf -dW "$program")
wanted=$(nm --undefined-only "$@")

holds "its place in memory is random (PIE)" shows header 'Type: +DYN'
holds "its place in memory is random (PIE), by its flags" shows dynamic 'FLAGS_1.*PIE'
holds "its tables of functions are read-only (RELRO)" shows segments '^ +GNU_RELRO'
holds "all of these tables, from the start (BIND_NOW)" shows dynamic 'BIND_NOW|FLAGS_1.*NOW'
holds "it has no executable stack" shows segments '^ +GNU_STACK .* RW +0x'
holds "it has no segment that can be written and executed" lacks segments '^ +LOAD .* RWE '
holds "its stack is guarded (-fstack-protector-strong)" shows wanted ' __stack_chk_fail$'
holds "its calls are checked (_FORTIFY_SOURCE)" shows wanted ' __[a-z]+_chk$'

# The program as a whole is marked only where each object is, those of the C library that start it included.
if [[ $(uname -m) == x86_64 ]] && "$compiler" -fcf-protection=full -E -x c /dev/null > /dev/null 2>&1; then
  members=$(for library in "$@"; do ar t "$library"; done | wc -l)
  marked=$(readelf -nW "$@" | grep -cE 'IBT, SHSTK' || true)
  holds "each object may be run with CET ($marked of $members)" test "$members" -eq "$marked"
  notes=$(readelf -nW "$program")
  start=$(readelf -nW "$("$compiler" -print-file-name=Scrt1.o)" 2> /dev/null || true)
  if shows start 'IBT, SHSTK'; then
    holds "the program may be run with CET" shows notes 'IBT, SHSTK'
  else
    echo "        the program is not marked for CET: the C library's Scrt1.o is not"
  fi
fi
exit $failed
