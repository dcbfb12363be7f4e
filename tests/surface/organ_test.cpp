// SPDX-License-Identifier: GPL-3.0-or-later
// Three real organs. Their files are not part of the project (licence and size): the folder comes from the
// variable PALPATE_ORGANS, and without it these tests report themselves skipped.
#include "formats/surface/surface_io.hpp"
#include "precompute/common/body.hpp"
#include "precompute/surface/repair/clean.hpp"
#include "precompute/surface/repair/examine.hpp"
#include "precompute/surface/repair/report.hpp"
#include "tests/surface/faulty_shapes.hpp"

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <iostream>

namespace palpate::test {
namespace {

class Organ : public testing::Test {
protected:
  void SetUp() override {
    const char* folder = std::getenv("PALPATE_ORGANS");
    if (!folder || !std::filesystem::exists(folder)) GTEST_SKIP() << "PALPATE_ORGANS names no folder with organ files";
    folder_ = folder;
  }

  Scene scene(const std::string& file, const std::vector<std::string>& meshes) const {
    Scene result;
    result.file = "scene.toml";
    result.body.surfaces = {{folder_ / file, meshes, 1.0}};
    return result;
  }

  static Body prepared(const Scene& scene) {
    const auto start = std::chrono::steady_clock::now();
    Body body = prepare_body(scene);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::cout << surface::text(body.report) << "  base: " << body.base.triangles.size() << " triangles, edge "
              << body.base_size * 1e3 << " mm; prepared in " << seconds.count() << " s\n";
    EXPECT_TRUE(surface::examine(body.query->surface()).clean());
    EXPECT_TRUE(surface::examine(body.base).clean());
    EXPECT_GT(body.base.triangles.size(), 2000U);
    EXPECT_LT(body.base.triangles.size(), 9000U);
    return body;
  }

  std::filesystem::path folder_;
};

TEST_F(Organ, LiverCapsuleClosedByItsBareArea) {
  auto liver = scene("VH_F_Liver.glb", {"VH_F_capsule_of_the_liver", "VH_F_bare_area_of_liver"});
  liver.supports.resize(1);
  liver.supports[0].kind = SupportScene::Kind::mesh;
  liver.supports[0].mesh = "VH_F_bare_area_of_liver";
  const Body body = prepared(liver);
  EXPECT_EQ(body.report.action, "repaired");
  EXPECT_EQ(body.report.vertices, 17951U);
  EXPECT_EQ(body.report.triangles, 35898U);
  EXPECT_NEAR(body.report.volume, 2138e-6, 1e-6);
  EXPECT_LE(body.report.largest_move, 1e-9);
  EXPECT_FALSE(body.report.thin_bag);
}

TEST_F(Organ, LiverCapsuleAloneIsOpen) {
  auto alone = scene("VH_F_Liver.glb", {"VH_F_capsule_of_the_liver"});
  alone.body.repair = RepairMode::none;
  expect_error([&] { prepare_body(alone); }, ExitCode::bad_input, {"VH_F_Liver.glb", "230 boundary edges in 1 loop"});
  alone.body.repair = RepairMode::repair;
  expect_error([&] { prepare_body(alone); }, ExitCode::bad_input, {"VH_F_Liver.glb", "230 boundary edges in 1 loop"});
}

TEST_F(Organ, Ovary) {
  const Body body = prepared(scene("VH_F_Ovary_L.glb", {}));
  EXPECT_EQ(body.report.action, "used as it is");
  EXPECT_EQ(body.report.triangles, 424U);
  EXPECT_NEAR(body.report.volume, 1.0e-6, 0.01e-6);
}

TEST_F(Organ, KidneyCapsuleAloneIsRefusedAsAThinBag) {
  const auto input = read_surface({folder_ / "VH_M_Kidney_L.glb", {"VH_M_kidney_capsule_L"}, 1.0});
  expect_error(
      [&] {
        surface::clean_surface(input, {RepairMode::automatic, 0.005, 0}, "kidney");
      },
      ExitCode::bad_input, {"kidney", "no rim is flat enough", "not a solid"});
}

TEST_F(Organ, KidneyIsASolidWithItsInnerMeshes) {
  const Body body =
      prepared(scene("VH_M_Kidney_L.glb", {"VH_M_kidney_capsule_L", "VH_M_hilum_of_kidney_L", "VH_M_renal_pelvis_L"}));
  EXPECT_EQ(body.report.action, "wrapped");
  EXPECT_NEAR(body.report.volume, 200e-6, 8e-6);
  EXPECT_FALSE(body.report.thin_bag);
}

}  // namespace
}  // namespace palpate::test
