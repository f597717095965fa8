#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# usage: must_not_compile.sh CASE.cpp COMPILER [FLAGS...]
#
# The case must compile as it stands, and with -DMUST_NOT_COMPILE fail with the text behind `// expect: `.
set -euo pipefail
case=$1
shift
expected=$(sed -n 's|^// expect: ||p' "$case")
[ -n "$expected" ] || { echo "$case: no line '// expect: TEXT'" >&2; exit 1; }

echo "== the control must compile"
"$@" -fsyntax-only "$case"

echo "== the case must not"
if diagnostics=$("$@" -fsyntax-only -DMUST_NOT_COMPILE "$case" 2>&1); then
  echo "it compiled" >&2
  exit 1
fi
if ! grep -qF -- "$expected" <<< "$diagnostics"; then
  printf 'refused for another reason than "%s":\n%s\n' "$expected" "$diagnostics" >&2
  exit 1
fi
echo "refused: $expected"
