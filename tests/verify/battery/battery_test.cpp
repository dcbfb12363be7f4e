// SPDX-License-Identifier: GPL-3.0-or-later
// The stiff battery: its cells reach the ends they name, and results are counted, checked and refused as they should.
// All cells: palpate verify --battery stiff.
#include "precompute/verify/battery/battery.hpp"

#include "precompute/bake/parallel.hpp"
#include "precompute/common/random_subset.hpp"
#include "precompute/solve/pair/sample_difference.hpp"
#include "precompute/verify/battery/stiff_cells.hpp"
#include "precompute/verify/solver_bench.hpp"
#include "tests/support/shapes.hpp"
#include "tests/verify/battery/thickness.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <map>
#include <set>

namespace palpate::verify {
namespace {

TEST(StiffCells, CoverTheirRangesAndAreAllDifferent) {
  const auto cells = stiff_cells();
  EXPECT_GE(cells.size(), 300U);
  std::set<std::pair<std::string, std::string>> names;
  std::map<std::string, int> families;
  double softest = 1e99, hardest = 0, bluntest = 0, sharpest = 1e99, poisson = 0;
  std::size_t core = 0;
  for (const BatteryCell& cell : cells) {
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
  std::vector<BatteryCell> cells;
  for (const BatteryCell& cell : stiff_cells()) {
    if (cell.family == "size" && cells.empty()) cells.push_back(cell);
  }
  ASSERT_EQ(cells.size(), 1U);
  cells[0].scene.sampling.normal_points = 3;
  cells[0].scene.solver.mesh_size = 0.8;
  cells[0].scene.solver.growth = 1;
  cells[0].scene.solver.max_size = test::thickness(cells[0]);
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
  EXPECT_EQ(last, 4U);
  EXPECT_TRUE(result.cells[0].accepted) << result.cells[0].cause;
  ASSERT_TRUE(result.cells[0].difference) << result.cells[0].check_cause;
  EXPECT_GT(*result.cells[0].difference, 0);
  EXPECT_LT(*result.cells[0].difference, options.tolerance);
  EXPECT_FALSE(result.cells[1].accepted);
  EXPECT_NE(result.cells[1].cause.find("holds no point"), std::string::npos) << result.cells[1].cause;
  EXPECT_FALSE(result.cells[2].accepted);
  EXPECT_NE(result.cells[2].cause.find("open"), std::string::npos) << result.cells[2].cause;

  const BatteryFigures all = battery_figures(cells, result, options.tolerance);
  EXPECT_EQ(all.cells, 3U);
  EXPECT_EQ(all.converged, 1U);
  EXPECT_EQ(all.verified, 1U);
  EXPECT_EQ(all.wrong, 0U);
  EXPECT_EQ(battery_figures(cells, result, 1e-9).wrong, 1U);
  EXPECT_EQ(battery_figures(cells, result, options.tolerance, "open").cells, 1U);
}

// One cell of every family, drawn by a seed, on fewer points than the command solves.
TEST(Battery, ADrawnCellOfEveryFamilyConvergesOrSaysWhyNot) {
  std::map<std::string, std::vector<BatteryCell>> families;
  for (const BatteryCell& cell : stiff_cells()) families[cell.family].push_back(cell);
  std::vector<BatteryCell> cells;
  for (const auto& [family, all] : families) {
    cells.push_back(all[random_subset(all.size(), 1e-6, 23).at(0)]);
    cells.back().scene.sampling.normal_points = 4;
    cells.back().scene.solver.mesh_size = 0.6;
    cells.back().scene.solver.growth = 1;
    cells.back().scene.solver.max_size = test::thickness(cells.back());
  }
  BatteryOptions options;
  options.verified_share = 0;
  options.threads = 2;
  const BatteryResult result = run_battery(cells, options);
  std::size_t converged = 0;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const CellResult& cell = result.cells[k];
    EXPECT_TRUE(cell.accepted ? cell.samples.size() >= 3 : !cell.cause.empty())
        << cells[k].family << ", " << cells[k].name;
    EXPECT_TRUE(cell.accepted || !cells[k].core) << cells[k].family << ", " << cells[k].name << ": " << cell.cause;
    converged += cell.accepted;
  }
  EXPECT_GE(converged, cells.size() * 7 / 10);
}

Sample sample(SampleKind kind, std::uint16_t index, const Eigen::Vector3d& deflection, const Eigen::Vector3d& force) {
  Sample s;
  s.kind = kind;
  s.index = index;
  s.deflection = deflection;
  s.force = force;
  return s;
}

TEST(SampleDifference, MatchesFromFullDepthAndByDirection) {
  using K = SampleKind;
  const std::vector<Sample> reference{
      sample(K::normal, 0, {0, 0, 1e-4}, {0, 0, 1}),          sample(K::normal, 1, {0, 0, 5e-4}, {0, 0, 5}),
      sample(K::normal, 2, {0, 0, 1e-3}, {0, 0, 10}),         sample(K::tangential, 0, {1e-4, 0, 1e-3}, {-1, 0, 10}),
      sample(K::tangential, 1, {2e-4, 0, 1e-3}, {-2, 0, 10}), sample(K::tangential, 2, {0, 1e-4, 1e-3}, {0, -1, 10})};
  std::vector<Sample> other(reference.begin() + 1, reference.end());  // without the shallowest
  EXPECT_EQ(solve::sample_difference(other, reference).normal, 0);
  EXPECT_EQ(solve::sample_difference(other, reference).stiffness, 0);
  other[1].force = {0, 0, 10.2};
  for (std::size_t k = 2; k < other.size(); ++k) other[k].force.z() = 10.2;
  other[4].force.y() = -1.1;  // the push along y
  const solve::SampleDifference d = solve::sample_difference(other, reference);
  EXPECT_NEAR(d.normal, 0.02, 1e-12);
  EXPECT_NEAR(d.stiffness, 0.1, 1e-9);
  EXPECT_NEAR(d.tangential, std::hypot(0.1, 0.2) / std::hypot(1, 10), 1e-12);
}

TEST(SolverBench, RowsComeNearerToTheReference) {
  std::vector<BatteryCell> cells = stiff_cells();
  BatteryCell& cell = cells.front();
  cell.scene.material.young = 5e3;
  cell.scene.material.poisson = 0.45;
  cell.scene.sampling.normal_points = 4;
  const Body body = prepare_body(cell.scene, cell.surface);
  SolverBenchOptions options;
  options.settings = {{0.9, 1.0}, {0.4, 0.6}};
  options.reference = {0.3, 0.5};
  options.repeats = 1;
  const auto rows =
      bench_solver(cell.scene, body, tool::make_tool(cell.scene.tools[0]), {{ContactFrame{}, 0.003}}, options);
  ASSERT_EQ(rows.size(), 2U);
  for (const SolverBenchRow& row : rows) {
    EXPECT_EQ(row.solved, 1U);
    EXPECT_GT(row.seconds, 0);
    EXPECT_GT(row.difference.normal, 0);
    EXPECT_LT(row.difference.normal, 0.2);
    EXPECT_EQ(row.difference.tangential, 0);  // a frictionless scene has no tangential pushes
  }
  EXPECT_LT(rows[1].difference.normal, rows[0].difference.normal);
  EXPECT_GT(rows[1].nodes, rows[0].nodes);
}

TEST(DrawShare, IsAShareOfDifferentNumbersBySeed) {
  const auto drawn = random_subset(40, 0.2, 1);
  EXPECT_EQ(drawn.size(), 8U);
  EXPECT_EQ(std::set<std::size_t>(drawn.begin(), drawn.end()).size(), 8U);
  for (const std::size_t k : drawn) EXPECT_LT(k, 40U);
  EXPECT_EQ(random_subset(40, 0.2, 1), drawn);
  EXPECT_NE(random_subset(40, 0.2, 2), drawn);
  EXPECT_EQ(random_subset(40, 1e-6, 1).size(), 1U);
  EXPECT_TRUE(random_subset(40, 0, 1).empty());
  EXPECT_TRUE(random_subset(0, 1, 1).empty());
}

TEST(ParallelFor, DoesEachPieceOnceAndStopsWhenAsked) {
  std::vector<std::atomic<int>> seen(1000);
  EXPECT_TRUE(bake::parallel_for(seen.size(), 4, {}, [&](std::size_t k) { ++seen[k]; }));
  for (const auto& count : seen) EXPECT_EQ(count, 1);
  std::atomic<int> asked{0}, worked{0};
  EXPECT_FALSE(bake::parallel_for(
      1000, 4, [&] { return ++asked > 10; }, [&](std::size_t) { ++worked; }));
  EXPECT_LE(worked, 13);
  EXPECT_THROW(bake::parallel_for(10, 2, {},
                                  [](std::size_t k) {
                                    if (k == 3) throw std::runtime_error("piece 3");
                                  }),
               std::runtime_error);
}

}  // namespace
}  // namespace palpate::verify
