// SPDX-License-Identifier: Apache-2.0
#include "sim/record_table.hpp"

#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>

#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::sim {

namespace {

std::vector<std::string> cells_of(const std::string& line) {
  for (const char separator : {'\t', ';', ','}) {
    if (line.find(separator) == std::string::npos) continue;
    std::vector<std::string> cells;
    for (const std::string& cell : split(line, separator)) cells.push_back(trimmed(cell));
    return cells;
  }
  std::vector<std::string> cells;
  for (const std::string& cell : split(trimmed(line), ' ')) {
    if (!cell.empty()) cells.push_back(cell);
  }
  return cells;
}

std::optional<double> number_of(const std::string& cell) {
  if (cell.empty()) return std::numeric_limits<double>::quiet_NaN();
  const char* first = cell.data() + (cell[0] == '+' ? 1 : 0);
  double value = 0.0;
  const auto [end, error] = std::from_chars(first, cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size()) return std::nullopt;
  return value;
}

// Nothing unless every cell is a number or empty, and one is a number.
std::optional<std::vector<double>> numbers_of(const std::vector<std::string>& cells) {
  std::vector<double> numbers;
  bool any = false;
  for (const std::string& cell : cells) {
    const std::optional<double> number = number_of(cell);
    if (!number) return std::nullopt;
    any = any || !std::isnan(*number);
    numbers.push_back(*number);
  }
  if (!any) return std::nullopt;
  return numbers;
}

struct Block {
  std::vector<std::string> header;
  std::vector<std::vector<double>> rows;
};

RecordTable table_of(const Block& block) {
  RecordTable table;
  table.columns.resize(block.rows[0].size());
  for (const std::vector<double>& row : block.rows) {
    for (size_t k = 0; k < row.size(); ++k) table.columns[k].push_back(row[k]);
  }
  // LVM names a column of comments that its rows leave out.
  if (block.header.size() >= table.columns.size()) {
    table.names.assign(block.header.begin(), block.header.begin() + static_cast<std::ptrdiff_t>(table.columns.size()));
  }
  return table;
}

bool holds_numbers(const std::vector<double>& column) {
  for (const double value : column) {
    if (std::isnan(value)) return false;
  }
  return true;
}

std::string names_of(const RecordTable& table) {
  std::string all;
  for (const std::string& name : table.names) all += (all.empty() ? "" : " ") + name;
  return all + (all.empty() ? "0 to " : ", or 0 to ") + std::to_string(table.columns.size() - 1);
}

}  // namespace

RecordTable read_record_table(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw bad_argument("file", path, "cannot be read, a table of numbers is accepted");
  Block longest, block;
  std::vector<std::string> words;
  std::string line;
  while (std::getline(file, line)) {
    const std::string bare = trimmed(line);
    if (bare.empty() || bare[0] == '#' || bare[0] == '%') continue;
    if (line.back() == '\r') line.pop_back();
    const std::vector<std::string> cells = cells_of(line);
    const auto numbers = numbers_of(cells);
    if (!numbers) {
      words = cells;
      if (block.rows.size() > longest.rows.size()) longest = block;
      block = Block{};
      continue;
    }
    if (block.rows.empty() || block.rows[0].size() != numbers->size()) {
      if (block.rows.size() > longest.rows.size()) longest = block;
      block = Block{block.rows.empty() ? words : std::vector<std::string>{}, {}};
    }
    block.rows.push_back(*numbers);
  }
  if (block.rows.size() > longest.rows.size()) longest = block;
  if (longest.rows.empty()) throw bad_argument("file", path, "holds no numbers, a table of numbers is accepted");
  return table_of(longest);
}

size_t column_of(const RecordTable& table, const std::string& wanted, const std::string& option) {
  if (wanted.empty()) {
    for (size_t k = table.columns.size(); k-- > 0;) {
      if (holds_numbers(table.columns[k])) return k;
    }
    return table.columns.size() - 1;
  }
  for (size_t k = 0; k < table.names.size(); ++k) {
    if (table.names[k] == wanted) return k;
  }
  size_t index = 0;
  const auto [end, error] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), index);
  if (error == std::errc() && end == wanted.data() + wanted.size() && index < table.columns.size()) return index;
  throw bad_argument(option, wanted, "not a column of the file, accepted: " + names_of(table));
}

std::vector<float> samples_of(const RecordTable& table, size_t column, size_t first, size_t end) {
  std::vector<float> samples;
  const std::vector<double>& values = table.columns[column];
  for (size_t n = first; n < end; ++n) {
    if (!std::isfinite(values[n])) {
      throw bad_argument("row", std::to_string(n), "holds no number in the column, whole records are accepted");
    }
    samples.push_back(static_cast<float>(values[n] - values[first]));
  }
  return samples;
}

std::vector<float> decimated(const std::vector<float>& samples, size_t factor) {
  if (factor <= 1) return samples;
  const size_t half = 4 * factor;
  std::vector<double> taps;
  double sum = 0.0;
  for (size_t i = 0; i <= 2 * half; ++i) {
    const double x = (static_cast<double>(i) - static_cast<double>(half)) / static_cast<double>(factor);
    const double angle = 0.94 * M_PI * x;
    const double window = 0.5 + 0.5 * std::cos(M_PI * x / 4.5);
    taps.push_back(window * (x == 0.0 ? 1.0 : std::sin(angle) / angle));
    sum += taps.back();
  }
  std::vector<float> kept;
  for (size_t n = 0; n + taps.size() <= samples.size(); n += factor) {
    double value = 0.0;
    for (size_t i = 0; i < taps.size(); ++i) value += taps[i] / sum * static_cast<double>(samples[n + i]);
    kept.push_back(static_cast<float>(value));
  }
  return kept;
}

}  // namespace stillpoint::sim
