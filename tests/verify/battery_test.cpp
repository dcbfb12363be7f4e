// SPDX-License-Identifier: GPL-3.0-or-later
// The stiff battery: its cells reach the ends they name, and results are counted, checked and refused as they should.
// All cells: palpate verify --battery stiff.
#include "precompute/verify/battery.hpp"

#include "precompute/verify/parallel.hpp"
#include "tests/support/shapes.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <set>

namespace palpate {
namespace {

TEST(StiffCells, CoverTheirRangesAndAreAllDifferent) {
  const auto cells = stiff_cells();
  EXPECT_GE(cells.size(), 300U);
  std::set<std::pair<std::string, std::string>> names;
  std::map<std::string, int> families;
  double softest = 1e99, hardest = 0, bluntest = 0, sharpest = 1e99, poisson = 0;
  std::size_t core = 0;
  for (const StiffCell& cell : cells) {
    EXPECT_TRUE(names.emplace(cell.family, cell.name).second) << cell.family << ", " << cell.name;
    EXPECT_TRUE(test::closed_and_oriented(cell.surface)) << cell.family << ", " << cell.name;
    EXPECT_GT(test::surface_volume(cell.surface), 0) << cell.family << ", " << cell.name;
    EXPECT_GT(cell.depth, 0);
    ++families[cell.family];
    core += cell.core;
    const MaterialScene& m = cell.scene.material;
    softest = std::min(softest, m.young);
    hardest = std::max(hardest, m.young);
    poisson = std::max(poisson, m.poisson);
    sharpest = std::min(sharpest, cell.scene.tools[0].radius);
    bluntest = std::max(bluntest, cell.scene.tools[0].radius);
    EXPECT_FALSE(cell.core && (m.young < 10 || m.young > 1e7)) << cell.name;
  }
  EXPECT_GE(families.size(), 12U);
  EXPECT_LE(softest, 10);
  EXPECT_GE(hardest, 1e11);
  EXPECT_GE(poisson, 0.4999);
  EXPECT_LE(sharpest, 1e-4);
  EXPECT_GE(bluntest, 0.5);
  EXPECT_GE(core, cells.size() / 2);
}

// A plain cell, one whose support is out of reach, one whose surface is open.
TEST(Battery, ConvergesChecksAndRefusesByName) {
  std::vector<StiffCell> cells;
  for (const StiffCell& cell : stiff_cells()) {
    if (cell.family == "size" && cells.empty()) cells.push_back(cell);
  }
  ASSERT_EQ(cells.size(), 1U);
  cells[0].scene.sampling.normal_points = 4;
  cells.push_back(cells[0]);
  cells[1].scene.supports[0].point = {0, 0, -100};
  cells.push_back(cells[0]);
  cells[2].family = "open";
  cells[2].scene.body.repair = RepairMode::none;
  cells[2].surface.triangles.pop_back();
  cells[2].surface.parts.pop_back();
  BatteryOptions options;
  options.verified_share = 1;
  options.threads = 2;
  std::size_t last = 0;
  options.progress = [&](std::size_t done, std::size_t) { last = done; };
  const BatteryResult result = run_battery(cells, options);
  EXPECT_FALSE(result.stopped);
  EXPECT_EQ(last, 4U);
  EXPECT_EQ(result.cells[0].end, CellResult::End::converged) << result.cells[0].cause;
  ASSERT_TRUE(result.cells[0].difference) << result.cells[0].check_cause;
  EXPECT_GT(*result.cells[0].difference, 0);
  EXPECT_LT(*result.cells[0].difference, options.tolerance);
  EXPECT_EQ(result.cells[1].end, CellResult::End::refused);
  EXPECT_NE(result.cells[1].cause.find("holds no point"), std::string::npos) << result.cells[1].cause;
  EXPECT_EQ(result.cells[2].end, CellResult::End::refused);
  EXPECT_NE(result.cells[2].cause.find("open"), std::string::npos) << result.cells[2].cause;

  const BatteryFigures all = battery_figures(cells, result, options.tolerance);
  EXPECT_EQ(all.cells, 3U);
  EXPECT_EQ(all.converged, 1U);
  EXPECT_EQ(all.verified, 1U);
  EXPECT_EQ(all.wrong, 0U);
  EXPECT_EQ(battery_figures(cells, result, 1e-9).wrong, 1U);
  EXPECT_EQ(battery_figures(cells, result, options.tolerance, "open").cells, 1U);
}

TEST(ParallelFor, DoesEachPieceOnceAndStopsWhenAsked) {
  std::vector<std::atomic<int>> seen(1000);
  EXPECT_TRUE(parallel_for(seen.size(), 4, {}, [&](std::size_t k) { ++seen[k]; }));
  for (const auto& count : seen) EXPECT_EQ(count, 1);
  std::atomic<int> asked{0}, worked{0};
  EXPECT_FALSE(parallel_for(
      1000, 4, [&] { return ++asked > 10; }, [&](std::size_t) { ++worked; }));
  EXPECT_LE(worked, 13);
  EXPECT_THROW(parallel_for(10, 2, {},
                            [](std::size_t k) {
                              if (k == 3) throw std::runtime_error("piece 3");
                            }),
               std::runtime_error);
}

}  // namespace
}  // namespace palpate
