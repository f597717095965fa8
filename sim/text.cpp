// SPDX-License-Identifier: Apache-2.0
#include "sim/text.hpp"

#include <charconv>
#include <cmath>

#include "sim/refusal.hpp"

namespace stillpoint::sim {
namespace {

// from_chars takes no plus sign, people do.
std::string_view without_plus(std::string_view text) {
  const bool plus = text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+';
  return plus ? text.substr(1) : text;
}

}  // namespace

std::string shortest(double value) {
  char buffer[32];
  const std::to_chars_result result = std::to_chars(buffer, buffer + sizeof buffer, value);
  return std::string(buffer, result.ptr);
}

std::string exact_decimal(int64_t value, int fraction_bits) {
  const uint64_t magnitude = value < 0 ? UINT64_C(0) - static_cast<uint64_t>(value) : static_cast<uint64_t>(value);
  const uint64_t mask = (UINT64_C(1) << fraction_bits) - 1;
  std::string digits = (value < 0 ? "-" : "") + std::to_string(magnitude >> fraction_bits);
  uint64_t fraction = magnitude & mask;
  if (fraction != 0) digits += '.';
  while (fraction != 0) {
    fraction *= 10;
    digits += static_cast<char>('0' + (fraction >> fraction_bits));
    fraction &= mask;
  }
  return digits;
}

double parse_number(std::string_view text, const std::string& what) {
  const std::string_view digits = without_plus(text);
  double value = 0.0;
  const std::from_chars_result result = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool all = result.ptr == digits.data() + digits.size();
  if (!all || digits.empty() || result.ec == std::errc::invalid_argument) {
    throw bad_argument(what, std::string(text), "not a number, a finite decimal number is accepted");
  }
  if (result.ec == std::errc::result_out_of_range || !std::isfinite(value)) {
    throw bad_argument(what, std::string(text), "not a finite number, a number up to 1.8e308 is accepted");
  }
  return value;
}

double parse_positive(std::string_view text, const std::string& what) {
  const double value = parse_number(text, what);
  if (value <= 0.0) {
    throw bad_argument(what, std::string(text), "must be above zero, a number above zero is accepted");
  }
  return value;
}

int64_t parse_integer(std::string_view text, const std::string& what, int64_t low, int64_t high) {
  const std::string_view digits = without_plus(text);
  const std::string range = "an integer from " + std::to_string(low) + " to " + std::to_string(high) + " is accepted";
  int64_t value = 0;
  const std::from_chars_result result = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (result.ec == std::errc::invalid_argument || result.ptr != digits.data() + digits.size() || digits.empty()) {
    throw bad_argument(what, std::string(text), "not an integer, " + range);
  }
  if (result.ec == std::errc::result_out_of_range || value < low || value > high) {
    throw bad_argument(what, std::string(text), "out of range, " + range);
  }
  return value;
}

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> pieces;
  size_t start = 0;
  while (true) {
    const size_t end = text.find(separator, start);
    pieces.emplace_back(text.substr(start, end == std::string_view::npos ? end : end - start));
    if (end == std::string_view::npos) return pieces;
    start = end + 1;
  }
}

double parse_within(std::string_view text, const std::string& what, double low, double high) {
  const double value = parse_number(text, what);
  if (value < low || value > high)
    throw bad_argument(what, std::string(text),
                       "out of range, " + shortest(low) + " to " + shortest(high) + " is accepted");
  return value;
}

std::string trimmed(std::string_view text) {
  const size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return "";
  return std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

}  // namespace stillpoint::sim
