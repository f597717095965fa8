// SPDX-License-Identifier: Apache-2.0
// The shaper family on the command line: design, robustness, recommend.
#include <cmath>
#include <filesystem>
#include <fstream>

#include "tests/sim/cli_checks.hpp"

using stillpoint::testing::check_keys;
using stillpoint::testing::check_refused;
using stillpoint::testing::Json;
using stillpoint::testing::json_of;
using stillpoint::testing::Outcome;
using stillpoint::testing::run_program;
using stillpoint::testing::scratch_file;

namespace {

const std::string kEveryType =
    "zv:11:0.1+zvd:11:0.1+zvdd:11:0.1+zvddd:11:0.1+mzv:11:0.1+ei:11:0.1+ei2:11:0.1+ei3:11:0.1+cv1:11:0.1";

std::string train_file(const std::string& text) {
  const std::string path = scratch_file("train.csv");
  std::ofstream(path) << text;
  return path;
}

}  // namespace

TEST_HOST(design_knows_every_type_and_its_band) {
  struct Row {
    const char* type;
    double low;
    double high;
  };
  // Reference 2, v = 5 %, zeta 0.1; within the 1 % that the grid may move an edge.
  constexpr Row kRows[] = {{"cv1", 0.76485, 1.24832}, {"cv2", 0.57439, 1.53538}, {"cv3", 0.41327, 2.37834},
                           {"ei", 0.77273, 1.24475},  {"ei2", 0.59892, 1.45861}, {"ei3", 0.47635, 1.62774}};
  for (const Row& row : kRows) {
    const Json design = json_of(std::string("design --shaper ") + row.type + ":11:0.1");
    const Json& shaper = design["shapers"][0];
    TEST_INFO("type", row.type);
    REQUIRE(shaper["type"] == row.type);
    TEST_ASSERT_DOUBLE_RELATIVE(0.01, row.low, shaper["low_ratio"].get<double>());
    TEST_ASSERT_DOUBLE_RELATIVE(0.01, row.high, shaper["high_ratio"].get<double>());
    TEST_ASSERT_AT_MOST_DOUBLE(1.0, shaper["band_miss"].get<double>());
    double sum = 0.0;
    for (const Json& impulse : shaper["impulses"]) sum += impulse["amplitude"].get<double>();
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.0, sum);
  }
  TEST_ASSERT_EQUAL_UINT32(9, json_of("design --shaper " + kEveryType)["shapers"].size());
}

TEST_HOST(the_price_of_a_negative_shaper_is_told) {
  const Json design = json_of("design --shaper um-zv:5:0.02");
  TEST_ASSERT_DOUBLE_WITHIN(0.01, 3.0, design["peak_gain"].get<double>());
  TEST_ASSERT_AT_LEAST_DOUBLE(2.5, design["highest_gain"].get<double>());
  TEST_ASSERT_AT_LEAST_DOUBLE(5.0, design["highest_gain_hz"].get<double>());
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.0, json_of("design --shaper cv2:5:0.02")["highest_gain"].get<double>());
}

TEST_HOST(a_train_from_a_file_keeps_its_amplitudes_on_whole_ticks) {
  const std::string file = train_file("# a comment\ntime_s,amplitude\n0,0.25\n0.05,0.5\n0.1,0.25\n");
  const Json design = json_of("design --shaper custom:10:0:file=" + file);
  REQUIRE(design["stages"].size() == 1);
  REQUIRE(design["stages"][0].size() == 3);
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.25, design["stages"][0][0]["gain"].get<double>());
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.5, design["stages"][0][1]["gain"].get<double>());
  TEST_ASSERT_AT_MOST_DOUBLE(1e-8, design["shapers"][0]["residual_on_grid"].get<double>());
}

TEST_HOST(shapers_that_cannot_be_are_refused_with_what_can) {
  check_refused(2, "tolerance: 0.05: above the maximum, at most 0.038", "design --shaper ei3:11:0.3");
  check_refused(2, "frequency: 350: above the maximum, at most 310.", "design --shaper cv4:350:0");
  check_refused(2, "tolerance: 0.3: out of range, 0.001 to 0.2", "design --shaper cv4:10:0:v=0.3");
  check_refused(2, "spacing: 0.6: out of range, 0.25 to 0.5", "design --shaper mzv:10:0:spacing=0.6");
  check_refused(2, "shaper key: spacing=0.3: not known", "design --shaper zv:10:0:spacing=0.3");
  check_refused(2, "train: nowhere.csv: cannot be read", "design --shaper custom:10:0:file=nowhere.csv");
  check_refused(2, "shaper: custom:10:0: has no train", "design --shaper custom:10:0");
  check_refused(2, "sum of impulse amplitudes: 0.75: below the minimum, at least 1",
                "design --shaper custom:10:0:file=" + train_file("0,0.25\n0.05,0.5\n"));
  check_refused(2, "impulse time: 0.05: below the minimum, at least 0.1",
                "design --shaper custom:10:0:file=" + train_file("0,0.25\n0.1,0.5\n0.05,0.25\n"));
}

TEST_HOST(robustness_prints_the_promise) {
  const Json promise = json_of("robustness");
  TEST_ASSERT_EQUAL_UINT32(13, promise["types"].size());
  for (const Json& type : promise["types"]) {
    TEST_ASSERT_EQUAL_UINT32(4, type["dampings"].size());
    check_keys(type["dampings"][0], {"damping_ratio", "exists", "length_periods", "low_ratio", "high_ratio"});
  }
  // Peers, 5 % at zeta 0.1: exact ZV, ZVD, ZVDD +-4, -15/+20 (a vendor's mean of both ends), -23/+38.
  const Json& zv = promise["types"][0]["dampings"][2];
  TEST_ASSERT_DOUBLE_WITHIN(0.005, 0.963, zv["low_ratio"].get<double>());
  TEST_ASSERT_DOUBLE_WITHIN(0.005, 1.038, zv["high_ratio"].get<double>());
  check_refused(2, "--tolerance: 0.5: out of range, 0.001 to 0.2", "robustness --tolerance 0.5");
}

TEST_HOST(recommend_prints_what_it_promises) {
  const Json answer = json_of("recommend --band 8:14 --damping 0.05:0.1 --tolerance 0.05");
  check_keys(answer, {"shaper", "length_ticks", "worst_residual", "candidates"});
  TEST_ASSERT_AT_MOST_DOUBLE(0.05, answer["worst_residual"].get<double>());
  for (const Json& candidate : answer["candidates"]) {
    check_keys(candidate, {"shaper", "length_ticks", "worst_residual", "delay_s", "keeps_band", "why"});
    const bool shorter = candidate["length_ticks"] < answer["length_ticks"];
    TEST_ASSERT_FALSE(candidate["keeps_band"].get<bool>() && shorter);
  }
  // The answer is one that design takes, with the length told.
  const Json design = json_of("design --shaper " + answer["shaper"].get<std::string>());
  REQUIRE(design["length_ticks"] == answer["length_ticks"]);
}

TEST_HOST(the_optimal_train_can_be_used_as_a_custom_one) {
  const std::string file = scratch_file("optimal.csv");
  const Json answer = json_of("recommend --band 9:11 --damping 0.02 --optimal --csv " + file);
  check_keys(answer, {"impulses", "length_ticks", "worst_residual"});
  const Json design = json_of("design --shaper custom:10:0.02:v=0.051,file=" + file);
  REQUIRE(design["length_ticks"] == answer["length_ticks"]);
  TEST_ASSERT_AT_MOST_DOUBLE(0.9 + 2e-3, design["shapers"][0]["low_ratio"].get<double>());
  TEST_ASSERT_AT_LEAST_DOUBLE(1.1 - 2e-3, design["shapers"][0]["high_ratio"].get<double>());
}

TEST_HOST(recommend_refuses_by_name) {
  check_refused(2, "--band: 8: not a band, LO:HI", "recommend --band 8 --damping 0");
  check_refused(2, "frequency: 8: below the minimum, at least 14", "recommend --band 14:8 --damping 0");
  check_refused(2, "frequency: 600: above the maximum, at most 499.", "recommend --band 8:600 --damping 0");
  check_refused(2, "damping ratio: 0.4: above the maximum, at most 0.3", "recommend --band 8:9 --damping 0.4");
  check_refused(2, "damping ratio: 0.1: below the minimum, at least 0.2", "recommend --band 8:9 --damping 0.2:0.1");
  check_refused(2, "--tolerance: 0: out of range", "recommend --band 8:9 --damping 0 --tolerance 0");
  const Outcome outcome = run_program("recommend --band 3:40 --damping 0 --json");
  TEST_ASSERT_EQUAL_INT32(1, outcome.exit_code);
  REQUIRE(Json::parse(outcome.output).at("result") == "no_shaper");
  REQUIRE(outcome.errors.rfind("stillpoint: error: --band: 3:40: no shaper of the family keeps it", 0) == 0);
}

TEST_HOST(group_tells_what_staying_in_step_costs) {
  const Json ways = json_of("group --shaper zv:11:0.11 --shaper zv:17:0.05+ei:40:0")["ways"];
  TEST_ASSERT_EQUAL_UINT32(3, ways.size());
  for (const Json& way : ways) check_keys(way, {"way", "delay_s", "length_ticks", "line_signals", "taps_per_tick"});
  TEST_ASSERT_AT_LEAST_DOUBLE(1e-3, ways[0]["steady_lag_s"].get<double>());
  TEST_ASSERT_AT_MOST_DOUBLE(1e-9, ways[1]["steady_lag_s"].get<double>());
  TEST_ASSERT_AT_LEAST_DOUBLE(1e-3, ways[1]["corner_lag_s"].get<double>());
  TEST_ASSERT_TRUE(ways[2]["worst_lag_s"] == 0.0);
  check_refused(2, "--shaper: 1 axes: no group", "group --shaper zv:11:0.11");
}
