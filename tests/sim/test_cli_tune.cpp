// SPDX-License-Identifier: Apache-2.0
// `stillpoint tune` as a program.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "tests/sim/cli_checks.hpp"

using stillpoint::testing::check_keys;
using stillpoint::testing::check_refused;
using stillpoint::testing::Json;
using stillpoint::testing::json_of;
using stillpoint::testing::Outcome;
using stillpoint::testing::read_text;
using stillpoint::testing::run_program;
using stillpoint::testing::scratch_file;

namespace {

const std::string kMove = "tune --distance 1.7 --velocity 1.2 --acceleration 20 --jerk 600 --duration 1.62 ";

const std::string kShort = "tune --distance 0.02 --velocity 1.2 --acceleration 20 --jerk 600 ";

double number(const Json& object, const char* key) { return object.at(key).get<double>(); }

void check_mode(const Json& modes, size_t index, double frequency_hz, double damping_ratio) {
  TEST_ASSERT_TRUE(modes.size() > index);
  TEST_ASSERT_DOUBLE_RELATIVE(0.005, frequency_hz, number(modes[index], "frequency_hz"));
  TEST_ASSERT_DOUBLE_RELATIVE(0.1, damping_ratio, number(modes[index], "damping_ratio"));
}

// The setpoints of a trace, in units, from the first to the last tick of the state.
std::vector<double> setpoints_in(const std::string& csv, const std::string& state) {
  std::istringstream lines(read_text(csv));
  std::vector<double> setpoints;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    std::vector<std::string> row;
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
    if (row.size() == 9 && row[2] == state) setpoints.push_back(std::stod(row[4]));
  }
  return setpoints;
}

}  // namespace

TEST_HOST(tune_finds_the_papers_arm_and_leaves_it_still) {
  const Json tune = json_of(kMove + "--arm 11:0.11");
  REQUIRE(tune.at("result") == "ok");
  check_keys(tune, {"identified", "shaper", "announced", "source", "source_enough", "excited_by", "plain", "shaped",
                    "residual_ratio", "within_limits", "zero_delay_met", "flaws", "predicted", "verified",
                    "first_announced", "memory_bytes"});
  check_keys(tune["announced"], {"travel", "velocity", "acceleration", "jerk", "duration_s"});
  REQUIRE(tune["identified"].at("result") == "ok");
  TEST_ASSERT_EQUAL_UINT64(1, tune["identified"].at("modes").size());
  const Json& mode = tune["identified"]["modes"][0];
  check_keys(mode, {"frequency_hz", "damping_ratio", "amplitude", "frequency_std_hz", "damping_std", "confidence"});
  check_mode(tune["identified"]["modes"], 0, 11.0, 0.11);
  REQUIRE(tune["source"] == "accelerometer");
  REQUIRE(tune["excited_by"] == "move");
  TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.7, number(tune["announced"], "travel"));
  // 31 % is what the paper reached.
  TEST_ASSERT_AT_MOST_DOUBLE(0.02, number(tune, "residual_ratio"));
  TEST_ASSERT_TRUE(number(tune["shaped"], "total_time_s") < number(tune["plain"], "total_time_s"));
  TEST_ASSERT_TRUE(tune["within_limits"].get<bool>() && tune["zero_delay_met"].get<bool>());
  TEST_ASSERT_AT_MOST_DOUBLE(32768.0, number(tune["memory_bytes"], "own") + number(tune["memory_bytes"], "borrowed"));
}

// The shaper printed is the one that was run: `move` with it gives the same figures.
TEST_HOST(what_tune_prints_is_what_move_does_with_it) {
  const Json tune = json_of(kMove + "--arm 11:0.11");
  std::string move = "move" + kMove.substr(4) + "--zero-delay --arm 11:0.11 --shaper ";
  const Json again = json_of(move + tune.at("shaper").get<std::string>());
  for (const char* key : {"plain", "shaped", "residual_ratio"}) REQUIRE(again.at(key) == tune.at(key));
}

TEST_HOST(tune_repeats_itself_with_the_same_noise_and_not_with_other) {
  const Json once = json_of(kMove + "--arm 11:0.11 --noise 0.1 --seed 5");
  REQUIRE(once == json_of(kMove + "--arm 11:0.11 --noise 0.1 --seed 5 --zero-delay"));
  REQUIRE(once.at("identified") != json_of(kMove + "--arm 11:0.11 --noise 0.1 --seed 6").at("identified"));
}

TEST_HOST(tune_finds_two_modes) {
  const Json tune = json_of(kMove + "--arm 9:0.03:0.7,24:0.02:0.3");
  const Json& modes = tune.at("identified").at("modes");
  TEST_ASSERT_EQUAL_UINT64(2, modes.size());
  const bool slow_first = number(modes[0], "frequency_hz") < 15.0;
  check_mode(modes, slow_first ? 0 : 1, 9.0, 0.03);
  check_mode(modes, slow_first ? 1 : 0, 24.0, 0.02);
  TEST_ASSERT_TRUE(tune.at("shaper").get<std::string>().find('+') != std::string::npos);
  TEST_ASSERT_AT_MOST_DOUBLE(0.01, number(tune, "residual_ratio"));
}

TEST_HOST(tune_listens_to_the_following_error_where_the_arm_shakes_its_motor) {
  const Json tune = json_of(kMove + "--arm 11:0.05 --source following-error --reaction 0.02 --encoder-noise 2");
  REQUIRE(tune.at("source") == "following-error");
  TEST_ASSERT_TRUE(tune.at("source_enough").get<bool>());
  check_mode(tune.at("identified").at("modes"), 0, 11.0, 0.05);
  TEST_ASSERT_AT_MOST_DOUBLE(0.05, number(tune, "residual_ratio"));
}

TEST_HOST(tune_says_why_there_is_no_mode) {
  // Nearly all of the tip moves with the motor.
  const std::string stiff = kMove + "--arm 11:0.11:1e-9";
  const Outcome outcome = run_program(stiff + " --json");
  TEST_ASSERT_EQUAL_INT32(1, outcome.exit_code);
  const Json object = Json::parse(outcome.output);
  REQUIRE(object.at("result") == "no_mode");
  TEST_ASSERT_TRUE(object.at("identified").at("modes").empty());
  TEST_ASSERT_FALSE(object.contains("shaper"));
  check_refused(1, "tune: no_mode: ", stiff);
}

TEST_HOST(tune_tells_a_sensor_at_its_end_from_an_arm_that_does_not_ring) {
  const Outcome outcome = run_program(kMove + "--arm 11:0.11 --range 10 --json");
  TEST_ASSERT_EQUAL_INT32(1, outcome.exit_code);
  const Json object = Json::parse(outcome.output);
  REQUIRE(object.at("result") == "saturated");
  TEST_ASSERT_TRUE(number(object.at("flaws"), "saturated") > 0.0);
  REQUIRE(json_of(kMove + "--arm 11:0.11 --range 30").at("result") == "ok");
}

TEST_HOST(tune_of_a_noiseless_arm_finds_it_to_the_registers_last_digit) {
  const Json tune = json_of(kMove + "--arm 11:0.11 --noise 0");
  REQUIRE(tune.at("source") == "accelerometer");
  REQUIRE(tune.at("shaper") == "zv:11:0.11");
}

TEST_HOST(a_flickering_encoder_does_not_put_the_start_out_of_reach_of_the_default_travel) {
  for (int seed = 1; seed <= 6; ++seed) {
    json_of(kMove + "--arm 11:0.11 --encoder-noise 50 --seed " + std::to_string(seed));
  }
}

TEST_HOST(tune_without_time_for_zero_delay_takes_the_least) {
  const Json tune =
      json_of("tune --distance 1.7 --velocity 1.2 --acceleration 20 --jerk 600 --duration 1.515 --arm 11:0.11");
  TEST_ASSERT_FALSE(tune.at("zero_delay_met").get<bool>());
  TEST_ASSERT_TRUE(number(tune.at("shaped"), "move_time_s") > 1.515);
  TEST_ASSERT_AT_MOST_DOUBLE(0.02, number(tune, "residual_ratio"));
}

TEST_HOST(every_excitation_keeps_what_it_announces) {
  for (const char* kind : {"move", "bump", "stepped-sine", "chirp"}) {
    TEST_INFO(kind, kind);
    const std::string csv = scratch_file("tune.csv");
    const Json tune =
        json_of(kShort + "--arm 11:0.05 --band 5:40 --amplitude 0.01 --excitation " + kind + " --csv " + csv);
    REQUIRE(tune.at("excited_by") == kind);
    check_mode(tune.at("identified").at("modes"), 0, 11.0, 0.05);
    const Json& announced = tune.at("announced");
    const std::vector<double> setpoints = setpoints_in(csv, "1");
    TEST_ASSERT_TRUE(setpoints.size() > 20);
    double travel = 0.0, velocity = 0.0, acceleration = 0.0;
    for (size_t i = 2; i < setpoints.size(); ++i) {
      travel = std::max(travel, std::abs(setpoints[i]));
      velocity = std::max(velocity, std::abs(setpoints[i] - setpoints[i - 1]) / 1e-3);
      acceleration = std::max(acceleration, std::abs(setpoints[i] - 2.0 * setpoints[i - 1] + setpoints[i - 2]) / 1e-6);
    }
    TEST_ASSERT_TRUE(travel > 0.0 && travel <= number(announced, "travel") * (1.0 + 1e-9));
    TEST_ASSERT_AT_MOST_DOUBLE(number(announced, "velocity") * (1.0 + 1e-6), velocity);
    TEST_ASSERT_AT_MOST_DOUBLE(number(announced, "acceleration") * (1.0 + 1e-4), acceleration);
    TEST_ASSERT_AT_MOST_DOUBLE(0.02 * (1.0 + 1e-9), travel);
    TEST_ASSERT_AT_MOST_DOUBLE(1.2, velocity);
    TEST_ASSERT_AT_MOST_DOUBLE(20.0 * (1.0 + 1e-4), acceleration);
  }
}

TEST_HOST(tune_refuses_by_the_options_name) {
  const std::string arm = kMove + "--arm 11:0.11 ";
  check_refused(2, "--arm: missing: ", kMove);
  check_refused(2, "--excitation: hammer: not known, accepted: auto move bump stepped-sine chirp",
                arm + "--excitation hammer");
  check_refused(2, "--source: ear: not known, accepted: auto accelerometer following-error", arm + "--source ear");
  check_refused(2, "--band: 5: not a band", arm + "--band 5");
  check_refused(2, "--band: 40:5: not a band", arm + "--band 40:5");
  check_refused(2, "--band: 5:450: not a band", arm + "--band 5:450");
  check_refused(2, "--amplitude: 0: must be above zero", arm + "--amplitude 0");
  check_refused(2, "--travel: -1: must be above zero", arm + "--travel -1");
  check_refused(2, "--tolerance: 0.9: ", arm + "--tolerance 0.9");
  check_refused(2, "--noise: -1: ", arm + "--noise -1");
  check_refused(2, "--range: 0: must be above zero", arm + "--range 0");
  check_refused(2, "--reaction: 0.9: ", arm + "--reaction 0.9");
  check_refused(2, "--seed: x: ", arm + "--seed x");
  check_refused(2, "travel: ", arm + "--travel 0.5");  // the move needs more
  check_refused(2, "option: --shaper: not known to `tune`", arm + "--shaper zv:11:0.11");
}

TEST_HOST(hil_takes_what_a_tuning_needs_with_tune_alone) {
  const std::string hil = "hil --elf x" + kMove.substr(4) + "--arm 11:0.11 ";
  check_refused(2, "--noise: 0.1: given alone, it is accepted with --tune", hil + "--shaper zv:11:0.11 --noise 0.1");
  check_refused(2, "--shaper: zv:11:0.11: with --tune the drive finds its own", hil + "--tune --shaper zv:11:0.11");
}

TEST_HOST(tune_draws_the_record_the_spectrum_and_the_moves) {
  if (std::system("gnuplot --version >/dev/null 2>&1") != 0) return;
  const std::string picture = scratch_file("tune.svg");
  TEST_ASSERT_EQUAL_INT32(0, run_program(kMove + "--arm 11:0.11 --plot " + picture).exit_code);
  const std::string svg = read_text(picture);
  for (const char* title : {"Record and fit, accelerometer", "Spectrum (Hann)", "The whole move"}) {
    TEST_INFO(title, title);
    TEST_ASSERT_TRUE(svg.find(title) != std::string::npos);
  }
}
