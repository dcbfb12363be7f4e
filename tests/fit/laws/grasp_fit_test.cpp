// SPDX-License-Identifier: GPL-3.0-or-later
// Curves of a grasp from samples with a known answer.
#include "precompute/fit/laws/grasp_fit.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

#include "formats/io/error.hpp"

namespace palpate::fit::grasp_fit_test {
namespace {

constexpr double Z = 0.005;

// The gradient of an energy: stiffer in than out, off to one side, with a tangential stiffness that grows with the
// depth and has skew axes.
Eigen::Vector3d answer(const Eigen::Vector3d& d) {
  const double x = d.x(), y = d.y(), z = d.z() / Z, grows = 1 + 0.3 * z;
  const double normal = 1.2 * z + 0.4 * z * z * (z > 0 ? 1 : -0.2);
  const double coupling = (-0.1 * x + 0.05 * y + 0.5 * 0.3 * (200 * x * x + 80 * x * y + 150 * y * y)) / Z;
  return {0.1 * z - grows * (200 * x + 40 * y), -0.05 * z - grows * (40 * x + 150 * y), normal + coupling};
}

std::vector<Sample> samples(double depth) {
  std::vector<Sample> all;
  const auto add = [&](double x, double y, double z) {
    Sample s;
    s.kind = SampleKind::grasped;
    s.index = static_cast<std::uint16_t>(all.size());
    s.deflection = {x, y, z};
    s.force = answer(s.deflection);
    all.push_back(s);
  };
  add(0, 0, depth / 2);
  for (int k = -6; k <= 6; ++k) add(0, 0, depth * k / 6);
  for (const double z : {depth, 0.0, -depth}) {
    for (const double r : {0.25, 0.5}) {
      add(r * depth, 0, z);
      add(0, r * depth, z);
      add(-r * depth, 0, z);
      add(0, -r * depth, z);
    }
  }
  return all;
}

TEST(GraspFit, FindsForceAndStiffnessOnBothSidesOfTheSurface) {
  for (const double depth : {Z, 0.5 * Z}) {
    std::vector<Sample> given = samples(depth);
    Sample turned = given.back();
    turned.rotation = {0.1, 0, 0};
    turned.force *= 3;
    given.push_back(turned);  // no deflection of p
    const GraspCurves grasp = fit_grasp(given, Z, "pair");
    EXPECT_EQ(grasp.depth, depth / 2);
    EXPECT_EQ(grasp.pulled, depth);
    for (const Eigen::Vector3d& d : {Eigen::Vector3d(0, 0, -0.7 * depth), Eigen::Vector3d(0.2 * depth, 0.3 * depth, 0),
                                     Eigen::Vector3d(-0.3 * depth, 0.1 * depth, 0.4 * depth)}) {
      EXPECT_LT((evaluate(grasp, Z, d) - answer(d)).norm(), 0.02 * answer(d).norm()) << d.transpose();
    }
    std::vector<double> errors = grasp_errors(grasp, Z, given);
    EXPECT_EQ(errors.size(), given.size() - 1);
    std::nth_element(errors.begin(), errors.begin() + errors.size() / 2, errors.end());
    EXPECT_LT(errors[errors.size() / 2], 0.01);
  }
}

TEST(GraspFit, SharesOfTurnedNeighboursMakeTheSameAnswer) {
  const GraspCurves one = fit_grasp(samples(Z), Z, "pair");
  const Eigen::Vector2d turned(std::cos(0.7), std::sin(0.7));
  const GraspCurves sum = blend_grasps({{&one, 0.25, turned}, {&one, 0.75, turned}}, Z);
  EXPECT_DOUBLE_EQ(sum.depth, one.depth);
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(0.7).toRotationMatrix();
  const Eigen::Vector3d d(0.001, -0.0005, -0.002);
  const Eigen::Vector2d back = turn.transpose() * d.head<2>();
  const Eigen::Vector3d own = evaluate(one, Z, {back.x(), back.y(), d.z()}), carried = evaluate(sum, Z, d);
  EXPECT_LT((carried.head<2>() - turn * own.head<2>()).norm(), 1e-9);
  EXPECT_NEAR(carried.z(), own.z(), 1e-9);
}

TEST(GraspFit, RefusesWhatIsTooLittleOrNoNumber) {
  EXPECT_THROW(fit_grasp({}, Z, "pair"), Error);
  std::vector<Sample> few = samples(Z);
  few.resize(2);
  EXPECT_THROW(fit_grasp(few, Z, "pair"), Error);
  std::vector<Sample> broken = samples(Z);
  broken[3].force.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(fit_grasp(broken, Z, "pair"), Error);
  std::vector<Sample> idle = samples(Z);
  for (Sample& s : idle) s.force.setZero();
  EXPECT_THROW(fit_grasp(idle, Z, "pair"), Error);
}

}  // namespace
}  // namespace palpate::fit::grasp_fit_test
