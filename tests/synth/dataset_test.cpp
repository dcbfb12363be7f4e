// SPDX-License-Identifier: GPL-3.0-or-later
// A written data set is a scene that reads back, the same bytes for the same seed, and refused when it cannot be.
#include "datasets-synthetic/dataset.hpp"

#include "formats/io/error.hpp"
#include "formats/scene/scene.hpp"
#include "formats/surface/surface_io.hpp"
#include "tests/synth/surface_checks.hpp"

#include <gtest/gtest.h>
#include <unistd.h>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

namespace palpate::synth {
namespace {

class Dataset : public testing::Test {
protected:
  void SetUp() override {
    std::string pattern = (std::filesystem::temp_directory_path() / "palpate-synth-XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static std::string bytes(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
  }

  static void expect_refused(const DatasetOptions& options, const std::filesystem::path& folder,
                             const std::string& cause) {
    try {
      write_dataset(options, folder);
      ADD_FAILURE() << "was not refused";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::usage);
      EXPECT_NE(std::string(error.what()).find(cause), std::string::npos) << error.what();
    }
    EXPECT_FALSE(std::filesystem::exists(folder)) << "a refusal left files";
  }

  std::filesystem::path folder_;
};

TEST_F(Dataset, EveryOrganReadsBackAsAScene) {
  for (const Organ organ : {Organ::slab, Organ::ball, Organ::liver}) {
    for (const bool inclusion : {false, true}) {
      DatasetOptions options;
      options.organ = organ;
      options.inclusion = inclusion;
      options.friction = 0.25;
      const auto files = write_dataset(options, folder_);
      const Scene scene = read_scene(files[0]);
      EXPECT_EQ(scene.friction, 0.25);
      ASSERT_EQ(scene.regions.size(), inclusion ? 1U : 0U);
      ASSERT_EQ(scene.body.surfaces.size(), 1U);
      const Surface body = read_surface(scene.body.surfaces[0]);
      EXPECT_EQ(test::edge_faults(body), 0);
      if (inclusion) {
        EXPECT_EQ(scene.regions[0].material.young, options.inclusion_young);
        const Surface ball = read_surface(scene.regions[0].surface);
        EXPECT_EQ(test::edge_faults(ball), 0);
        EXPECT_LT(test::volume(ball), 0.2 * test::volume(body));
      }
    }
  }
}

TEST_F(Dataset, KidneyHasItsPyramidsInside) {
  DatasetOptions options;
  options.organ = Organ::kidney;
  const Scene scene = read_scene(write_dataset(options, folder_)[0]);
  EXPECT_EQ(scene.material.tissue, "kidney");
  ASSERT_EQ(scene.regions.size(), 6U);
  const Surface body = read_surface(scene.body.surfaces[0]);
  EXPECT_EQ(test::edge_faults(body), 0);
  for (const RegionScene& region : scene.regions) {
    EXPECT_NEAR(region.material.young / scene.material.young, 2, 0.01);
    double nearest = 100;
    for (const Eigen::Vector3d& v : body.vertices) {
      nearest = std::min(nearest, (v - region.centre).cwiseQuotient(region.radii).norm());
    }
    EXPECT_GT(nearest, 1.2);
  }
}

TEST_F(Dataset, BladderIsAHollowShellThatMayBeFilled) {
  DatasetOptions options;
  options.organ = Organ::bladder;
  const auto empty = write_dataset(options, folder_ / "empty");
  options.pressure = 1000;
  const auto filled = write_dataset(options, folder_ / "filled");
  EXPECT_EQ(bytes(empty[2]), bytes(filled[2]));
  EXPECT_NE(bytes(empty[1]), bytes(filled[1]));  // the motion goes to where the wall has risen to
  EXPECT_FALSE(read_scene(empty[0]).prestress.any());
  const Scene scene = read_scene(filled[0]);
  EXPECT_EQ(scene.prestress.pressure, 1000);
  const Surface shell = read_surface(scene.body.surfaces[0]);
  EXPECT_EQ(test::edge_faults(shell), 0);
  const double wall = 4 * std::numbers::pi / 3 * (35 * 32 * 40 - 31 * 28 * 36) * 1e-9;
  EXPECT_NEAR(test::volume(shell) / wall, 1, 0.02);
  options.pressure = 3000;
  expect_refused(options, folder_ / "none", "holds up to about");
}

TEST_F(Dataset, SheetIsThinAndHeldAtBothEnds) {
  DatasetOptions options;
  options.organ = Organ::sheet;
  options.depth = 0.001;
  const Scene scene = read_scene(write_dataset(options, folder_)[0]);
  const Surface body = read_surface(scene.body.surfaces[0]);
  EXPECT_EQ(test::edge_faults(body), 0);
  EXPECT_NEAR(test::volume(body), 0.06 * 0.04 * 0.002, 1e-9);
  ASSERT_EQ(scene.supports.size(), 2U);
  EXPECT_EQ(scene.supports[0].point.x(), -scene.supports[1].point.x());
  EXPECT_EQ(scene.supports[0].normal.x(), -1);
  options.inclusion = true;
  expect_refused(options, folder_ / "none", "a slab, a ball or a liver");
}

TEST_F(Dataset, TumourIsARegionOfItsTissue) {
  DatasetOptions options;
  options.organ = Organ::liver;
  options.inclusion = options.tumour = true;
  options.inclusion_gap = 0.006;
  const Scene scene = read_scene(write_dataset(options, folder_)[0]);
  ASSERT_EQ(scene.regions.size(), 1U);
  EXPECT_EQ(scene.regions[0].shape, RegionScene::Shape::ellipsoid);
  EXPECT_EQ(scene.regions[0].material.tissue, "liver-tumour");
  EXPECT_EQ(scene.material.tissue, "liver");
  options.organ = Organ::slab;
  expect_refused(options, folder_ / "none", "a tumour is the inclusion of a liver");
  options.tumour = false;
  options.organ = Organ::kidney;
  expect_refused(options, folder_ / "none", "a slab, a ball or a liver");
  options.inclusion = false;
  options.pressure = 1;
  expect_refused(options, folder_ / "none", "only a bladder");
}

TEST_F(Dataset, ToolsReadBack) {
  DatasetOptions options;
  options.instrument = Instrument::punch;
  EXPECT_EQ(read_scene(write_dataset(options, folder_)[0]).tools[0].shape, ToolScene::Shape::punch);
  options.instrument = Instrument::capsule;
  const Scene capsule = read_scene(write_dataset(options, folder_)[0]);
  EXPECT_EQ(capsule.tools[0].shape, ToolScene::Shape::capsule);
  EXPECT_TRUE(capsule.tools[0].whole);
  options.instrument_as_mesh = true;
  EXPECT_EQ(read_scene(write_dataset(options, folder_)[0]).tools[0].shape, ToolScene::Shape::mesh);
  options.instrument = Instrument::sphere;  // a mesh, too: with no key that only a capsule has
  EXPECT_EQ(read_scene(write_dataset(options, folder_)[0]).tools[0].shape, ToolScene::Shape::mesh);
  options.instrument = Instrument::stylus;
  options.tool_radius = 0.001;
  const Scene stylus = read_scene(write_dataset(options, folder_)[0]);
  EXPECT_EQ(test::edge_faults(read_surface(stylus.tools[0].surface)), 0);
}

TEST_F(Dataset, SameSeedSameBytes) {
  DatasetOptions options;
  options.organ = Organ::liver;
  options.inclusion = true;
  options.seed = 5;
  const auto first = write_dataset(options, folder_ / "a");
  const auto second = write_dataset(options, folder_ / "b");
  ASSERT_EQ(first.size(), 4U);
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(bytes(first[i]), bytes(second[i])) << first[i];
  options.seed = 6;
  const auto third = write_dataset(options, folder_ / "c");
  EXPECT_NE(bytes(first[1]), bytes(third[1]));
  EXPECT_NE(bytes(first[2]), bytes(third[2]));
}

TEST_F(Dataset, RefusesWhatDoesNotFit) {
  DatasetOptions options;
  options.inclusion = true;
  options.inclusion_radius = 0.05;
  expect_refused(options, folder_ / "none", "the inclusion of radius");
  options.organ = Organ::liver;
  options.inclusion_radius = 0.01;
  options.inclusion_gap = 0.06;
  expect_refused(options, folder_ / "none", "the inclusion of radius");
  DatasetOptions stylus;
  stylus.instrument = Instrument::stylus;
  expect_refused(stylus, folder_ / "none", "needs a length");
  DatasetOptions punch;
  punch.instrument = Instrument::punch;
  punch.instrument_as_mesh = true;
  expect_refused(punch, folder_ / "none", "a punch is not written as a mesh");
  DatasetOptions fine;
  fine.edge = 1e-5;
  expect_refused(fine, folder_ / "none", "edge: got");
}

}  // namespace
}  // namespace palpate::synth
