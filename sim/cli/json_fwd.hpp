// SPDX-License-Identifier: Apache-2.0
// The type's name, for headers; json.hpp to use it.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace stillpoint::cli {

// Keeps the order in which keys are added.
using Json = nlohmann::ordered_json;

}  // namespace stillpoint::cli
