// SPDX-License-Identifier: Apache-2.0
// A drive's settings as a file.
#pragma once

#include <string>
#include <vector>

#include "sim/cli/json_fwd.hpp"
#include "sim/hil/register_port.hpp"

namespace stillpoint::cli {

// {"product", "firmware", "map_version", "settings": {name: value}, "shaper_sets": [{name: value}, ...]}: every setting
// in the unit of its register; of the sets what they have staged. The set on show is the one before, afterwards.
Json exported(sim::RegisterPort& port);

// Writes what the file says; needs the axis standing. Refuses before anything is written what is not known, out of
// range or another product's; what the drive still refuses leaves all as it was before, and what is thrown says so.
// What it returns is to be known: that the file is of another firmware or map, and what the drive has otherwise than it
// says.
std::vector<std::string> import_settings(sim::RegisterPort& port, const Json& file);

Json read_json_file(const std::string& path);
void write_json_file(const std::string& path, const Json& object);

}  // namespace stillpoint::cli
