// SPDX-License-Identifier: GPL-3.0-or-later
// prepare_body: files joined, inclusions placed, supports checked, coarse copies made.
#include "formats/surface/surface_io.hpp"
#include "precompute/common/body.hpp"
#include "precompute/geometry/intersections.hpp"
#include "precompute/geometry/topology.hpp"
#include "precompute/sites/haptic_mesh.hpp"
#include "precompute/surface/repair/examine.hpp"
#include "tests/surface/faulty_shapes.hpp"

#include <cstdlib>
#include <filesystem>
#include <numbers>

namespace palpate::test {
namespace {

class Prepare : public testing::Test {
protected:
  void SetUp() override {
    auto pattern = (std::filesystem::temp_directory_path() / "palpate-XXXXXX").string();
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    scene_.file = folder_ / "scene.toml";
    scene_.body.surfaces = {file("cube", cube())};
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  SurfaceSource file(const std::string& name, const Surface& surface) const {
    const auto path = folder_ / (name + ".ply");
    write_surface(surface, path);
    return {path, {}, 1.0};
  }

  void expect_refused(const std::vector<std::string>& pieces) const {
    expect_error([&] { prepare_body(scene_); }, ExitCode::bad_input, pieces);
  }

  SupportScene& support(SupportScene::Kind kind) {
    scene_.supports.emplace_back();
    scene_.supports.back().kind = kind;
    return scene_.supports.back();
  }

  RegionScene& add_region(const std::string& name, const SurfaceSource& surface) {
    RegionScene& region = scene_.regions.emplace_back();
    region.name = name;
    region.surface = surface;
    return region;
  }

  std::filesystem::path folder_;
  Scene scene_;
};

TEST_F(Prepare, PlainCubeWithTheDefaultSupport) {
  scene_.material.young = 1234;
  scene_.material.poisson = 0.3;
  const Body body = prepare_body(scene_);
  EXPECT_EQ(body.report.action, "used as it is");
  EXPECT_NEAR(body.report.volume, 0.008, 1e-8);
  EXPECT_NEAR(body.diagonal, 0.2 * std::sqrt(3.0), 1e-7);
  EXPECT_EQ(body.material.young, 1234);
  EXPECT_TRUE(body.inclusions.empty());
  ASSERT_EQ(body.supports.size(), 1U);
  EXPECT_TRUE(body.held({0.1, 0.1, 0.0}));
  EXPECT_TRUE(body.held({0.0, 0.1, 0.0199}));
  EXPECT_FALSE(body.held({0.0, 0.1, 0.0201}));
  EXPECT_FALSE(body.held({0.1, 0.1, 0.2}));
  EXPECT_TRUE(surface::examine(body.base).clean());
  EXPECT_GT(body.base.triangles.size(), 2000U);
  EXPECT_LT(body.base.triangles.size(), 8000U);
  EXPECT_NEAR(surface_volume(body.base), 0.008, 1e-4);
}

TEST_F(Prepare, NamedMeshesFromTwoFilesAndAMeshSupport) {
  const auto [box, lid] = cube_and_lid(0);
  scene_.body.surfaces = {file("box", box), file("lid", lid)};
  support(SupportScene::Kind::mesh).mesh = "lid";
  const Body body = prepare_body(scene_);
  EXPECT_EQ(body.report.action, "repaired");
  EXPECT_NEAR(body.report.volume, 0.008, 1e-8);
  EXPECT_TRUE(body.held({0.1, 0.1, 0.2}));
  EXPECT_FALSE(body.held({0.1, 0.0, 0.1}));
  scene_.supports[0].mesh = "bottom";
  expect_refused({"scene.toml", "support 1", "'bottom'", "box, lid"});
}

TEST_F(Prepare, UncleanSurfaceInModeNone) {
  scene_.body.repair = RepairMode::none;
  scene_.body.surfaces = {file("holed", small_hole())};
  expect_refused({"holed.ply", "3 boundary edges"});
}

TEST_F(Prepare, SupportsOfEveryKind) {
  auto& box = support(SupportScene::Kind::box);
  box.box_min = {-1, -1, 0.15};
  box.box_max = {1, 1, 1};
  auto& distance = support(SupportScene::Kind::distance);
  distance.other = file("bone", box_surface({-0.1, 0, 0}, {-0.005, 0.2, 0.1}));
  distance.within = 0.01;
  auto& half = support(SupportScene::Kind::half_space);
  half.point = {0.2, 0, 0};
  half.normal = {-1, 0, 0};
  const Body body = prepare_body(scene_);
  EXPECT_EQ(body.support_surfaces[0], nullptr);
  EXPECT_NE(body.support_surfaces[1], nullptr);
  EXPECT_TRUE(body.held({0.1, 0.1, 0.2}));   // box
  EXPECT_TRUE(body.held({0.0, 0.1, 0.05}));  // distance
  EXPECT_TRUE(body.held({0.2, 0.1, 0.05}));  // half space
  EXPECT_FALSE(body.held({0.1, 0.0, 0.05}));
  EXPECT_FALSE(body.held({0.0, 0.1, 0.13}));
}

TEST_F(Prepare, SupportsThatHoldNothingOrEverything) {
  auto& box = support(SupportScene::Kind::box);
  box.box_min = {1, 1, 1};
  box.box_max = {2, 2, 2};
  expect_refused({"scene.toml", "support 1", "holds no point"});
  box.box_min = {-1, -1, -1};
  expect_refused({"scene.toml", "whole surface"});
  box.box_max = {0.1, 1, 1};
  EXPECT_NO_THROW(prepare_body(scene_));
  auto& half = support(SupportScene::Kind::half_space);
  half.point = {0, 0, -1};
  expect_refused({"scene.toml", "support 2", "holds no point"});
}

TEST_F(Prepare, SupportInsideALargeTriangleHolds) {
  for (const SupportScene::Type type : {SupportScene::Type::fixed, SupportScene::Type::spring}) {
    scene_.supports.clear();
    auto& box = support(SupportScene::Kind::box);
    box.type = type;
    box.stiffness = 1e6;
    box.box_min = {0.02, 0.12, -1};
    box.box_max = {0.06, 0.16, 0.001};
    EXPECT_NO_THROW(prepare_body(scene_));
    box.type = SupportScene::Type::slider;
    expect_refused({"scene.toml", "free to slide along"});
  }
}

TEST_F(Prepare, EveryComponentMustBeHeld) {
  const Surface ball = named(sphere_surface({0.5, 0.1, 0.1}, 0.05), "ball");
  scene_.body.surfaces = {file("cube", cube()), file("ball", ball)};
  auto& floor = support(SupportScene::Kind::half_space);
  floor.point = {0, 0, 0.01};
  floor.normal = {0, 0, 1};
  expect_refused({"scene.toml", "component 2 of 2", "mL round (0.5, 0.1, 0.1)", "float away"});
  floor.point.z() = 0.06;
  EXPECT_NO_THROW(prepare_body(scene_));
  // The wall of a cavity is a component of the surface, not of the body.
  Surface inward = sphere_surface({0.1, 0.1, 0.1}, 0.03);
  for (auto& t : inward.triangles) std::swap(t[1], t[2]);
  scene_.body.surfaces = {file("cube", cube()), file("hollow", inward)};
  const Body hollow = prepare_body(scene_);
  EXPECT_TRUE(hollow.in_cavity({0.1, 0.1, 0.125}));
  EXPECT_FALSE(hollow.in_cavity({0.1, 0.1, 0.19}));
  scene_.sampling.spacing = 0.015;
  scene_.sampling.depth = 0.1;
  bool over = false;
  const sites::HapticMesh sites = sites::make_haptic_mesh(scene_, hollow);
  std::size_t inner = 0;
  for (std::size_t k = 0; k < sites.points.size(); ++k) {
    const bool in_wall = (sites.points[k] - Eigen::Vector3d(0.1, 0.1, 0.1)).norm() < 0.035;
    inner += in_wall;
    EXPECT_EQ(sites.selected[k] != 0, !in_wall);
    // Over the cavity a push bends the wall: what it could squeeze ends where the cavity does.
    if (std::abs(sites.normals[k].z()) < 0.99 ||
        (sites.points[k] - Eigen::Vector3d(0.1, 0.1, 0.1)).head<2>().norm() > 0.01)
      continue;
    over = true;
    EXPECT_NEAR(sites.thickness[k], 0.07, 0.003);
    EXPECT_NEAR(sites.depth[k], 0.6 * 0.13, 0.003);
  }
  EXPECT_TRUE(over);
  EXPECT_GT(inner, 3U);
  // The default support holds the lowest tenth; what it does not reach floats, too.
  scene_.body.surfaces = {file("cube", cube()), file("ball", ball)};
  scene_.supports.clear();
  expect_refused({"scene.toml", "component 2 of 2", "float away"});
}

TEST_F(Prepare, SupportsMustLeaveNoRigidMotionFree) {
  const auto slider = [&](const Eigen::Vector3d& normal) {
    auto& half = support(SupportScene::Kind::half_space);
    half.type = SupportScene::Type::slider;
    half.point = 0.001 * normal;
    half.normal = normal;
  };
  slider({0, 0, 1});
  expect_refused({"scene.toml", "component 1 of 1", "free to slide along"});
  slider({0, 1, 0});
  expect_refused({"free to slide along", "0, 0)"});
  slider({1, 0, 0});
  EXPECT_NO_THROW(prepare_body(scene_));
  scene_.supports.resize(1);
  scene_.supports[0].type = SupportScene::Type::spring;
  scene_.supports[0].stiffness = 1e4;
  EXPECT_NO_THROW(prepare_body(scene_));
}

TEST_F(Prepare, Inclusions) {
  add_region("tumour", file("a", sphere_surface({0.06, 0.1, 0.1}, 0.03))).material.young = 5e4;
  add_region("vessel", file("b", inside_out()));
  // An inside-out inclusion is turned; scaled to a sixth it fits beside the first.
  scene_.regions[1].surface.unit = 1.0;
  Surface small = inside_out();
  for (auto& v : small.vertices) v = v / 6 + Eigen::Vector3d(0.13, 0.1, 0.1);
  write_surface(small, scene_.regions[1].surface.file);
  const Body body = prepare_body(scene_);
  ASSERT_EQ(body.inclusions.size(), 2U);
  EXPECT_EQ(body.inclusions[0].name, "tumour");
  EXPECT_EQ(body.inclusions[0].material.young, 5e4);
  for (const auto& inclusion : body.inclusions) {
    EXPECT_TRUE(surface::examine(inclusion.base).clean());
    EXPECT_EQ(geometry::crossings(inclusion.base, body.base), 0U);
    EXPECT_LT(inclusion.query->signed_distance(inclusion.name == "tumour" ? Eigen::Vector3d(0.06, 0.1, 0.1)
                                                                          : Eigen::Vector3d(0.14, 0.11, 0.11)),
              0);
  }
  EXPECT_EQ(geometry::crossings(body.inclusions[0].base, body.inclusions[1].base), 0U);
}

TEST_F(Prepare, RegionsByTheirMeasures) {
  scene_.regions.reserve(2);
  RegionScene& ball = add_region("ball", {});
  ball.shape = RegionScene::Shape::ellipsoid;
  ball.centre = {0.06, 0.06, 0.06};
  ball.radii = {0.02, 0.03, 0.02};
  RegionScene& block = add_region("block", {});
  block.shape = RegionScene::Shape::box;
  block.box_min = {0.12, 0.12, 0.12};
  block.box_max = {0.15, 0.16, 0.17};
  const Body body = prepare_body(scene_);
  ASSERT_EQ(body.inclusions.size(), 2U);
  const double exact = 4.0 / 3 * std::numbers::pi * 0.02 * 0.03 * 0.02;
  EXPECT_NEAR(geometry::signed_volume(body.inclusions[0].query->surface()) / exact, 1.0, 0.05);
  EXPECT_NEAR(geometry::signed_volume(body.inclusions[1].query->surface()), 0.03 * 0.04 * 0.05, 1e-12);
  scene_.regions[0].centre.x() = 0.015;
  expect_refused({"region 'ball'", "intersects the body's surface"});
}

TEST_F(Prepare, InclusionsThatDoNotFit) {
  const auto place = [&](const Surface& s) {
    scene_.regions.clear();
    add_region("tumour", file("tumour", s));
  };
  place(sphere_surface({0.0, 0.1, 0.1}, 0.03));
  expect_refused({"'tumour'", "tumour.ply", "intersects the body"});
  place(sphere_surface({0.5, 0.1, 0.1}, 0.03));
  expect_refused({"'tumour'", "outside"});
  place(sphere_surface({0.1, 0.1, 0.1}, 0.5));
  expect_refused({"'tumour'", "outside"});
  place(sphere_surface({0.1, 0.1, 0.1}, 0.03));
  add_region("second", file("second", sphere_surface({0.12, 0.1, 0.1}, 0.03)));
  expect_refused({"'second'", "intersects region 'tumour'"});
  scene_.regions[1].surface = file("second", sphere_surface({0.1, 0.1, 0.1}, 0.01));
  expect_refused({"'second'", "inside region 'tumour'"});
}

TEST_F(Prepare, MissingFileAndEmptyScene) {
  scene_.body.surfaces[0].file = folder_ / "none.ply";
  expect_error([&] { prepare_body(scene_); }, ExitCode::io, {"none.ply"});
  scene_.body.surfaces.clear();
  expect_refused({"scene.toml", "no surface"});
}

TEST_F(Prepare, SameBytesEveryTime) {
  scene_.body.surfaces = {file("two", overlapping())};
  scene_.body.wrap_alpha = 0.02;
  const Body a = prepare_body(scene_), b = prepare_body(scene_);
  EXPECT_EQ(a.query->surface().vertices, b.query->surface().vertices);
  EXPECT_EQ(a.base.vertices, b.base.vertices);
  EXPECT_EQ(a.base.triangles, b.base.triangles);
}

}  // namespace
}  // namespace palpate::test
