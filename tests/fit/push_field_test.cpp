// SPDX-License-Identifier: GPL-3.0-or-later
// Normal indentations over sites: extrapolation beside solved ones, blends beyond.
#include "precompute/fit/push_field.hpp"

#include <gtest/gtest.h>

#include "tests/fit/grid_plan.hpp"

namespace palpate::test {
namespace {

constexpr double kDeepest = 0.005;  // m

/// Grows by a factor e in `length` (m) along x, and more slowly along y.
double growing_stiffness(const Eigen::Vector3d& at, double length) {
  return 400 * std::exp((at.x() + 0.3 * at.y()) / length);
}

class ColumnsMissing : public testing::Test {
protected:
  /// A grid of 7 x 7 sites, 1 cm apart, whose last `missing` columns have no push.
  explicit ColumnsMissing(int missing = 2) {
    grid_ = grid_plan(7, kDeepest, 0.3, [this](int k) {
      return power_law(growing_stiffness({0.01 * (k % 7), 0.01 * (k / 7), 0}, kLength), 1.5);
    });
    graph_ = fit::site_graph(49, grid_.triangles);
    for (std::uint32_t k = 0; k < 49; ++k) {
      if (static_cast<int>(k % 7) < 7 - missing) curves_.emplace(k, grid_.journal.pairs[k].samples);
    }
  }
  static constexpr double kLength = 0.1;
  GridPlan grid_;
  fit::SiteGraph graph_;
  std::map<std::uint32_t, fit::NormalCurve> curves_;
};

TEST_F(ColumnsMissing, SitesBesideSolvedOnesAreExtrapolated) {
  const fit::PushField field(grid_.plan.sites, graph_, curves_);
  for (std::uint32_t site = 0; site < 49; ++site) {
    ASSERT_TRUE(field.known(site));
    EXPECT_EQ(field.solved(site), site % 7 < 5);
    EXPECT_EQ(field.extrapolated().count(site), site % 7 == 5 ? 1U : 0U);
    const double truth = growing_stiffness(grid_.plan.sites[site].frame.origin, kLength);
    for (const double depth : {0.1 * kDeepest, 0.5 * kDeepest, kDeepest}) {
      const double ratio = field.force(site, depth, grid_.plan.sites[site].frame).z() / (truth * std::pow(depth, 1.5));
      if (site % 7 <= 5) {
        EXPECT_NEAR(ratio, 1, 0.01) << site;
      } else {
        EXPECT_NEAR(ratio, std::exp(-0.1), 0.02) << site << ": the mean of the column before";
      }
    }
  }
}

TEST_F(ColumnsMissing, TheSlopeIsThatOfTheLogarithm) {
  const fit::PushField field(grid_.plan.sites, graph_, curves_);
  for (const std::uint32_t site : {8U, 24U, 32U, 30U}) {
    EXPECT_LT((field.slope(site, kDeepest) - Eigen::Vector3d(1, 0.3, 0) / kLength).norm(), 0.1) << site;
  }
}

}  // namespace
}  // namespace palpate::test
