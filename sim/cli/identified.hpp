// SPDX-License-Identifier: Apache-2.0
// How a record and the modes found in it are shown.
#pragma once

#include <string>
#include <vector>

#include "shaper/identify/identification.hpp"
#include "sim/cli/json_fwd.hpp"
#include "sim/cli/plot.hpp"

namespace stillpoint::cli {

struct IdentifiedRecord {
  std::vector<float> samples;
  double rate_hz = 0.0;
  double first_s = 0.0;  // of the first sample
  Identification found{};

  double time_of(size_t n) const { return first_s + static_cast<double>(n) / rate_hz; }
};

// In another unit, `scale` of them to one of before.
IdentifiedRecord scaled(const IdentifiedRecord& record, double scale);

// The model at every sample of the record.
std::vector<double> fitted(const IdentifiedRecord& record);

// `result`, `modes`, `confidence`, `noise`, `hum_hz`.
Json json_of(const Identification& found);
void print_modes(const Identification& found);

// Why nothing was found, and what would be accepted.
const char* why(Finding finding);

// The record with the fitted ringing over it; its spectrum with the modes marked.
Panel record_panel(const IdentifiedRecord& record, const std::string& title, const std::string& unit);
Panel spectrum_panel(const IdentifiedRecord& record);

}  // namespace stillpoint::cli
