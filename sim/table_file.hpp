// SPDX-License-Identifier: Apache-2.0
// A profile table as a text file, and as a source file for flash.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shaper/profile/profile_table.hpp"

namespace stillpoint::sim {

// Owns its nodes. `table()` points into it.
struct TableData {
  uint32_t order = 0;
  uint32_t spans = 0;
  std::vector<int64_t> nodes;
  TablePeaks peaks = {};

  ProfileTable table() const { return {order, spans, nodes.data(), peaks}; }
};

// The format, stable: lines of comments (#) and empty ones are passed over; then `stillpoint profile table 1`,
// `order N`, `spans N`, and a line a knot: position and derivatives up to the order, times 2^48, as whole numbers
// (profile_table.hpp). The peaks are found when it is read. Throws a Refusal on anything else, and on what no move is.
TableData read_table(const std::string& path);

// `comments`: a line each. Throws a Refusal where the file cannot be written.
void write_table(const std::string& path, const TableData& data, const std::vector<std::string>& comments);

// The same as constexpr C++, `name` in namespace stillpoint.
void write_table_header(const std::string& path, const TableData& data, const std::string& name,
                        const std::vector<std::string>& comments);

}  // namespace stillpoint::sim
