// SPDX-License-Identifier: GPL-3.0-or-later
// Closed forms against figures worked out by hand and against each other, and how well the fit follows them.
#include "precompute/fit/closed_form.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "precompute/fit/laws/pair_fit.hpp"

namespace palpate::test {
namespace {

using fit::ClosedForm;
using Law = AnalyticScene::Law;

ClosedForm form(Law law) {
  ClosedForm f;
  f.law = law;
  f.young = 6000;
  f.poisson = 0.5;
  f.radius = 0.004;
  f.slope = std::tan(1.2);
  f.thickness = 0.02;
  f.stiffness = law == Law::spring ? 150 : 2e6;
  f.tangential = law == Law::spring ? 60 : 1e6;
  f.flat = law == Law::punch;
  return f;
}

TEST(ClosedForm, FiguresByHand) {
  // E* = 8000 Pa, R = 4 mm, d = 1 mm: sqrt(R d) = 2 mm.
  EXPECT_NEAR(form(Law::hertz).push(0.001), 4.0 / 3 * 8000 * 0.002 * 0.001, 1e-12);
  EXPECT_NEAR(form(Law::hertz).tangential_stiffness(0.001), 8 * 2000 * 0.002 / 1.5, 1e-9);
  EXPECT_NEAR(form(Law::punch).push(0.001), 2 * 8000 * 0.004 * 0.001, 1e-12);
  EXPECT_NEAR(form(Law::cone).push(0.001), 2 / std::numbers::pi * 8000 * std::tan(1.2) * 1e-6, 1e-12);
  EXPECT_NEAR(form(Law::spring).push(0.001), 0.15, 1e-12);
  // x = 0.1: 1 + 0.1133 + 0.01283 + 0.000769 + 0.00000975.
  EXPECT_NEAR(form(Law::layer).push(0.001), form(Law::hertz).push(0.001) * 1.12690875, 1e-9);
  // Winkler: stiffness times the volume between the ball (a paraboloid) and the surface, here summed up.
  double volume = 0;
  const int n = 20000;
  for (int k = 0; k < n; ++k) {
    const double r2 = 2 * 0.004 * 0.001 * (k + 0.5) / n;
    volume += std::numbers::pi * (2 * 0.004 * 0.001 / n) * (0.001 - r2 / (2 * 0.004));
  }
  EXPECT_NEAR(form(Law::winkler).push(0.001) / (2e6 * volume), 1, 1e-6);
  ClosedForm flat = form(Law::winkler);
  flat.flat = true;
  EXPECT_NEAR(flat.push(0.001), 2e6 * std::numbers::pi * 16e-6 * 0.001, 1e-9);
}

TEST(ClosedForm, TangentialForceIsTheContactAreasShare) {
  // A bed under a ball answers a tangential push with its contact area, dF/dd over the normal stiffness of the bed.
  const ClosedForm bed = form(Law::winkler);
  const double step = 1e-7, d = 0.0015, slope = (bed.push(d + step) - bed.push(d - step)) / (2 * step);
  EXPECT_NEAR(bed.tangential_stiffness(d) / 1e6, slope / 2e6, 1e-9);
  // Mindlin's over the normal stiffness of Hertz, Sneddon, cone alike: 2 (1 - nu) / (2 - nu).
  for (const Law law : {Law::hertz, Law::punch, Law::cone}) {
    const ClosedForm f = form(law);
    const double stiffness = (f.push(d + step) - f.push(d - step)) / (2 * step);
    EXPECT_NEAR(f.tangential_stiffness(d) / stiffness, 2 * (1 - 0.5) / (2 - 0.5), 1e-6);
  }
}

TEST(ClosedForm, TheFitFollowsEveryLaw) {
  constexpr double depth = 0.003;
  solve::PairPath path;
  for (int k = 1; k <= 12; ++k) path.normal_depths.push_back(depth * k * k / 144);
  path.tangential_depths = {path.normal_depths[5], path.normal_depths[11]};
  path.tangential_directions = 4;
  path.tangential_reach = 0.4;
  path.friction = 0.3;
  const fit::ResponseScales scales{depth, 0.4 * depth, {5, 0, 3, 3, true}, 16};
  for (const Law law : {Law::hertz, Law::punch, Law::cone, Law::layer, Law::winkler, Law::spring}) {
    const ClosedForm f = form(law);
    const std::vector<Sample> samples = sample_law(f, path);
    ASSERT_EQ(samples.size(), 12U + 2 * 4 * 3);
    const fit::Potential fitted(fit::fit_pair(samples, scales, "law").coefs, scales);
    for (double z = 0.05 * depth; z < depth; z += 0.05 * depth) {
      EXPECT_NEAR(fitted.force({0, 0, z}).z() / f.push(z), 1, 0.01)
          << static_cast<int>(law) << " " << z;
    }
    EXPECT_NEAR(fitted.friction(depth), 0.3, 1e-3);
    const double x = 0.3 * depth;
    EXPECT_NEAR(fitted.force({x, 0, depth}).x(), -f.tangential_stiffness(depth) * x,
                0.05 * f.tangential_stiffness(depth) * x + 1e-5)
        << static_cast<int>(law);
  }
}

}  // namespace
}  // namespace palpate::test
