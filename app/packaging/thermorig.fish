# SPDX-License-Identifier: MIT
# fish completion of thermorig: the program itself knows its words.
function __thermorig_complete
  set -l words (commandline -opc) (commandline -ct)
  $words[1] complete $words[2..-1] 2>/dev/null
end
complete -c thermorig -f -a '(__thermorig_complete)'
