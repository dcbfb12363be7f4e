// SPDX-License-Identifier: GPL-3.0-or-later
// Error estimates from two meshes: which samples get which difference.
#include "precompute/solve/pair/error_estimate.hpp"

#include "precompute/solve/pair/sample_difference.hpp"

#include <gtest/gtest.h>

namespace palpate::solve {
namespace {

using Eigen::Vector3d;

Sample sample(SampleKind kind, std::uint16_t index, const Vector3d& deflection, const Vector3d& force) {
  Sample s;
  s.kind = kind;
  s.index = index;
  s.deflection = deflection;
  s.force = force;
  s.error_estimate = 0.001;
  return s;
}

// Normal indentations of F = d (mm, N) to 1, 2 and 4 mm; the other mesh's force at each is `factors` times as large.
std::vector<Sample> normal_indentation(const Vector3d& factors) {
  std::vector<Sample> samples;
  for (int k = 0; k < 3; ++k) {
    const double depth = 1 << k;
    samples.push_back(sample(SampleKind::normal, std::uint16_t(k), {0, 0, 1e-3 * depth}, {0, 0, factors[k] * depth}));
  }
  return samples;
}

TEST(MeshError, NormalIndentationsTakeTheLargestOfTheNeighbouringDepths) {
  std::vector<Sample> samples = normal_indentation({1, 1, 1});
  ASSERT_TRUE(add_mesh_errors(samples, normal_indentation({1, 1.25, 1}), 0.5));
  // Only the middle depth differs, by a fifth of the other's force.
  for (const Sample& s : samples) EXPECT_NEAR(s.error_estimate, 0.001 + 0.5 * 0.2, 1e-12);
  samples = normal_indentation({1, 1, 1});
  ASSERT_TRUE(add_mesh_errors(samples, normal_indentation({1, 1, 1.25}), 1));
  EXPECT_NEAR(samples[0].error_estimate, 0.001, 1e-12);
  EXPECT_NEAR(samples[2].error_estimate, 0.001 + 0.2, 1e-12);
}

TEST(MeshError, TangentialPushesAddTheirShareOfTheTangentialDifference) {
  std::vector<Sample> samples = normal_indentation({1, 1, 1}), other = samples;
  samples.push_back(sample(SampleKind::tangential, 0, {1e-3, 0, 4e-3}, {-1, 0, 4}));
  samples.push_back(sample(SampleKind::path, 0, {2e-3, 0, 4e-3}, {-3, 0, 4}));
  other.push_back(sample(SampleKind::tangential, 0, {1e-3, 0, 4e-3}, {-0.8, 0, 4}));
  ASSERT_TRUE(add_mesh_errors(samples, other, 1));
  EXPECT_NEAR(samples[2].error_estimate, 0.001, 1e-12);
  EXPECT_NEAR(samples[3].error_estimate, 0.001 + 0.25 * 1 / std::hypot(1, 4), 1e-12);
  EXPECT_NEAR(samples[4].error_estimate, 0.001 + 0.25 * 3 / 5, 1e-12);
}

// With little friction a tool is moved aside by far less than it is deep.
TEST(SampleDifference, APushAsideHasNoPartnerInOneTheOtherWay) {
  const Sample right = sample(SampleKind::tangential, 0, {1e-4, 0, 4e-3}, {-0.3, 0, 4});
  const Sample left = sample(SampleKind::tangential, 1, {-1e-4, 0, 4e-3}, {0.3, 0, 4});
  const Sample nearly = sample(SampleKind::tangential, 0, {1.1e-4, 0, 4.1e-3}, {-0.3, 0, 4});
  EXPECT_EQ(sample_difference({right}, {left}).compared, 0U);
  EXPECT_EQ(sample_difference({right}, {left, nearly}).samples.at(0).other, 1U);
}

TEST(MeshError, NothingIsAddedWhereNoDepthIsSolvedOnBoth) {
  std::vector<Sample> samples = normal_indentation({1, 1, 1});
  EXPECT_FALSE(add_mesh_errors(samples, {}, 1));
  EXPECT_FALSE(add_mesh_errors(samples, {sample(SampleKind::normal, 0, {0, 0, 8e-3}, {0, 0, 8})}, 1));
  for (const Sample& s : samples) EXPECT_EQ(s.error_estimate, 0.001);
}

TEST(MeshError, TheComparedPathHasOneShortTangentialMoveADepth) {
  PairPath path;
  path.normal_depths = {1e-3, 2e-3};
  path.tangential_depths = {1e-3, 2e-3};
  path.tangential_directions = 4;
  path.tangential_points = 3;
  path.tangential_reach = 0.6;
  path.grasp_depth = 1e-3;
  path.slip_points = 2;
  const PairPath compared = compared_path(path);
  EXPECT_EQ(compared.normal_depths, path.normal_depths);
  EXPECT_EQ(compared.tangential_depths, path.tangential_depths);
  EXPECT_EQ(compared.tangential_directions, 1);
  EXPECT_EQ(compared.tangential_points, 1);
  EXPECT_NEAR(compared.tangential_reach, 0.2, 1e-12);
  EXPECT_EQ(compared.grasp_depth, 0);
  EXPECT_EQ(compared.slip_points, 0);
}

}  // namespace
}  // namespace palpate::solve
