// SPDX-License-Identifier: Apache-2.0
// Measured records as instruments write them: CSV, tab-separated, LabVIEW's LVM, with or without a header.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace stillpoint::sim {

struct RecordTable {
  std::vector<std::string> names;            // of the columns; empty where the file names none
  std::vector<std::vector<double>> columns;  // NaN where a cell is empty
  size_t rows() const { return columns.empty() ? 0 : columns[0].size(); }
};

// The longest run of lines that hold numbers alone, as many in each; a line of as many words just before it names the
// columns. Tabs, semicolons, commas or spaces part the cells, whichever comes first in this order. Lines that begin
// with # or % and empty ones do not count. Refuses a file that cannot be read or holds no numbers.
RecordTable read_record_table(const std::string& path);

// A column by name or, failing that, by index from 0; the last that holds numbers for an empty `wanted`. Refuses what
// is not there, with `option` as the culprit.
size_t column_of(const RecordTable& table, const std::string& wanted, const std::string& option);

// Rows first to end (exclusive) of a column, less the first of them, in single precision. Refuses empty cells.
std::vector<float> samples_of(const RecordTable& table, size_t column, size_t first, size_t end);

// Every factor-th value behind a low-pass filter (Hann-windowed sinc, 8 factor + 1 taps, flat to 0.35 of the new
// rate, 40 dB down from 0.65 on), where the whole filter lies within the record: the first value stands 4 factor
// samples after the record's. factor 1 changes nothing.
std::vector<float> decimated(const std::vector<float>& samples, size_t factor);

}  // namespace stillpoint::sim
