// SPDX-License-Identifier: GPL-3.0-or-later
// What Hayward and Mahvash (2004) say of their figures 2 and 4, of the scenes that `palpate verify --paper` solves.
#include "precompute/verify/paper.hpp"

#include "datasets-synthetic/paper.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::verify {
namespace {

class Paper : public ::testing::Test {
protected:
  test::TemporaryFolder folder;
  synth::PaperScenes scenes = synth::write_paper_scenes(folder.path());

  static void expect_holds(const PaperFigure& figure) {
    for (const PaperStatement& s : figure.statements) {
      EXPECT_TRUE(s.holds()) << s.text << ": " << s.figure << ", limit " << s.limit;
    }
    for (const PaperPanel& panel : figure.panels) {
      for (const PaperCurve& curve : panel.curves) {
        ASSERT_GE(curve.at.size(), 3U) << panel.title << ", " << curve.name;
        for (std::size_t k = 0; k < curve.at.size(); ++k) {
          EXPECT_TRUE(std::isfinite(curve.force[k])) << panel.title << ", " << curve.name;
          if (k > 0) {
            EXPECT_GT(curve.at[k], curve.at[k - 1]) << panel.title << ", " << curve.name;
          }
        }
      }
    }
  }
};

TEST_F(Paper, Figure2) {
  const PaperFigure figure = solve_figure_2(read_scene(scenes.loose), read_scene(scenes.firm), 1);
  expect_holds(figure);
  for (const PaperPanel& panel : figure.panels) {
    for (const PaperCurve& curve : panel.curves) EXPECT_GT(curve.force.back(), 0) << panel.title << ", " << curve.name;
  }
}

TEST_F(Paper, Figure4) {
  const PaperFigure figure = solve_figure_4(read_scene(scenes.homogeneous), read_scene(scenes.inclusion), 1);
  expect_holds(figure);
}

// The statements can fail: curves that contradict them are reported.
TEST(PaperStatements, FailWhereTheCurvesSayOtherwise) {
  const PaperCurve line{"line", {0, 1, 2}, {0, 1, 2}}, half{"half", {0, 1, 2}, {0, 0.4, 0.8}},
      bent{"bent", {0, 1, 2}, {0, 0, 2}}, late{"late", {0, 1, 2}, {0, 1, 0.5}};
  const auto holds = [](const std::vector<PaperStatement>& statements) {
    std::vector<bool> all;
    for (const PaperStatement& s : statements) all.push_back(s.holds());
    return all;
  };
  using Answers = std::vector<bool>;
  EXPECT_EQ(holds(figure_2_statements({{"loose", {line, line, line}}, {"firm", {line, half, line}}})),
            Answers({true, true, true}));
  EXPECT_EQ(holds(figure_2_statements({{"loose", {line, half, line}}, {"firm", {line, line, bent}}})),
            Answers({false, false, false}));
  EXPECT_EQ(holds(figure_2_statements({{"loose", {line, line, line}}, {"firm", {line, late, line}}})),
            Answers({true, true, false}));
  const PaperPanel apart{"end", {line, half}}, still{"end", {{"", {0, 2}, {1, 1}}, {"", {0, 2}, {0.5, 0.5}}}};
  const PaperCurve short_of{"nan", {0, 1, 2}, {0, std::nan(""), 2}};
  EXPECT_EQ(holds(figure_4_statements({{"alike", {line, line}}, {"skewed", {line, half}}, still})),
            Answers({true, true, false}));
  EXPECT_EQ(holds(figure_4_statements({{"alike", {line, line}}, {"skewed", {half, line}}, still})),
            Answers({true, false, false}));
  EXPECT_EQ(holds(figure_4_statements({{"alike", {line, half}}, {"skewed", {line, line}}, apart})),
            Answers({false, false, true}));
  EXPECT_EQ(holds(figure_4_statements({{"alike", {line, short_of}}, {"skewed", {line, short_of}}, still})),
            Answers({false, false, false}));
}

TEST(PaperCurves, ForcesAreLinearBetweenPointsAndNoneBeyond) {
  const PaperCurve curve{"", {0, 1, 3}, {0, 2, 10}};
  EXPECT_EQ(force_at(curve, 0), 0);
  EXPECT_DOUBLE_EQ(force_at(curve, 0.5), 1);
  EXPECT_DOUBLE_EQ(force_at(curve, 2), 6);
  EXPECT_DOUBLE_EQ(force_at(curve, 3), 10);
  EXPECT_TRUE(std::isnan(force_at(curve, 3.1)));
  EXPECT_TRUE(std::isnan(force_at(curve, -0.1)));
}

}  // namespace
}  // namespace palpate::verify
