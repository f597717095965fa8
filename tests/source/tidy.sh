#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# usage: tidy.sh BUILD_TREE [PART PARTS]
# clang-tidy, as .clang-tidy says, on every product source that the tree compiles, or on every PARTSth, from PART on.
set -euo pipefail
cd "$(dirname "$0")/../.."

mapfile -t sources < <(sed -n 's/^ *"file": "\(.*\)",\{0,1\}$/\1/p' "$1/compile_commands.json" |
  grep -E "^$PWD/(shaper|firmware|sim)/" | sort -u)
for i in "${!sources[@]}"; do
  [ $((i % ${3:-1} + 1)) -eq "${2:-1}" ] || unset "sources[$i]"
done
[ ${#sources[@]} -gt 0 ] || { echo "tidy.sh: no product sources in $1" >&2; exit 1; }

# It must find what is planted, or a broken set-up would pass everything.
planted=$(mktemp -d)
trap 'rm -rf "$planted"' EXIT
cp .clang-tidy "$planted"
echo 'int BadName(int* p) { if (p == 0) return *p; return 1; }' > "$planted/planted.cpp"
if clang-tidy --quiet "$planted/planted.cpp" -- -std=c++17 > "$planted/log" 2>&1; then
  echo "tidy.sh: a planted violation was not found" >&2
  exit 1
fi
grep -q 'readability-identifier-naming' "$planted/log"
grep -q 'clang-analyzer-core.NullDereference' "$planted/log"

jobs=$([ $# -gt 1 ] && echo 1 || nproc)
# The analyzer's paths through the templates of the command line's packages take as long as all else together.
check() {
  if [[ $2 == */sim/cli/* ]]; then
    clang-tidy --quiet --checks='-clang-analyzer-*' -p "$1" "$2"
  else
    clang-tidy --quiet -p "$1" "$2"
  fi
}
export -f check
printf '%s\0' "${sources[@]}" | xargs -0 -n 1 -P "$jobs" bash -c 'check "$0" "$1"' "$1" 2>&1 |
  { grep -v -E '^[0-9]+ warnings?( and [0-9]+ errors?)? generated' || true; }
echo "${#sources[@]} files clean"
