#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# usage: registers_doc.sh STILLPOINT     firmware/registers.md is what the firmware's table says
set -euo pipefail
cd "$(dirname "$0")/../.."
if ! "$1" registers | diff -u firmware/registers.md -; then
  echo "registers_doc.sh: \`stillpoint registers > firmware/registers.md\` brings it up to date" >&2
  exit 1
fi
