// SPDX-License-Identifier: Apache-2.0
// The registers of a rig, as the commands reach them. A request takes 20 ticks.
#pragma once

#include "sim/hil/register_port.hpp"
#include "tests/firmware/rig.hpp"

namespace stillpoint::testing {

class RigPort : public sim::RegisterPort {
 public:
  explicit RigPort(Rig& rig) : rig_(rig) {}
  std::vector<uint16_t> read(uint16_t address, uint16_t count) override {
    ticks_ += 20;
    const Bytes response = rig_.exchange(Client::read_request(address, count));
    refuse_exception(address, response);
    std::vector<uint16_t> words;
    for (size_t i = 2; i < response.size(); i += 2)
      words.push_back(static_cast<uint16_t>((response[i] << 8) | response[i + 1]));
    return words;
  }
  using RegisterPort::write;
  void write(uint16_t address, const std::vector<uint16_t>& values) override {
    ticks_ += 20;
    refuse_exception(address, rig_.exchange(Client::write_request(address, values)));
  }
  uint64_t ticks() const override { return ticks_; }

 private:
  static void refuse_exception(uint16_t address, const Bytes& response) {
    const uint32_t exception = Client::exception_in(response);
    if (exception != 0) throw sim::refused_register(address, static_cast<int>(exception));
  }

  Rig& rig_;
  uint64_t ticks_ = 0;
};

}  // namespace stillpoint::testing
