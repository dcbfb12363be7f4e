// SPDX-License-Identifier: GPL-3.0-or-later
// Motions reach the given depth, begin and end in the air, and move as smoothly as a hand.
#include "datasets-synthetic/motion.hpp"

#include "datasets-synthetic/shapes.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <cstdio>
#include <sstream>

namespace palpate::synth {
namespace {

struct Row {
  double t;
  Eigen::Vector3d position;
  Eigen::Quaterniond orientation;
};

std::vector<Row> parse(const std::string& text) {
  std::istringstream stream(text);
  std::string line;
  std::getline(stream, line);
  EXPECT_EQ(line, "t,x,y,z,qw,qx,qy,qz");
  std::vector<Row> rows;
  while (std::getline(stream, line)) {
    Row row{};
    double w = 0, x = 0, y = 0, z = 0;
    EXPECT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf", &row.t, &row.position.x(), &row.position.y(),
                          &row.position.z(), &w, &x, &y, &z),
              8)
        << line;
    row.orientation = Eigen::Quaterniond(w, x, y, z);
    rows.push_back(row);
  }
  return rows;
}

/// Height of the tip's pole over the site along its normal.
double height(const Row& row, const Site& site, double tip_offset) {
  const Eigen::Vector3d tip = row.position - row.orientation * Eigen::Vector3d(0, 0, tip_offset);
  return (tip - site.point).dot(site.normal);
}

TEST(View, FindsTheTopOfASphere) {
  const Surface ball = geometry::ellipsoid({0, 0, 0}, {0.04, 0.04, 0.04}, 0.003, "ball");
  const View view(ball);
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {0.01, 0.02}, {-0.02, 0.005}}) {
    const std::optional<Site> site = view.highest(x, y);
    ASSERT_TRUE(site.has_value());
    const double z = std::sqrt(0.04 * 0.04 - x * x - y * y);
    EXPECT_NEAR(site->point.z(), z, 1e-4);
    EXPECT_LT((site->normal - Eigen::Vector3d(x, y, z) / 0.04).norm(), 0.01);
  }
  EXPECT_FALSE(view.highest(0.05, 0).has_value());
}

TEST(View, LosesNothingBetweenTriangles) {
  const Surface slab = box({0.1, 0.1, 0.02}, 0.01, "slab");
  const View view(slab);
  for (int i = -9; i <= 9; ++i) {
    const std::optional<Site> site = view.highest(0.005 * i, 0.005 * i);  // along diagonals and through corners
    ASSERT_TRUE(site.has_value()) << i;
    EXPECT_NEAR(site->point.z(), 0.0, 1e-12);
    if (std::abs(i) < 8) {  // the rim's normals lean
      EXPECT_GT(site->normal.z(), 0.99);
    }
  }
}

TEST(Probe, PressesToTheDepthAndLetsGo) {
  const Site site{{0.01, 0.02, 0.03}, Eigen::Vector3d(0.3, -0.2, 0.9).normalized()};
  const MotionOptions options;
  const auto rows = parse(probe_motion(site, options));
  ASSERT_EQ(rows.size(), 3001U);
  double lowest = 1, farthest = 0, quickest = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_NEAR(rows[i].orientation.norm(), 1.0, 1e-8);
    EXPECT_NEAR(rows[i].t, static_cast<double>(i) / 1000, 1e-9);
    const double h = height(rows[i], site, options.tip_offset);
    lowest = std::min(lowest, h);
    const Eigen::Vector3d tip = rows[i].position - rows[i].orientation * Eigen::Vector3d(0, 0, options.tip_offset);
    farthest = std::max(farthest, (tip - site.point - h * site.normal).norm());
    if (i > 0) quickest = std::max(quickest, (rows[i].position - rows[i - 1].position).norm() * 1000);
  }
  EXPECT_NEAR(lowest, -options.depth, 1e-7);
  EXPECT_NEAR(farthest, options.tangential, 1e-7);
  EXPECT_NEAR(height(rows.front(), site, options.tip_offset), options.clearance, 1e-7);
  EXPECT_NEAR(height(rows.back(), site, options.tip_offset), options.clearance, 1e-7);
  EXPECT_LT(quickest, 0.06);  // m/s
}

TEST(Scan, FollowsTheSurface) {
  const Surface ball = geometry::ellipsoid({0, 0, 0}, {0.04, 0.04, 0.04}, 0.002, "ball");
  const View view(ball);
  std::vector<Site> sites;
  for (int i = -10; i <= 10; ++i) sites.push_back(*view.highest(0.001 * i, 0));
  const MotionOptions options;
  const auto rows = parse(scan_motion(sites, options));
  double lowest = 1;
  for (const Row& row : rows) {
    const Eigen::Vector3d tip = row.position - row.orientation * Eigen::Vector3d(0, 0, options.tip_offset);
    lowest = std::min(lowest, tip.norm() - 0.04);
  }
  EXPECT_NEAR(lowest, -options.depth / 2, 2e-4);
  EXPECT_NEAR(rows.front().position.norm(), 0.04 + options.clearance + options.tip_offset, 2e-4);
  EXPECT_NEAR(rows.back().position.norm(), 0.04 + options.clearance + options.tip_offset, 2e-4);
}

}  // namespace
}  // namespace palpate::synth
