#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# usage: format.sh [--fix]     every source is formatted as .clang-format says, and no line is longer than it allows
set -euo pipefail
cd "$(dirname "$0")/../.."

mapfile -t sources < <(find shaper hal firmware sim tests -name '*.[ch]pp' | sort)
if [ "${1:-}" = --fix ]; then
  clang-format -i "${sources[@]}"
else
  clang-format --dry-run -Werror --ferror-limit=5 "${sources[@]}"
fi
# clang-format leaves comments alone (ReflowComments), so their length is looked at here.
if grep -nE '^.{121,}' "${sources[@]}"; then
  echo "format.sh: longer than 120 columns" >&2
  exit 1
fi
echo "${#sources[@]} files formatted"
