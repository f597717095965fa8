// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace stillpoint::cli {

// A table for people: the first column to the left, the others to the right.
class Table {
 public:
  explicit Table(std::vector<std::string> header) { rows_.push_back(std::move(header)); }

  // As many cells as the header has.
  void row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  void print() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

// Four significant digits; plain where that is short, with an exponent where it is not.
std::string figure(double value);
std::string figure(const std::optional<double>& value);  // "never" for nothing
std::string seconds(double value);                       // to the microsecond
std::string seconds(const std::optional<double>& value);
std::string yes_no(bool value);

}  // namespace stillpoint::cli
