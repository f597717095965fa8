// SPDX-License-Identifier: Apache-2.0
// The stored images: what is in them, what is made of those of other firmware, and that no power cut loses or mixes a
// set.
#include "firmware/parameter_store.hpp"

#include <vector>

#include "firmware/crc32.hpp"
#include "firmware/default_axis.hpp"
#include "shaper/axis/axis.hpp"
#include "tests/support/flash_model.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;
using namespace stillpoint::firmware;
using namespace stillpoint::testing;

namespace {

using Values = std::vector<uint32_t>;
using Words = std::vector<uint32_t>;

// What a firmware holds in RAM, and what it does at the start.
struct Boot {
  Axis<16> axis;
  Parameters parameters = {};
  ShaperSettings shaper = {};
  ParameterStore store = {};

  explicit Boot(hal::Nonvolatile* memory) {
    TEST_ASSERT_OK(axis.configure(kDefaultAxis));
    parameters.load_defaults();
    shaper.begin(axis, parameters, Meanwhile{});
    store.begin(memory);
  }
  Loaded load() { return store.load(parameters, shaper); }
  bool save() { return store.save(parameters, shaper); }

  // Everything that is stored.
  Values values() const {
    Values all;
    for (size_t i = 0; i < kParameterCount; ++i) {
      if (!stored(kParameters[i])) continue;
      const uint32_t sets = of_shaper_set(kParameters[i]) ? kShaperSets : 1;
      for (uint32_t set = 0; set < sets; ++set) {
        all.push_back(sets == 1 ? parameters.value(i) : shaper.staged(set, kParameters[i].name));
      }
    }
    return all;
  }

  void randomise(Random& random) {
    shaper.show_set(static_cast<uint32_t>(random.integer(0, kShaperSets - 1)));
    for (size_t i = 0; i < kParameterCount; ++i) {
      const Parameter parameter = kParameters[i];
      if (!stored(parameter)) continue;
      const uint32_t sets = of_shaper_set(parameter) ? kShaperSets : 1;
      for (uint32_t set = 0; set < sets; ++set) {
        const uint32_t value = random_value(parameter, random);
        if (sets == 1) {
          parameters.set_value(i, value);
        } else {
          shaper.stage(set, parameter.name, value);
        }
      }
    }
  }

  static uint32_t random_value(const Parameter& parameter, Random& random) {
    for (;;) {
      const int64_t low = parameter.is_signed() ? static_cast<int32_t>(parameter.minimum) : int64_t{parameter.minimum};
      const int64_t high = parameter.is_signed() ? static_cast<int32_t>(parameter.maximum) : int64_t{parameter.maximum};
      const auto value = static_cast<uint32_t>(random.integer(low, high));
      uint32_t accepted = 0;
      if (in_range(parameter, parameter.maximum, value, accepted)) return value;
    }
  }
};

// An image as the format says, by another hand than the product's.
uint32_t reference_crc32(const Words& words) {
  uint32_t crc = UINT32_MAX;
  for (const uint32_t word : words) {
    for (int bit = 0; bit < 32; ++bit) {
      const bool odd = ((crc ^ (word >> bit)) & 1) != 0;
      crc = odd ? (crc >> 1) ^ 0xEDB88320 : crc >> 1;
    }
  }
  return ~crc;
}

Words image(uint32_t version, uint32_t sequence, const Words& payload) {
  Words words{0x50495053, version << 16 | static_cast<uint32_t>(payload.size()), sequence};
  words.insert(words.end(), payload.begin(), payload.end());
  words.push_back(reference_crc32(words));
  return words;
}

void place(FlashModel& flash, size_t page, const Words& words) {
  for (size_t i = 0; i < words.size(); ++i) flash.pages[page][i] = words[i];
}

TEST(the_crc_is_the_usual_one) {
  // "12345678" as two words.
  TEST_ASSERT_EQUAL_UINT32(0x9AE0DAAF, ~crc32_update(crc32_update(kCrc32Initial, 0x34333231), 0x38373635));
}

TEST(what_was_saved_comes_back_and_a_blank_memory_leaves_the_defaults) {
  Random random(1);
  FlashModel flash;
  TEST_ASSERT_EQUAL_ENUM(Loaded::kNothing, Boot(&flash).load());
  for (int i = 0; i < 20; ++i) {
    TEST_INFO("save", i);
    Boot saved(&flash);
    saved.randomise(random);
    TEST_ASSERT_TRUE(saved.save());
    Boot next(&flash);
    TEST_ASSERT_TRUE(next.values() != saved.values());
    TEST_ASSERT_EQUAL_ENUM(Loaded::kImage, next.load());
    TEST_ASSERT_TRUE(next.values() == saved.values());
  }
  TEST_ASSERT_FALSE(flash.overwritten);
}

TEST(an_image_is_laid_out_as_its_format_says) {
  FlashModel flash;
  Boot boot(&flash);
  boot.shaper.stage(5, Register::kModeCount, 3);
  boot.parameters.set(Register::kPositionTimeMs, 77);
  TEST_ASSERT_TRUE(boot.save());
  const Words& page = flash.pages[0];
  const uint32_t payload = page[1] & 0xFFFF;
  TEST_ASSERT_TRUE(image(1, 0, Words(page.begin() + 3, page.begin() + 3 + payload)) ==
                   Words(page.begin(), page.begin() + 4 + payload));
  uint32_t found = 0;
  for (size_t i = 3; i < 3 + payload; i += 2) {
    const uint32_t address = page[i] & 0xFFFF;
    if (page[i] == 0x00050100) found += page[i + 1] == 3 ? 1U : 0U;
    if (page[i] == 0x00000072) found += page[i + 1] == 77 ? 1U : 0U;
    // Neither commands, nor set-points, nor what only shows.
    TEST_ASSERT_TRUE(address != 0x0014 && address != 0x0040 && address != 0x0044 && address != 0x0101);
    TEST_ASSERT_TRUE(address != 0x0130 && address != 0x0041);
  }
  TEST_ASSERT_EQUAL_UINT32(2, found);
  TEST_ASSERT_EQUAL_UINT32(2 * boot.values().size(), payload);
}

TEST(an_older_firmwares_image_leaves_the_defaults_for_what_it_lacks) {
  FlashModel flash;
  // With an address that is not there any more, one that is now read-only, half of a value, a value now out of range.
  place(flash, 1, image(1, 9, {0x0072, 55, 0x0FF0, 1, 0x0041, 3, 0x0061, 4, 0x006A, 2, 0x00070100, 2, 0x00080100, 1}));
  Boot boot(&flash);
  Boot fresh(nullptr);
  TEST_ASSERT_EQUAL_ENUM(Loaded::kImage, boot.load());
  fresh.parameters.set(Register::kPositionTimeMs, 55);
  fresh.shaper.stage(7, Register::kModeCount, 2);
  TEST_ASSERT_TRUE(boot.values() == fresh.values());
  TEST_ASSERT_EQUAL_UINT32(0, boot.parameters.get(Register::kStatusword));
}

TEST(what_an_image_has_and_is_left_out_is_named) {
  struct Case {
    uint32_t key;
    uint32_t value;
    uint32_t reason;
    uint32_t accepted;
  };
  constexpr Case kCases[] = {{0x0088, 5000, 0x8500, 800}, {0x0089, 2, 0x8500, 1},     {0x006A, 2, 0x8400, 0},
                             {0x7FF0, 1, 0x8400, 0},      {0x0041, 3, 0x8400, 0},     {0x0061, 4, 0x8400, 0},
                             {0x00030100, 5, 0x8500, 4},  {0x00090100, 1, 0x8400, 0}, {0x00010072, 1, 0x8400, 0},
                             {0x0101, 1, 0x8400, 0},      {0x0108, 0, 0x8400, 0},     {0x00080101, 8, 0x8500, 7},
                             {0x0072, 55, 0, 0},          {0x00080102, 4999, 0, 0},   {0x00070100, 2, 0, 0},
                             {0x00080100, 1, 0, 0},       {0x00080101, 7, 0, 0}};
  for (const Case& c : kCases) {
    TEST_INFO("key", c.key);
    FlashModel flash;
    place(flash, 0, image(1, 0, {0x0072, 44, c.key, c.value, 0x0023, 7}));
    Boot boot(&flash);
    TEST_ASSERT_EQUAL_ENUM(Loaded::kImage, boot.load());
    TEST_ASSERT_EQUAL_UINT32(c.reason, boot.parameters.get(Register::kRefusalReason));
    TEST_ASSERT_EQUAL_UINT32(c.reason == 0 ? 0 : c.key & 0xFFFF, boot.parameters.get(Register::kRefusedRegister));
    TEST_ASSERT_EQUAL_UINT32(c.accepted, boot.parameters.get(Register::kRefusalAccepted));
    TEST_ASSERT_EQUAL_UINT32(c.key == 0x0072 ? 55 : 44, boot.parameters.get(Register::kPositionTimeMs));
    TEST_ASSERT_EQUAL_UINT32(7, boot.parameters.get(Register::kClientWatchdogMs));
  }
}

TEST(the_newest_image_counts_also_where_the_sequence_wraps) {
  for (const uint32_t sequence : {0U, 5U, 0x7FFFFFFFU, UINT32_MAX}) {
    for (size_t page = 0; page < 2; ++page) {
      FlashModel flash;
      place(flash, page, image(1, sequence, {0x0072, 1}));
      place(flash, 1 - page, image(1, sequence + 1, {0x0072, 2}));
      Boot boot(&flash);
      TEST_ASSERT_EQUAL_ENUM(Loaded::kImage, boot.load());
      TEST_ASSERT_EQUAL_UINT32(2, boot.parameters.get(Register::kPositionTimeMs));
      TEST_ASSERT_TRUE(boot.save());
      TEST_ASSERT_EQUAL_UINT32(sequence + 2, flash.pages[page][2]);
      TEST_ASSERT_EQUAL_UINT32(sequence + 1, flash.pages[1 - page][2]);
    }
  }
}

// By itself it is kept until its page's turn comes. Beside a set that is in force it goes: one of the two must, and a
// cut must not leave neither.
TEST(an_image_of_a_version_that_is_not_known_is_passed_over_and_never_kept_for_the_one_in_force) {
  for (const uint32_t version : {0U, 2U, 0xFFFFU}) {
    for (const uint32_t sequence : {2U, 4U}) {
      FlashModel flash;
      place(flash, 0, image(version, sequence, {0x0072, 1}));
      FlashModel alone = flash;
      Boot first(&alone);
      TEST_ASSERT_EQUAL_ENUM(Loaded::kUnknownVersion, first.load());
      TEST_ASSERT_TRUE(first.save());
      TEST_ASSERT_EQUAL_UINT32(version << 16 | 2, alone.pages[0][1]);
      TEST_ASSERT_EQUAL_UINT32(sequence + 1, alone.pages[1][2]);
      TEST_ASSERT_EQUAL_ENUM(Loaded::kImage, Boot(&alone).load());

      place(flash, 1, image(1, 3, {0x0072, 2}));
      Boot boot(&flash);
      TEST_ASSERT_EQUAL_ENUM(sequence > 3 ? Loaded::kOlderImage : Loaded::kImage, boot.load());
      TEST_ASSERT_EQUAL_UINT32(2, boot.parameters.get(Register::kPositionTimeMs));
      TEST_ASSERT_TRUE(boot.save());
      TEST_ASSERT_EQUAL_UINT32(4, flash.pages[0][2]);
      TEST_ASSERT_EQUAL_UINT32(3, flash.pages[1][2]);
      TEST_ASSERT_EQUAL_ENUM(Loaded::kImage, Boot(&flash).load());
    }
  }
}

TEST_HOST(a_power_cut_beside_an_image_of_a_newer_version_leaves_the_old_set_or_the_new_one) {
  Random random(20261125);
  for (size_t page = 0; page < 2; ++page) {
    FlashModel before;
    place(before, page, image(1, 3, {0x0072, 2}));
    place(before, 1 - page, image(2, 4, {0x0072, 1}));
    Boot boot(&before);
    TEST_ASSERT_EQUAL_ENUM(Loaded::kOlderImage, boot.load());
    boot.parameters.set(Register::kPositionTimeMs, 3);
    FlashModel uncut = before;
    uncut.cut_at(FlashModel::kNever, 0);
    boot.store.begin(&uncut);
    TEST_ASSERT_TRUE(boot.save());
    for (uint64_t cut = 0; cut < uncut.operations(); ++cut) {
      TEST_INFO("cut", cut);
      FlashModel after = before;
      after.cut_at(cut, random.next());
      boot.store.begin(&after);
      TEST_ASSERT_FALSE(boot.save());
      after.power_up();
      Boot next(&after);
      const Loaded loaded = next.load();
      const uint32_t got = next.parameters.get(Register::kPositionTimeMs);
      TEST_ASSERT_TRUE(loaded == Loaded::kImage || loaded == Loaded::kOlderImage);
      TEST_ASSERT_TRUE(got == 2 || got == 3);
    }
  }
}

TEST(every_single_wrong_bit_makes_an_image_bad) {
  const Words good = image(1, 0, {0x0072, 55, 0x0100, 3});
  for (size_t bit = 0; bit < 32 * good.size(); ++bit) {
    TEST_INFO("bit", bit);
    FlashModel flash;
    place(flash, 0, good);
    flash.pages[0][bit / 32] ^= UINT32_C(1) << (bit % 32);
    Boot boot(&flash);
    const Loaded loaded = boot.load();
    // Where the magic is gone there is nothing to be called bad.
    TEST_ASSERT_EQUAL_ENUM(bit < 32 ? Loaded::kNothing : Loaded::kBad, loaded);
    TEST_ASSERT_TRUE(boot.values() == Boot(nullptr).values());
  }
}

TEST(memory_that_is_not_there_or_does_not_answer_fails_the_save_and_loads_nothing) {
  TEST_ASSERT_FALSE(Boot(nullptr).save());
  TEST_ASSERT_EQUAL_ENUM(Loaded::kNothing, Boot(nullptr).load());
  FlashModel flash;
  flash.dead = true;
  TEST_ASSERT_FALSE(Boot(&flash).save());
  TEST_ASSERT_EQUAL_ENUM(Loaded::kNothing, Boot(&flash).load());
  flash.dead = false;
  flash.cut_at(10, 1);  // fails in the middle without a cut: the save says so
  TEST_ASSERT_FALSE(Boot(&flash).save());
}

// 200 sets in a row, each save repeated with a cut at each of its operations.
TEST_HOST(a_power_cut_at_any_erase_or_word_leaves_the_old_set_or_the_new_one) {
  constexpr int kSaves = 200;
  const uint64_t seed = 20261125;
  TEST_INFO("seed", seed);
  Random random(seed);
  FlashModel flash;
  Values old = Boot(nullptr).values();
  uint64_t cuts = 0;
  uint64_t kept = 0;
  for (int save = 0; save < kSaves; ++save) {
    TEST_INFO("save", save);
    Boot boot(&flash);
    boot.randomise(random);
    const Values wanted = boot.values();
    FlashModel uncut = flash;
    uncut.cut_at(FlashModel::kNever, 0);
    boot.store.begin(&uncut);
    const bool saved = boot.save();
    TEST_ASSERT_TRUE(saved);
    FlashModel after = flash;
    for (uint64_t cut = 0; cut < uncut.operations(); ++cut) {
      TEST_INFO("cut", cut);
      after = flash;
      after.cut_at(cut, random.next());
      boot.store.begin(&after);
      const bool claimed = boot.save();
      TEST_ASSERT_FALSE(claimed);
      after.power_up();
      Boot next(&after);
      const Loaded loaded = next.load();
      const Values got = next.values();
      TEST_ASSERT_TRUE(got == old || got == wanted);
      TEST_ASSERT_TRUE(loaded == Loaded::kImage || save == 0);
      ++cuts;
      kept += got == old ? 1U : 0U;
    }
    // Half of the sequences go on from the last cut's ruins, half from the whole new set.
    const bool retried = random.integer(0, 1) == 0;
    if (retried) {
      flash = after;
      boot.store.begin(&flash);
      const bool again = boot.save();
      TEST_ASSERT_TRUE(again);
    } else {
      uncut.power_up();
      flash = uncut;
    }
    old = wanted;
  }
  MESSAGE(cuts, " cuts in ", kSaves, " saves, old set kept in ", kept);
  TEST_ASSERT_FALSE(flash.overwritten);
  TEST_ASSERT_AT_LEAST_INT64(int64_t{kSaves} * 300, cuts);
}

}  // namespace
