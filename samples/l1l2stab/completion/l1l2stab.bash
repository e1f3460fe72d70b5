# SPDX-License-Identifier: MIT
# Completion of l1l2stab for bash. The options and their values come from the program itself.
_l1l2stab() {
  local word=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} values
  # bash takes --name=value apart into three words.
  if [[ $word == '=' ]]; then
    word=
  elif [[ $previous == '=' ]]; then
    previous=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  COMPREPLY=()
  compopt -o filenames 2>/dev/null
  if [[ $previous == --* ]]; then
    values=$("${COMP_WORDS[0]}" --complete 2>/dev/null | sed -n "s/^$previous //p")
    case $values in
      '') ;;
      FILE) mapfile -t COMPREPLY < <(compgen -f -- "$word") && return ;;
      DIR) mapfile -t COMPREPLY < <(compgen -d -- "$word") && return ;;
      VALUE) return ;;
      *) mapfile -t COMPREPLY < <(compgen -W "$values" -- "$word") && return ;;
    esac
  fi
  if [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$("${COMP_WORDS[0]}" --complete 2>/dev/null | sed 's/ .*//')" -- "$word")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
  fi
}
complete -F _l1l2stab l1l2stab
