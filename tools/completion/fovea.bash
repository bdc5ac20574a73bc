# Completion of fovea, fovea-sim, fovea-hw and fovea-bench for bash. Options, sub-commands and choices are read from each
# program's own --help, scenarios from `fovea-sim list`, keys from `fovea-sim keys` and `fovea-hw CONFIG --keys`: nothing is
# listed here twice.

# Words from the --help of "$@", one per line: `commands`, `options`, or the choices of the option $1.
_fovea_help() {
  local what=$1
  shift
  "$@" --help 2> /dev/null | awk -v what="$what" '
    /^[A-Z].*:$/ { part = $0 }
    what == "commands" && part == "Subcommands:" && /^  [a-z]/ { print $1 }
    what == "options" && /^ +(-[a-zA-Z],)?--/ {
      name = $1
      sub(/^-[a-zA-Z],/, "", name)
      sub(/[^-a-zA-Z].*$/, "", name)
      print name
    }
    what ~ /^--/ && match($1, what "$|" what "[^-a-z]") && match($0, /\{[^}]*\}/) {
      choices = substr($0, RSTART + 1, RLENGTH - 2)
      gsub(/,/, "\n", choices)
      print choices
    }'
}

# The keys that --set of "$@" accepts. Those of fovea-hw depend on its configuration, the first word after the program. A
# replay accepts the keys of the servo, a comparison those of the arm.
_fovea_keys() {
  local folder=$1 sections='[a-z]'
  local -a ask=("${folder}fovea-sim" keys)
  shift
  case "${*##*/}" in
    fovea-hw) ask=("$1" "${COMP_WORDS[1]}" --keys) ;;
    'fovea replay')
      ask=("${folder}fovea-hw" loopback --keys)
      sections='\(servo\|safety\)\.'
      ;;
    'fovea compare') sections='arm\.' ;;
  esac
  "${ask[@]}" 2> /dev/null | sed -n "s/^\($sections[^ ]*\) = .*/\1=/p"
}

_fovea_scenarios() {
  "${1}fovea-sim" list 2> /dev/null | awk '{ print $1 }'
}

_fovea() {
  local program=${1/#'~/'/$HOME/} word=$2 previous=$3
  # The folder of this program and of the others.
  local folder=${program%"${program##*/}"}
  local -a call=("$program") found
  local w choices
  COMPREPLY=()
  # The sub-commands typed so far, without the word at the cursor.
  for w in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    if _fovea_help commands "${call[@]}" | grep -qxF -- "$w"; then
      call+=("$w")
    fi
  done
  if [ "$previous" = --set ]; then
    mapfile -t found < <(compgen -W "$(_fovea_keys "$folder" "${call[@]}")" -- "$word")
    compopt -o nospace 2> /dev/null
  elif [[ "${call[*]##*/} $previous" == 'fovea compare --scenario' ]]; then
    mapfile -t found < <(
      compgen -W "$(_fovea_scenarios "$folder")" -- "$word"
      compgen -f -- "$word"
    )
    compopt -o filenames 2> /dev/null
  elif [[ $word == -* ]]; then
    mapfile -t found < <(compgen -W "$(_fovea_help options "${call[@]}")" -- "$word")
  elif [[ $previous == --* ]] && choices=$(_fovea_help "$previous" "${call[@]}") && [ -n "$choices" ]; then
    mapfile -t found < <(compgen -W "$choices" -- "$word")
  else
    local names
    names=$(_fovea_help commands "${call[@]}")
    case "${call[*]##*/}" in
      'fovea-sim run' | 'fovea-sim serve' | 'fovea-sim pictures') names=$(_fovea_scenarios "$folder") ;;
      fovea-hw) names='loopback panda' ;;
    esac
    mapfile -t found < <(
      compgen -W "$names" -- "$word"
      compgen -f -- "$word"
    )
    compopt -o filenames 2> /dev/null
  fi
  COMPREPLY=("${found[@]}")
}

complete -F _fovea fovea fovea-sim fovea-hw fovea-bench
