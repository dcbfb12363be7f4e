// SPDX-License-Identifier: GPL-3.0-or-later
// Features that a program leaves out: the same forces without them; a file that needs them is refused by name.
#include <string>
#include <vector>

#include "tests/runtime/support.hpp"

namespace palpate::features_test {
namespace {

using namespace test;
using runtime::BasicContact;
using runtime::Contact;
using runtime::ContactSet;
using runtime::RigidMotion;
using runtime::StiffnessScale;
using runtime::StillBody;
using runtime::View;

constexpr std::uint32_t kPlain = layout::feature_tangential_bias | layout::feature_friction;

template <std::uint32_t kFeatures>
void expect_the_same(const Options& options) {
  const Opened box(box_content(options));
  ASSERT_EQ(box.view.features, kFeatures);
  std::vector<runtime::SiteScales::Scale> memory(box.view.meta->site_count);
  runtime::SiteScales scales(box.view, memory.data());
  for (std::uint32_t i = 0; i < memory.size(); i += 2) scales.set(i, 0.5F);
  const StiffnessScale<StillBody> scaled{{&box.view}, &scales, &box.view};
  Contact full(box.view, 0), full_moving(box.view, 0), full_scaled(box.view, 0);
  BasicContact<kFeatures> lean(box.view, 0), moving(box.view, 0), lean_scaled(box.view, 0);
  ContactSet<3> full_set(box.view, 0);
  ContactSet<3, kFeatures> set(box.view, 0);
  int touched = 0;
  for (int i = 0; i < 2000; ++i) {
    const Pose body = turned(1e-4 * i, {0, 0, 1}, {1e-5 * i, 0, 0}), pose = probing(2e-3 * i);
    const RigidMotion motion{&box.view, body};
    const Tick a[] = {full.tick(pose), full_moving.tick(body * pose, motion), full_scaled.tick(pose, scaled), full_set.tick(pose)};
    const Tick b[] = {lean.tick(pose), moving.tick(body * pose, motion), lean_scaled.tick(pose, scaled), set.tick(pose)};
    for (std::size_t k = 0; k < 4; ++k) {
      ASSERT_EQ(a[k].state, b[k].state) << k << ' ' << i;
      ASSERT_EQ(distance(a[k].force, b[k].force), 0) << kFeatures << ' ' << k << ' ' << i;
      ASSERT_EQ(distance(a[k].torque, b[k].torque), 0) << k << ' ' << i;
    }
    touched += length(b[0].force) > 0;
  }
  EXPECT_GT(touched, 500);
}

TEST(Features, ContactWithoutUnusedFeaturesHasTheSameForces) {
  Options options;
  expect_the_same<kPlain>(options);
  options.softening = true;
  expect_the_same<kPlain | layout::feature_slip_softening>(options);
  options.softening = false;
  options.search = true;
  expect_the_same<kPlain | layout::feature_search>(options);
  options.search = options.friction = options.bias = false;
  expect_the_same<0>(options);
  options.tools = Options::Tools::capsule;
  expect_the_same<layout::feature_tool_patches>(options);
}

template <std::uint32_t kFeatures>
void expect_refused(const Options& options, const std::string& name) {
  const Opened file(box_content(options));
  const runtime::OpenResult opened = View::open<kFeatures>(file.bytes.data(), file.bytes.size());
  EXPECT_FALSE(opened);
  EXPECT_EQ(opened.error, "the file has " + name + ", which this program leaves out");
  EXPECT_FALSE(View::open_trusted<kFeatures>(file.bytes.data(), file.bytes.size()));
}

TEST(Features, FileThatNeedsMoreIsRefusedByName) {
  constexpr std::uint32_t kAll = layout::feature_all;
  Options options;
  expect_refused<kAll & ~layout::feature_tangential_bias>(options, "tangential forces of normal indentations");
  expect_refused<kAll & ~layout::feature_friction>(options, "friction");
  options.search = true;
  expect_refused<kAll & ~layout::feature_search>(options, "a search tree");
  options.tools = Options::Tools::capsule;
  expect_refused<kAll & ~layout::feature_tool_patches>(options, "tools of several vertices");
  options.spins = 4;
  expect_refused<kAll & ~layout::feature_spin>(options, "spins of tools");
  Options softening;
  softening.softening = true;
  expect_refused<kAll & ~layout::feature_slip_softening>(softening, "softening of contacts that slip");
  Options bonded;
  bonded.bonded = bonded.bonded_torque = true;
  expect_refused<kAll & ~layout::feature_bonded>(bonded, "bonded contacts");
  expect_refused<kAll & ~layout::feature_bonded_torque>(bonded, "torques of bonded contacts");
}

TEST(Features, TickOfAViewThatHasMoreIsAFault) {
  const Opened box(box_content({}));
  BasicContact<layout::feature_tangential_bias> contact(box.view, 0);
  const Pose pose = probing(0.4);
  EXPECT_EQ(contact.tick(pose).fault, runtime::Fault::feature_left_out);
  EXPECT_EQ(contact.tick(pose, runtime::search(box.view, 0, pose)).fault, runtime::Fault::feature_left_out);
  EXPECT_EQ(contact.tick(pose, RigidMotion{&box.view, Pose()}).state, State::fault);
  // A bond is no part of a contact.
  Options bonded;
  bonded.bonded = true;
  const Opened file(box_content(bonded));
  EXPECT_EQ(BasicContact<kPlain>(file.view, 0).tick(pose).state, Contact(file.view, 0).tick(pose).state);
}

}  // namespace
}  // namespace palpate::features_test
