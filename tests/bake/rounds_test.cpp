// SPDX-License-Identifier: GPL-3.0-or-later
// Rounds of automatic sampling on a ball whose stiffness is known everywhere, without any contact solve.
#include "precompute/pipeline/rounds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>

#include "precompute/geometry/feature_normals.hpp"
#include "precompute/solve/pair/pair.hpp"
#include "tests/mesh/bodies.hpp"

namespace palpate::test {
namespace {

using Eigen::Vector3d;

constexpr double kBall = 0.05, kLump = 0.012;  // m
const Vector3d kLumpAt(0, kBall, 0);

/// N/m^1.5: three times as stiff over a lump, and slowly stiffer to one side.
double lump(const Vector3d& at) {
  return 400 * (1 + 2 * std::exp(-(at - kLumpAt).squaredNorm() / (2 * kLump * kLump)) + 0.3 * at.x() / kBall);
}

/// The same unit: twice as stiff in the middle of a groove 16 mm wide, with kinks at its bottom and its rims.
double groove(const Vector3d& at) { return 400 * (1 + std::max(0.0, 1 - std::abs(at.x() - 0.003) / 0.008)); }

class BallRounds : public testing::Test {
protected:
  BallRounds() : body_(body_of(sphere_surface({0, 0, 0}, kBall, 4), 0.008)) {
    body_.report.area = 4 * std::numbers::pi * kBall * kBall;
    ToolScene sphere;
    sphere.radius = 0.005;
    scene_.tools = {sphere};
    scene_.sampling.depth = 0.003;
    scene_.sampling.spacing = pipeline::first_spacing(scene_, body_);
    tools_ = {tool::make_tool(sphere)};
  }

  /// Rounds until there are no more.
  struct Sites {
    sites::HapticMesh mesh;
    bake::Plan plan;
    JournalContent journal;
    bake::SamplingEstimate estimate;
    int rounds = 0;
  };
  [[nodiscard]] Sites sampled() const {
    const pipeline::Sampled sampled{scene_, body_, tools_};
    Sites s;
    s.mesh = sites::make_haptic_mesh(scene_, body_);
    s.plan = pipeline::first_round(sampled, s.mesh);
    pipeline::RoundErrors errors;
    do {
      solve(s);
      errors = pipeline::round_errors(sampled, s.mesh, s.plan, s.journal);
      s.estimate = errors.estimate;
      ++s.rounds;
    } while (!s.estimate.met && s.rounds < 20 && pipeline::add_round(sampled, s.journal, errors, s.mesh, s.plan));
    return s;
  }

  void solve(Sites& s) const {
    for (auto k = static_cast<std::uint32_t>(s.journal.pairs.size()); k < s.plan.pairs.size(); ++k) {
      JournalPair& pair = s.journal.pairs[k];
      for (const double z : solve::normal_path(scene_, s.plan.pairs[k].depth).normal_depths) {
        Sample sample;
        sample.index = static_cast<std::uint16_t>(pair.samples.size());
        sample.deflection = {0, 0, z};
        sample.force = {0, 0, stiffness_(s.plan.pairs[k].frame.origin) * std::pow(z, 1.5)};
        pair.samples.push_back(sample);
      }
      pair.outcome.emplace();
      pair.outcome->accepted = true;
    }
  }

  /// 95th percentile of the error of interpolation over the whole ball.
  [[nodiscard]] double true_p95(const Sites& s) const {
    Surface coarse;
    coarse.vertices = s.mesh.points;
    coarse.triangles = s.mesh.triangles;
    set_one_part(coarse, "patches");
    const geometry::SurfaceQuery query(coarse);
    std::mt19937_64 engine(7);
    std::normal_distribution<double> normal;
    std::vector<double> errors;
    for (int k = 0; k < 4000; ++k) {
      const Vector3d at = kBall * Vector3d(normal(engine), normal(engine), normal(engine)).normalized();
      const auto& t = s.mesh.triangles[query.closest(at).triangle];
      const auto w =
          geometry::closest_on_triangle(at, s.mesh.points[t[0]], s.mesh.points[t[1]], s.mesh.points[t[2]]).weights;
      double predicted = 0;
      for (int c = 0; c < 3; ++c) predicted += w[c] * stiffness_(s.mesh.points[t[c]]);
      errors.push_back(std::abs(predicted / stiffness_(at) - 1));
    }
    std::sort(errors.begin(), errors.end());
    return errors[errors.size() * 95 / 100];
  }

  double (*stiffness_)(const Vector3d&) = lump;
  Scene scene_;
  Body body_;
  std::vector<tool::Tool> tools_;
};

TEST_F(BallRounds, SitesGatherWhereTheForceCurvesUntilTheToleranceHolds) {
  scene_.response.tolerance = 0.02;
  const Sites s = sampled();
  EXPECT_TRUE(s.estimate.met);
  EXPECT_GT(s.rounds, 1);
  EXPECT_GT(s.estimate.places, 40U);
  const double p95 = true_p95(s);
  EXPECT_LE(p95, 0.02);
  EXPECT_LE(p95, 1.5 * s.estimate.p95());
  EXPECT_LE(s.estimate.p95(), 1.5 * p95);
  // Sites over the lump are at least three times as dense as on the other half of the ball.
  const auto share = [&](double low, double high) {  // of the sites, over that of the area, by height
    double sites = 0;
    for (const Vector3d& p : s.mesh.points) sites += p.y() >= low * kBall && p.y() < high * kBall ? 1 : 0;
    return sites / (high - low);
  };
  EXPECT_GT(share(0.85, 1.01), 3 * share(-1.01, 0));
  EXPECT_LT(s.mesh.points.size(), 600U);
}

TEST_F(BallRounds, KinksBetweenSitesAreFoundAndCountInTheEstimate) {
  stiffness_ = groove;
  scene_.response.tolerance = 0.08;
  const Sites s = sampled();
  EXPECT_TRUE(s.estimate.met);
  const double p95 = true_p95(s);
  EXPECT_LE(p95, 0.08);
  EXPECT_LE(p95, 1.5 * s.estimate.p95());
  EXPECT_LE(s.estimate.p95(), 1.5 * p95);
  EXPECT_LT(s.mesh.points.size(), 1500U);
}

TEST_F(BallRounds, EveryRoleIsPlannedAndEarlierPairsKeepTheirNumbers) {
  scene_.response.tolerance = 0.02;
  const Sites s = sampled();
  const sites::HapticMesh first_mesh = sites::make_haptic_mesh(scene_, body_);
  const bake::Plan first = pipeline::first_round({scene_, body_, tools_}, first_mesh);
  ASSERT_LT(first.pairs.size(), s.plan.pairs.size());
  for (std::size_t k = 0; k < first.pairs.size(); ++k) {
    EXPECT_EQ(first.pairs[k].frame.origin, s.plan.pairs[k].frame.origin);
    EXPECT_EQ(first.pairs[k].frame.n, s.plan.pairs[k].frame.n);
    EXPECT_EQ(first.pairs[k].role, s.plan.pairs[k].role);
  }
  std::size_t count[3] = {};
  for (const PairPlan& p : s.plan.pairs) ++count[static_cast<std::size_t>(p.role)];
  EXPECT_EQ(count[static_cast<std::size_t>(PairRole::normal)], s.plan.sites.size());
  EXPECT_GE(count[static_cast<std::size_t>(PairRole::full)], s.plan.sites.size() / 10);
  EXPECT_LE(count[static_cast<std::size_t>(PairRole::full)], s.plan.sites.size() / 5);
  EXPECT_GE(count[static_cast<std::size_t>(PairRole::hidden)], 40U);
}

TEST_F(BallRounds, ForcesBelowTheFloorAskForNoSites) {
  scene_.response.tolerance = 0.02;
  const Sites without = sampled();
  scene_.response.floor = 2 * stiffness_({0, kBall, 0}) * std::pow(scene_.sampling.depth, 1.5);  // twice the largest
  const Sites with = sampled();
  EXPECT_TRUE(with.estimate.met);
  EXPECT_LT(with.mesh.points.size(), without.mesh.points.size());
}

TEST_F(BallRounds, RoundsAreTheSameEveryTime) {
  scene_.response.tolerance = 0.03;
  const Sites a = sampled(), b = sampled();
  EXPECT_EQ(a.mesh.points, b.mesh.points);
  EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
  EXPECT_EQ(a.estimate.p95(), b.estimate.p95());
}

TEST_F(BallRounds, TheMostSitesAreNotExceededMuch) {
  scene_.response.tolerance = 0.001;
  scene_.sampling.most_sites = 150;
  const Sites s = sampled();
  EXPECT_FALSE(s.estimate.met);
  EXPECT_GE(s.plan.sites.size(), 150U);
  EXPECT_LT(s.plan.sites.size(), 300U) << "the closure of a last round";
}

}  // namespace
}  // namespace palpate::test
