// SPDX-License-Identifier: GPL-3.0-or-later
// Closed forms of contact, as `palpate verify --closed-forms` holds the solver to them.
#include "precompute/verify/closed_forms.hpp"
#include "precompute/verify/bonded_layer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>

namespace palpate::verify {

void PrintTo(const ClosedForm& form, std::ostream* out) { *out << form.name; }

namespace {

class ClosedForms : public ::testing::TestWithParam<ClosedForm> {};

// Those of few seconds.
std::vector<ClosedForm> quick_forms() {
  std::vector<ClosedForm> chosen = closed_forms();
  std::erase_if(chosen, [](const ClosedForm& f) { return f.name.ends_with("Mindlin") || f.name.ends_with("cone"); });
  return chosen;
}

std::string test_name(const ::testing::TestParamInfo<ClosedForm>& info) {
  std::string name = info.param.name;
  std::erase_if(name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; });
  return name;
}

TEST_P(ClosedForms, HoldOnTwoBodies) {
  const LawCheck c = check(GetParam());
  EXPECT_EQ(c.cause, "");
  EXPECT_TRUE(c.holds()) << c.worst().over_law << " where " << c.worst().tolerance << " is allowed";
}
INSTANTIATE_TEST_SUITE_P(Quick, ClosedForms, ::testing::ValuesIn(quick_forms()), test_name);

// The slow form that slips, on coarser elements and one body; ClosedForms.Command has the others.
TEST(SlowForms, SlippingHoldsOnCoarserElements) {
  const std::vector<ClosedForm> all = closed_forms();
  const auto form =
      std::find_if(all.begin(), all.end(), [](const ClosedForm& f) { return f.name.starts_with("Catt"); });
  ASSERT_NE(form, all.end());
  const LawValues v = form->solve(form->large, 1.5);
  EXPECT_EQ(v.cause, "");
  EXPECT_FALSE(v.values.empty());
  for (const LawValue& value : v.values) EXPECT_NEAR(value.over_law, 1, value.tolerance);
}

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
