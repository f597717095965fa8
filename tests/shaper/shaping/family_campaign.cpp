// SPDX-License-Identifier: Apache-2.0
// As many random designs of the family as asked for, up to 100 Hz and above, each held against its continuous shaper.
// Fails where gains, zeros or reports are not what they promise.  Usage: family_campaign DESIGNS [SEED]
#include <cstdlib>

#include "tests/shaper/shaping/family_check.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

int main(int argc, char** argv) {
  const auto designs = static_cast<long>(argc > 1 ? std::atof(argv[1]) : 2000);
  const auto seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1ULL;
  Random random(seed);
  FamilyTally low;
  FamilyTally high;
  for (long n = 0; n < designs; ++n) {
    const bool is_low = n / 13 % 2 == 0;
    const ShaperSpec spec = is_low ? random_spec(random, n, 0.5, kTwoSidedHz) : random_spec(random, n, 100.001, 300.0);
    const Checked checked = check_design(spec);
    FamilyTally one;
    one.add(spec, checked);
    if (one.total().silent + one.total().broken > 0)
      std::printf("%s at %.17g Hz, zeta %.17g, v %.17g: hump %.2Le, above %.2Le, edge %.2Le, band_miss %.3f\n",
                  text(spec.kind), spec.mode.frequency_hz, spec.mode.damping_ratio, spec.tolerance, checked.hump,
                  checked.excess, checked.edge, checked.band_miss);
    (is_low ? low : high).add(spec, checked);
  }
  low.print("0.5 to 100 Hz");
  high.print("100 to 300 Hz (hump: what passes the tolerance, relative; edge: what is narrower)");
  const long failed = low.total().silent + low.total().broken + high.total().silent + high.total().broken;
  std::printf("seed %llu: %ld designs: %s\n", seed, designs, failed == 0 ? "as promised" : "FAILED");
  return failed == 0 ? 0 : 1;
}
