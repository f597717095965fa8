// SPDX-License-Identifier: Apache-2.0
#include "sim/record_table.hpp"

#include <cmath>
#include <cstdio>
#include <fstream>

#include "sim/refusal.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using namespace stillpoint::sim;

namespace {

class Written {
 public:
  explicit Written(const std::string& content) { std::ofstream("test_record_table.txt") << content; }
  ~Written() { std::remove("test_record_table.txt"); }
  RecordTable read() const { return read_record_table("test_record_table.txt"); }
};

RecordTable table_from(const std::string& content) { return Written(content).read(); }

}  // namespace

TEST_HOST(commas_a_header_and_comments) {
  const RecordTable table = table_from("# made up\ntime_s,tip\n0,1.5\n% aside\n0.1,-2e-3\r\n\n0.2,+3\n");
  TEST_ASSERT_EQUAL_UINT64(3, table.rows());
  TEST_ASSERT_EQUAL_UINT64(1, column_of(table, "tip", "--column"));
  TEST_ASSERT_EQUAL_UINT64(0, column_of(table, "0", "--column"));
  TEST_ASSERT_EQUAL_UINT64(1, column_of(table, "", "--column"));
  TEST_ASSERT_DOUBLE_WITHIN(0.0, -2e-3, table.columns[1][1]);
  TEST_ASSERT_DOUBLE_WITHIN(0.0, 3.0, table.columns[1][2]);
}

TEST_HOST(a_line_of_settings_above_the_record_is_not_of_it) {
  const RecordTable table = table_from("trigger, rate, duration\n90, 1000, 5\n\n-90.36\n-90.64\n-90.91\n");
  TEST_ASSERT_EQUAL_UINT64(1, table.columns.size());
  TEST_ASSERT_EQUAL_UINT64(3, table.rows());
  TEST_ASSERT_TRUE(table.names.empty());
}

TEST_HOST(labview_measurements_begin_with_an_empty_field) {
  const RecordTable table = table_from(
      "LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\t\n\t\nChannels\t2\t\nSamples\t2\t2\n"
      "X0\t0.0E+0\t0.0E+0\n***End_of_Header***\nX_Value\tF\tm_1\tComment\n\t0.05\t0.23\n\t0.06\t0.24\n");
  TEST_ASSERT_EQUAL_UINT64(2, table.rows());
  TEST_ASSERT_EQUAL_UINT64(2, column_of(table, "m_1", "--column"));
  TEST_ASSERT_EQUAL_UINT64(2, column_of(table, "", "--column"));
  TEST_ASSERT_TRUE(std::isnan(table.columns[0][0]));
  REQUIRE_THROWS_AS(samples_of(table, 0, 0, 2), Refusal);
}

TEST_HOST(spaces_and_semicolons_part_cells_too) {
  TEST_ASSERT_EQUAL_UINT64(2, table_from("1  2\n 3 4\n").columns.size());
  TEST_ASSERT_EQUAL_UINT64(2, table_from("a;b\n1;2\n3;4\n").columns.size());
}

TEST_HOST(what_is_not_there_is_refused) {
  REQUIRE_THROWS_AS(read_record_table("no_such_file.csv"), Refusal);
  REQUIRE_THROWS_AS(table_from("only\nwords\n"), Refusal);
  const RecordTable table = table_from("a,b\n1,2\n");
  REQUIRE_THROWS_AS(column_of(table, "c", "--column"), Refusal);
  REQUIRE_THROWS_AS(column_of(table, "2", "--column"), Refusal);
}

// A damped sinusoid stays one: the ratio of samples a period apart is the old one's, once a new sample.
TEST_HOST(decimation_keeps_what_rings) {
  std::vector<float> samples;
  for (int n = 0; n < 4000; ++n) samples.push_back(static_cast<float>(std::exp(-5e-4 * n) * std::cos(0.05 * n)));
  const std::vector<float> kept = decimated(samples, 5);
  TEST_ASSERT_EQUAL_UINT64((4000 - 41) / 5 + 1, kept.size());
  for (size_t n = 0; n < kept.size(); ++n) {
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, static_cast<double>(samples[5 * n + 20]), static_cast<double>(kept[n]));
  }
}

// What would come back as another frequency is a hundredth at most.
TEST_HOST(decimation_keeps_out_what_would_fold_back) {
  for (const double of_new_rate : {0.65, 0.8, 1.0, 1.7}) {
    std::vector<float> samples;
    for (int n = 0; n < 2000; ++n) samples.push_back(static_cast<float>(std::cos(2.0 * M_PI * of_new_rate / 5.0 * n)));
    for (const float value : decimated(samples, 5)) {
      TEST_INFO(of_new_rate, of_new_rate);
      TEST_ASSERT_AT_MOST_DOUBLE(0.01, std::fabs(static_cast<double>(value)));
    }
  }
}
