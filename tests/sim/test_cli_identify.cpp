// SPDX-License-Identifier: Apache-2.0
// `stillpoint identify` as a program.
#include <cmath>
#include <filesystem>
#include <fstream>

#include "tests/sim/cli_checks.hpp"

using stillpoint::testing::check_keys;
using stillpoint::testing::check_refused;
using stillpoint::testing::Json;
using stillpoint::testing::json_of;
using stillpoint::testing::Outcome;
using stillpoint::testing::Random;
using stillpoint::testing::read_text;
using stillpoint::testing::run_program;
using stillpoint::testing::scratch_file;

namespace {

// The axis moves for half a second, then the arm rings at 11 Hz, 0.05.
std::string record_file() {
  const std::string path = scratch_file("ringing.csv");
  std::ofstream file(path);
  Random random(3);
  file << "# made up\ntime_s,axis,tip\n";
  for (int n = 0; n < 2500; ++n) {
    const double t = n * 1e-3, after = t - 0.5;
    const double tip = after < 0.0 ? 3.0 * std::sin(40.0 * t)
                                   : 2.0 * std::exp(-0.05 * 69.115 * after) * std::cos(69.029 * after) +
                                         0.02 * random.between(-1.0, 1.0);
    file << t << ',' << (after < 0.0 ? t : 0.5) << ',' << 100.0 + tip << '\n';
  }
  return path;
}

std::string constant_file() {
  const std::string path = scratch_file("constant.csv");
  std::ofstream file(path);
  for (int n = 0; n < 300; ++n) file << "1.5\n";
  return path;
}

}  // namespace

TEST_HOST(identify_prints_its_modes_as_json) {
  const Json object = json_of("identify " + record_file() + " --rate 1000 --column tip --at-rest axis");
  REQUIRE(object.at("result") == "ok");
  check_keys(object, {"confidence", "noise", "hum_hz", "first_row", "end_row", "decimation", "highest_hz"});
  TEST_ASSERT_EQUAL_UINT64(1, object.at("modes").size());
  const Json& mode = object["modes"][0];
  check_keys(mode, {"frequency_hz", "damping_ratio", "amplitude", "frequency_std_hz", "damping_std", "confidence",
                    "viscous", "damping_early", "damping_late"});
  TEST_ASSERT_DOUBLE_RELATIVE(0.002, 11.0, mode["frequency_hz"].get<double>());
  TEST_ASSERT_DOUBLE_RELATIVE(0.05, 0.05, mode["damping_ratio"].get<double>());
  TEST_ASSERT_AT_LEAST_INT64(500, object["first_row"].get<int64_t>());
}

TEST_HOST(identify_takes_rows_and_a_column_by_index) {
  const Json object =
      json_of("identify " + record_file() + " --rate 1000 --column 2 --from 500 --to 2000 --max-modes 1");
  REQUIRE(object.at("first_row") == 500);
  REQUIRE(object.at("end_row") == 2000);
  TEST_ASSERT_DOUBLE_RELATIVE(0.02, 2.0, object["modes"][0]["amplitude"].get<double>());
}

TEST_HOST(identify_says_why_there_is_no_mode) {
  const Outcome outcome = run_program("identify " + constant_file() + " --rate 100 --json");
  TEST_ASSERT_EQUAL_INT32(1, outcome.exit_code);
  const Json object = Json::parse(outcome.output);
  REQUIRE(object.at("result") == "no_mode");
  TEST_ASSERT_TRUE(object.at("modes").empty());
  check_refused(1, "record: no_mode", "identify " + constant_file() + " --rate 100");
  check_refused(1, "record: too_short", "identify " + record_file() + " --rate 1000 --from 500 --to 660");
}

TEST_HOST(identify_refuses_what_it_cannot_read) {
  check_refused(2, "file: no_such.csv", "identify no_such.csv --rate 100");
  check_refused(2, "--rate: 0", "identify " + constant_file() + " --rate 0");
  check_refused(2, "--column: tip", "identify " + constant_file() + " --rate 100 --column tip");
  check_refused(2, "--to: 301", "identify " + constant_file() + " --rate 100 --to 301");
  check_refused(2, "--max-modes: 9", "identify " + constant_file() + " --rate 100 --max-modes 9");
  check_refused(2, "option: arguments", "identify --rate 100");
}

TEST_HOST(identify_writes_its_trace_and_draws_it) {
  const std::string csv = scratch_file("identify.csv"), svg = scratch_file("identify.svg");
  const Outcome outcome =
      run_program("identify " + record_file() + " --rate 1000 --at-rest axis --csv " + csv + " --plot " + svg);
  TEST_ASSERT_EQUAL_INT32(0, outcome.exit_code);
  const std::string trace = read_text(csv);
  TEST_ASSERT_TRUE(trace.rfind("# stillpoint identify", 0) == 0);
  TEST_ASSERT_TRUE(trace.find("time_s,record,fit,residual\n") != std::string::npos);
  TEST_ASSERT_TRUE(std::filesystem::file_size(svg) > 1000);
}
