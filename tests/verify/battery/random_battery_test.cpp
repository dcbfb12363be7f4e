// SPDX-License-Identifier: GPL-3.0-or-later
// The random battery: its draw, its verdicts, and forty of its contacts beside the finer meshes' forces of an earlier
// run (random_contacts.md). All: palpate verify --battery random.
#include "precompute/verify/battery/random_battery.hpp"
#include "precompute/verify/battery/random_cells.hpp"

#include "tests/support/shapes.hpp"
#include "tests/verify/battery/thickness.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace palpate::verify {
namespace {

using test::thickness;

TEST(RandomCells, AreThoseOfTheirSeedAndSpanTheirRanges) {
  const auto cells = random_cells(3, 200), fewer = random_cells(3, 7), others = random_cells(4, 7);
  ASSERT_EQ(cells.size(), 200U);
  for (std::size_t k = 0; k < fewer.size(); ++k) {
    EXPECT_EQ(fewer[k].name, cells[k].name);
    EXPECT_NE(others[k].name, cells[k].name);
  }
  std::map<std::string, int> families;
  std::map<ToolScene::Shape, int> shapes;
  double softest = 1e99, hardest = 0, smallest = 1e99, largest = 0;
  int friction = 0, inclusions = 0, springs = 0;
  for (const BatteryCell& cell : cells) {
    EXPECT_TRUE(test::closed_and_oriented(cell.surface)) << cell.name;
    EXPECT_GT(test::surface_volume(cell.surface), 0) << cell.name;
    EXPECT_GT(cell.depth, 0) << cell.name;
    EXPECT_NEAR(cell.normal.norm(), 1, 1e-9) << cell.name;
    ++families[cell.family];
    const ToolScene& tool = cell.scene.tools.at(0);
    ++shapes[tool.shape];
    const double ratio = tool.radius / thickness(cell);
    smallest = std::min(smallest, ratio), largest = std::max(largest, ratio);
    softest = std::min(softest, cell.scene.material.young), hardest = std::max(hardest, cell.scene.material.young);
    friction += cell.scene.friction > 0;
    inclusions += !cell.scene.regions.empty();
    springs += cell.scene.supports.at(0).type == SupportScene::Type::spring;
  }
  EXPECT_EQ(families.size(), 4U);
  EXPECT_EQ(shapes.size(), 4U);
  EXPECT_LT(softest, 1e3);
  EXPECT_GT(hardest, 1e9);
  EXPECT_LT(smallest, 2e-4);
  EXPECT_GT(largest, 1.5);
  for (const int count : {friction, inclusions, springs}) EXPECT_GT(count, 20);
}

TEST(RandomBattery, FiguresCountVerdictsAndCoverage) {
  std::vector<JudgedCell> cells(3);
  cells[0].verdict = Verdict::right;
  cells[0].samples = {{0.01, 0.02}, {0.02, 0.01}};
  cells[0].solve.processor = 2;
  cells[1].verdict = Verdict::wrong;
  cells[1].samples = {{0.1, 0.01}, {0, 0.004}};
  cells[2].verdict = Verdict::refused_sound;
  cells[2].solve.processor = 5;
  const RandomFigures f = random_figures(cells);
  EXPECT_EQ(f.cells, 3U);
  EXPECT_EQ(f.verdicts.at(Verdict::wrong), 1U);
  EXPECT_EQ(f.samples, 4U);
  EXPECT_EQ(f.covered, 2U);
  EXPECT_EQ(f.coverage(), 0.5);
  EXPECT_EQ(f.error.worst, 0.1);
  EXPECT_EQ(f.ratio.worst, 4);  // an error of 0 counts as the solver's tolerance
  EXPECT_EQ(f.seconds.worst, 5);
}

// The cheap ones on coarse meshes: none is accepted and wrong, most are right, and estimates cover the errors.
TEST(RandomBattery, CheapContactsAreRightAndCovered) {
  std::vector<BatteryCell> cells;
  for (BatteryCell& cell : random_cells(47, 400)) {
    const bool small = cell.scene.tools[0].radius < 0.05 * thickness(cell);
    if (cell.family != "block" || small || cell.scene.friction > 0 || !cell.scene.regions.empty()) continue;
    if (cells.size() == 10) break;
    cell.scene.sampling.normal_points = 3;
    cell.scene.solver.mesh_size = 0.5;
    cell.scene.solver.growth = 0.8;
    cell.scene.solver.max_size = 0.5 * thickness(cell);
    cells.push_back(std::move(cell));
  }
  ASSERT_EQ(cells.size(), 10U);
  std::vector<JudgedCell> judged(cells.size());
  RandomBatteryOptions options;
  options.refine = 0.75;
  run_random_battery(cells, options, [&](std::size_t k, const JudgedCell& cell) { judged[k] = cell; });
  for (std::size_t k = 0; k < cells.size(); ++k) {
    EXPECT_NE(judged[k].verdict, Verdict::wrong) << cells[k].name << ": " << judged[k].excess;
    EXPECT_NE(judged[k].verdict, Verdict::refused_sound) << cells[k].name << ": " << judged[k].solve.cause;
    EXPECT_GT(judged[k].solve.processor, 0);
  }
  const RandomFigures f = random_figures(judged);
  EXPECT_GE(f.verdicts.at(Verdict::right), 8U);
  EXPECT_GE(f.coverage(), 0.9);
}

// A contact of a battery's draw, and the forces of its finer mesh: a line of its report.
struct Recorded {
  std::uint64_t seed = 0;
  std::string cell;
  CellSolve reference;
};

std::vector<Recorded> recorded_contacts() {
  std::ifstream file(PALPATE_RANDOM_CONTACTS);
  std::vector<Recorded> all;
  for (std::string line; std::getline(file, line);) {
    const auto json = nlohmann::json::parse(line);
    Recorded contact{json.at("seed"), json.at("cell"), {}};
    contact.reference.accepted = true;
    for (const auto& s : json.at("reference")) {
      Sample sample;
      sample.kind = static_cast<SampleKind>(s.at("kind").get<int>());
      for (int i = 0; i < 3; ++i) {
        sample.deflection[i] = s.at("deflection").at(std::size_t(i));
        sample.force[i] = s.at("force").at(std::size_t(i));
      }
      contact.reference.samples.push_back(sample);
    }
    all.push_back(std::move(contact));
  }
  return all;
}

class RandomContacts : public testing::TestWithParam<std::size_t> {};

TEST_P(RandomContacts, AreRightAtDefaultSettings) {
  const auto contacts = recorded_contacts();
  ASSERT_LT(GetParam(), contacts.size());
  const Recorded& contact = contacts[GetParam()];
  const auto number = static_cast<std::uint32_t>(std::stoul(contact.cell));  // its name begins with it
  const BatteryCell cell = random_cells(contact.seed, number + 1).back();
  ASSERT_EQ(cell.name, contact.cell) << "the draw has changed: record anew, see random_contacts.md";
  const JudgedCell judged = judge(solve_cell(cell), contact.reference, {});
  EXPECT_EQ(judged.verdict, Verdict::right)
      << verdict_name(judged.verdict) << ", " << judged.excess << " of what is allowed; " << judged.solve.cause;
  EXPECT_GE(judged.samples.size(), 3U);
}

INSTANTIATE_TEST_SUITE_P(Seed31, RandomContacts, testing::Range(std::size_t{0}, std::size_t{40}));

}  // namespace
}  // namespace palpate::verify
