// SPDX-License-Identifier: GPL-3.0-or-later
// Conservative advancement: the first touch of a moving tool against closed forms.
#include "palpate/geometry/sweep.hpp"

#include <cmath>
#include <numbers>

#include "tests/runtime/support.hpp"

namespace palpate::sweep_test {
namespace {

using namespace test;
using runtime::BodyPoint;
using runtime::Sweep;
using runtime::ToolShape;

constexpr double kTolerance = 1e-6;  // m

Sweep sweep_of(const runtime::View& view, std::uint32_t tool, const Pose& from, const Pose& to, int* searches = nullptr) {
  const ToolShape<> shape(view, tool);
  const auto search = [&](const Pose& pose, const BodyPoint& near) {
    if (searches != nullptr) ++*searches;
    return shape.touch(view, pose, near);
  };
  return sweep(from, to, search(from, {}), shape.extent(), kTolerance, search);
}

TEST(Sweep, BallMeetsAPlaneWhereItsSkinDoes) {
  const Opened box(box_content(uniform()));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> draw(-1, 1);
  for (int i = 0; i < 200; ++i) {
    const Vec3 from{0.01 * draw(random), 0.01 * draw(random), kTop + kTipRadius + 0.004 * (1.1 + draw(random))};
    const Vec3 to{from.x + 0.003 * draw(random), from.y, kTop + kTipRadius - 0.004};
    const Sweep s = sweep_of(box.view, 0, upright(from), upright(to));
    ASSERT_TRUE(s.touches) << i;
    EXPECT_LE(s.touch.clearance, kTolerance);
    EXPECT_GT(s.touch.clearance, -1e-9) << "nothing is passed";
    EXPECT_NEAR(s.pose.translation.z, kTop + kTipRadius, 2 * kTolerance);
    const double share = (from.z - kTop - kTipRadius) / (from.z - to.z);
    EXPECT_NEAR(s.share, share, kTolerance / (from.z - to.z) * 2);
  }
}

TEST(Sweep, FreeWayEndsAtItsEndWithoutTouch) {
  const Opened box(box_content(uniform()));
  const Pose from = upright({0, 0, kTop + 0.02}), to = upright({0.02, 0, kTop + 0.01});
  const Sweep s = sweep_of(box.view, 0, from, to);
  EXPECT_FALSE(s.touches);
  EXPECT_EQ(s.share, 1);
  EXPECT_EQ(distance(s.pose.translation, to.translation), 0);
  EXPECT_NEAR(s.touch.clearance, 0.01 - kTipRadius, 1e-7);
}

TEST(Sweep, GrazingWayIsLimitedInSteps) {
  const Opened box(box_content(uniform()));
  const double height = kTop + kTipRadius + 2e-6;
  int searches = 0;
  const Sweep s = sweep_of(box.view, 0, upright({-0.005, 0, height}), upright({0.005, 0, height}), &searches);
  EXPECT_FALSE(s.touches);
  EXPECT_LT(s.share, 1);
  EXPECT_GT(s.share, 0);
  EXPECT_LE(searches, runtime::kSweepSteps + 1);
}

TEST(Sweep, OverlapAtTheStartTouchesThere) {
  const Opened box(box_content(uniform()));
  const Sweep s = sweep_of(box.view, 0, upright(centre(0.001)), upright(centre(0.003)));
  EXPECT_TRUE(s.touches);
  EXPECT_EQ(s.share, 0);
}

// A stem swings down about its far end; the closed form is the angle at which its tip's skin meets the top.
TEST(Sweep, SwingingStemMeetsThePlaneAtItsClosedFormAngle) {
  Options options = uniform();
  options.tools = Options::Tools::capsule;
  const Opened box(box_content(options));
  const double high = 0.02;  // m, of the far end over the top
  const auto pose = [&](double angle) {
    Pose p = turned(std::numbers::pi / 2 - angle, {0, 1, 0}, {});
    p.translation = Vec3{0.005, 0, kTop + high} - p.rotate({0, 0, kStemLength});
    return p;
  };
  double angle = 0;
  Sweep s;
  for (int k = 0; k < 100 && !s.touches; ++k) {
    s = sweep_of(box.view, 0, pose(0.01 * k), pose(0.01 * (k + 1)));
    angle = 0.01 * k + 0.01 * s.share;
  }
  ASSERT_TRUE(s.touches);
  EXPECT_NEAR(std::sin(angle), (high - kTipRadius) / kStemLength, 1e-3);
  EXPECT_NEAR(s.touch.core.point.z, 0, 1e-9);
  EXPECT_GT(s.touch.clearance, -1e-9);
}

}  // namespace
}  // namespace palpate::sweep_test
