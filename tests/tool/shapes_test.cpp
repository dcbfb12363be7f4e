// SPDX-License-Identifier: GPL-3.0-or-later
// Signed distances of the tools and the poses of their contact vertices.
#include "precompute/tool/shapes.hpp"
#include "precompute/tool/taper.hpp"

#include "precompute/tool/tool.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <string>

namespace palpate::tool {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

TEST(Shapes, GradientAndHessianMatchDifferences) {
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> coordinate(-1.6, 1.6);
  for (const auto& shape : {make_sphere(0.7), make_capsule(0.5, 0.8), make_punch(0.8, 0.2, 1.5),
                            make_taper(0.15, 0.5, 0.5, 1.2), make_taper(0.1, 1.2, HUGE_VAL, 0.4)}) {
    int checked = 0;
    for (int k = 0; k < 400; ++k) {
      const Vector3d p(coordinate(engine), coordinate(engine), coordinate(engine));
      const DistanceSample s = shape->distance(p);
      const double step = 1e-5;
      Vector3d slope;
      Matrix3d bend;
      for (int i = 0; i < 3; ++i) {
        const DistanceSample up = shape->distance(p + step * Vector3d::Unit(i));
        const DistanceSample down = shape->distance(p - step * Vector3d::Unit(i));
        slope[i] = (up.value - down.value) / (2 * step);
        bend.col(i) = (up.gradient - down.gradient) / (2 * step);
      }
      EXPECT_NEAR(s.gradient.norm(), 1.0, 1e-12);
      if ((bend - s.hessian).norm() > 1) continue;  // straddles a seam of the distance function
      ++checked;
      EXPECT_LT((slope - s.gradient).norm(), 1e-6) << p.transpose();
      EXPECT_LT((bend - s.hessian).norm(), 1e-4) << p.transpose();
    }
    EXPECT_GT(checked, 380);
  }
}

TEST(Shapes, KnownDistances) {
  EXPECT_NEAR(make_sphere(0.5)->distance({0, 0, -2}).value, 1.5, 1e-15);
  EXPECT_NEAR(make_capsule(0.5, 2)->distance({1, 0, 1}).value, 0.5, 1e-15);
  EXPECT_NEAR(make_capsule(0.5, 2)->distance({0, 0, 3}).value, 0.5, 1e-15);
  EXPECT_NEAR(make_punch(1, 0.1, 3)->distance({0.3, 0.2, -0.25}).value, 0.25, 1e-15);
  EXPECT_NEAR(make_punch(1, 0.1, 3)->distance({2, 0, 1}).value, 1.0, 1e-15);
  const auto needle = make_taper(0.1, 0.5, 0.4, 3);  // its point ends at z = 0.3 / tan 0.5 = 0.549
  EXPECT_NEAR(needle->distance({0, 0, -1}).value, 0.9, 1e-15);
  EXPECT_NEAR(needle->distance({1, 0, 2}).value, 0.6, 1e-15);
  EXPECT_NEAR(needle->distance({0, 0, 2}).value, -0.4, 1e-15);
  const Eigen::Vector3d side(std::cos(0.5), 0, -std::sin(0.5));
  EXPECT_NEAR(needle->distance(Vector3d(0.1, 0, 0.1 / std::tan(0.5)) + 0.3 * side).value, 0.2, 1e-15);
  EXPECT_LT((needle->distance(Vector3d(0.1, 0, 0.1 / std::tan(0.5)) + 0.3 * side).gradient - side).norm(), 1e-14);
  EXPECT_NEAR(needle->distance({0, 0, 4}).value, 0.9, 1e-15);
}

// Points that a contact leaves out must be beyond, and points clearly beyond should be left out.
TEST(Shapes, WhatIsSurelyBeyondIs) {
  const std::shared_ptr<const ToolShape> shapes[] = {make_sphere(0.005), make_capsule(0.004, 0.02)};
  std::mt19937 random(7);
  std::uniform_real_distribution<double> coordinate(-0.01, 0.03), gap(-0.004, 0.004);
  int beyond = 0;
  for (const auto& shape : shapes) {
    for (int n = 0; n < 20000; ++n) {
      const Vector3d p(coordinate(random), coordinate(random), coordinate(random));
      const double value = shape->distance(p).value;
      // Near the boundary too, where rounding decides.
      for (const double limit : {gap(random), value, std::nextafter(value, 0.0), value + 1e-12, value - 1e-12}) {
        const bool told = shape->surely_beyond(p, limit);
        if (told) {
          ASSERT_GE(value, limit) << p.transpose();
        }
        if (value > limit + 1e-11 && limit > -0.0039) {
          ASSERT_TRUE(told) << p.transpose() << " " << limit;
          ++beyond;
        }
      }
    }
  }
  EXPECT_GT(beyond, 10000);
}

// Every contact vertex lies on the tool's surface, its normal is the distance's gradient, and the touching
// pose puts it on the frame's origin with opposite normals and no overlap with a flat body.
TEST(Tools, ContactVerticesTouchWithOppositeNormals) {
  ContactFrame frame;
  frame.origin = {0.1, -0.2, 0.3};
  frame.n = Vector3d(1, 2, 2) / 3;
  frame.x = Vector3d(2, 1, -2) / 3;
  frame.y = frame.n.cross(frame.x);
  for (const auto kind : {ToolScene::Shape::sphere, ToolScene::Shape::punch, ToolScene::Shape::capsule,
                          ToolScene::Shape::cone, ToolScene::Shape::needle}) {
    ToolScene scene;
    scene.shape = kind;
    if (kind == ToolScene::Shape::capsule) scene.spins = 3;
    const Tool tool = make_tool(scene);
    for (const ToolVertex& v : tool.vertices) {
      const DistanceSample s = tool.shape->distance(v.point);
      EXPECT_NEAR(s.value, 0, 1e-12) << v.name;
      EXPECT_LT((s.gradient - v.normal).norm(), 1e-6) << v.name;
      EXPECT_NEAR(v.normal.dot(v.tangent), 0, 1e-12) << v.name;
      const Eigen::Isometry3d pose = touching_pose(v, frame);
      EXPECT_NEAR(pose.linear().determinant(), 1.0, 1e-12);
      EXPECT_LT((pose * v.point - frame.origin).norm(), 1e-12) << v.name;
      EXPECT_LT((pose.linear() * v.normal + frame.n).norm(), 1e-12) << v.name;
      EXPECT_LT((pose.linear() * v.tangent - frame.x).norm(), 1e-12) << v.name;
      for (int k = 0; k < 50; ++k) {
        const double angle = 0.1257 * k, reach = 0.001 * k;
        const Vector3d on = frame.origin + reach * (std::cos(angle) * frame.x + std::sin(angle) * frame.y);
        EXPECT_GT(tool.shape->distance(pose.inverse() * on).value, -1e-9) << v.name;
      }
    }
  }
}

// By the right hand about the frame's normal, from where the first spin lies; the tip is round.
TEST(Tools, SpinsTurnTheToolAboutTheContactsNormal) {
  ToolScene scene;
  scene.shape = ToolScene::Shape::capsule;
  const Tool once = make_tool(scene);
  scene.spins = 8;
  const Tool tool = make_tool(scene);
  ASSERT_EQ(tool.vertices.size(), 1 + 8 * (once.vertices.size() - 1));
  EXPECT_EQ(tool.patches.size(), once.patches.size());
  ContactFrame frame;
  frame.n = Vector3d(1, 2, 2) / 3;
  frame.x = Vector3d(2, 1, -2) / 3;
  frame.y = frame.n.cross(frame.x);
  std::set<std::string> names;
  for (std::size_t first = 0; first < tool.vertices.size();
       first += static_cast<std::size_t>(tool.vertices[first].spins)) {
    const int spins = tool.vertices[first].spins;
    EXPECT_EQ(spins, first == 0 ? 1 : 8);
    const Eigen::Matrix3d straight = touching_pose(tool.vertices[first], frame).linear();
    for (int k = 0; k < spins; ++k) {
      const ToolVertex& v = tool.vertices[first + static_cast<std::size_t>(k)];
      EXPECT_TRUE(names.insert(v.name).second) << v.name;
      EXPECT_EQ(v.spins, k == 0 ? spins : 0);
      const Eigen::Matrix3d wanted = Eigen::AngleAxisd(std::numbers::pi / 4 * k, frame.n) * straight;
      EXPECT_LT((touching_pose(v, frame).linear() - wanted).norm(), 1e-12) << v.name;
    }
  }
  for (const auto& patch : tool.patches) {
    for (const std::int32_t corner : patch) EXPECT_GT(tool.vertices[static_cast<std::size_t>(corner)].spins, 0);
  }
}

TEST(Tools, CapsuleHasTipShoulderAndStemAndInterpolatesOnItsSurface) {
  ToolScene scene;
  scene.shape = ToolScene::Shape::capsule;
  const Tool tool = make_tool(scene);
  EXPECT_GE(tool.vertices.size(), 8u);
  for (std::size_t p = 0; p < tool.patches.size(); ++p) {
    const ToolVertex v = interpolate(tool, static_cast<std::int32_t>(p), {0.35, 0.65, 0});
    EXPECT_NEAR(tool.shape->distance(v.point).value, 0, 1e-12);
    EXPECT_LT((tool.shape->distance(v.point).gradient - v.normal).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace palpate::tool
