// SPDX-License-Identifier: Apache-2.0
// How a plain and a shaped move are shown.
#pragma once

#include <string>

#include "sim/cli/csv.hpp"
#include "sim/cli/json_fwd.hpp"
#include "sim/cli/move_job.hpp"
#include "sim/cli/plot.hpp"
#include "sim/cli/table.hpp"
#include "sim/evaluation.hpp"

namespace stillpoint::cli {

Settings settings_of(const MoveJob& job);

// `plain`, `shaped`, `residual_ratio`, `within_limits`, `zero_delay_met`.
Json json_of(const sim::Comparison& comparison);

// Columns: move, residual, ratio, settling, total, peaks.
Table figures_table();
void add_figures(Table& table, const std::string& name, const sim::MoveFigures& figures, double residual_ratio);
void print_comparison(const sim::Comparison& comparison);
// How the axis timed the shaped move and what bound it: of a move on the host, the drive's registers do not hold it.
void print_timing(const MoveReport& report);
void add_timing(Json& object, const MoveReport& report);

// Setpoint, motor, arm and acceleration of both moves until the plain one has settled and some time more.
void write_move_csv(const std::string& path, const std::string& command, const MoveJob& job,
                    const sim::Comparison& comparison);
Picture picture_of(const std::string& title, const MoveJob& job, const sim::Comparison& comparison);

}  // namespace stillpoint::cli
