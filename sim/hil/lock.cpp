// SPDX-License-Identifier: Apache-2.0
#include "sim/hil/lock.hpp"

#include <fstream>
#include <sstream>

#include "sim/hil/campaign_lock.hpp"
#include "sim/hil/usart_lock.hpp"
#include "sim/refusal.hpp"

namespace stillpoint::sim {

std::unique_ptr<Lock> start_locked(const std::string& elf, Pace pace, const std::vector<std::string>& arguments) {
  std::ostringstream contents;
  contents << std::ifstream(elf, std::ios::binary).rdbuf();
  const std::string image = contents.str();
  if (image.compare(0, 4, "\177ELF") != 0) {
    throw bad_argument("elf", elf, "not an ELF file that can be read, a firmware image for the STM32F405 is accepted");
  }
  if (image.find(STILLPOINT_CAMPAIGN_MARKER) != std::string::npos) return std::make_unique<CampaignLock>(elf, pace);
  return std::make_unique<UsartLock>(elf, kProductionClock, arguments);
}

}  // namespace stillpoint::sim
