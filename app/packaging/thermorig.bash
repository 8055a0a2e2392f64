# SPDX-License-Identifier: MIT
# bash completion of thermorig: the program itself knows its words. Installed as
# /usr/share/bash-completion/completions/thermorig; or: source thermorig.bash
_thermorig() {
  local line=${COMP_LINE:0:COMP_POINT} words found last
  read -ra words <<<"$line"
  [[ $line == *[[:space:]] ]] && words+=("")
  last=${words[-1]}
  mapfile -t found < <("${words[0]/#\~\//$HOME/}" complete "${words[@]:1}" 2>/dev/null | cut -f1)
  [[ ${#found[@]} == 1 && ${found[0]} == *[/=] ]] && compopt -o nospace 2>/dev/null
  # bash takes '=' for the end of a word: what stands before it is there already.
  [[ $last == -*=* && $COMP_WORDBREAKS == *=* ]] && found=("${found[@]#"${last%%=*}="}")
  COMPREPLY=("${found[@]}")
}
complete -F _thermorig thermorig
