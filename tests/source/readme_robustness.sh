#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# usage: readme_robustness.sh STILLPOINT    the README's table of forgiven frequency errors is what the command prints
set -euo pipefail
cd "$(dirname "$0")/../.."
diff <(sed -n "/^Error of the arm's frequency/,/^\`\`\`$/p" README.md | sed '$d') <("$1" robustness) ||
  { echo "readme_robustness.sh: README.md (<) differs from what 'stillpoint robustness' prints (>)" >&2; exit 1; }
echo "the promise in README.md is what the command prints"
