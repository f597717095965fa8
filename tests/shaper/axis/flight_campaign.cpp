// SPDX-License-Identifier: Apache-2.0
// As many random flights of ten commands as asked for.  Usage: flight_campaign FLIGHTS [SEED]
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "tests/shaper/axis/flights.hpp"

int main(int argc, char** argv) {
  const auto count = static_cast<long>(argc > 1 ? std::atof(argv[1]) : 2000);
  const auto seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1ULL;
  const auto flights = std::make_unique<stillpoint::testing::RandomFlights>(seed);
  long faults = 0;
  for (long flight = 0; flight < count; ++flight) {
    const char* const fault = flights->fly();
    if (fault != nullptr && ++faults <= 5) std::printf("flight %ld: %s\n", flight, fault);
  }
  std::printf("seed %llu: %ld flights, %ld commands taken in motion, %ld ticks of quick stops, faults: %ld\n", seed,
              count, flights->in_motion, flights->stopped_ticks, faults);
  return faults == 0 ? 0 : 1;
}
