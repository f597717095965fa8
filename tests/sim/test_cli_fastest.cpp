// SPDX-License-Identifier: Apache-2.0
// `stillpoint move --fastest` as a program.
#include <string>

#include "tests/sim/cli_checks.hpp"

using stillpoint::testing::check_keys;
using stillpoint::testing::check_refused;
using stillpoint::testing::Json;
using stillpoint::testing::json_of;
using stillpoint::testing::Outcome;
using stillpoint::testing::run_program;

namespace {

const std::string kFastest = "move --fastest --velocity 2 --acceleration 20 --jerk 400 ";
const std::string kArm = "--arm 11:0.11 ";

}  // namespace

TEST_HOST(fastest_prints_what_move_does_and_the_candidates) {
  const Json move = json_of(kFastest + kArm + "--distance 0.1 --least-ticks");
  check_keys(move, {"plain", "shaped", "residual_ratio", "within_limits", "zero_delay_met", "fastest", "ticks",
                    "least_ticks", "ratio_to_least", "candidates"});
  TEST_ASSERT_EQUAL_INT32(212, move["least_ticks"].get<int>());  // reference.md, 5
  TEST_ASSERT_AT_MOST_DOUBLE(1.015, move["ratio_to_least"].get<double>());
  TEST_ASSERT_AT_LEAST_DOUBLE(1.0, move["ratio_to_least"].get<double>());
  TEST_ASSERT_TRUE(move["within_limits"].get<bool>());
  TEST_ASSERT_AT_MOST_DOUBLE(0.05, move["residual_ratio"].get<double>());
  // The first is the one chosen, and what `shaped` is about.
  const Json& best = move["candidates"][0];
  REQUIRE(best["name"] == move["fastest"]);
  REQUIRE(best["ticks"] == move["ticks"]);
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, best["move_ticks"].get<double>() * 1e-3, move["shaped"]["move_time_s"].get<double>());
  int behind_zv = 0;
  for (const Json& each : move["candidates"]) {
    check_keys(each, {"name", "shaper", "zero_delay", "timing", "ticks", "move_ticks", "residual_ratio",
                      "peak_velocity", "peak_acceleration", "peak_jerk", "within_limits"});
    if (each["name"] == "s-curve + zv:11:0.11") behind_zv = each["ticks"].get<int>();
  }
  TEST_ASSERT_EQUAL_INT32(246, behind_zv);
  TEST_ASSERT_AT_MOST_INT64(behind_zv, move["ticks"].get<int>());
}

TEST_HOST(fastest_designs_for_the_shaper_that_is_given) {
  const Json move = json_of(kFastest + "--arm 11.4:0.1 --shaper zvd:11:0.11 --distance 0.1");
  bool found = false;
  for (const Json& each : move["candidates"]) found = found || each["shaper"] == "zv:11:0.11";
  TEST_ASSERT_TRUE(found);
  TEST_ASSERT_FALSE(move.contains("least_ticks"));
}

TEST_HOST(fastest_prints_a_table) {
  const Outcome outcome = run_program(kFastest + kArm + "--distance -0.02 --least-ticks --tolerance 0.02");
  TEST_ASSERT_EQUAL_INT32(0, outcome.exit_code);
  TEST_ASSERT_TRUE(outcome.errors.empty());
  for (const char* text : {"combination", "s-curve + um-zv:11:0.11, zero delay",
                           "still soonest: ", "the least ticks that any command needs: 135"}) {
    TEST_INFO(text, text);
    TEST_ASSERT_TRUE(outcome.output.find(text) != std::string::npos);
  }
}

TEST_HOST(move_says_how_it_was_timed) {
  const Json move = json_of("move --distance 0.02 --velocity 2 --acceleration 20 --jerk 400 --zero-delay " + kArm +
                            "--shaper zv:11:0.11");
  REQUIRE(move["shaped"]["timing"] == "raised");
  REQUIRE(move["shaped"]["binding"] == "jerk");
  TEST_ASSERT_EQUAL_INT32(145, move["shaped"]["total_ticks"].get<int>());
}

TEST_HOST(what_does_not_go_with_fastest_is_refused) {
  const std::string move = "move --distance 0.1 --velocity 2 --acceleration 20 --jerk 400 --shaper none " + kArm;
  check_refused(2, "--least-ticks: given: given alone, it is accepted with --fastest", move + "--least-ticks");
  check_refused(2, "--tolerance: 0.1: given alone, it is accepted with --fastest", move + "--tolerance 0.1");
  check_refused(2, "--duration: 1: not with --fastest", move + "--fastest --duration 1");
  check_refused(2, "--zero-delay: given: not with --fastest", move + "--fastest --zero-delay");
  check_refused(2, "--tolerance: 0.5: ", move + "--fastest --tolerance 0.5");
  check_refused(2, "--arm: missing", kFastest + "--distance 0.1");
}
