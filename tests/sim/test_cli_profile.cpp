// SPDX-License-Identifier: Apache-2.0
// `profile` with every kind and from a start in motion; `table`, and what is read back of it.
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
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

// The column of that name.
std::vector<double> column(const std::string& path, const std::string& name) {
  std::istringstream text(read_text(path));
  std::vector<double> values;
  long index = -1;
  for (std::string line; std::getline(text, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream cells(line);
    std::string cell;
    if (index < 0) {
      for (long i = 0; std::getline(cells, cell, ','); ++i) {
        if (cell == name) index = i;
      }
      continue;
    }
    for (long i = 0; i <= index; ++i) std::getline(cells, cell, ',');
    values.push_back(std::stod(cell));
  }
  return values;
}

Json profile(const std::string& arguments) {
  const Json json = json_of("profile " + arguments);
  TEST_ASSERT_TRUE(json.at("within_limits").get<bool>());
  return json;
}

void write_text(const std::string& path, const std::string& text) { std::ofstream(path) << text; }

}  // namespace

TEST_HOST(every_kind_of_profile_takes_its_time_and_says_its_phases) {
  struct Row {
    const char* kind;
    double duration_s;
    size_t phases;
    const char* shape;
  };
  // 1.7/1.2 + pi sqrt(1.2/1200), 15/8 and 35/16 of 1.7/1.2
  const Row rows[] = {
      {"sin2", 1.5160125493, 3, "sine ramp up"}, {"poly5", 2.65625, 1, "poly5"}, {"poly7", 3.0989583333, 1, "poly7"}};
  for (const Row& row : rows) {
    TEST_INFO("kind", row.kind);
    const Json json = profile(kMove + "--kind " + row.kind);
    REQUIRE(json["kind"] == row.kind);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, row.duration_s, json["duration_s"].get<double>());
    TEST_ASSERT_EQUAL_INT32(std::ceil(row.duration_s * 1e3), json["duration_ticks"].get<int>());
    TEST_ASSERT_EQUAL_UINT32(row.phases, json["phases"].size());
    double distance = 0.0;
    for (const Json& phase : json["phases"]) {
      check_keys(phase, {"start_s", "duration_s", "shape", "distance"});
      distance += phase["distance"].get<double>();
    }
    REQUIRE(json["phases"][0]["shape"] == row.shape);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.7, distance);
  }
  // Undamped, 12.5 Hz: a ramp of 80 + 25 ms.
  const Json matched = profile(kMove + "--kind matched:12.5:0");
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.7 / 1.2 + 0.105, matched["duration_s"].get<double>());
  REQUIRE(matched["kind"] == "matched:12.5:0");
}

TEST_HOST(a_matched_move_alone_leaves_the_arm_still) {
  const std::string arm = "--shaper none --arm 11:0.11 ";
  const Json plain = json_of("move " + kMove + arm);
  const Json matched = json_of("move " + kMove + "--kind matched:11:0.11 " + arm);
  const double before = plain["plain"]["residual_peak"].get<double>();
  TEST_ASSERT_AT_MOST_DOUBLE(1e-7 * before, matched["plain"]["residual_peak"].get<double>());
  // and takes less than S-curve and ZV, 1.51 s and half a period of 45.7 ms
  TEST_ASSERT_AT_MOST_DOUBLE(1.51 + 0.0457, matched["plain"]["move_time_s"].get<double>());
}

TEST_HOST(kinds_that_are_none_are_refused) {
  const std::string accepted = "accepted: s-curve trapezoid sin2 poly5 poly7 table:FILE matched:F:Z";
  check_refused(2, "--kind: poly6: not a known kind of profile, " + accepted, "profile --kind poly6 " + kMove);
  check_refused(2, "--kind: sin2:1: not a known kind of profile, " + accepted, "profile --kind sin2:1 " + kMove);
  check_refused(2, "--kind: matched:11: not a mode, matched:FREQUENCY:DAMPING", "profile --kind matched:11 " + kMove);
  check_refused(2, "--kind: 0: must be above zero", "profile --kind matched:0:0.1 " + kMove);
  check_refused(2, "frequency: 600: above the maximum, at most 500 ", "profile --kind matched:600:0.1 " + kMove);
  check_refused(2, "table: /nowhere: cannot be read", "profile --kind table:/nowhere " + kMove);
  check_refused(2, "--jerk: missing: a jerk limit for the poly5",
                "profile --kind poly5 --distance 1 --velocity 1 --acceleration 1");
  const std::string hil = "hil --elf x --shaper none --arm 11:0.11 ";
  check_refused(2, "--kind: poly7: not in the drive's register", hil + kMove + "--kind poly7");
  check_refused(2, "--kind: matched:11:0.1: not in the drive's register", hil + kMove + "--kind matched:11:0.1");
  check_refused(2, "--deceleration-jerk: 300: the drive has one register",
                hil + kMove + "--kind sin2 --deceleration-jerk 300");
}

TEST_HOST(each_jerk_limit_holds_on_its_own_ramp) {
  const std::string csv = scratch_file("two_jerks.csv");
  profile(kMove + "--kind sin2 --deceleration-jerk 150 --csv " + csv);
  const std::vector<double> jerk = column(csv, "jerk");
  double first = 0.0;
  double second = 0.0;
  for (size_t i = 0; i < jerk.size(); ++i) {
    double& peak = i < jerk.size() / 2 ? first : second;
    peak = std::max(peak, std::abs(jerk[i]));
  }
  TEST_ASSERT_DOUBLE_RELATIVE(0.02, 600.0, first);
  TEST_ASSERT_DOUBLE_RELATIVE(0.02, 150.0, second);
}

TEST_HOST(a_profile_may_begin_in_motion) {
  const std::string csv = scratch_file("moving.csv");
  const std::string moving = kMove + "--deceleration 5 --start-velocity -0.6 --start-acceleration 3 ";
  const Json json = profile(moving + "--csv " + csv);
  // -0.6 unit/s is lost at up to 20 unit/s^2, not 5: what turns round may use the larger. It is the planner's decision;
  // here: position 0 at tick 0, the motion given, arrival.
  const std::vector<double> position = column(csv, "position");
  TEST_ASSERT_TRUE(position.front() == 0.0 && position.back() == 1.7);
  TEST_ASSERT_EQUAL_UINT32(position.size(), json["duration_ticks"].get<unsigned>() + 1);
  const double first_step = (position[1] - position[0]) * 1e3;
  TEST_ASSERT_DOUBLE_WITHIN(600e-6 / 6.0 + 1e-9, -0.6 + 3.0 / 2e3, first_step);
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 3.0, column(csv, "acceleration").front());
  // Nothing given is a move from rest.
  const Json rest = json_of("profile " + kMove + "--start-velocity 0 --start-acceleration 0");
  REQUIRE(rest == json_of("profile " + kMove));
}

TEST_HOST(a_start_beyond_its_limits_is_judged_by_what_it_forces) {
  const Json fast = profile(kMove + "--start-velocity 3");
  TEST_ASSERT_DOUBLE_RELATIVE(1e-3, 3.0, fast["peak_velocity"].get<double>());
  const Json hard = profile(kMove + "--start-velocity 0.5 --start-acceleration 30");
  TEST_ASSERT_DOUBLE_RELATIVE(0.03, 30.0, hard["peak_acceleration"].get<double>());
  profile(kMove + "--start-velocity 1.19 --start-acceleration 19");
  profile(kMove + "--start-acceleration -25 --deceleration 40");
  profile("--distance 0 --velocity 1 --acceleration 10 --deceleration 3 --jerk 100 --start-velocity 0.9");
  check_refused(2, "--start-velocity: 3: only an s-curve begins in motion",
                "profile --kind sin2 --start-velocity 3 " + kMove);
  check_refused(2, "--start-acceleration: fast: not a number", "profile --start-acceleration fast " + kMove);
  check_refused(2, "--duration: 4: a move that begins in motion takes the least time",
                "profile --duration 4 --start-velocity 1 " + kMove);
}

TEST_HOST(a_table_of_a_polynomial_is_the_polynomial) {
  const std::string file = scratch_file("poly5.table");
  const Json table = json_of("table --kind poly5 --order 2 --spans 1 --out " + file);
  check_keys(table, {"source", "samples", "order", "spans", "flash_bytes", "largest_deviation", "peak_velocity",
                     "peak_acceleration", "peak_deceleration", "peak_jerk"});
  TEST_ASSERT_AT_MOST_DOUBLE(1e-15, table["largest_deviation"].get<double>());
  TEST_ASSERT_EQUAL_INT32(48, table["flash_bytes"].get<int>());
  TEST_ASSERT_DOUBLE_RELATIVE(1e-12, 60.0, table["peak_jerk"].get<double>());
  const std::string own = scratch_file("own.csv");
  const std::string read = scratch_file("read.csv");
  profile(kMove + "--kind poly5 --csv " + own);
  profile(kMove + "--kind table:" + file + " --csv " + read);
  const std::vector<double> expected = column(own, "position_counts");
  const std::vector<double> actual = column(read, "position_counts");
  TEST_ASSERT_EQUAL_UINT32(expected.size(), actual.size());
  for (size_t i = 0; i < expected.size(); ++i) TEST_ASSERT_DOUBLE_WITHIN(3e-10, expected[i], actual[i]);
}

TEST_HOST(a_table_of_a_csv_follows_its_samples_and_is_read_back_as_written) {
  const std::string csv = scratch_file("septic.csv");
  const std::string file = scratch_file("septic.table");
  profile(kMove + "--kind poly7 --csv " + csv);
  const Json table = json_of("table --from " + csv + " --order 3 --spans 2 --out " + file);
  TEST_ASSERT_AT_MOST_DOUBLE(1e-12, table["largest_deviation"].get<double>());
  TEST_ASSERT_DOUBLE_RELATIVE(1e-6, 52.5, table["peak_jerk"].get<double>());
  TEST_ASSERT_EQUAL_INT32(3099, profile(kMove + "--kind table:" + file)["duration_ticks"].get<int>());
  // An s-curve has steps of jerk: no table follows them, more spans come nearer.
  double before = 1.0;
  for (const char* spans : {"16", "64", "256"}) {
    const std::string as_table = "table --kind s-curve " + kMove + "--order 2 --spans " + spans + " --out " + file;
    const double deviation = json_of(as_table)["largest_deviation"].get<double>();
    TEST_ASSERT_AT_MOST_DOUBLE(before / 4.0, deviation);
    before = deviation;
    profile(kMove + "--kind table:" + file);
  }
  // Positions alone, and two columns under other names, in other units, backwards.
  write_text(csv, "# a ramp of a cosine\nt;x\n");
  check_refused(2, "--from: ", "table --from " + csv);
  std::string alone;
  std::string pairs = "ms,where\n";
  for (int i = 0; i <= 200; ++i) {
    const double x = 0.5 - 0.5 * std::cos(3.14159265358979324 * i / 200);
    alone += std::to_string(x) + "\n";
    pairs += std::to_string(10 + i * 5) + ", " + std::to_string(7.0 - 2.0 * x) + "\r\n";
  }
  for (const std::string& text : {alone, pairs}) {
    write_text(csv, text);
    const Json cosine = json_of("table --from " + csv + " --order 1 --spans 8 --out " + file);
    TEST_ASSERT_AT_MOST_DOUBLE(1e-4, cosine["largest_deviation"].get<double>());
    TEST_ASSERT_DOUBLE_RELATIVE(1e-2, 1.5707963, cosine["peak_velocity"].get<double>());
    // Order 1 needs no jerk limit.
    profile("--distance 1.7 --velocity 1.2 --acceleration 20 --kind table:" + file);
  }
}

TEST_HOST(a_table_for_flash_holds_the_same_nodes) {
  const std::string file = scratch_file("sine.table");
  const std::string header = scratch_file("sine.hpp");
  json_of("table --kind sin2 " + kMove + "--order 3 --spans 5 --name kSine --out " + file + " --header " + header);
  std::string source = read_text(header);
  std::istringstream lines(read_text(file));
  int knots = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || (std::isdigit(static_cast<unsigned char>(line[0])) == 0 && line[0] != '-')) continue;
    std::istringstream cells(line);
    for (std::string cell; cells >> cell;) {
      const std::string literal = "INT64_C(" + cell + "),";
      const size_t at = source.find(literal);
      TEST_ASSERT_TRUE(at != std::string::npos);
      source.erase(0, at + literal.size());  // in the same order
    }
    ++knots;
  }
  TEST_ASSERT_EQUAL_INT32(6, knots);
  TEST_ASSERT_TRUE(source.find("ProfileTable kSine = {\n    3, 5, kSineNodes, {") != std::string::npos);
}

TEST_HOST(tables_that_are_none_are_refused_by_line) {
  const std::string file = scratch_file("bad.table");
  const std::string kind = "profile --kind table:" + file + " " + kMove;
  const std::string head = "stillpoint profile table 1\norder 1\nspans 1\n";
  write_text(file, "time,position\n");
  check_refused(2, "table: " + file + ": does not begin with `stillpoint profile table 1`", kind);
  write_text(file, "stillpoint profile table 1\norder 4\nspans 1\n");
  check_refused(2, file + ", line 2: 4: ", kind);
  write_text(file, "stillpoint profile table 1\norder 1\n0 0\n");
  check_refused(2, "table: " + file + ", line 3: no `spans N`", kind);
  write_text(file, head + "0 0\n281474976710656 0 0\n");
  check_refused(2, "table: " + file + ", line 5: 3 numbers, 2 are accepted", kind);
  write_text(file, head + "0 0\n");
  check_refused(2, "table: " + file + ": 1 knots, 2 are accepted", kind);
  write_text(file, head + "0 0\n281474976710656 1\n");
  check_refused(2, "profile table: ", kind);
  check_refused(2, "--from: missing: ", "table");
  check_refused(2, "--from: x: given with --kind", "table --from x --kind poly5");
  check_refused(2, "--order: 4: ", "table --kind poly5 --order 4");
  check_refused(2, "--spans: 0: ", "table --kind poly5 --spans 0");
  check_refused(2, "--name: 1st: not a name in C++", "table --kind poly5 --name 1st");
  check_refused(2, "--out: /nowhere/x: not written", "table --kind poly5 --out /nowhere/x");
  write_text(file, "0,0\n1,0.1\n2,0.5\n3,0.9\n4,1\n");
  check_refused(2, "--spans: 2: too many for 5 samples", "table --from " + file + " --order 3 --spans 2");
  write_text(file, "0,0\n1,0.1\n1,0.5\n");
  check_refused(2, "--from: " + file + ", line 3: not after the line before", "table --from " + file);
  write_text(file, "0,1\n1,2\n2,1\n");
  check_refused(2, "--from: " + file + ": ends where it begins", "table --from " + file);
}
