// SPDX-License-Identifier: Apache-2.0
// Numbers from text and to text, without a locale.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "shaper/base/signal.hpp"

namespace stillpoint::sim {

// The decimal that reads back as the same double.
std::string shortest(double value);

// value * 2^-fraction_bits, every digit of it, whole numbers without a point. fraction_bits in [0, 60].
std::string exact_decimal(int64_t value, int fraction_bits);
inline std::string exact_counts(Signal signal) { return exact_decimal(signal, kSignalFractionBits); }

// All of `text` as a finite decimal number; throws a Refusal that calls it `what`.
double parse_number(std::string_view text, const std::string& what);
// The same, and above zero.
double parse_positive(std::string_view text, const std::string& what);
// The same as parse_number, and in [low, high].
double parse_within(std::string_view text, const std::string& what, double low, double high);
// All of `text` as an integer in [low, high].
int64_t parse_integer(std::string_view text, const std::string& what, int64_t low, int64_t high);

// The pieces between the separators: always one more than there are separators.
std::vector<std::string> split(std::string_view text, char separator);

// Without what editors and other systems leave around it: spaces, tabs, carriage returns.
std::string trimmed(std::string_view text);

}  // namespace stillpoint::sim
