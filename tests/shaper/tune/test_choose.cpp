// SPDX-License-Identifier: Apache-2.0
// Which shaper is proposed for what was found, held against its own response.
#include "shaper/shaping/band_check.hpp"
#include "shaper/tune/choose.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;

namespace {

constexpr double kTick = 1e-3;

IdentifiedMode found_mode(double frequency_hz, double damping, double amplitude, double frequency_std_hz,
                          double damping_std) {
  IdentifiedMode mode{};
  mode.frequency_hz = frequency_hz;
  mode.damping_ratio = damping;
  mode.amplitude = amplitude;
  mode.frequency_std_hz = frequency_std_hz;
  mode.damping_std = damping_std;
  mode.confidence = 1.0;
  mode.viscous = true;
  return mode;
}

Identification found(const IdentifiedMode& first) {
  Identification result{};
  result.finding = Finding::kFound;
  result.mode_count = 1;
  result.mode[0] = first;
  return result;
}

TuneProposal proposal_for(const Identification& identification, double tolerance) {
  TuneProposal proposal{};
  choose(identification, tolerance, kTick, proposal);
  return proposal;
}

}  // namespace

TEST(a_mode_that_is_known_well_gets_a_zv) {
  const TuneProposal proposal = proposal_for(found(found_mode(11.0, 0.05, 1.0, 0.01, 0.001)), 0.05);
  TEST_ASSERT_EQUAL_UINT32(1, proposal.spec_count);
  TEST_ASSERT_EQUAL_ENUM(ShaperKind::kZv, proposal.specs[0].kind);
  TEST_ASSERT_DOUBLE_WITHIN(1e-4, 11.0, proposal.specs[0].mode.frequency_hz);
  TEST_ASSERT_DOUBLE_WITHIN(2e-3, 0.5 / 11.0, proposal.length_s);
  TEST_ASSERT_AT_MOST_DOUBLE(0.05, proposal.residual);
}

TEST(the_less_is_known_the_longer_is_the_shaper_and_it_keeps_the_tolerance) {
  const ShaperKind kinds[] = {ShaperKind::kZv, ShaperKind::kZvd, ShaperKind::kEi, ShaperKind::kZvdd,
                              ShaperKind::kZvddd};
  const double deviations[] = {0.05, 0.3, 0.95, 1.25, 1.6};  // of 11 Hz, two of them either way
  for (int i = 0; i < 5; ++i) {
    TEST_INFO(deviation, deviations[i]);
    const Identification identification = found(found_mode(11.0, 0.05, 1.0, deviations[i], 0.002));
    const TuneProposal proposal = proposal_for(identification, 0.05);
    TEST_ASSERT_EQUAL_UINT32(1, proposal.spec_count);
    TEST_ASSERT_EQUAL_ENUM(kinds[i], proposal.specs[0].kind);
    ShaperDesign design{};
    TEST_ASSERT_OK(design_of(proposal, kTick, design));
    const ModeBand band{11.0 - 2.0 * deviations[i], 11.0 + 2.0 * deviations[i], 0.046, 0.054};
    const double leaves = worst_residual(design.cascade(), band, kTick).residual;
    TEST_ASSERT_AT_MOST_DOUBLE(0.0501, leaves);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, leaves, proposal.residual);
  }
}

TEST(what_no_shaper_holds_is_told_by_the_residual) {
  const TuneProposal proposal = proposal_for(found(found_mode(11.0, 0.05, 1.0, 4.0, 0.02)), 0.02);
  TEST_ASSERT_EQUAL_UINT32(1, proposal.spec_count);
  TEST_ASSERT_AT_LEAST_DOUBLE(0.1, proposal.residual);
}

TEST(a_second_mode_gets_its_own_where_it_matters) {
  Identification identification = found(found_mode(11.0, 0.05, 1.0, 0.01, 0.001));
  identification.mode[identification.mode_count++] = found_mode(29.0, 0.03, 0.2, 0.05, 0.002);
  const TuneProposal both = proposal_for(identification, 0.05);
  TEST_ASSERT_EQUAL_UINT32(2, both.spec_count);
  TEST_ASSERT_AT_MOST_DOUBLE(0.05, both.residual);
  identification.mode[1].amplitude = 0.005;
  const TuneProposal one = proposal_for(identification, 0.05);
  TEST_ASSERT_EQUAL_UINT32(1, one.spec_count);
  TEST_ASSERT_AT_MOST_DOUBLE(0.05, one.residual);
}

TEST(a_zero_of_the_first_shaper_on_the_second_mode_is_made_use_of) {
  // A ZV has zeros at odd multiples of its own, of the same decay.
  Identification identification = found(found_mode(10.0, 0.03, 1.0, 0.005, 0.0005));
  identification.mode[identification.mode_count++] = found_mode(30.0, 0.01, 0.2, 0.01, 0.0005);
  TEST_ASSERT_EQUAL_UINT32(1, proposal_for(identification, 0.05).spec_count);
}

TEST(nothing_found_proposes_nothing) { TEST_ASSERT_EQUAL_UINT32(0, proposal_for(Identification{}, 0.05).spec_count); }

TEST(what_the_ticks_cannot_hold_is_left_and_told) {
  const TuneProposal proposal = proposal_for(found(found_mode(495.0, 0.05, 1.0, 0.1, 0.001)), 0.05);
  TEST_ASSERT_EQUAL_UINT32(0, proposal.spec_count);
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.0, proposal.residual);
}
