# SPDX-License-Identifier: MIT
# Sourced by the benches that run a program of a build folder.

# take_arguments OPTION DEFAULT WORD...: json ("yes" or empty), build (--build FOLDER, default build) and number, which
# follows OPTION, or stands alone where OPTION is "".
take_arguments() {
  local option=$1
  number=$2 json="" build=build
  shift 2
  while [ $# -gt 0 ]; do
    case $1 in
      --json) json=yes ;;
      --build)
        [ $# -gt 1 ] || refuse_word "$1"
        build=$2
        shift
        ;;
      *)
        [ -z "$option" ] || { [ "$1" = "$option" ] && [ $# -gt 1 ] && shift; } || refuse_word "$1"
        [[ $1 =~ ^[0-9]+(\.[0-9]+)?$ ]] || refuse_word "$1"
        number=$1
        ;;
    esac
    shift
  done
}

# take_options "NAME..." WORD...: each --NAME VALUE into the variable NAME; what is left into words.
take_options() {
  local names=" $1 " name
  words=()
  shift
  while [ $# -gt 0 ]; do
    name=${1#--}
    if [ "$1" = "--$name" ] && [[ $names == *" $name "* ]]; then
      [ $# -gt 1 ] || refuse_word "$1"
      printf -v "$name" %s "$2"
      shift
    else
      words+=("$1")
    fi
    shift
  done
}

refuse_word() {
  echo "unknown: $1; try: $(sed -n 's/^.*Usage: //p' "tests/bench/${0##*/}")" >&2
  exit 2
}

# require_built TARGET: program, its path in $build.
require_built() {
  program=$build/bin/$1
  [ -x "$program" ] && return
  echo "$program is not there; try: cmake --build $build --target $1" >&2
  exit 2
}
