// SPDX-License-Identifier: Apache-2.0
#include "shaper/axis/jerk_sequence.hpp"

namespace stillpoint {

double JerkSequence::total() const {
  double sum = 0.0;
  for (size_t k = 0; k < kJerkParts; ++k) sum += length[k];
  return sum;
}

JerkPath::JerkPath(const JerkSequence& sequence) : after_{} {
  PathPoint m{};
  for (size_t k = 0; k < kJerkParts; ++k) {
    const double t = sequence.length[k];
    const double j = jerk_sign(k);
    m.position += t * (m.velocity + t * (m.acceleration / 2.0 + t * j / 6.0));
    m.velocity += t * (m.acceleration + t * j / 2.0);
    m.acceleration += t * j;
    m.time += t;
    after_[k] = m;
  }
}

bool JerkPath::peaks_in(size_t part) const {
  return jerk_sign(part) < 0.0 && before(part).acceleration >= 0.0 && after_[part].acceleration <= 0.0;
}

double JerkPath::peak_velocity(size_t part) const {
  const PathPoint m = before(part);
  return m.velocity + m.acceleration * m.acceleration / 2.0;
}

PathPoint JerkPath::effect(size_t part, double time) const {
  const PathPoint& m = after_[part];
  const double j = jerk_sign(part);
  const double rest = time - m.time;
  return PathPoint{1.0, j, m.acceleration + j * rest, m.velocity + rest * (m.acceleration + rest * j / 2.0)};
}

}  // namespace stillpoint
