// SPDX-License-Identifier: Apache-2.0
// A drive's settings as a file.
#pragma once

#include <string>

#include "sim/cli/json_fwd.hpp"
#include "sim/hil/register_port.hpp"

namespace stillpoint::cli {

// {"product", "firmware", "map_version", "settings": {name: value}, "shaper_sets": [{name: value}, ...]}: every setting
// in the unit of its register; of the sets what they have staged. The set on show is the one before, afterwards.
Json exported(sim::RegisterPort& port);

// Writes what the file says, the axis's own limits first, since they bound the others; needs the axis standing. Refuses
// a name that is not known before anything is written. What the drive refuses ends it, with the drive's reason; what
// was written before stays.
void import_settings(sim::RegisterPort& port, const Json& file);

Json read_json_file(const std::string& path);
void write_json_file(const std::string& path, const Json& object);

}  // namespace stillpoint::cli
