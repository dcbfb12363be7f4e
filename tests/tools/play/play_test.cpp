// SPDX-License-Identifier: GPL-3.0-or-later
// Playing a motion: forces of a push, independence of the rows' spacing, the CSV.
#include "tools/play/play.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "tests/support/response_samples.hpp"

namespace palpate {
namespace {

using cli::MotionRow;
using cli::PlayedRow;
using cli::PlaySummary;

constexpr double kTop = test::kBoxSize / 4;

// Straight down to `depth`, sideways, back up; `rows` rows to each part.
std::vector<MotionRow> probe(double depth, int rows) {
  const double touch = kTop + test::kTipRadius;
  std::vector<MotionRow> motion;
  const auto add = [&](double x, double z) {
    motion.push_back({static_cast<double>(motion.size()) / rows, {x, 0, z}, {1, 0, 0, 0}});
  };
  for (int i = 0; i < rows; ++i) add(0, touch + 0.005 - (0.005 + depth) * i / rows);
  for (int i = 0; i < rows; ++i) add(0.003 * i / rows, touch - depth);
  for (int i = 0; i <= rows; ++i) add(0.003, touch - depth + (0.005 + depth) * i / rows);
  return motion;
}

class Play : public testing::Test {
protected:
  void SetUp() override {
    test::ResponseSampleOptions options;
    options.uniform = true;
    options.bias = false;
    bytes_ = encode(test::box_content(options));
    const runtime::OpenResult opened = runtime::View::open(bytes_.data(), bytes_.size());
    ASSERT_TRUE(opened) << opened.error;
    view_ = opened.view;
  }
  std::vector<std::byte> bytes_;
  runtime::View view_;
};

TEST_F(Play, AProbeTouchesOncePressesSlidesAndLetsGo) {
  PlaySummary s;
  const std::vector<PlayedRow> rows = cli::play(view_, 0, probe(0.003, 100), s);
  ASSERT_EQ(rows.size(), 301U);
  EXPECT_EQ(s.contacts, 1U);
  EXPECT_FALSE(s.starts_inside);
  EXPECT_EQ(s.rows_extrapolated, 0U);
  EXPECT_NEAR(s.peak_depth, 0.003, 1e-6);
  EXPECT_GT(s.slide_time, 0.3);
  EXPECT_LT(s.slide_time, s.contact_time);
  EXPECT_EQ(length(rows.front().tick.force), 0);
  EXPECT_EQ(length(rows.back().tick.force), 0);
  EXPECT_GT(rows[100].tick.force.z, 0.5);
}

TEST_F(Play, RowsFarApartGiveTheForcesOfRowsCloseTogether) {
  PlaySummary fine, coarse;
  const std::vector<PlayedRow> a = cli::play(view_, 0, probe(0.003, 600), fine),
                               b = cli::play(view_, 0, probe(0.003, 6), coarse);
  for (std::size_t i = 0; i < b.size(); ++i) {
    EXPECT_LT(length(a[100 * i].tick.force - b[i].tick.force), 0.02) << i;
  }
  EXPECT_GT(coarse.ticks, 100U);
}

// A bump between two rows far apart: the summary is of the ticks, not of the rows.
TEST_F(Play, WhatHappensBetweenTwoRowsIsAccountedFor) {
  // Diagonally across an upper edge of the box, 3 mm deep in the middle of the way, free at both ends.
  const double edge = test::kBoxSize / 2, in = (test::kTipRadius - 0.003) / std::sqrt(2.0);
  const runtime::Vec3 middle{edge + in, 0, kTop + in}, way{0.02, 0, -0.02};
  PlaySummary s;
  const std::vector<PlayedRow> rows =
      cli::play(view_, 0, {{0, middle - way, {1, 0, 0, 0}}, {0.1, middle + way, {1, 0, 0, 0}}}, s);
  for (const PlayedRow& row : rows) EXPECT_EQ(length(row.tick.force), 0);
  EXPECT_EQ(s.contacts, 1U);
  EXPECT_GT(s.contact_time, 0.01);
  EXPECT_LT(s.contact_time, 0.1);
  EXPECT_LE(s.slide_time, s.contact_time);
  EXPECT_GT(s.peak_force, 0.01);
  EXPECT_GT(s.peak_depth, 0.001);
}

TEST_F(Play, AStartInsideIsReported) {
  PlaySummary s;
  const std::vector<PlayedRow> rows = cli::play(view_, 0, {{0, {0, 0, kTop + 0.003}, {1, 0, 0, 0}}}, s);
  EXPECT_TRUE(s.starts_inside);
  EXPECT_EQ(length(rows[0].tick.force), 0);
}

TEST_F(Play, DeeperThanSampledIsCounted) {
  PlaySummary s;
  cli::play(view_, 0, probe(0.006, 100), s);
  EXPECT_GT(s.rows_extrapolated, 50U);
}

TEST_F(Play, CsvHasOneRowAPoseAndTwelveColumns) {
  PlaySummary s;
  std::istringstream csv(cli::forces_csv(cli::play(view_, 0, probe(0.003, 10), s)));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line, "t,fx,fy,fz,tx,ty,tz,state,depth,cx,cy,cz");
  int rows = 0, contacts = 0;
  while (std::getline(csv, line)) {
    ++rows;
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), 11) << line;
    contacts += line.find("stick") != std::string::npos || line.find("slide") != std::string::npos;
  }
  EXPECT_EQ(rows, 31);
  EXPECT_GT(contacts, 10);
}

}  // namespace
}  // namespace palpate
