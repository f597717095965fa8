// SPDX-License-Identifier: Apache-2.0
#include "shaper/identify/quiet_start.hpp"

namespace stillpoint {

namespace {

constexpr float kStill = 0.01F;  // of the most the axis moves in a window
constexpr size_t kMargin = 2;    // windows

float motion(const Record& position, size_t first, size_t window) {
  float low = position.samples[first], high = low;
  for (size_t n = first; n < first + window; ++n) {
    low = position.samples[n] < low ? position.samples[n] : low;
    high = position.samples[n] > high ? position.samples[n] : high;
  }
  return high - low;
}

}  // namespace

size_t quiet_start(const Record& position, size_t window) {
  if (window < 2) window = 2;
  if (position.count < window) return position.count;
  float most = 0.0F;
  for (size_t first = 0; first + window <= position.count; ++first) {
    const float here = motion(position, first, window);
    most = here > most ? here : most;
  }
  if (!(most > 0.0F)) return 0;
  for (size_t first = position.count - window + 1; first-- > 0;) {
    if (motion(position, first, window) <= kStill * most) continue;
    const size_t start = first + kMargin * window;
    return start < position.count ? start : position.count;
  }
  return 0;
}

}  // namespace stillpoint
