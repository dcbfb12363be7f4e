// SPDX-License-Identifier: GPL-3.0-or-later
// Error of the sum of contacts that lie near each other: the measured figures, contact radii, several tools at once.
#include "palpate/contact/superposition.hpp"

#include <cmath>
#include <vector>

#include "tests/runtime/support.hpp"

namespace palpate::superposition_test {
namespace {

using namespace test;
using runtime::Contact;
using runtime::ContactRadius;
using runtime::superposition_error;
using runtime::SuperpositionError;

TEST(Superposition, ErrorIsTheMeasuredOneAndFallsWithTheDistance) {
  const double measured[] = {0.33, 0.22, 0.11, 0.04};
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(superposition_error(0.002 * (1 << k), 0.002), measured[k], 1e-12);
  double last = 0.5;
  for (double apart = 0; apart < 30; apart += 0.01) {
    EXPECT_LE(superposition_error(apart, 1), last);
    EXPECT_LT(last - superposition_error(apart, 1), 0.01);
    last = superposition_error(apart, 1);
  }
  EXPECT_EQ(superposition_error(1, 0), 0);
}

TEST(Superposition, RadiusIsThatOfATipOrOfAFlatPunch) {
  Options options;
  options.tools = Options::Tools::all;
  ResponseFileContent content = box_content(options);
  const Opened box(content);
  EXPECT_NEAR(ContactRadius(box.view, 0).at(0.002), std::sqrt(kTipRadius * 0.002), 1e-9);
  EXPECT_NEAR(ContactRadius(box.view, 1).at(0.002), std::sqrt(kTipRadius * 0.002), 1e-9);
  EXPECT_NEAR(ContactRadius(box.view, 2).at(0.002), std::sqrt(0.004 * 0.002), 1e-6) << "a mesh counts as its extent";
  content.tools[0].probe_radius = 0;
  const Opened punch(std::move(content));
  EXPECT_NEAR(ContactRadius(punch.view, 0).at(1e-4), kTipRadius, 1e-9);
  EXPECT_NEAR(ContactRadius(punch.view, 0).at(0.004), kTipRadius, 1e-9);
}

// Five fingertips: each has the force of its own contact, whatever the others do.
TEST(Superposition, NearToolsAreToldFromFarOnes) {
  const Opened box(box_content(flat()));
  const ContactRadius radius(box.view, 0);
  for (const double spacing : {0.02, 0.004}) {
    std::vector<Contact> hand(5, Contact(box.view, 0));
    SuperpositionError error;
    for (int i = 0; i < 800; ++i) {
      Tick ticks[5];
      for (std::size_t k = 0; k < 5; ++k) {
        const double angle = 1.2566 * static_cast<double>(k), out = spacing / 1.1756;
        const double z = kTop + kTipRadius + 2e-4 - 1e-6 * i - 1e-4 * static_cast<double>(k);
        ticks[k] = hand[k].tick(upright({out * std::cos(angle), out * std::sin(angle), z}));
      }
      error = SuperpositionError{};
      for (int a = 0; a < 5; ++a) {
        for (int b = a + 1; b < 5; ++b) error.add(ticks[a], radius, ticks[b], radius);
      }
    }
    EXPECT_EQ(error.notable(), spacing < 0.01) << error.error;
    EXPECT_NEAR(error.spacing, spacing, 0.05 * spacing);
  }
}

}  // namespace
}  // namespace palpate::superposition_test
