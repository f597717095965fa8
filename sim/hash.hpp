// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "shaper/base/signal.hpp"

namespace stillpoint::sim {

// FNV-1a, 64 bits, over the bytes of the setpoints, least significant first, from the first to the last one that
// differs from the one before it. setpoints[0] is where the axis stood, so a move gives the same hash however long it
// was waited for before and after. Nothing changes: the hash of nothing.
inline uint64_t setpoint_hash(const std::vector<Signal>& setpoints) {
  uint64_t hash = UINT64_C(0xCBF29CE484222325);
  size_t first = 1;
  while (first < setpoints.size() && setpoints[first] == setpoints[first - 1]) ++first;
  size_t end = setpoints.size();
  while (end > first && setpoints[end - 1] == setpoints[end - 2]) --end;
  for (size_t i = first; i < end; ++i) {
    const uint64_t bits = static_cast<uint64_t>(setpoints[i]);
    for (int shift = 0; shift < 64; shift += 8) hash = (hash ^ ((bits >> shift) & 0xFFU)) * UINT64_C(0x100000001B3);
  }
  return hash;
}

}  // namespace stillpoint::sim
