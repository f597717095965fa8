// SPDX-License-Identifier: Apache-2.0
// Every number that the drive's registers can hold has words, and none more: against the headers that name the numbers.
#include <fstream>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "firmware/parameters.hpp"
#include "sim/cli/drive_state.hpp"
#include "sim/cli/register_guide.hpp"
#include "sim/hil/register_texts.hpp"
#include "sim/hil/value_texts.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;  // a test of many small names
using firmware::Register;

namespace {

using Numbers = std::map<std::string, uint32_t>;  // by name
using Words = std::function<const char*(uint32_t)>;

std::string file(const std::string& path) {
  std::ifstream in(std::string(STILLPOINT_SOURCE) + "/" + path);
  TEST_INFO("path", path);
  TEST_ASSERT_TRUE(in.good());
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string without_comments(const std::string& source) {
  return std::regex_replace(source, std::regex("//[^\n]*"), "");
}

uint32_t number(const std::string& text) {
  const size_t shift = text.find("U <<");
  if (shift == std::string::npos) return static_cast<uint32_t>(std::stoul(text, nullptr, 0));
  return static_cast<uint32_t>(std::stoul(text)) << std::stoul(text.substr(shift + 4));
}

// The enumerators of each `enum class` of a header.
std::map<std::string, Numbers> enumerations(const std::string& header) {
  const std::string source = without_comments(file(header));
  const std::regex block("enum class (\\w+) : \\w+ \\{([^}]*)\\}");
  const std::regex entry("(k\\w+)\\s*(?:=\\s*(\\w+))?");
  std::map<std::string, Numbers> found;
  for (std::sregex_iterator each(source.begin(), source.end(), block), end; each != end; ++each) {
    const std::string body = (*each)[2];
    uint32_t next = 0;
    for (std::sregex_iterator one(body.begin(), body.end(), entry); one != end; ++one) {
      if ((*one)[2].matched) next = number((*one)[2]);
      found[(*each)[1]][(*one)[1]] = next++;
    }
  }
  return found;
}

// The constants of a header whose names begin so.
Numbers constants(const std::string& header, const std::string& prefix) {
  const std::string source = without_comments(file(header));
  const std::regex constant("constexpr uint16_t (" + prefix + "\\w+) = ([^;]+);");
  Numbers found;
  for (std::sregex_iterator each(source.begin(), source.end(), constant), end; each != end; ++each)
    found[(*each)[1]] = number((*each)[2]);
  return found;
}

std::set<uint32_t> values_of(const Numbers& numbers) {
  std::set<uint32_t> values;
  for (const auto& [name, value] : numbers) values.insert(value);
  return values;
}

std::set<uint32_t> worded(const Words& words, uint32_t last) {
  std::set<uint32_t> values;
  for (uint32_t value = 0; value <= last; ++value) {
    const char* const text = words(value);
    if (text != nullptr && *text != '\0') values.insert(value);
  }
  return values;
}

void check_worded(const std::string& name, const Numbers& numbers, const Words& words, uint32_t last) {
  TEST_INFO("of", name);
  TEST_ASSERT_TRUE(!numbers.empty());
  const std::set<uint32_t> with_words = worded(words, last);
  for (const auto& number : numbers) {
    TEST_INFO("enumerator", number.first);
    TEST_ASSERT_TRUE(with_words.count(number.second) == 1);
  }
  TEST_ASSERT_TRUE(with_words == values_of(numbers));
}

template <typename Enumeration>
const char* text_of(uint32_t value) {
  return sim::text(static_cast<Enumeration>(value));
}

Words of_register(Register name) {
  return [name](uint32_t value) { return sim::value_text(name, value); };
}

// None is no fault, but is one of the codes.
const char* fault_words(uint32_t code) {
  static const auto kFaults = cli::faults();
  return code == 0 || kFaults.count(static_cast<uint16_t>(code)) != 0 ? "words" : "";
}

const char* reason_words(uint32_t reason) {
  static const auto kReasons = cli::drive_reasons();
  return kReasons.count(static_cast<uint16_t>(reason)) != 0 ? "words" : "";
}

TEST(every_enumeration_of_the_register_map_has_words_for_each_enumerator) {
  const std::map<std::string, Words> words_of = {{"Tracking", of_register(Register::kTracking)},
                                                 {"TuneCommand", of_register(Register::kTuneCommand)},
                                                 {"ScopeCommand", of_register(Register::kScopeCommand)},
                                                 {"ScopeTrigger", of_register(Register::kScopeTrigger)},
                                                 {"ScopeEdge", of_register(Register::kScopeEdge)},
                                                 {"ScopeSource", of_register(Register::kFirstScopeChannel)},
                                                 {"CommandKey", text_of<firmware::CommandKey>},
                                                 {"CommandResult", of_register(Register::kCommandResult)},
                                                 {"OperationMode", of_register(Register::kMode)},
                                                 {"ShaperState", of_register(Register::kShaperState)},
                                                 {"FaultCode", fault_words},
                                                 {"StopOption", of_register(Register::kQuickStopOption)}};
  const std::set<std::string> places = {"Register", "ModeField", "FoundField"};
  for (const auto& each : enumerations("firmware/registers.hpp")) {
    if (places.count(each.first) != 0) continue;
    TEST_INFO("enumeration", each.first);
    TEST_ASSERT_TRUE(words_of.count(each.first) == 1);
    check_worded(each.first, each.second, words_of.at(each.first), UINT16_MAX);
  }
}

TEST(so_have_the_enumerations_that_registers_show_from_elsewhere) {
  const auto check = [](const char* header, const char* name, const Words& words) {
    check_worded(name, enumerations(header)[name], words, UINT8_MAX);
  };
  check("firmware/state_machine.hpp", "DriveState",
        [](uint32_t value) { return cli::text(static_cast<firmware::DriveState>(value)); });
  check("firmware/state_machine.hpp", "DriveCommand", text_of<firmware::DriveCommand>);
  check("shaper/axis/axis_config.hpp", "AxisPhase", text_of<AxisPhase>);
  check("shaper/profile/stream_limiter.hpp", "StreamPolicy", of_register(Register::kStreamPolicy));
  check("shaper/identify/capture.hpp", "CaptureState", of_register(Register::kScopeState));
  check("shaper/identify/identification.hpp", "Finding", of_register(Register::kTuneResult));
  check("shaper/tune/auto_tune.hpp", "TuneState", of_register(Register::kTuneState));
  check("shaper/tune/tune_plan.hpp", "TuneExcitation", of_register(Register::kTuneExcitedBy));
  check("shaper/tune/tune_plan.hpp", "TuneSource", of_register(Register::kTuneSourceUsed));
  check("shaper/shaping/shaper_spec.hpp", "ShaperKind", of_register(mode_register(0, firmware::ModeField::kKind)));
}

TEST(every_reason_has_words_and_so_has_every_error_and_quantity_of_the_shapers) {
  check_worded("reasons", constants("firmware/registers.hpp", "kReason"), reason_words, UINT16_MAX);
  auto status = enumerations("shaper/base/status.hpp");
  const auto but_unknown = [](const std::string& text) { return text.rfind("unknown", 0) == 0 ? "" : "words"; };
  check_worded(
      "errors", status["Error"], [&](uint32_t value) { return but_unknown(text(static_cast<Error>(value))); },
      UINT8_MAX);
  check_worded(
      "quantities", status["Quantity"], [&](uint32_t value) { return but_unknown(text(static_cast<Quantity>(value))); },
      UINT8_MAX);
}

TEST(every_bit_that_means_something_has_words) {
  check_worded("warnings", constants("firmware/registers.hpp", "kWarning"), sim::warning_text, UINT16_MAX);
  check_worded("controlword", constants("firmware/state_machine.hpp", "kControl"), sim::control_text, UINT16_MAX);
  check_worded("statusword", constants("firmware/state_machine.hpp", "kStatus"), sim::status_text, UINT16_MAX);
  check_worded("scope flags", constants("firmware/registers.hpp", "kScope"), sim::scope_flag_text, UINT16_MAX);
}

TEST(a_register_whose_values_have_words_accepts_none_without) {
  size_t seen = 0;
  for (const firmware::Parameter parameter : firmware::kParameters) {
    const Words words = of_register(parameter.name);
    if (!parameter.writable() || worded(words, UINT8_MAX).empty()) continue;
    TEST_INFO("address", address_of(parameter.name));
    ++seen;
    for (uint32_t value = 0; value <= UINT16_MAX; ++value) {
      uint32_t accepted = 0;
      if (!in_range(parameter, parameter.maximum, value, accepted)) continue;
      TEST_INFO("value", value);
      TEST_ASSERT_TRUE(words(value) != nullptr);
    }
  }
  TEST_ASSERT_TRUE(seen > 15);
}

TEST(the_printed_map_has_a_row_for_each_fault_and_each_reason) {
  const std::string map = file("firmware/registers.md");
  const auto check = [&](const Numbers& numbers) {
    for (const auto& number : numbers) {
      std::ostringstream row;
      row << "\n| " << std::uppercase << std::hex << number.second << " | ";
      TEST_INFO("name", number.first);
      if (number.second != 0) TEST_ASSERT_TRUE(map.find(row.str()) != std::string::npos);
    }
  };
  check(enumerations("firmware/registers.hpp")["FaultCode"]);
  check(enumerations("firmware/registers.hpp")["CommandKey"]);
  check(constants("firmware/registers.hpp", "kReason"));
}

}  // namespace
