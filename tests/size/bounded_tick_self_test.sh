#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# usage: bounded_tick_self_test.sh LINKER_SCRIPT COMPILER [FLAGS...]     bounded_tick.py finds what is planted
set -euo pipefail
here=$(dirname "$0")
script=$1
shift
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

examine() {  # PLANT EXPECTED_TEXT
  "${@:3}" "-D$1" -nostdlib -T "$script" "$here/planted_tick.cpp" -lgcc -o "$work/$1.elf"
  local answer=0
  "$here/bounded_tick.py" "$work/$1.elf" > "$work/log" || answer=$?
  if [ "$1" = NOTHING ]; then
    [ $answer -eq 0 ] || { cat "$work/log" >&2; echo "the control is refused" >&2; exit 1; }
  elif [ $answer -ne 1 ] || ! grep -q "^error: $2" "$work/log"; then
    cat "$work/log" >&2
    echo "$1 is not found: exit $answer, no line 'error: $2'" >&2
    exit 1
  fi
  echo "$1: ${2:-nothing found}"
}

examine NOTHING "" "$@"
examine PLANT_DOUBLE "floating point helper on the tick path: __aeabi_dadd" "$@"
examine PLANT_FLOAT "floating point on the tick path" "$@"
examine PLANT_DIVISION "division on the tick path" "$@"
examine PLANT_LONG_DIVISION "division helper on the tick path: __aeabi_ldivmod" "$@"
examine PLANT_RECURSION "recursion on the tick path: deeper" "$@"
examine PLANT_POINTER "an indirect call that no vtable answers" "$@"
examine PLANT_HEAP "heap in the image: malloc" "$@"
examine PLANT_UNREACHED "the walk does not reach" "$@"
