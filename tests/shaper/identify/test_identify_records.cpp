// SPDX-License-Identifier: Apache-2.0
// Records that others measured (tests/data/, with their origin): frequency and damping inside the ranges that moving
// the start of the window gives, which is wider than any error bar of noise.
#include "shaper/identify/identify.hpp"
#include "shaper/identify/quiet_start.hpp"
#include "sim/record_table.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;

namespace {

IdentifyMemory<kLargestFft> memory;

struct Excerpt {
  const char* file;
  const char* column;
  double rate_hz;
  size_t first = 0;
  const char* at_rest = nullptr;
};

Identification identified(const Excerpt& excerpt) {
  const sim::RecordTable table = sim::read_record_table(std::string(STILLPOINT_TEST_DATA) + "/" + excerpt.file);
  size_t first = excerpt.first;
  if (excerpt.at_rest != nullptr) {
    const size_t axis = sim::column_of(table, excerpt.at_rest, "column");
    const std::vector<float> position = sim::samples_of(table, axis, 0, table.rows());
    first = quiet_start({position.data(), position.size()}, static_cast<size_t>(0.1 * excerpt.rate_hz));
  }
  const size_t column = sim::column_of(table, excerpt.column, "column");
  const std::vector<float> samples = sim::samples_of(table, column, first, table.rows());
  IdentifyConfig config;
  config.rate_hz = excerpt.rate_hz;
  Identification found{};
  TEST_ASSERT_OK(identify({samples.data(), samples.size()}, config, IdentifyScratch(memory), found));
  return found;
}

struct Range {
  double low;
  double high;
};

void check_mode(const IdentifiedMode& mode, const Range& frequency, const Range& damping) {
  TEST_INFO(frequency, mode.frequency_hz);
  TEST_INFO(damping, mode.damping_ratio);
  TEST_ASSERT_AT_LEAST_DOUBLE(frequency.low, mode.frequency_hz);
  TEST_ASSERT_AT_MOST_DOUBLE(frequency.high, mode.frequency_hz);
  TEST_ASSERT_AT_LEAST_DOUBLE(damping.low, mode.damping_ratio);
  TEST_ASSERT_AT_MOST_DOUBLE(damping.high, mode.damping_ratio);
}

void check_one(const Excerpt& excerpt, const Range& frequency, const Range& damping) {
  const Identification found = identified(excerpt);
  TEST_INFO(first, excerpt.first);
  TEST_ASSERT_EQUAL_ENUM(Finding::kFound, found.finding);
  TEST_ASSERT_EQUAL_UINT64(1, found.mode_count);
  check_mode(found.mode[0], frequency, damping);
}

}  // namespace

TEST_HOST(the_flexible_link_by_the_window_of_the_reference) {
  check_one({"flexible_link_5deg.csv", "tip_rad", 500.0, 1100}, {1.828, 1.844}, {0.014, 0.021});
  check_one({"flexible_link_0deg.csv", "tip_rad", 500.0, 900}, {1.818, 1.836}, {0.012, 0.020});
}

TEST_HOST(the_flexible_link_from_where_its_hub_rests) {
  check_one({"flexible_link_5deg.csv", "tip_rad", 500.0, 0, "hub_rad"}, {1.828, 1.844}, {0.014, 0.021});
  check_one({"flexible_link_0deg.csv", "tip_rad", 500.0, 0, "hub_rad"}, {1.818, 1.836}, {0.012, 0.020});
}

// The hub creeps in steps of a few counts, one a swing: too little to name a mode by, and it says so.
TEST_HOST(the_hub_of_the_flexible_link_does_not_show_it) {
  TEST_ASSERT_EQUAL_ENUM(Finding::kNoisy, identified({"flexible_link_5deg.csv", "hub_rad", 500.0, 1100}).finding);
  TEST_ASSERT_EQUAL_ENUM(Finding::kNoisy, identified({"flexible_link_0deg.csv", "hub_rad", 500.0, 900}).finding);
}

TEST_HOST(both_close_modes_of_the_hammer_in_each_block_and_sensor) {
  for (const char* file : {"hammer_first.csv", "hammer_second.csv"}) {
    for (const char* sensor : {"m_1", "m_2"}) {
      const Identification found = identified({file, sensor, 0.5 / 0.000977});
      TEST_INFO(sensor, sensor);
      TEST_ASSERT_EQUAL_ENUM(Finding::kFound, found.finding);
      TEST_ASSERT_AT_LEAST_INT64(2, found.mode_count);
      const bool in_order = found.mode[0].frequency_hz < found.mode[1].frequency_hz;
      check_mode(found.mode[in_order ? 0 : 1], {19.764, 19.770}, {0.0025, 0.0027});
      check_mode(found.mode[in_order ? 1 : 0], {21.149, 21.153}, {0.00196, 0.00204});
      TEST_ASSERT_AT_LEAST_DOUBLE(0.9, found.confidence);
    }
  }
}

TEST_HOST(the_pendulums) {
  check_one({"bicycle_fork.csv", "gyro_V", 50.0}, {0.6276, 0.632}, {0.0068, 0.0144});
  check_one({"rotary_pendulum.csv", "angle_deg", 1000.0}, {1.664, 1.693}, {0.024, 0.028});
}

// Its damping grows as it decays; the first half's and the rest's are both inside the range.
TEST_HOST(the_forks_damping_grows) {
  const Identification found = identified({"bicycle_fork.csv", "gyro_V", 50.0});
  TEST_ASSERT_FALSE(found.mode[0].viscous);
  TEST_ASSERT_AT_LEAST_DOUBLE(0.0068, found.mode[0].damping_early);
  TEST_ASSERT_AT_LEAST_DOUBLE(found.mode[0].damping_early, found.mode[0].damping_late);
  TEST_ASSERT_AT_MOST_DOUBLE(0.0144, found.mode[0].damping_late);
}

TEST_HOST(coulomb_friction_is_not_viscous) {
  const Identification found = identified({"coulomb_pendulum.csv", "theta_rad", 125.0});
  TEST_ASSERT_EQUAL_ENUM(Finding::kFound, found.finding);
  TEST_ASSERT_FALSE(found.mode[0].viscous);
  TEST_ASSERT_DOUBLE_WITHIN(0.01, 1.284, found.mode[0].frequency_hz);
  TEST_ASSERT_AT_MOST_DOUBLE(0.3, found.confidence);
}
