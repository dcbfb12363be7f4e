// SPDX-License-Identifier: GPL-3.0-or-later
// A virtual coupling in closed loops: what oscillates without it rests with the stiffest one that is called safe, and
// the bound that says so against Colgate's condition.
#include "device/stability/safety.hpp"
#include "palpate/format/mapped_file.hpp"
#include "palpate/palpate.hpp"
#include "tests/device/stability/stability_cases.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

namespace palpate::test {
namespace {

using device::LoopTiming;
using device::PlantOptions;
using runtime::CouplingOptions;

// A contact of stiffness C behind a spring K and a damper B, which takes differences, n periods late: what damping a
// device needs at any frequency (Colgate and Schenkel 1997) is no more than it has.
TEST(CoupledLoop, LargestCouplingMeetsColgatesConditionAtEveryFrequency) {
  constexpr double kPeriod = 0.001, kDamping = 1;
  PlantOptions plant;
  plant.damping = kDamping;
  plant.friction = plant.resolution = 0;
  for (int n = 0; n < 5; ++n) {
    plant.delay_in = plant.delay_out = 0.5 * kPeriod * n;
    const LoopTiming timing{kPeriod, 0};
    for (const double damper : {0.0, 0.1, 0.5, 0.95}) {
      const double bound = device::passive_stiffness(plant, timing, 3, damper).least();
      for (const double over : {1.001, 1.5, 4.0, 100.0, 1e6}) {
        const double contact = over * device::passive_stiffness(plant, timing).least();
        const double spring = contact * bound / (contact - bound);
        double most = 0;
        for (double x = 1e-3; x < 3.1415; x += 1e-3) {
          const std::complex<double> late = std::polar(1.0, -x), change = 1.0 - late;
          const std::complex<double> h = 1.0 / (1 / contact + 1.0 / (spring + damper / kPeriod * change));
          most = std::max(most, 0.5 * kPeriod * (change * std::pow(late, n) * h).real() / (1 - std::cos(x)));
        }
        EXPECT_LE(most, kDamping * (1 + 1e-6)) << n << ' ' << damper << ' ' << over;
        // Nothing is given away but where a damper and a delay need most at other frequencies.
        if (damper == 0) {
          EXPECT_NEAR(most, kDamping, 1e-4) << n << ' ' << over;
        }
      }
    }
  }
  EXPECT_EQ(device::passive_stiffness(plant, {kPeriod, 0}, 3, 2 * kDamping).least(), 0);
}

constexpr double kStiff = 5000;  // N/m

StabilityCase case_of(const char* kind, const ContactLaw& law, const NamedHand& hand) {
  return {device::find_sim_kind(kind), &law, &hand, 1000, 0.0015};
}

/// The contact has the stiffness kStiff where it rests. It swings without a coupling and behind a coupling that is too
/// stiff; behind a coupling that is called safe it rests. `thrown`: the first two may bounce without a pattern, by more
/// than a hundred encoder steps.
void expect_mended(const StabilityCase& c, const CouplingOptions& safe, bool thrown = false) {
  const double scale = scale_of(c, kStiff), step = c.kind->plant.resolution;
  const std::string name = std::string(c.kind->kind.name) + ' ' + c.law->name;
  const auto expect_swing = [&](const device::Swing& swing, const char* held) {
    EXPECT_TRUE(swing.oscillates(step) || (thrown && swing.late > 100 * step))
        << name << ", " << held << ": " << swing.early / step << " steps, then " << swing.late / step;
  };
  expect_swing(swing(c, scale, c.law->make(scale)), "no coupling");
  CouplingOptions stiff;
  stiff.stiffness = 4 * kStiff;
  expect_swing(coupled_swing(c, scale, stiff), "too stiff a coupling");
  const device::Swing swing = coupled_swing(c, scale, safe);
  EXPECT_FALSE(swing.oscillates(step)) << name << ' ' << safe.stiffness << ' ' << safe.damping;
  EXPECT_LT(swing.late, 3 * step) << name << ' ' << safe.stiffness << ' ' << safe.damping;
}

TEST(CoupledLoop, RestsBehindTheLargestCoupling) {
  const std::vector<NamedHand> grips = hands();
  const std::vector<ContactLaw> laws = plain_laws();
  for (const char* kind : {"sim", "sim-premium", "sim-woody"}) {
    for (const ContactLaw& law : laws) {
      for (const double share : {0.0, 0.2}) {
        const StabilityCase c = case_of(kind, law, grips[0]);
        const double damping = share * c.kind->plant.damping;
        const double bound = device::passive_stiffness(plant_of(c), {1 / c.rate, 0}, 3, damping).least();
        expect_mended(c, {kStiff * bound / (kStiff - bound), damping});
      }
    }
  }
}

// The same for a file, and with what is said of it: safety() counts all of its responses, so its coupling is softer.
TEST(CoupledLoop, RestsOnAFileBehindWhatSafetySays) {
  const runtime::MappedFile file(PALPATE_GOLDENS "/quadratic.palp");
  const runtime::OpenResult opened = runtime::View::open(file.data(), file.size());
  ASSERT_TRUE(opened) << opened.error;
  const ContactLaw law = file_law("quadratic", opened.view);
  const std::vector<NamedHand> grips = hands();
  for (const char* kind : {"sim", "sim-premium"}) {
    const StabilityCase c = case_of(kind, law, grips[0]);
    device::SafetyOptions options;
    options.timing.period = 1 / c.rate;
    options.scale = scale_of(c, kStiff);
    const device::Safety safety = device::safety(opened.view, plant_of(c), options);
    EXPECT_FALSE(safety.passive_for_any_hand());
    expect_mended(c, {safety.largest_coupling, 0}, true);
  }
}

// A tool that is held 20 mm deep in a box without friction slides round it, by millimetres in a tick. The energy from
// that contact must not feed an oscillation.
TEST(CoupledLoop, GetsNothingFromAToolThatSlidesRoundABody) {
  const runtime::MappedFile file(PALPATE_GOLDENS "/frictionless.palp");
  const runtime::OpenResult opened = runtime::View::open(file.data(), file.size());
  ASSERT_TRUE(opened) << opened.error;
  const ContactLaw law = file_law("frictionless", opened.view);
  const std::vector<NamedHand> grips = hands();
  ASSERT_EQ(grips[1].name, "firm");
  const StabilityCase c{device::find_sim_kind("sim-woody"), &law, &grips[1], 1000, 0.004};
  const double stiffness = 5 * 1770.34, safe = device::passive_stiffness(plant_of(c), {1 / c.rate, 0}).least();
  const device::Swing swing = coupled_swing(c, scale_of(c, stiffness), {stiffness * safe / (stiffness - safe)});
  EXPECT_FALSE(swing.oscillates(c.kind->plant.resolution)) << swing.early << ' ' << swing.late;
  EXPECT_LE(swing.to_hand, kTrace);
}

TEST(CoupledLoop, SafetyAsksForASofterSpringBesideADamper) {
  const runtime::MappedFile file(PALPATE_GOLDENS "/quadratic.palp");
  const runtime::OpenResult opened = runtime::View::open(file.data(), file.size());
  ASSERT_TRUE(opened) << opened.error;
  const device::PlantOptions& plant = device::find_sim_kind("sim")->plant;
  device::SafetyOptions options;
  options.scale = 50;
  double last = device::safety(opened.view, plant, options).largest_coupling;
  EXPECT_GT(last, 100);
  for (const double damping : {0.1, 0.2, 0.4}) {
    options.damping = damping;
    const double largest = device::safety(opened.view, plant, options).largest_coupling;
    EXPECT_LT(largest, last);
    last = largest;
  }
  options.damping = plant.damping;
  EXPECT_EQ(device::safety(opened.view, plant, options).largest_coupling, 0);
  options.damping = -1;
  EXPECT_TRUE(options.validate());
}

// A real device's mechanics are those of the simulated kind that speaks its language.
TEST(CoupledLoop, KnowsWhatStandsForADevice) {
  for (const device::DeviceKind& kind : device::kDevices) {
    const device::SimKind* sim = device::find_stand_in(kind);
    const std::string driver = kind.driver;
    EXPECT_EQ(sim == nullptr ? "" : sim->kind.name, std::string(driver == "falcon"   ? "sim-falcon"
                                                                : driver == "wooden" ? "sim-woody"
                                                                                     : ""))
        << kind.name;
  }
  for (const device::SimKind& kind : device::sim_kinds()) EXPECT_EQ(device::find_stand_in(kind.kind), &kind);
}

}  // namespace
}  // namespace palpate::test
