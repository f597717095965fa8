// SPDX-License-Identifier: Apache-2.0
// What the test image (tests/hil/campaign) and the host exchange once a tick over two FIFOs, in place of the two serial
// lines: the servo link's frames as they are, and with them the client line's bytes and what was measured. Fixed
// lengths, so that a tick is one read and one write. Freestanding: the chip includes it too.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "firmware/servo_link.hpp"

namespace stillpoint::sim {

// Relative to the emulator's working directory. Semihosting opens them, the host makes them.
#define STILLPOINT_CAMPAIGN_IN "servo.in"    // to the chip
#define STILLPOINT_CAMPAIGN_OUT "servo.out"  // from the chip

// In the image, and in no other.
#define STILLPOINT_CAMPAIGN_MARKER "stillpoint campaign transport 1"

constexpr uint8_t kPaceLock = 0;
constexpr uint8_t kPaceFreeSysTick = 1;

// Bytes alone, so that both sides lay it out alike. Numbers little-endian.
struct CampaignToChip {
  uint8_t sync[servo_link::kSyncBytes];
  uint8_t pace;  // of the first record; kPace...
  uint8_t client_bytes;
  uint8_t client[44];
};

struct CampaignFromChip {
  uint8_t reply[servo_link::kReplyBytes];
  uint8_t reserved;
  uint8_t client_bytes;
  uint8_t client[40];
  uint8_t timer_counts[4];  // TIM2's, over Application::tick: 1 GHz in the emulator
  uint8_t late_ticks[4];
};

static_assert(sizeof(CampaignToChip) == 64 && sizeof(CampaignFromChip) == 64, "no padding");

}  // namespace stillpoint::sim
