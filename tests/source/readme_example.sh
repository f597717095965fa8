#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# usage: readme_example.sh COMPILER SHAPER_LIBRARY    the README's example, compiled freestanding as it stands, then run
set -euo pipefail
cd "$(dirname "$0")/../.."

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
sed -n '/^```cpp$/,/^```$/{//!p}' README.md > "$work/example.cpp"
[ -s "$work/example.cpp" ] || { echo "readme_example.sh: no example in README.md" >&2; exit 1; }
cat > "$work/main.cpp" <<'END'
#include <cstdint>
bool begin();
bool move_to(std::int32_t target_counts);
std::int64_t tick_1khz();
int main() {
  if (!begin()) return 1;
  tick_1khz();
  if (!move_to(1000000) || move_to(5)) return 2;
  std::int64_t setpoint = 0;
  for (int i = 0; i < 2000; ++i) setpoint = tick_1khz();
  return setpoint == std::int64_t{1000000} << 32 ? 0 : 3;
}
END
"$1" -std=c++17 -Wall -Wextra -Werror -ffreestanding -fno-exceptions -fno-rtti -I. -c "$work/example.cpp" -o "$work/example.o"
"$1" -std=c++17 "$work/main.cpp" "$work/example.o" "$2" -o "$work/run"
"$work/run"
echo "the example of README.md builds and arrives"
