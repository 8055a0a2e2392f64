#compdef thermorig
# SPDX-License-Identifier: MIT
# zsh completion of thermorig: the program itself knows its words. Installed as _thermorig in a folder of $fpath.
local -a whole whole_meanings begun
local line
while IFS= read -r line; do
  if [[ $line == *[/=] ]]; then
    begun+=("$line")
  else
    whole+=("${line%%$'\t'*}")
    whole_meanings+=("${line/$'\t'/  -- }")
  fi
done < <("${words[1]/#\~\//$HOME/}" complete "${(@Q)words[2,CURRENT]}" 2>/dev/null)
compadd -S '' -a begun
compadd -l -d whole_meanings -a whole
