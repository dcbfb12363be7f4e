// SPDX-License-Identifier: GPL-3.0-or-later
// Every type of support, by named mesh, box, half-space and distance to a surface: the same part of the body, held the
// same way.
#include "formats/surface/surface_io.hpp"
#include "precompute/solve/pair/pair.hpp"
#include "precompute/surface/repair/weld.hpp"
#include "tests/support/press.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>

namespace palpate::solve {
namespace {

using Eigen::Vector3d;
using Kind = SupportScene::Kind;
using Type = SupportScene::Type;

constexpr double kHalf = 0.02;

// The block's bottom is a mesh of its own.
Surface block() {
  Surface s = test::box_surface({-kHalf, -kHalf, -kHalf}, {kHalf, kHalf, 0}, 6);
  s.part_names = {"block", "bottom"};
  for (std::size_t t = 0; t < s.triangles.size(); ++t) {
    bool low = true;
    for (const auto v : s.triangles[t]) low = low && s.vertices[std::size_t(v)].z() < -kHalf + 1e-9;
    s.parts[t] = low ? 1 : 0;
  }
  return s;
}

class SupportKinds : public ::testing::TestWithParam<Type> {};

TEST_P(SupportKinds, HoldTheSamePartAlike) {
  const test::TemporaryFolder folder;
  const Surface table = test::box_surface({-0.1, -0.1, -0.04}, {0.1, 0.1, -kHalf - 0.001});
  write_surface(table, folder.path() / "table.ply");
  const auto support = [&](Kind kind) {
    SupportScene s;
    s.kind = kind;
    s.type = GetParam();
    s.stiffness = s.type == Type::spring ? 3e5 : 0.0;
    s.mesh = "bottom";
    s.box_min = {-1, -1, -1};
    s.box_max = {1, 1, -kHalf + 1e-6};
    s.point = {0, 0, -kHalf + 1e-6};
    s.other.file = folder.path() / "table.ply";
    s.within = 0.001 + 1e-6;
    return s;
  };
  std::vector<Vector3d> forces;
  for (const Kind kind : {Kind::half_space, Kind::box, Kind::distance, Kind::mesh}) {
    Scene scene;
    scene.body.surfaces.emplace_back();
    scene.friction = 0;
    scene.sampling.normal_points = 4;
    scene.supports = {support(kind)};
    if (GetParam() == Type::slider) {  // what it leaves free is held at two sides, by sliders too
      for (const Vector3d& n : {Vector3d(1, 0, 0), Vector3d(0, 1, 0)}) {
        scene.supports.push_back(test::half_space(Type::slider, -(kHalf - 1e-6) * n, n));
      }
    }
    const Body body = prepare_body(scene, block());
    const SupportScene* below = body.support_at({0.001, 0.002, -kHalf});
    ASSERT_NE(below, nullptr);
    EXPECT_EQ(below->kind, kind);
    EXPECT_EQ(body.support_at({0.001, 0.002, 0}), nullptr);
    PairOptions options = pair_options(scene);
    options.mesh_size = 0.45;
    options.growth = 0.8;
    options.max_size = kHalf / 2;
    const PairResult r = test::press(body, ToolScene{}, bake_path(scene, 0.003), options);
    ASSERT_TRUE(r.outcome.accepted) << r.outcome.cause;
    forces.push_back(r.samples.back().force);
  }
  for (const Vector3d& f : forces) {
    EXPECT_GT(f.z(), 0);
    // The rim that meshes are refined along is found to a few micrometres: it may differ by so much.
    EXPECT_LT((f - forces[0]).norm(), 0.01 * forces[0].norm());
  }
}

INSTANTIATE_TEST_SUITE_P(
    Types, SupportKinds, ::testing::Values(Type::fixed, Type::spring, Type::slider), [](const auto& type) {
      return std::string(type.param == Type::fixed ? "Fixed" : type.param == Type::spring ? "Spring" : "Slider");
    });

}  // namespace
}  // namespace palpate::solve
