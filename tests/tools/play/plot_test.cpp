// SPDX-License-Identifier: GPL-3.0-or-later
// Plots: well-formed, inside their frame, and no peak lost.
#include "tools/play/plot.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sstream>

namespace palpate {
namespace {

using cli::line_plot_svg;
using cli::PlotPanel;

// Tags open and close in order.
bool well_formed(const std::string& svg) {
  std::vector<std::string> open;
  for (std::size_t at = svg.find('<'); at != std::string::npos; at = svg.find('<', at + 1)) {
    const std::size_t end = svg.find('>', at);
    if (end == std::string::npos) return false;
    const std::string tag = svg.substr(at + 1, end - at - 1);
    const std::string name = tag.substr(tag[0] == '/' ? 1 : 0, tag.find_first_of(" />", 1) - (tag[0] == '/' ? 1 : 0));
    if (tag[0] == '/') {
      if (open.empty() || open.back() != name) return false;
      open.pop_back();
    } else if (tag.back() != '/') {
      open.push_back(name);
    }
  }
  return open.empty();
}

// Vertical pixel positions of the first line.
std::vector<double> heights(const std::string& svg) {
  const std::size_t begin = svg.find("points=\"") + 8;
  std::istringstream points(svg.substr(begin, svg.find('"', begin) - begin));
  std::vector<double> result;
  double x = 0, y = 0;
  char comma = 0;
  while (points >> x >> comma >> y) result.push_back(y);
  return result;
}

TEST(Plot, IsWellFormedAndNamesWhatItShows) {
  std::vector<double> x, y;
  for (int i = 0; i <= 100; ++i) {
    x.push_back(i / 100.0);
    y.push_back(std::sin(i / 10.0));
  }
  const std::string svg = line_plot_svg("A <title> & more", "time (s)", x,
                                        {{"force (N)", {{"x", y}, {"y", y}}}, {"depth (mm)", {{"z", x}}}});
  EXPECT_TRUE(well_formed(svg)) << svg;
  for (const char* text : {"A &lt;title&gt; &amp; more", "time (s)", "force (N)", "depth (mm)", ">-1.0<", ">0.5<"}) {
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  }
  for (const double h : heights(svg)) {
    EXPECT_GE(h, 44);
    EXPECT_LE(h, 44 + 230);
  }
}

TEST(Plot, ThinnedLinesKeepTheirPeaks) {
  std::vector<double> x, y;
  for (int i = 0; i < 200000; ++i) {
    x.push_back(i);
    y.push_back(i == 77777 ? 1.0 : 0.0);
  }
  const std::string svg = line_plot_svg("t", "x", x, {{"y", {{"y", y}}}});
  EXPECT_LT(svg.size(), 100000U);
  const std::vector<double> h = heights(svg);
  EXPECT_EQ(*std::min_element(h.begin(), h.end()), 44);  // the peak reaches the frame's top
}

TEST(Plot, SurvivesConstantsSinglePointsAndGaps) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [x, y] : {std::pair<std::vector<double>, std::vector<double>>{{0}, {0}},
                             {{1, 2, 3}, {5, 5, 5}},
                             {{1, 2, 3}, {kNan, 1, kNan}},
                             {{1, 2}, {kNan, kNan}},
                             {{0, 1e-9}, {1e-12, -1e12}},
                             {{1e18, 1e18 + 1024}, {0, 1}},  // where a step of the axis does not change the number
                             {{1.7e9, 1.7e9 + 1e-6}, {0, 1}}}) {
    const std::string svg = line_plot_svg("t", "x", x, {{"y", {{"y", y}}}});
    EXPECT_TRUE(well_formed(svg));
    EXPECT_LT(svg.size(), 40000U);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("inf"), std::string::npos);
  }
}

// The last points of the line are the largest values; a series without values is left out.
TEST(Plot, DistributionsRiseToTheLargestValue) {
  std::vector<double> values;
  for (int k = 0; k < 1000; ++k) values.push_back((k * 7919) % 1000);
  const std::string svg = cli::distribution_svg("errors", "error (%)", {{"normal", values}, {"tangential", {}}});
  EXPECT_TRUE(well_formed(svg));
  EXPECT_NE(svg.find("normal (1000)"), std::string::npos);
  EXPECT_EQ(svg.find("tangential"), std::string::npos);
  const std::vector<double> y = heights(svg);
  ASSERT_GT(y.size(), 100U);
  for (std::size_t k = 1; k < y.size(); ++k) EXPECT_LE(y[k], y[k - 1] + 0.011);
  // Values spread evenly: a straight line.
  EXPECT_NEAR(y[y.size() / 2], 0.5 * (y.front() + y.back()), 2);
}

}  // namespace
}  // namespace palpate
