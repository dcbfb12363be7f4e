// SPDX-License-Identifier: GPL-3.0-or-later
// Features that a program leaves out: the same forces without them, a file that needs them refused by name.
#include <string>
#include <vector>

#include "tests/runtime/support.hpp"

namespace palpate {
namespace {

using namespace test;
using runtime::BasicAdjustedContact;
using runtime::BasicContact;
using runtime::BasicMovingContact;
using runtime::Contact;
using runtime::View;

constexpr std::uint32_t kPlain = layout::feature_lateral | layout::feature_friction;

// Down, aside until it slides, back, up.
Pose stroking(int tick) {
  const double t = 2e-3 * tick, depth = 0.003 * std::sin(2 * t), aside = 0.004 * std::sin(5 * t);
  return upright({aside, 0.3 * aside, kTop + kTipRadius - depth});
}

template <std::uint32_t kFeatures>
void expect_the_same(const Options& options) {
  const Opened box(box_content(options));
  ASSERT_EQ(box.view.features, kFeatures);
  std::vector<runtime::SiteScales::Scale> factors(box.view.meta->site_count);
  runtime::SiteScales scales(box.view, factors.data());
  for (std::uint32_t i = 0; i < factors.size(); i += 2) scales.set(i, 0.5F);
  Contact full(box.view, 0);
  runtime::MovingContact full_moving(box.view, 0);
  runtime::AdjustedContact full_adjusted(box.view, 0, scales);
  BasicContact<kFeatures> lean(box.view, 0);
  BasicMovingContact<kFeatures> moving(box.view, 0);
  BasicAdjustedContact<kFeatures> adjusted(box.view, 0, scales);
  int touched = 0;
  for (int i = 0; i < 2000; ++i) {
    const Pose body = turned(1e-4 * i, {0, 0, 1}, {1e-5 * i, 0, 0}), pose = stroking(i), tool = body * pose;
    const Tick a[] = {full.tick(pose), full_moving.tick(body, tool), full_adjusted.tick(pose, 1e-3)};
    const Tick b[] = {lean.tick(pose), moving.tick(body, tool), adjusted.tick(pose, 1e-3)};
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_EQ(a[k].state, b[k].state) << k << ' ' << i;
      ASSERT_EQ(distance(a[k].force, b[k].force), 0) << k << ' ' << i;
      ASSERT_EQ(distance(a[k].torque, b[k].torque), 0) << k << ' ' << i;
    }
    touched += length(b[0].force) > 0;
  }
  EXPECT_GT(touched, 500);
}

TEST(LeftOut, GivesTheSameForces) {
  Options options;
  expect_the_same<kPlain>(options);
  options.search = true;
  expect_the_same<kPlain | layout::feature_search>(options);
  options.search = options.friction = options.lateral = false;
  expect_the_same<0>(options);
  options.tools = Options::Tools::capsule;
  expect_the_same<layout::feature_tool_patches>(options);
  Options coupled;
  coupled.coupled = 4;
  expect_the_same<kPlain | layout::feature_coupled>(coupled);
}

TEST(LeftOut, TakesNoMemory) {
  static_assert(sizeof(BasicContact<0>) < sizeof(BasicContact<kPlain>));
  static_assert(sizeof(BasicContact<kPlain>) + sizeof(coupled::Law) < sizeof(Contact) + 16);
  static_assert(sizeof(BasicMovingContact<0>) == sizeof(BasicContact<0>));
  static_assert(sizeof(BasicAdjustedContact<0>) < sizeof(BasicAdjustedContact<kPlain>));
}

// What a file holds and a program left out.
template <std::uint32_t kFeatures>
void expect_refused(const Options& options, const std::string& name) {
  const Opened file(box_content(options));
  const runtime::OpenResult opened = View::open<kFeatures>(file.bytes.data(), file.bytes.size());
  EXPECT_FALSE(opened);
  EXPECT_EQ(opened.error, "the file has " + name + ", which this program leaves out");
  EXPECT_FALSE(View::open_trusted<kFeatures>(file.bytes.data(), file.bytes.size()));
}

TEST(LeftOut, IsNamedWhereAFileNeedsIt) {
  constexpr std::uint32_t kAll = layout::feature_all;
  Options options;
  expect_refused<kAll & ~layout::feature_lateral>(options, "sideways forces of straight pushes");
  expect_refused<kAll & ~layout::feature_friction>(options, "friction");
  options.search = true;
  expect_refused<kAll & ~layout::feature_search>(options, "a search tree");
  options.tools = Options::Tools::capsule;
  expect_refused<kAll & ~layout::feature_tool_patches>(options, "tools of several vertices");
  options.coupled = 2;
  options.lateral = false;
  expect_refused<kAll & ~layout::feature_coupled>(options, "coupled responses");
  options.spins = 4;
  expect_refused<kAll & ~layout::feature_spin>(options, "spins of tools");
  Options relieved;
  relieved.relief = true;
  expect_refused<kAll & ~layout::feature_relief>(relieved, "contacts that push less where they slip");
  Options holding;
  holding.grasp = holding.turn = true;
  expect_refused<kAll & ~layout::feature_grasp>(holding, "grasps");
  expect_refused<kAll & ~layout::feature_turn>(holding, "turns of grasps");
}

TEST(LeftOut, IsAFaultWhereAViewOfMoreIsTicked) {
  const Opened box(box_content({}));
  BasicContact<layout::feature_lateral> contact(box.view, 0);
  EXPECT_EQ(contact.tick(stroking(200)).state, State::fault);
  EXPECT_EQ(contact.tick(stroking(200), runtime::search(box.view, 0, stroking(200))).state, State::fault);
  EXPECT_EQ(BasicMovingContact<layout::feature_lateral>(box.view, 0).tick(Pose(), stroking(200)).state, State::fault);
  // Grasps are no matter of a contact.
  Options holding;
  holding.grasp = true;
  const Opened held(box_content(holding));
  EXPECT_EQ(BasicContact<kPlain>(held.view, 0).tick(stroking(0)).state, Contact(held.view, 0).tick(stroking(0)).state);
}

}  // namespace
}  // namespace palpate
