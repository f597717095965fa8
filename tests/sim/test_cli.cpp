// SPDX-License-Identifier: Apache-2.0
// The face that other programs are built on: exit codes, error lines, JSON keys, CSV columns.
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "tests/sim/cli_checks.hpp"
#include "tests/sim/program.hpp"
#include "tests/support/test.hpp"

using stillpoint::testing::check_keys;
using stillpoint::testing::check_refused;
using stillpoint::testing::json_of;
using stillpoint::testing::Outcome;
using stillpoint::testing::read_text;
using stillpoint::testing::run_program;
using stillpoint::testing::scratch_file;
using Json = nlohmann::json;

namespace {

const std::string kMove = "--distance 1.7 --velocity 1.2 --acceleration 20 --jerk 600 ";
const std::string kArm = "--shaper zv:11:0.11 --arm 11:0.11 ";

// A CSV file: the header and the numbers below it, the comments checked and left out.
struct Csv {
  std::string header;
  std::vector<std::vector<std::string>> rows;
};

Csv csv_of(const std::string& path) {
  Csv csv;
  std::istringstream text(read_text(path));
  bool begun = false;
  for (std::string line; std::getline(text, line);) {
    if (!line.empty() && line[0] == '#') {
      TEST_ASSERT_FALSE(begun);
      continue;
    }
    if (!begun) {
      begun = true;
      csv.header = line;
      continue;
    }
    csv.rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) csv.rows.back().push_back(cell);
  }
  return csv;
}

}  // namespace

TEST_HOST(bad_arguments_end_with_2_and_name_what_is_accepted) {
  check_refused(2, "command: missing: ", "");
  check_refused(2,
                "command: dance: not known, accepted: design limits profile sensitivity robustness recommend group "
                "identify shape move tune hil drive emulate scope registers demo park table",
                "dance");
  check_refused(2, "option: --color: not known to `design`, accepted: ", "design --shaper zv:11:0.1 --color red");
  check_refused(2, "option: --shaper: needs exactly one value", "design --shaper");
  check_refused(2, "--shaper: missing: ", "design");
  check_refused(
      2,
      "shaper type: xy: not a known type, accepted: zv zvd zvdd zvddd mzv ei ei2 ei3 cv1 cv2 cv3 cv4 um-zv custom none",
      "design --shaper xy:11:0.1");
  check_refused(2, "frequency: 600: above the maximum, at most 490 ", "design --shaper zv:600:0.1");
  check_refused(2, "--tick: 0: must be above zero", "design --shaper zv:11:0.1 --tick 0");
  check_refused(2, "--distance: missing: ", "profile --velocity 1 --acceleration 1");
  check_refused(2, "--distance: far: not a number", "profile --distance far --velocity 1 --acceleration 1");
  check_refused(2, "--distance: 3000: beyond the range", "profile --distance 3000 --velocity 1 --acceleration 1");
  check_refused(2, "--distance: 1e-9: less than half a count", "profile --distance 1e-9 --velocity 1 --acceleration 1");
  check_refused(2, "--velocity: nan: not a finite number", "profile --distance 1 --velocity nan --acceleration 1");
  check_refused(2, "--acceleration: -2: must be above zero", "profile --distance 1 --velocity 1 --acceleration -2");
  check_refused(2,
                "--kind: sine: not a known kind of profile, accepted: s-curve trapezoid sin2 poly5 poly7 table:FILE "
                "matched:F:Z still:F:Z",
                "profile --kind sine " + kMove);
  check_refused(2, "--jerk: missing: ", "profile --kind s-curve --distance 1 --velocity 1 --acceleration 1");
  check_refused(2, "option: --start-velocity: not known to `move`", "move --start-velocity 1 " + kArm + kMove);
  check_refused(2, "--arm: missing: ", "move --shaper zv:11:0.1 " + kMove);
  check_refused(2, "arm: 11: not a mode", "move --shaper zv:11:0.1 --arm 11 " + kMove);
  check_refused(2, "--settle-band: 0: out of range", "move --settle-band 0 " + kArm + kMove);
  check_refused(2, "--shaped-duration: 1.7: given alone", "move --shaped-duration 1.7 " + kArm + kMove);
  check_refused(2, "--plot: x.pdf: ", "move --plot x.pdf " + kArm + kMove);
  check_refused(2, "--csv: /nowhere/x.csv: ", "move --csv /nowhere/x.csv " + kArm + kMove);
}

TEST_HOST(what_the_drive_cannot_take_is_refused_before_it_is_started) {
  const std::string hil = "hil " + kArm + kMove;
  check_refused(2, "--elf: missing: ", hil);
  check_refused(2, "elf: /dev/null: not an ELF file", hil + "--elf /dev/null");
  check_refused(2, "--tick: 0.002: not the firmware's, 0.001 is accepted", hil + "--elf x --tick 0.002");
  check_refused(2, "velocity: 5000: beyond the drive's register, 1e-06 to 4294.967295 ",
                "hil " + kArm + "--elf x --distance 1 --velocity 5000 --acceleration 20 --jerk 600");
  check_refused(2, "frequency: 0.4: beyond the drive's register, 0.5 to 300 ",
                "hil --shaper zv:0.4:0.1 --arm 11:0.11 --elf x " + kMove);
  check_refused(2,
                "--shaper: 5 modes: ", "hil --shaper zv:9:0+zv:8:0+zv:7:0+zv:6:0+zv:5:0 --arm 11:0 --elf x " + kMove);
  check_refused(2, "elf: /dev/null: not an ELF file", "demo --elf /dev/null");
}

TEST_HOST(what_cannot_be_done_ends_with_1_and_json_names_the_cause) {
  check_refused(1, "duration: 1.5: shorter than the limits allow, at least 1.51 s", "profile --duration 1.5 " + kMove);
  const std::string zero_delay = "move --zero-delay --duration 1.52 " + kArm + kMove;
  check_refused(1, "duration: 1.52: the shaped move would exceed its velocity limit, at least 1.532 s", zero_delay);
  const Outcome outcome = run_program(zero_delay + " --json");
  TEST_ASSERT_EQUAL_INT32(1, outcome.exit_code);
  REQUIRE(Json::parse(outcome.output).at("result") == "velocity_limit");
}

TEST_HOST(help_and_version_are_there_for_everything) {
  for (const char* arguments : {"--help", "--version", "design --help", "profile --help", "shape --help", "move --help",
                                "tune --help", "hil --help", "demo --help"}) {
    TEST_INFO(arguments, arguments);
    const Outcome outcome = run_program(arguments);
    TEST_ASSERT_EQUAL_INT32(0, outcome.exit_code);
    TEST_ASSERT_TRUE(outcome.output.size() > 10 && outcome.errors.empty());
  }
}

TEST_HOST(design_prints_what_it_promises) {
  const Json design = json_of("design --shaper zv:11:0.11+zvd:40:0.05:v=0.02");
  check_keys(design, {"shapers", "stages", "taps", "length_ticks", "delay_s", "peak_gain"});
  TEST_ASSERT_EQUAL_UINT32(2, design["shapers"].size());
  for (const Json& shaper : design["shapers"]) {
    check_keys(shaper, {"type", "frequency_hz", "damping_ratio", "tolerance", "impulses", "residual_on_grid",
                        "low_ratio", "high_ratio"});
    TEST_ASSERT_AT_MOST_DOUBLE(1e-6, shaper["residual_on_grid"].get<double>());
    check_keys(shaper["impulses"][0], {"time_s", "amplitude"});
  }
  TEST_ASSERT_EQUAL_UINT32(3, design["stages"].size());
  for (const Json& stage : design["stages"]) {
    double sum = 0.0;
    for (const Json& tap : stage) sum += tap.at("gain").get<double>();
    TEST_ASSERT_TRUE(sum == 1.0);  // gains have 30 bits: doubles add them exactly
  }
  REQUIRE(design == json_of("design --shaper zv:11:0.11 --shaper zvd:40:0.05:v=0.02"));
}

TEST_HOST(sensitivity_prints_what_it_promises) {
  // Undamped, ZV leaves |cos(pi/2 r)| at r times its frequency, ZVD the square of it.
  const std::string csv_file = scratch_file("sensitivity.csv");
  json_of("sensitivity --shaper zv:10:0 --shaper zvd:10:0 --from 5 --to 15 --points 5 --csv " + csv_file);
  const Csv csv = csv_of(csv_file);
  REQUIRE(csv.header == "frequency_hz,residual_continuous,residual_on_grid,residual_continuous_2,residual_on_grid_2");
  TEST_ASSERT_EQUAL_UINT32(5, csv.rows.size());
  for (size_t i = 0; i < 5; ++i) {
    const double expected = std::abs(std::cos(1.5707963267948966 * (0.5 + 0.25 * static_cast<double>(i))));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, expected, std::stod(csv.rows[i][1]));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, expected, std::stod(csv.rows[i][2]));  // half a period is a whole 50 ticks
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, expected * expected, std::stod(csv.rows[i][3]));
  }
  TEST_ASSERT_AT_MOST_DOUBLE(1e-8, std::stod(csv.rows[2][2]));
}

TEST_HOST(profile_prints_what_it_promises) {
  const std::string csv_file = scratch_file("profile.csv");
  const Json profile = json_of("profile " + kMove + "--csv " + csv_file);
  check_keys(profile, {"duration_s", "duration_ticks", "peak_velocity", "peak_acceleration", "peak_jerk", "phases"});
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.51, profile["duration_s"].get<double>());
  TEST_ASSERT_EQUAL_INT32(1510, profile["duration_ticks"].get<int>());
  const Csv csv = csv_of(csv_file);
  REQUIRE(csv.header == "tick,time_s,position_counts,position,velocity,acceleration,jerk");
  TEST_ASSERT_EQUAL_UINT32(1511, csv.rows.size());
  REQUIRE(csv.rows.front()[2] == "0");
  REQUIRE(csv.rows.back()[2] == "1700000");
  REQUIRE(csv.rows[1][2] == "0.1000000000931322574615478515625");  // j t^3 / 6 to the nearest LSB
}

TEST_HOST(move_prints_what_it_promises) {
  const std::string csv_file = scratch_file("move.csv");
  const Json move = json_of("move --duration 1.62 --zero-delay " + kArm + kMove + "--csv " + csv_file);
  check_keys(move, {"plain", "shaped", "residual_ratio", "within_limits", "zero_delay_met"});
  for (const char* which : {"plain", "shaped"}) {
    check_keys(move[which], {"move_time_s", "residual_peak", "settling_time_s", "total_time_s", "peak_velocity",
                             "peak_acceleration", "peak_jerk"});
  }
  TEST_ASSERT_DOUBLE_WITHIN(0.05, 13.0, move["plain"]["residual_peak"].get<double>());
  TEST_ASSERT_AT_MOST_DOUBLE(1e-8, move["residual_ratio"].get<double>());
  TEST_ASSERT_TRUE(move["within_limits"].get<bool>() && move["zero_delay_met"].get<bool>());
  const Csv csv = csv_of(csv_file);
  for (const char* column : {"plain_setpoint", "plain_motor", "plain_arm", "plain_acceleration", "shaped_setpoint",
                             "shaped_motor", "shaped_arm", "shaped_acceleration"}) {
    TEST_ASSERT_TRUE(csv.header.find(column) != std::string::npos);
  }
  REQUIRE(csv.rows.back()[2] == "1700000");
  REQUIRE(csv.rows.back()[7] == "1700000");
}

TEST_HOST(the_register_map_says_to_programs_what_values_faults_and_reasons_mean) {
  const Json map = json_of("registers");
  const auto text_of = [](const Json& list, uint32_t value) {
    for (const Json& entry : list) {
      if (entry.at("value") == value) return entry.at("text").get<std::string>();
    }
    return std::string();
  };
  TEST_ASSERT_TRUE(text_of(map.at("faults"), 0x8612) == "the position is beyond a soft limit");
  TEST_ASSERT_TRUE(text_of(map.at("reasons"), 0x8000).rfind("locked", 0) == 0);
  const auto named = [&](const char* name) {
    for (const Json& parameter : map.at("registers")) {
      if (parameter.at("name") == name) return parameter;
    }
    return Json();
  };
  TEST_ASSERT_TRUE(text_of(named("mode").at("values"), 6) == "homing");
  TEST_ASSERT_FALSE(named("profile-velocity").contains("values"));
  TEST_ASSERT_TRUE(named("profile-velocity").contains("unit"));
}

TEST_HOST(the_demo_shows_three_moves_and_a_picture) {
  if (std::system("gnuplot --version >/dev/null 2>&1") != 0) return;
  const std::string picture = scratch_file("demo.svg");
  const Json demo = json_of("demo --plot " + picture);
  TEST_ASSERT_EQUAL_UINT32(3, demo.at("moves").size());
  const double longest[] = {1.666, 1.62, 1.60};
  for (size_t i = 0; i < 3; ++i) {
    const Json& move = demo["moves"][i];
    TEST_ASSERT_AT_MOST_DOUBLE(longest[i] + 1e-9, move["shaped"]["move_time_s"].get<double>());
    TEST_ASSERT_AT_MOST_DOUBLE(1e-8, move["residual_ratio"].get<double>());
    TEST_ASSERT_TRUE(move["within_limits"].get<bool>());
  }
  TEST_ASSERT_TRUE(std::filesystem::file_size(picture) > 10000);
}

TEST_HOST(pictures_are_drawn_where_gnuplot_is) {
  if (std::system("gnuplot --version >/dev/null 2>&1") != 0) return;
  for (const char* name : {"picture.svg", "picture.png"}) {
    const std::string file = scratch_file(name);
    TEST_ASSERT_EQUAL_INT32(0, run_program("move --plot " + file + " " + kArm + kMove).exit_code);
    TEST_ASSERT_TRUE(std::filesystem::file_size(file) > 10000);
  }
}
