// SPDX-License-Identifier: GPL-3.0-or-later
// A field that is blended again and again answers as one that is new: what it keeps is never of another place.
#include <algorithm>
#include <cmath>
#include <random>

#include "tests/runtime/support.hpp"

namespace palpate {
namespace {

using namespace test;
using runtime::BodyPoint;
using runtime::Field;
using runtime::Spin;
using runtime::ToolPoint;

// c goes on within a patch or leaps to another; p to vertices, edges and the middle of the tool's patches, and stays
// now and then; the tool, and how it is turned, change.
class Wandering {
public:
  Wandering(const runtime::View& view, unsigned seed) : view_(view), random_(seed) {}

  void go() {
    if (one_in(5)) at_.triangle = below(view_.meta->triangle_count);
    double a = unit(), b = unit();
    if (one_in(8)) a = 0;
    if (a + b > 1) {
      a = 1 - a;
      b = 1 - b;
    }
    at_.bary[0] = a;
    at_.bary[1] = b;
    at_.bary[2] = std::max(0.0, 1 - a - b);
    if (one_in(3)) {
      tool_ = below(view_.meta->tool_count);
      const layout::ToolRecord& tool = view_.tools[tool_];
      on_tool_ = {tool.first_patch, {1, 0, 0}};
      if (tool.patch_count > 0) on_tool_.patch += below(tool.patch_count);
    }
    const layout::ToolRecord& tool = view_.tools[tool_];
    if (one_in(3) && tool.vertex_count > 1) {
      const bool mesh = tool.kind == static_cast<std::uint32_t>(layout::ToolKind::mesh);
      const double share = one_in(3) ? 0 : unit(), rest = mesh && !one_in(3) ? unit() * (1 - share) : 0;
      on_tool_.weights[0] = 1 - share - rest;
      on_tool_.weights[1] = share;
      on_tool_.weights[2] = rest;
    }
    spun_ = view_.spins != nullptr && one_in(2);
    if (one_in(2)) pose_ = Pose::from_quaternion(unit() + 0.1, unit() - 0.5, unit() - 0.5, unit() - 0.5, {});
  }

  void build(Field& field) const {
    if (!spun_) return field.build(view_, tool_, at_, on_tool_);
    field.build_spun(view_, tool_, at_, on_tool_, normal(view_, at_), Spin{&pose_, 0});
  }

  Vec3 deflection(const Field& field) {
    const Vec3 n = field.normal(), x = runtime::any_orthogonal(n);
    const double z = (one_in(8) ? 1.3 : unit()) * view_.meta->depth_scale, most = 0.6 * view_.meta->sideways_scale;
    return (most * (unit() - 0.5)) * x + (most * (unit() - 0.5)) * cross(n, x) - z * n;
  }

private:
  double unit() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>(random_()) % count; }
  bool one_in(std::uint32_t count) { return below(count) == 0; }

  const runtime::View& view_;
  std::mt19937 random_;
  BodyPoint at_;
  std::uint32_t tool_ = 0;
  ToolPoint on_tool_;
  bool spun_ = false;
  Pose pose_;
};

void expect_as_new(const Options& options) {
  const Opened box(box_content(options));
  for (unsigned seed = 1; seed <= 4; ++seed) {
    Wandering way(box.view, seed);
    Field kept;
    for (int step = 0; step < 3000; ++step) {
      way.go();
      way.build(kept);
      Field fresh;
      way.build(fresh);
      for (int push = 0; push < 3; ++push) {
        const Vec3 d = way.deflection(fresh);
        const runtime::FieldForce now = kept.force(d), then = fresh.force(d);
        ASSERT_LT(length(now.force - then.force), 1e-12 * (1 + length(then.force)))
            << "seed " << seed << " step " << step;
        const runtime::DepthTerms a = kept.at_depth(then.depth), b = fresh.at_depth(then.depth);
        ASSERT_NEAR(kept.stored(a, d), fresh.stored(b, d), 1e-12);
        ASSERT_LT(length(kept.deepened(0.7 * then.depth, a, d) - fresh.deepened(0.7 * then.depth, b, d)), 1e-12);
        ASSERT_TRUE(now.limit == then.limit || std::fabs(now.limit - then.limit) < 1e-12);
      }
      ASSERT_NEAR(kept.covered(), fresh.covered(), 1e-14);
      ASSERT_NEAR(kept.depth_limit(), fresh.depth_limit(), 1e-14);
    }
  }
}

Options every_tool() {
  Options options;
  options.cells = 2;
  options.tools = Options::Tools::all;
  return options;
}

TEST(FieldKept, SeparableAnswersAsNew) {
  Options options = every_tool();
  expect_as_new(options);
  options.rim = true;
  expect_as_new(options);
  options.rim = options.friction = options.lateral = false;
  expect_as_new(options);
}

TEST(FieldKept, CoupledAnswersAsNew) {
  Options options = every_tool();
  for (const std::uint32_t bits : {8U, 12U, 16U}) {
    for (const int order : {2, 3, 4}) {
      options.bits = bits;
      options.coupled = order;
      expect_as_new(options);
    }
  }
}

TEST(FieldKept, SpunAnswersAsNew) {
  Options options = every_tool();
  options.spins = 3;
  expect_as_new(options);
  options.coupled = 2;
  options.bits = 12;
  expect_as_new(options);
}

}  // namespace
}  // namespace palpate
