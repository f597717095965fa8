// SPDX-License-Identifier: Apache-2.0
// Export and import, whatever the drive has before: the firmware in this process.
#include "sim/cli/drive_files.hpp"

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "sim/cli/drive_registers.hpp"
#include "sim/cli/drive_settings.hpp"
#include "sim/refusal.hpp"
#include "tests/firmware/drive402.hpp"
#include "tests/sim/refusals.hpp"
#include "tests/sim/rig_port.hpp"
#include "tests/support/random.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;
using cli::Json;

namespace {

// A port that is cut, or whose drive refuses, from its nth write on.
class CutPort final : public RigPort {
 public:
  using RigPort::RigPort;
  using RigPort::write;
  void write(uint16_t address, const std::vector<uint16_t>& values) override {
    const bool shows = address == 0x0101 || address == 0x0014;
    if (!shows) ++writes;
    if (!shows && writes == refuse_at) throw sim::refused_register(address, 4);
    if (cut || (!shows && writes == cut_at)) {
      cut = true;
      throw sim::silent_register(address, 5);
    }
    RigPort::write(address, values);
  }
  int writes = 0;
  int refuse_at = 0;
  int cut_at = 0;
  bool cut = false;
};

struct Holder : Drive402 {
  CutPort port{*this};

  void set(uint16_t address, int64_t value) {
    unlock();
    TEST_ASSERT_EQUAL_UINT32(0, write_wide(address, value));
  }
  std::string said_of_import(const Json& file) {
    return refusal_of([&] { static_cast<void>(cli::import_settings(port, file)); }).said;
  }
};

void check_same(const Json& expected, const Json& actual) {
  TEST_INFO("expected", expected.dump());
  TEST_INFO("actual", actual.dump());
  TEST_ASSERT_TRUE(expected == actual);
}

Json delivered() {
  Holder drive;
  return cli::exported(drive.port);
}

// Anything that a drive can be brought to, by writes as a client would make them.
void scramble(Holder& drive, Random& random) {
  for (int i = 0; i < 60; ++i) {
    const auto index = static_cast<size_t>(random.integer(0, firmware::kParameterCount - 1));
    const firmware::Parameter parameter = firmware::kParameters[index];
    const bool of_set = random.integer(0, 3) == 0;
    if (!cli::is_setting(parameter, of_set)) continue;
    if (of_set) TEST_ASSERT_EQUAL_UINT32(0, drive.write_single(0x0101, static_cast<uint32_t>(random.integer(0, 7))));
    const bool tracking = parameter.name == firmware::Register::kTracking;
    const int64_t low = parameter.is_signed() ? static_cast<int32_t>(parameter.minimum) : int64_t{parameter.minimum};
    const int64_t high = parameter.is_signed() ? static_cast<int32_t>(parameter.maximum) : int64_t{parameter.maximum};
    // Small ones often: limits below what stands under them.
    const int64_t value = random.integer(low, random.integer(0, 1) == 0 ? high : std::min(high, low + 1000000));
    if (tracking) continue;
    drive.unlock();
    if (parameter.words() == 2) {
      static_cast<void>(drive.write_wide(firmware::address_of(parameter.name), value));
    } else {
      static_cast<void>(drive.write_single(firmware::address_of(parameter.name), static_cast<uint16_t>(value)));
    }
  }
}

TEST(any_drives_export_goes_into_any_other_drive_and_into_its_own) {
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    TEST_INFO("seed", seed);
    Random random(seed);
    Holder one;
    Holder other;
    scramble(one, random);
    scramble(other, random);
    const Json file = cli::exported(one.port);
    const uint32_t shown = other.get(0x0101);
    const std::vector<std::string> told = cli::import_settings(other.port, file);
    TEST_INFO("told", told.empty() ? std::string() : told[0]);
    TEST_ASSERT_TRUE(told.empty());
    check_same(file, cli::exported(other.port));
    TEST_ASSERT_EQUAL_UINT32(shown, other.get(0x0101));
    TEST_ASSERT_TRUE(cli::import_settings(one.port, file).empty());
    check_same(file, cli::exported(one.port));
  }
}

TEST(an_export_goes_over_a_ceiling_that_was_lowered_and_back) {
  for (const uint16_t ceiling : {uint16_t{0x0058}, uint16_t{0x005A}, uint16_t{0x005C}}) {
    TEST_INFO("ceiling", ceiling);
    const Json as_delivered = delivered();
    Holder drive;
    drive.set(ceiling, 1000);
    const Json lowered = cli::exported(drive.port);
    TEST_ASSERT_TRUE(cli::import_settings(drive.port, as_delivered).empty());
    check_same(as_delivered, cli::exported(drive.port));
    TEST_ASSERT_TRUE(cli::import_settings(drive.port, lowered).empty());
    check_same(lowered, cli::exported(drive.port));
  }
}

TEST(an_axis_that_is_enabled_never_stands_beyond_limits_that_are_half_written) {
  for (const int32_t position : {-50000, 50000}) {
    Json file = delivered();
    file["settings"]["soft-limit-low"] = -70000;
    file["settings"]["soft-limit-high"] = 70000;
    Holder drive;
    drive.enable();
    drive.start_move(position);
    drive.control(0x0F);
    drive.step(2000);
    TEST_ASSERT_TRUE(cli::import_settings(drive.port, file).empty());
    TEST_ASSERT_EQUAL_UINT32(0, drive.get(0x0010));
    TEST_ASSERT_EQUAL_UINT32(0x27, drive.state());
  }
}

TEST(what_the_drive_refuses_half_way_leaves_everything_as_it_was) {
  Random random(7);
  Holder from;
  scramble(from, random);
  const Json file = cli::exported(from.port);
  int writes = 0;
  {
    Holder counted;
    TEST_ASSERT_TRUE(cli::import_settings(counted.port, file).empty());
    writes = counted.port.writes;
  }
  TEST_ASSERT_AT_LEAST_INT64(10, writes);
  for (int at = 1; at <= writes; ++at) {
    TEST_INFO("refused at", at);
    Holder drive;
    TEST_ASSERT_EQUAL_UINT32(0, drive.write_single(0x0101, 3));
    const Json before = cli::exported(drive.port);
    drive.port.refuse_at = at;
    const std::string said = drive.said_of_import(file);
    check_says("Modbus exception 4", said);
    check_says(at == 1 ? "; nothing has been changed" : "; all is as it was before", said);
    check_same(before, cli::exported(drive.port));
    TEST_ASSERT_EQUAL_UINT32(3, drive.get(0x0101));
  }
}

TEST(what_a_drive_that_falls_silent_may_have_kept_is_named) {
  Holder from;
  from.set(0x0060, 777);
  from.set(0x0062, 888);
  Holder drive;
  const Json file = cli::exported(from.port);
  drive.port.cut_at = 2;
  const std::string said = drive.said_of_import(file);
  check_says("no answer to 5 requests", said);
  check_says("; written and perhaps not put back: profile-velocity, acceleration", said);
}

TEST(a_move_under_way_refuses_limits_with_nothing_kept) {
  Holder from;
  from.set(0x0058, 800000);
  const Json file = cli::exported(from.port);
  Holder drive;
  drive.enable();
  const Json before = cli::exported(drive.port);
  drive.start_move(2000000);
  drive.control(0x0F);
  check_says("the axis moves", drive.said_of_import(file));
  check_same(before, cli::exported(drive.port));
}

TEST(a_file_that_cannot_be_as_it_says_is_refused_before_anything_is_written) {
  const auto refused = [](const std::string& said, const char* part, const char* name, const Json& value) {
    Json file = delivered();
    (part[0] == 0 ? file : file[part])[name] = value;
    Holder drive;
    check_says(said, drive.said_of_import(file));
    TEST_ASSERT_EQUAL_INT64(0, drive.port.writes);
    check_same(delivered(), cli::exported(drive.port));
  };
  const char* const settings = "settings";
  refused("product: 7: another product's, 21328 is accepted", "", "product", 7);
  refused("profile-velocity: 4000000000: out of range, ", settings, "profile-velocity", 4000000000);
  refused("profile-velocity: 0: out of range, 1 is accepted", settings, "profile-velocity", 0);
  refused("mode: 2: not available in this firmware", settings, "mode", 2);
  refused("mode: 9: out of range, 8 is accepted", settings, "mode", 9);
  refused("position-window-time: -1: outside the register", settings, "position-window-time", -1);
  refused("position-window-time: 9223372036854775807: outside", settings, "position-window-time", UINT64_MAX);
  refused("setting: 0060: there twice", settings, "0060", 100);
  refused("settings: 5: no names and values", "", "shaper_sets", Json::array({5}));
  Json partial = {{"product", 0x5350}, {"firmware", 1}, {"map_version", 0x0100}, {"shaper_sets", Json::array()}};
  partial[settings] = {{"quick-stop-jerk", 4000000000}};  // and no maximum with it
  Holder drive;
  check_says("quick-stop-jerk: 4000000000: out of range, ", drive.said_of_import(partial));
}

TEST(another_firmware_or_map_is_told_and_taken) {
  Json file = delivered();
  file["firmware"] = 2;
  file["map_version"] = 7;
  file["settings"]["profile-velocity"] = 555;
  file.erase("product");
  Holder drive;
  const std::vector<std::string> told = cli::import_settings(drive.port, file);
  TEST_ASSERT_EQUAL_UINT64(3, told.size());
  check_says("product: not in the file, the drive's is 21328", told[0]);
  check_says("firmware: 2 in the file, the drive's is 1", told[1]);
  check_says("map_version: 7 in the file, the drive's is 256", told[2]);
  TEST_ASSERT_EQUAL_UINT32(555, drive.get_wide(0x0060));
}

TEST(a_directory_is_no_file) {
  const auto read = [] { static_cast<void>(cli::read_json_file(std::filesystem::temp_directory_path().string())); };
  check_says(": a directory, a file that can be read is accepted", refusal_of(read).said);
}

}  // namespace
