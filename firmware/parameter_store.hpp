// SPDX-License-Identifier: Apache-2.0
// The parameters in memory that survives a power cut: two images, of which the newest whole one counts.
//
// An image lies at the beginning of a page, in words, low byte first:
//   magic | version << 16 | payload words | sequence | payload | CRC-32 of all before
// The payload of version 1 is pairs: set << 16 | register address, value. Set 0 to 7 with the registers of a shaper
// set, 0 with all others. What the shaper in force was made from, or one that could not be restored (see
// ShaperSettings::restoring), is there once more as set 8, with the number of its own set as 0101; without a shaper it
// is left out. So a firmware with more parameters reads the image of one with fewer and has its defaults for the rest;
// an address that it does not know, or a value that it no longer accepts, it leaves out; 0012 names the last of them.
//
// A save goes to the page that does not hold the image in force, the newest whole one of a known version, and counts
// from its last word, the CRC, on: a power cut before leaves the old set, after it the new one. (A cut *in* that word:
// the new one if the word can be read as it should be, else the old one.)
#pragma once

#include <stdint.h>

#include "firmware/parameters.hpp"
#include "firmware/shaper_settings.hpp"
#include "hal/nonvolatile.hpp"

namespace stillpoint::firmware {

constexpr uint32_t kImageMagic = 0x50495053;  // "SPIP" in memory
constexpr uint16_t kImageVersion = 1;

enum class Loaded : uint8_t {
  kNothing,         // nothing has ever been saved, or there is no memory: the defaults stay
  kImage,           // the newest whole image; after a cut that is the old one
  kOlderImage,      // that, but one saved after it is there, of a version that this firmware does not know
  kUnknownVersion,  // none is loaded: whole ones are there, but of versions that this firmware does not know
  kBad,             // none is loaded: none is whole, though at least one was begun
};

// What is stored: what a client can write and read back and that is no command. A set-point is a command.
bool stored(const Parameter& parameter);
// The registers 0100 on, which each shaper set has for itself.
bool of_shaper_set(const Parameter& parameter);

// Background. Zero-initialised storage is valid: there is no memory then. Holds no image, reads and writes word by
// word.
class ParameterStore {
 public:
  // Null: none.
  void begin(hal::Nonvolatile* memory) { memory_ = memory; }

  // Puts the image's values over those in force, each within its own range; limits among parameters are the caller's to
  // check. What was in force when it was saved is asked for again (ShaperSettings::restore). An image of an unknown
  // version is passed over for one that is known, also an older one, and is what the next save overwrites then: it
  // cannot be kept beside both the set in force and the one that is being written.
  Loaded load(Parameters& parameters, ShaperSettings& shaper) const;

  // True when the set is stored and reads back whole. False: the old one still counts. May take seconds.
  bool save(const Parameters& parameters, const ShaperSettings& shaper);

 private:
  static constexpr size_t kPages = 2;

  struct Header {
    uint32_t magic;
    uint32_t kind;  // version and payload words
    uint32_t sequence;
    bool whole;

    bool known() const { return kind >> 16 == kImageVersion; }
    int rank() const { return whole ? known() ? 2 : 1 : 0; }
    uint32_t payload_words() const { return kind & 0xFFFFU; }
  };

  bool word_at(size_t page, uint32_t index, uint32_t& word) const;
  void inspect(size_t page, Header& header) const;
  size_t page_to_keep(Header (&images)[kPages]) const;

  hal::Nonvolatile* memory_ = nullptr;
};

}  // namespace stillpoint::firmware
