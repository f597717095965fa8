// SPDX-License-Identifier: Apache-2.0
// A profile table out of samples of a move.
#pragma once

#include <string>
#include <vector>

#include "sim/experiment.hpp"
#include "sim/table_file.hpp"

namespace stillpoint::sim {

// Of a move from 0 to 1 in a time of 1; times rise.
struct ShapeSample {
  long double time;
  long double position;
};
using ShapeSamples = std::vector<ShapeSample>;

// `time,position` lines of a CSV file, in any unit and from anywhere: made a move from 0 to 1. With a header that names
// time_s and position those two columns (as `profile --csv` writes them), else the first two; of a single column, the
// positions at equal times. Lines that start with '#' are passed over. Throws a Refusal.
ShapeSamples read_shape(const std::string& path);

// Of a move of any kind, at least `least` of them: planned in units of 2^30 counts, on ticks as short as that takes.
ShapeSamples sample_shape(const MoveTask& task, size_t least);

struct TableFit {
  TableData data;
  double largest_deviation;  // from the samples, of the whole move
};

// The table whose polynomials are nearest to the samples (least squares), at rest at both ends and from order 2 on
// without acceleration there. Refuses spans that hold fewer samples than a knot has nodes.
TableFit fit_table(const ShapeSamples& samples, uint32_t order, uint32_t spans);

}  // namespace stillpoint::sim
