// SPDX-License-Identifier: GPL-3.0-or-later
// Fits of whole plans: filling from neighbours, its frames, refusals, figures, parts left out.
#include "precompute/fit/fit.hpp"

#include <gtest/gtest.h>

#include "formats/io/error.hpp"
#include "tests/fit/grid_plan.hpp"

namespace palpate::test {
namespace {

constexpr double Z = 0.005;

AnalyticPair hertz_with_friction(double stiffness) {
  AnalyticPair pair = power_law(stiffness, 1.5);
  pair.push = [stiffness](double z) -> Eigen::Vector3d {
    return Eigen::Vector3d(0.06, 0.02, 1.0) * stiffness * std::pow(z, 1.5);
  };
  pair.growth = [](double z) { return std::sqrt(z / Z); };
  pair.tangential_x = [](double x) { return -70 * x; };
  pair.tangential_y = [](double y) { return -70 * y; };
  pair.friction = 0.5;
  return pair;
}

fit::FitSettings settings(bool friction) {
  fit::FitSettings s;
  s.depth_scale = Z;
  s.friction = friction;
  s.tolerance = 0.01;
  return s;
}

fit::FittedResponses fit_grid(const GridPlan& grid, const fit::FitSettings& s) {
  return fit::fit_responses(grid.plan, grid.triangles, {1}, grid.journal, s);
}

fit::Potential potential(const fit::FittedResponses& fitted, std::size_t site) {
  const Response& r = fitted.responses[site];
  const response::Offsets o = response::offsets(fitted.scales.degrees);
  Eigen::VectorXd coefs(o.end);
  for (int k = 0; k < o.end; ++k) {
    coefs[k] = r.coefficients[static_cast<std::size_t>(k)] *
               (k < o.friction ? static_cast<double>(r.unit) : layout::kFrictionUnit);
  }
  return {coefs, fitted.scales};
}

double normal_force(const fit::FittedResponses& fitted, std::size_t site, double s) {
  return potential(fitted, site).force({0, 0, s * s * Z}).z();
}

TEST(Fit, RefusedPairsAreFilledAndMarked) {
  // Stiffness grows linearly over the grid: inverse-distance weights of a regular neighbourhood find it again.
  GridPlan grid =
      grid_plan(7, Z, 0.4, [](int k) { return hertz_with_friction(400.0 + 10.0 * (k % 7) + 5.0 * (k / 7)); });
  const fit::FittedResponses whole = fit_grid(grid, settings(true));
  EXPECT_EQ(whole.report.filled, 0U);
  refuse(grid, 24, "penetration 0.4");
  const fit::FittedResponses fitted = fit_grid(grid, settings(true));
  EXPECT_EQ(fitted.report.refused, 1U);
  EXPECT_EQ(fitted.report.filled, 1U);
  EXPECT_EQ(fitted.responses[24].flags, layout::response_filled);
  EXPECT_EQ(fitted.responses[23].flags, layout::response_solved);
  EXPECT_DOUBLE_EQ(fitted.responses[24].depth_limit, Z);
  for (const double s : {0.2, 0.5, 1.0}) EXPECT_NEAR(normal_force(fitted, 24, s) / normal_force(whole, 24, s), 1, 0.01);
  // Frames of neighbours are rotated by 0.4 rad and more: bias and stiffness must rotate with them.
  const fit::Potential a = potential(whole, 24), b = potential(fitted, 24);
  for (const Eigen::Vector3d& at :
       {Eigen::Vector3d(0, 0, Z), Eigen::Vector3d(0.3 * Z, 0, Z), Eigen::Vector3d(0, 0.3 * Z, 0.5 * Z)}) {
    EXPECT_LT((a.force(at) - b.force(at)).norm(), 0.02 * a.force(at).norm()) << at.transpose();
  }
  EXPECT_NEAR(b.friction(Z), 0.5, 1e-3);
}

TEST(Fit, APairThatCannotBeFittedIsFilledLikeARefusedOne) {
  GridPlan grid = grid_plan(7, Z, 0.0, [](int) { return power_law(500, 1.5); });
  auto& samples = grid.journal.pairs[24].samples;
  samples.resize(1);  // one depth is no curve
  const fit::FittedResponses fitted = fit_grid(grid, settings(false));
  EXPECT_EQ(fitted.report.accepted, 48U);
  EXPECT_EQ(fitted.report.refused, 1U);
  EXPECT_EQ(fitted.responses[24].flags, layout::response_filled);
  EXPECT_NEAR(normal_force(fitted, 24, 1.0) / normal_force(fitted, 23, 1.0), 1.0, 1e-4);
}

TEST(Fit, DegreesLeaveHalfOfTheToleranceToPlacesBetweenSites) {
  const GridPlan grid = grid_plan(5, Z, 0.0, [](int) { return power_law(500, 2.7); });
  fit::FitSettings s = settings(false);
  s.tolerance = 0.9;
  const fit::FittedResponses coarse = fit_grid(grid, s);
  ASSERT_GT(coarse.report.held_out.p95, 0.005);
  s.tolerance = 1.5 * coarse.report.held_out.p95;
  const fit::FittedResponses fine = fit_grid(grid, s);
  EXPECT_GT(fine.scales.degrees.normal, coarse.scales.degrees.normal);
  EXPECT_LE(fine.report.held_out.p95, fit::kFitShare * s.tolerance);
}

TEST(Fit, APairBeyondTheResidualIsFilledAsWell) {
  GridPlan grid = grid_plan(7, Z, 0.0, [](int) { return power_law(500, 1.5); });
  Sample& jumped = grid.journal.pairs[24].samples[8];
  jumped.force *= 0.1;
  fit::FitSettings s = settings(false);
  s.max_residual = 0.3;
  const fit::FittedResponses fitted = fit_grid(grid, s);
  EXPECT_EQ(fitted.report.refused, 1U);
  EXPECT_EQ(fitted.responses[24].flags, layout::response_filled);
  EXPECT_NEAR(normal_force(fitted, 24, 1.0) / normal_force(fitted, 23, 1.0), 1.0, 1e-4);
  s.max_residual = 100;
  EXPECT_EQ(fit_grid(grid, s).report.accepted, 49U);
  ASSERT_EQ(fitted.report.refusals.size(), 1U);
  EXPECT_NE(fitted.report.refusals[0].example.find("response.max_residual"), std::string::npos);
}

TEST(Fit, PairsWhoseTangentialPushEndedEarlyAreCounted) {
  GridPlan grid = grid_plan(5, Z, 0.0, [](int) { return power_law(500, 1.5); });
  grid.journal.pairs[3].outcome->cause = "stopped short: minimum Jacobian";
  EXPECT_EQ(fit_grid(grid, settings(false)).report.shortened, 1U);
}

TEST(Fit, FillingSpreadsOverWholeHoles) {
  GridPlan grid = grid_plan(7, Z, 0.0, [](int) { return power_law(500, 1.5); });
  for (const std::uint32_t site : {16, 17, 18, 23, 24, 25, 30, 31, 32}) refuse(grid, site, "jacobian 0.01");
  const fit::FittedResponses fitted = fit_grid(grid, settings(false));
  EXPECT_EQ(fitted.report.filled, 9U);
  EXPECT_NEAR(normal_force(fitted, 24, 1.0) / normal_force(fitted, 0, 1.0), 1.0, 1e-4);
}

TEST(Fit, UnconnectedSitesTakeTheNearest) {
  GridPlan grid = grid_plan(4, Z, 0.0, [](int k) { return power_law(400 + 10 * k, 1.5); });
  std::erase_if(grid.triangles, [](const auto& t) { return t[0] == 15 || t[1] == 15 || t[2] == 15; });
  refuse(grid, 15, "mesh");
  const fit::FittedResponses fitted = fit_grid(grid, settings(false));
  EXPECT_NEAR(normal_force(fitted, 15, 1.0), normal_force(fitted, 11, 1.0), 1e-4 * normal_force(fitted, 11, 1.0));
}

TEST(Fit, SkippedPairsAreFilledAndCounted) {
  GridPlan grid = grid_plan(5, Z, 0.0, [](int) { return power_law(500, 1.5); });
  skip(grid, 3, bake::SkipReason::support);
  skip(grid, 20, bake::SkipReason::outside);
  const fit::FittedResponses fitted = fit_grid(grid, settings(false));
  EXPECT_EQ(fitted.report.planned, 23U);
  EXPECT_EQ(fitted.report.support, 1U);
  EXPECT_EQ(fitted.report.outside, 1U);
  EXPECT_EQ(fitted.report.filled, 2U);
  EXPECT_EQ(fitted.responses[3].flags, layout::response_filled);
  EXPECT_EQ(fitted.responses[20].flags, layout::response_filled);
}

TEST(Fit, RefusedPairsAreListedByCauseWithTheirArea) {
  GridPlan grid = grid_plan(5, Z, 0.0, [](int) { return power_law(500, 1.5); });
  refuse(grid, 4, "penetration 0.41 of the contact radius");
  refuse(grid, 5, "penetration 0.37 of the contact radius");
  refuse(grid, 6, "mesh: both meshers refused");
  const fit::FittedResponses fitted = fit_grid(grid, settings(false));
  EXPECT_EQ(fitted.report.planned, 25U);
  EXPECT_EQ(fitted.report.refused, 3U);
  EXPECT_EQ(fitted.responses[4].flags, layout::response_filled);
  const std::vector<fit::Refusals>& refusals = fitted.report.refusals;
  ASSERT_EQ(refusals.size(), 2U);
  EXPECT_EQ(refusals[0].pairs, 2U);
  EXPECT_NEAR(refusals[0].area_share, 2.0 / 25, 1e-12);
  const std::string text = fit::to_text(refusals);
  EXPECT_NE(text.find("2 (8 % of the area) like pair 4 (site 4"), std::string::npos) << text;
  EXPECT_NE(text.find("both meshers"), std::string::npos) << text;
}

TEST(Fit, OnlyEveryPairRefusedIsAnError) {
  GridPlan grid = grid_plan(2, Z, 0.0, [](int) { return power_law(500, 1.5); });
  for (std::uint32_t k = 1; k < 4; ++k) refuse(grid, k, "mesh: no room");
  EXPECT_EQ(fit_grid(grid, settings(false)).report.filled, 3U);
  refuse(grid, 0, "mesh: no room");
  try {
    fit_grid(grid, settings(false));
    FAIL() << "there is nothing to fill from";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::numerical);
    EXPECT_NE(std::string(error.what()).find("mesh: no room"), std::string::npos) << error.what();
  }
}

/// As a bake samples: twelve depths, tangential pushes at two of them.
solve::PairPath sampled_path(double depth) {
  solve::PairPath path;
  for (int k = 1; k <= 12; ++k) path.normal_depths.push_back(depth * k * k / 144);
  path.tangential_depths = {depth / 4, depth};
  path.tangential_directions = 4;
  path.friction = 0.5;
  return path;
}

/// A grid of normal indentations, with all paths at every sixth site.
GridPlan grid_with_normal_indentations(const std::function<AnalyticPair(int)>& pair_at) {
  GridPlan grid = grid_plan(7, Z, 0.3, pair_at);
  const GridPlan all = grid;
  for (std::uint32_t k = 0; k < 49; ++k) {
    PairPlan normal = all.plan.pairs[k];
    normal.role = PairRole::normal;
    JournalPair pushed = all.journal.pairs.at(k);
    std::erase_if(pushed.samples, [](const Sample& s) { return s.kind != SampleKind::normal; });
    grid.journal.pairs[static_cast<std::uint32_t>(grid.plan.pairs.size())] = pushed;
    grid.plan.pairs.push_back(normal);
  }
  for (std::uint32_t k = 0; k < 49; ++k) {
    if (k % 6 == 0) continue;
    grid.plan.pairs[k].role = PairRole::hidden;  // no response is made of it
  }
  return grid;
}

TEST(Fit, NormalIndentationsGetTheResponsesOfSitesSolvedInFull) {
  // The stiffness varies by a factor of four, the tangential stiffness with it.
  const auto stiffness = [](int k) { return 400.0 * (1 + 3 * std::pow(std::sin(0.7 * k), 2)); };
  const auto pair_at = [&](int k) {
    AnalyticPair pair = hertz_with_friction(stiffness(k));
    pair.tangential_x = pair.tangential_y = [f = stiffness(k) / 400](double x) { return -70 * f * x; };
    return pair;
  };
  fit::FitSettings s = settings(true);
  s.path = sampled_path;
  const fit::FittedResponses whole = fit_grid(grid_plan(7, Z, 0.3, pair_at), s);
  const fit::FittedResponses carried = fit_grid(grid_with_normal_indentations(pair_at), s);
  EXPECT_EQ(carried.report.full, 9U);
  EXPECT_EQ(carried.report.carried, 40U);
  EXPECT_EQ(carried.report.filled, 0U);
  EXPECT_EQ(carried.report.refused, 0U);
  EXPECT_LT(carried.report.normal.p95, 0.02);
  EXPECT_LT(carried.report.left_out.p95, 0.03);
  for (std::size_t site = 0; site < 49; ++site) {
    EXPECT_EQ(carried.responses[site].flags, layout::response_solved);
    const fit::Potential a = potential(whole, site), b = potential(carried, site);
    for (const Eigen::Vector3d& at : {Eigen::Vector3d(0, 0, Z), Eigen::Vector3d(0, 0, 0.3 * Z),
                                      Eigen::Vector3d(0.3 * Z, 0, Z), Eigen::Vector3d(0, 0.1 * Z, 0.5 * Z)}) {
      EXPECT_LT((a.force(at) - b.force(at)).norm(), 0.03 * a.force(at).norm()) << site << ": " << at.transpose();
    }
    EXPECT_NEAR(b.friction(Z), 0.5, 0.01);
  }
}

TEST(Fit, AContactWithoutTangentialResponsesTakesThemFromItsNeighbours) {
  GridPlan grid = grid_plan(7, Z, 0.0, [](int k) { return hertz_with_friction(k == 24 ? 900 : 500); });
  JournalPair& alone = grid.journal.pairs[24];
  std::erase_if(alone.samples, [](const Sample& s) { return s.kind != SampleKind::normal; });
  alone.outcome->cause = "stopped short: tangential response";
  fit::FitSettings s = settings(true);
  s.path = sampled_path;
  const fit::FittedResponses fitted = fit_grid(grid, s);
  EXPECT_EQ(fitted.report.refused, 0U);
  EXPECT_EQ(fitted.report.shortened, 1U);
  EXPECT_EQ(fitted.report.carried, 1U);
  EXPECT_EQ(fitted.responses[24].flags, layout::response_solved);
  EXPECT_NEAR(normal_force(fitted, 24, 1.0) / normal_force(fitted, 23, 1.0), 9.0 / 5, 0.01);
}

TEST(Fit, AnUnfinishedBakeIsSaid) {
  GridPlan grid = grid_plan(3, Z, 0.0, [](int) { return power_law(500, 1.5); });
  grid.journal.pairs[2].outcome.reset();
  grid.journal.pairs.erase(5);
  try {
    fit_grid(grid, settings(false));
    FAIL() << "two pairs are open";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    EXPECT_NE(std::string(error.what()).find("2 of 9 pairs"), std::string::npos);
  }
}

TEST(Fit, SectionsThatAreNotNeededAreLeftOut) {
  GridPlan normal = grid_plan(3, Z, 0.0, [](int) { return power_law(500, 1.5); });
  fit::FittedResponses fitted = fit_grid(normal, settings(false));
  EXPECT_FALSE(fitted.report.bias);
  EXPECT_EQ(fitted.scales.degrees.bias, 0);
  EXPECT_FALSE(fitted.scales.degrees.friction_families);
  EXPECT_EQ(fitted.scales.tangential, 0.0);
  // One skewed pair suffices for a bias.
  GridPlan skewed = grid_plan(3, Z, 0.0, [](int k) { return k == 4 ? hertz_with_friction(500) : power_law(500, 1.5); });
  fitted = fit_grid(skewed, settings(false));
  EXPECT_TRUE(fitted.report.bias);
  EXPECT_GT(fitted.scales.degrees.bias, 0);
}

TEST(Fit, FiguresAreThoseOfTheSamples) {
  std::vector<std::pair<double, std::uint32_t>> errors;
  for (std::uint32_t k = 100; k >= 1; --k) errors.emplace_back(0.01 * k, k);
  const fit::ErrorFigures figures = fit::error_figures(errors);
  EXPECT_DOUBLE_EQ(figures.median, 0.505);
  EXPECT_DOUBLE_EQ(figures.p95, 0.95);
  EXPECT_DOUBLE_EQ(figures.worst, 1.0);
  EXPECT_EQ(figures.worst_pair, 100U);
  EXPECT_EQ(fit::error_figures({}).samples, 0U);

  const GridPlan grid = grid_plan(3, Z, 0.0, [](int k) { return hertz_with_friction(400 + 20 * k); });
  const fit::FitReport report = fit_grid(grid, settings(true)).report;
  EXPECT_EQ(report.normal.samples, 9U * 12U);
  EXPECT_EQ(report.tangential.samples, 9U * 24U);
  EXPECT_EQ(report.pairs.size(), 9U);
  EXPECT_LT(report.normal.worst, 0.02);
  EXPECT_LT(report.tangential.worst, 0.04);
}

}  // namespace
}  // namespace palpate::test
