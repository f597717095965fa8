// SPDX-License-Identifier: Apache-2.0
// In place of tuner.cpp, in an image of a drive that identifies nothing itself.
#include "firmware/tuner.hpp"

namespace stillpoint::firmware {

void Tuner::begin(const Parts&) {}
bool Tuner::available() const { return false; }
bool Tuner::command(TuneCommand, const Parameters&, uint32_t) { return false; }
void Tuner::keep_watch(bool) {}
void Tuner::service(uint32_t, const Meanwhile&) {}
void Tuner::follow(const Meanwhile&) {}
void Tuner::show() {}
bool Tuner::busy() const { return false; }
void Tuner::tick(const TuneSample&) {}

}  // namespace stillpoint::firmware
