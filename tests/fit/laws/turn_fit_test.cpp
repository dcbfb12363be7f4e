// SPDX-License-Identifier: GPL-3.0-or-later
// Curves of a turned grasp from samples of a known energy.
#include "precompute/fit/laws/turn_fit.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "formats/io/error.hpp"
#include "palpate/format/bonded_rules.hpp"

namespace palpate::fit::turn_fit_test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Coupling = Eigen::Matrix<double, 2, 3>;

constexpr double Z = 0.005;

struct Answer {
  Vector3d force, torque;
};

// The gradient of W = 1.2 z^2 / (2 Z) + g(z) (100 x^2 + 90 y^2) - T . theta + g(z) (e C theta + theta K theta / 2), its
// stiffnesses growing with the depth; the torque by J^-T from the rotation itself, solved for.
Answer answer(const Vector3d& d, const Vector3d& theta) {
  const double z = d.z() / Z, grows = 1 + 0.2 * z;
  const Vector3d torque = 1e-4 * Vector3d(1 + z, -2 * z, 0.5), slope = 1e-4 / Z * Vector3d(1, -2, 0);
  Matrix3d k;
  k << 4e-3, 3e-4, -2e-4, 3e-4, 3.5e-3, 1e-4, -2e-4, 1e-4, 6e-3;
  Coupling c;
  c << 0.05, 0.4, 0.02, -0.35, 0.03, 0.01;
  const Eigen::Vector2d e = d.head<2>(), stiff(200 * e.x(), 180 * e.y());
  const Eigen::Vector2d tangential = -grows * (stiff + c * theta);
  const double rise = 0.2 / Z * (0.5 * e.dot(stiff) + e.dot(c * theta) + 0.5 * theta.dot(k * theta));
  const Vector3d by_theta = -torque + grows * (c.transpose() * e + k * theta);
  Matrix3d jacobian = Matrix3d::Identity();
  if (const double a = theta.norm(); a > 0) {
    Matrix3d cross;
    cross << 0, -theta.z(), theta.y(), theta.z(), 0, -theta.x(), -theta.y(), theta.x(), 0;
    jacobian += (1 - std::cos(a)) / (a * a) * cross + (a - std::sin(a)) / (a * a * a) * cross * cross;
  }
  return {{tangential.x(), tangential.y(), 1.2 * z - slope.dot(theta) + rise},
          -jacobian.transpose().inverse() * by_theta};
}

std::vector<Sample> samples(double angle = 0.3) {
  std::vector<Sample> all;
  const auto add = [&](const Vector3d& d, const Vector3d& theta) {
    Sample s;
    s.kind = SampleKind::grasped;
    s.index = static_cast<std::uint16_t>(all.size());
    s.deflection = d;
    s.rotation = theta;
    const Answer a = answer(d, theta);
    s.force = a.force;
    s.torque = a.torque;
    all.push_back(s);
  };
  add({0, 0, Z / 2}, Vector3d::Zero());
  for (int k = -6; k <= 6; ++k) add({0, 0, Z * k / 6}, Vector3d::Zero());
  for (const double z : {Z, 0.0, -Z}) {
    for (const double r : {0.25, 0.5}) {
      for (const auto& [x, y] : {std::pair{r, 0.0}, {0.0, r}, {-r, 0.0}, {0.0, -r}}) {
        add({x * Z, y * Z, z}, Vector3d::Zero());
      }
    }
    for (int k = 0; k < 6; ++k) add({0, 0, z}, (k < 3 ? angle : -angle) * Vector3d::Unit(k % 3));
  }
  return all;
}

TEST(TurnFit, FindsTorqueStiffnessAndCoupling) {
  const std::vector<Sample> given = samples();
  const GraspCurves grasp = fit_grasp(given, Z, "pair");
  const TurnCurves turn = fit_turns(given, grasp, Z, "pair");
  EXPECT_NEAR(turn.turned, 0.3, 1e-12);
  for (const double e : turn_errors(grasp, turn, Z, given)) EXPECT_LT(e, 0.01);
  // Moved and turned at once, about no axis and at no depth of the samples.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int k = 0; k < 50; ++k) {
    const Vector3d d = Z * Vector3d(0.4 * unit(random), 0.4 * unit(random), 0.9 * unit(random));
    const Vector3d theta = 0.17 * Vector3d(unit(random), unit(random), unit(random));
    const Vector3d torque = answer(d, theta).torque;
    EXPECT_LT((evaluate_torque(grasp, turn, Z, d, theta) - torque).norm(), 0.02 * torque.norm() + 2e-5);
  }
}

void expect_stored(const GraspCurves& grasp, const TurnCurves& turn) {
  const Eigen::VectorXf move = grasp.curves.cast<float>(), curves = turn.curves.cast<float>();
  EXPECT_STREQ(bonded::broken_torque(move.data(), curves.data(), kGraspCoefs), nullptr);
}

// The stored coefficients are valid, also for noise that no energy has, and for a coupling that is too large for a
// bounded energy.
TEST(TurnFit, KeepsTheEnergyBoundedWhateverTheSamplesSay) {
  std::vector<Sample> coupled = samples();
  for (Sample& s : coupled) s.torque.y() -= 20 * 0.4 * s.deflection.x();
  const GraspCurves plain = fit_grasp(coupled, Z, "pair");
  const TurnCurves less = fit_turns(coupled, plain, Z, "pair");
  expect_stored(plain, less);
  EXPECT_LT(less.curves[10 * kGraspCoefs + 3], 1.0);  // N, of the 8.4 that the samples have
  std::mt19937 random(9);
  std::normal_distribution<double> noise;
  for (const double size : {0.1, 1.0, 10.0}) {
    std::vector<Sample> given = samples();
    for (Sample& s : given) {
      for (int k = 0; k < 3; ++k) s.torque[k] *= 1 + size * noise(random);
    }
    const GraspCurves grasp = fit_grasp(given, Z, "pair");
    TurnCurves turn;
    try {
      turn = fit_turns(given, grasp, Z, "pair");
    } catch (const Error& error) {
      EXPECT_GT(size, 0.1) << error.what();
      continue;
    }
    expect_stored(grasp, turn);
  }
}

TEST(TurnFit, SharesOfTurnedNeighboursMakeTheSameAnswer) {
  const std::vector<Sample> given = samples();
  const GraspCurves grasp = fit_grasp(given, Z, "pair");
  const TurnCurves one = fit_turns(given, grasp, Z, "pair");
  const Eigen::Vector2d axis(std::cos(0.7), std::sin(0.7));
  const GraspCurves moved = blend_grasps({{&grasp, 0.25, axis}, {&grasp, 0.75, axis}}, Z);
  const TurnCurves sum = blend_turns({{&one, 0.25, axis}, {&one, 0.75, axis}}, Z);
  EXPECT_DOUBLE_EQ(sum.turned, one.turned);
  const Matrix3d turn = Eigen::AngleAxisd(0.7, Vector3d::UnitZ()).toRotationMatrix();
  const Vector3d d(0.001, -0.0005, -0.002), theta(0.1, 0.05, -0.2);
  const Vector3d own = evaluate_torque(grasp, one, Z, turn.transpose() * d, turn.transpose() * theta);
  EXPECT_LT((evaluate_torque(moved, sum, Z, d, theta) - turn * own).norm(), 1e-12);
}

TEST(TurnFit, RefusesWhatIsTooLittleOrNoNumber) {
  const std::vector<Sample> good = samples();
  const GraspCurves grasp = fit_grasp(good, Z, "pair");
  const auto refused = [&](const std::vector<Sample>& given) {
    try {
      fit_turns(given, grasp, Z, "pair");
    } catch (const Error&) {
      return true;
    }
    return false;
  };
  EXPECT_FALSE(refused(good));
  EXPECT_TRUE(refused({}));
  std::vector<Sample> rolls = good;
  rolls.erase(std::remove_if(rolls.begin(), rolls.end(), [](const Sample& s) { return s.rotation.z() != 0; }),
              rolls.end());
  EXPECT_TRUE(refused(rolls));
  std::vector<Sample> broken = good;
  broken[3].torque.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refused(broken));
  std::vector<Sample> idle = good;
  for (Sample& s : idle) s.torque.setZero();
  EXPECT_TRUE(refused(idle));
  EXPECT_TRUE(refused(samples(1.2)));
}

}  // namespace
}  // namespace palpate::fit::turn_fit_test
