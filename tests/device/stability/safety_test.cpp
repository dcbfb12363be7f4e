// SPDX-License-Identifier: GPL-3.0-or-later
// A file's figures on a device: they agree with one another, and with the file's own slopes.
#include "device/stability/safety.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/device/golden.hpp"

namespace palpate::device {
namespace {

using test::Golden;

// No force of the runtime's fields changes by more than the file's slope allows, anywhere between its sites.
TEST(FileStiffness, BoundsEveryForceBetweenTheSites) {
  for (const char* name : {"quadratic", "bits_8", "frictionless", "spring"}) {
    const Golden golden(name);
    const FileStiffness stiffest = file_stiffness(golden.view);
    EXPECT_GT(stiffest.depth, 0) << name;
    double most = 0;
    for (std::uint32_t t = 0; t < golden.view.meta->triangle_count; ++t) {
      for (const double a : {0.0, 0.2, 0.7, 1.0}) {
        runtime::BlendedResponse<> field;
        field.blend(golden.view, 0, {t, {a, 0.5 * (1 - a), 0.5 * (1 - a)}}, {}, {1, 0, 0}, {});
        const Vec3 n = field.normal();
        const double step = 0.02 * field.depth_limit();
        for (int k = 1; k <= 50; ++k) {
          const Vec3 change = field.force(-k * step * n) - field.force(-(k - 1) * step * n);
          most = std::max(most, length(change) / step);
        }
      }
    }
    EXPECT_LE(most, 1.001 * stiffest.slope.norm) << name;
    EXPECT_GE(most, 0.04 * stiffest.slope.norm) << name;
  }
}

TEST(Safety, SaysWhatMakesAFileSafe) {
  const Golden golden("quadratic");
  const SimKind& kind = *find_sim_kind("sim-touch");
  SafetyOptions options;
  options.scale = 50;
  const Safety hard = safety(golden.view, kind.plant, options);
  EXPECT_FALSE(hard.settles());
  EXPECT_FALSE(hard.passive_for_any_hand());
  EXPECT_EQ(hard.stiffness, 50 * hard.file.slope.norm);
  // In line with the coupling, and at the scale, it is as stiff as the bound.
  EXPECT_NEAR(1 / (1 / hard.largest_coupling + 1 / hard.stiffness), hard.passive.least(), 1e-6);
  options.scale = 0.999 * hard.largest_scale;
  const Safety soft = safety(golden.view, kind.plant, options);
  EXPECT_TRUE(soft.settles());
  EXPECT_TRUE(soft.passive_for_any_hand());
  EXPECT_TRUE(std::isinf(soft.largest_coupling));
}

TEST(SafetyOptions, SayWhatIsWrong) {
  SafetyOptions options;
  EXPECT_FALSE(options.validate());
  options.scale = 0;
  EXPECT_TRUE(options.validate());
  options.scale = 1;
  options.timing.period = -1;
  EXPECT_TRUE(options.validate());
}

}  // namespace
}  // namespace palpate::device
