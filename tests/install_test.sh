#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What `cmake --install` puts under a prefix works there: the program with its simulator, man pages, completion, udev files.
# Usage: bash tests/install_test.sh BUILD_FOLDER
set -euo pipefail
build=$(realpath "$1")
prefix=$(mktemp -d "${TMPDIR:-/tmp}/thermorig-install.XXXXXX")
trap 'rm -rf "$prefix"' EXIT
fail() { echo "$1" >&2; exit 1; }
cd "$prefix"
cmake --install "$build" --prefix "$prefix" >/dev/null
program=$prefix/bin/thermorig

# Its own folder is where it looks for the AVR image, not the one that it was built in.
built=$("$build/bin/thermorig" --version) installed=$("$program" --version)
[ "$built" = "$installed" ] || fail "the installed program says: $installed"
[ ! -e "$build/bin/thermorig-avr" ] || [ -e libexec/thermorig/thermorig-avr ] || fail "thermorig-avr is not installed"
mv libexec gone
[ ! -e gone ] || grep -q "host build" <<<"$("$program" --version)" || fail "the simulator is found elsewhere"
mv gone libexec
! grep -qF "$(dirname "$build")" "$program" || fail "the program names the folder that it was built in"

for page in thermorig thermorig-record thermorig-dataset; do
  [ -s "share/man/man1/$page.1" ] || fail "there is no man page $page"
done
if command -v mandoc >/dev/null; then mandoc -T lint -W warning share/man/man1/*.1; fi
for rules in 60-thermorig 91-thermorig-brltty; do [ -s "lib/udev/rules.d/$rules.rules" ] || fail "$rules is not installed"; done

# What the shell would show of the line that is typed, a word a line.
export PATH=$prefix/bin:$PATH
typed() {
  bash -c 'source share/bash-completion/completions/thermorig
    COMP_LINE=$1 COMP_POINT=${#1} COMPREPLY=()
    _thermorig
    printf "%s\n" "${COMPREPLY[@]}"' _ "$1"
}
expect() { [ "$(typed "$1" | paste -sd' ')" = "$2" ] || fail "bash completes '$1' to: $(typed "$1")"; }
expect "thermorig rec" "record recover"
expect "thermorig record --simulated-gyro " "calibrated raw typical"
expect "thermorig export x.h5 --csv=g" "gyro"
expect "thermorig list s" "share/"
if command -v fish >/dev/null; then
  found=$(fish --no-config -c 'source share/fish/vendor_completions.d/thermorig.fish; complete -C "thermorig recor"')
  [[ $found == record$'\t'* ]] || fail "fish completes 'thermorig recor' to: $found"
fi
if command -v zsh >/dev/null; then zsh -n share/zsh/vendor-completions/_thermorig; fi

# The same by its key, in a shell on a terminal: --ver becomes --version, which names the compiler.
completes() { # SHELL SECONDS LINE...: how long it takes to begin, lines that make the completion known to it
  local shell=$1 pause=$2 said
  shift 2
  command -v "${shell%% *}" >/dev/null || return 0
  said=$({ printf '%s\n' "$@"; sleep "$pause"; printf 'thermorig --ver\t\n'; sleep "$pause"; printf 'exit\n'; } |
    TERM=xterm timeout 60 script -qec "$shell" /dev/null)
  grep -qa '^compiler' <<<"$said" || fail "${shell%% *} completes nothing on a terminal: $said"
}
if command -v script >/dev/null; then
  completes 'bash --norc --noprofile -i' 0 'source share/bash-completion/completions/thermorig'
fi
if command -v script >/dev/null && [ -n "${THERMORIG_EVERYTHING:-}" ]; then
  completes 'zsh -f -i' 1 'fpath=(share/zsh/vendor-completions $fpath)' 'autoload -Uz compinit; compinit -D -u'
  completes 'fish --no-config -i' 1 'source share/fish/vendor_completions.d/thermorig.fish'
fi
