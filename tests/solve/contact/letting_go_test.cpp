// SPDX-License-Identifier: GPL-3.0-or-later
// Series of points that let go, of random contacts that hold and that peel.
#include "precompute/solve/contact/letting_go.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace palpate::solve {
namespace {

// The round (from 1) of 30 in which a contact of `stuck` points is found to peel, by its points after each; 0: none.
int peels_in(std::size_t stuck, const std::vector<std::size_t>& after) {
  LettingGo letting_go(stuck);
  int round = 0;
  for (const std::size_t points : after) {
    if (letting_go.peels(points, 30 - ++round)) return round;
  }
  return 0;
}

TEST(LettingGo, AContactThatHoldsIsNotFoundToPeel) {
  EXPECT_EQ(peels_in(0, {0, 0}), 0);
  EXPECT_EQ(peels_in(6, {5, 5, 5}), 0);
  EXPECT_EQ(peels_in(123, {99, 99, 98, 98}), 0);
  EXPECT_EQ(peels_in(807, {748, 723, 717, 709, 704, 704, 701, 701}), 0);
  EXPECT_EQ(peels_in(793, {740, 721, 711, 705, 700, 694, 690, 690, 690}), 0);
  EXPECT_EQ(peels_in(866, {828, 802, 795, 795}), 0);
}

TEST(LettingGo, AContactThatPeelsIsFoundLongBeforeItHasPeeled) {
  EXPECT_EQ(peels_in(1520, {1435, 1365, 1308, 1263, 1210, 1154, 1089, 1021, 943, 823, 575, 333}), 5);
  EXPECT_EQ(peels_in(1475, {1384, 1331, 1278, 1234, 1179, 1130, 1077, 1019, 916, 785, 557, 392, 321}), 3);
  EXPECT_EQ(peels_in(1949, {1722, 1465, 1172, 900, 227}), 2);
  EXPECT_EQ(peels_in(100, {20}), 1);
}

// Ever fewer points let go, but their series leaves none.
TEST(LettingGo, ASeriesThatLeavesNothingPeels) { EXPECT_EQ(peels_in(1000, {900, 805, 714}), 2); }

}  // namespace
}  // namespace palpate::solve
