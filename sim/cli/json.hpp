// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "sim/cli/json_fwd.hpp"

namespace stillpoint::cli {

// A number with exactly these digits, where a double's shortest form would not do.
Json exact_number(const std::string& decimal);

// null for nothing.
Json optional_number(const std::optional<double>& value);

// The object and a line feed on standard output.
void print_json(const Json& object);

}  // namespace stillpoint::cli
