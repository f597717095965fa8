// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/table.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace stillpoint::cli {

void Table::print() const {
  std::vector<size_t> widths(rows_[0].size(), 0);
  for (const auto& row : rows_) {
    for (size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  size_t total = 2 * (widths.size() - 1);
  for (const size_t width : widths) total += width;
  for (size_t r = 0; r < rows_.size(); ++r) {
    std::string line = fmt::format("{:<{}}", rows_[r][0], widths[0]);
    for (size_t i = 1; i < rows_[r].size(); ++i) line += fmt::format("  {:>{}}", rows_[r][i], widths[i]);
    fmt::print("{}\n", line.substr(0, line.find_last_not_of(' ') + 1));
    if (r == 0) fmt::print("{}\n", std::string(total, '-'));
  }
}

std::string figure(double value) { return fmt::format("{:.4g}", value); }
std::string figure(const std::optional<double>& value) { return value ? figure(*value) : "never"; }
std::string seconds(double value) { return fmt::format("{:.6f}", value); }
std::string seconds(const std::optional<double>& value) { return value ? seconds(*value) : "never"; }
std::string yes_no(bool value) { return value ? "yes" : "no"; }

}  // namespace stillpoint::cli
