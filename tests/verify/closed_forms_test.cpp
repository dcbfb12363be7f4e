// SPDX-License-Identifier: GPL-3.0-or-later
// Closed forms of contact, as `palpate verify --closed-forms` holds the solver to them.
#include "precompute/verify/closed_forms.hpp"
#include "precompute/verify/bonded_layer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace palpate::verify {
namespace {

ClosedForm form_of(const std::string& name) {
  const std::vector<ClosedForm> all = closed_forms();
  const auto form = std::find_if(all.begin(), all.end(), [&](const ClosedForm& f) { return f.name.starts_with(name); });
  if (form == all.end()) throw std::invalid_argument("no closed form " + name);
  return *form;
}

TEST(ClosedForms, DimitriadisHoldsOnTwoBodies) {
  const LawCheck c = check(form_of("Dimitriadis"));
  EXPECT_EQ(c.cause, "");
  EXPECT_TRUE(c.holds()) << c.worst().over_law << " where " << c.worst().tolerance << " is allowed";
}

// One body, on elements that are `coarser`; ClosedForms.Command has both.
void expect_on_large_body(const std::string& name, double coarser) {
  const ClosedForm form = form_of(name);
  const LawValues v = form.solve(form.large, coarser);
  EXPECT_EQ(v.cause, "");
  EXPECT_FALSE(v.values.empty());
  for (const LawValue& value : v.values) EXPECT_NEAR(value.over_law, 1, value.tolerance);
}

TEST(ClosedForms, HertzHoldsOnALargeBody) { expect_on_large_body("Hertz", 1); }
TEST(ClosedForms, FlatPunchHoldsOnALargeBody) { expect_on_large_body("Sneddon, punch", 1); }

// The slow form that slips.
TEST(SlowForms, SlippingHoldsOnCoarserElements) { expect_on_large_body("Catt", 1.5); }

TEST(ClosedFormChecks, ALawThatIsMissedOnEitherBodyDoesNotHold) {
  const auto form = [](double at_small, double at_large) {
    return ClosedForm{"made up", "", 1, 2, [=](double size, double) {
                        return LawValues{{{size < 2 ? at_small : at_large, 0.02}}, ""};
                      }};
  };
  EXPECT_TRUE(check(form(1.015, 1.005)).holds());
  EXPECT_FALSE(check(form(1.045, 1.015)).holds()) << "the bodies differ by more than the tolerance";
  EXPECT_FALSE(check(form(1.000, 1.015)).holds()) << "an endless body would miss it";
  EXPECT_NEAR(check(form(1.000, 1.015)).worst().over_law, 1.03, 1e-12);
  EXPECT_FALSE(check(form(1.030, 1.025)).holds());
  EXPECT_FALSE(check(form(1, NAN)).holds());
  const ClosedForm refused{"refused", "", 1, 2, [](double size, double) {
                             return size < 2 ? LawValues{{{1, 0.02}}, ""} : LawValues{{}, "penetration"};
                           }};
  EXPECT_FALSE(check(refused).holds());
  EXPECT_EQ(check(refused).cause, "penetration");
}

// Beyond a narrow contact the series falls short of what it approximates.
TEST(BondedLayer, TheSeriesIsTheExactContactWhereItIsNarrow) {
  EXPECT_NEAR(bonded_layer_exact(0.1) / bonded_layer_series(0.1), 1, 0.005);
  EXPECT_NEAR(bonded_layer_exact(0.5) / bonded_layer_series(0.5), 1.084, 0.01);
  EXPECT_GT(bonded_layer_exact(1.0) / bonded_layer_series(1.0), 1.1);
}

}  // namespace
}  // namespace palpate::verify
