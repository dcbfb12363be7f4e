// SPDX-License-Identifier: GPL-3.0-or-later
// The drawn dent: against the compliance between two points, and against the tool's skin.
#include "palpate/shared/dent.hpp"

#include "tests/runtime/support.hpp"

#include <type_traits>
#include <vector>

namespace palpate::dent_test {
namespace {

using namespace test;
using namespace runtime;

static_assert(std::is_trivially_copyable_v<Dents>, "a TripleBuffer copies it");

ResponseFileContent box(int modes) {
  Options options = flat(false);
  options.modes = modes;
  return box_content(options);
}

// The vertices of the contact surface.
std::vector<Vec3> surface(const View& view) {
  std::vector<Vec3> points;
  for (std::uint32_t v = 0; v < view.meta->vertex_count; ++v) points.push_back(vertex(view, v));
  return points;
}

// A contact with a force, whose tool is far away.
Dents::One pressed(const View& view, const Vec3& at, const Vec3& force) {
  Dents::One one;
  one.at = closest_point(view, at, {}).at;
  one.force = force;
  one.radius = 0.002;
  one.pose = upright({0, 0, 1});
  return one;
}

TEST(Dent, VerticesMoveByTheComplianceTimesTheForces) {
  const Opened file(box(16));
  const View& view = file.view;
  const std::vector<Vec3> rest = surface(view);
  std::vector<Vec3> moved(rest.size());
  Dents dents;
  dents.contact[dents.count++] = pressed(view, {0.004, 0.002, kTop}, {0.1, -0.2, 1.5});
  dents.contact[dents.count++] = pressed(view, {-0.01, 0.005, kTop}, {0, 0.3, 0.8});
  Dent dent(view);
  dent.bind(rest.data(), rest.size());
  ASSERT_EQ(dent.count(), rest.size());
  dent.apply(dents, moved.data());
  const Compliance compliance(view);
  double most = 0;
  for (std::size_t v = 0; v < rest.size(); ++v) {
    const BodyPoint to = closest_point(view, rest[v], {}).at;
    Vec3 expected = rest[v];
    bool far = true;
    for (int k = 0; k < dents.count; ++k) {
      expected = expected - compliance.between(dents.contact[k].at, to) * dents.contact[k].force;
      far = far && length(rest[v] - position(view, dents.contact[k].at)) > 0.01;
    }
    if (!far) continue;
    EXPECT_LT(length(moved[v] - expected), 1e-9);
    most = std::max(most, length(moved[v] - rest[v]));
  }
  EXPECT_GT(most, 1e-5);
}

TEST(Dent, WithoutContactsNothingMoves) {
  const Opened file(box(8));
  const std::vector<Vec3> rest = surface(file.view);
  std::vector<Vec3> moved(rest.size());
  Dent dent(file.view);
  dent.bind(rest.data(), rest.size());
  dent.apply(Dents{}, moved.data());
  for (std::size_t v = 0; v < rest.size(); ++v) EXPECT_EQ(length(moved[v] - rest[v]), 0);
}

TEST(Dent, NoVertexLiesInTheTool) {
  const Opened file(box(0));
  Contact contact(file.view, 0);
  Pose pose;
  Tick tick;
  for (int k = 0; k <= 100; ++k) tick = contact.tick(pose = upright(centre(4e-5 * k)));
  Dents dents;
  ASSERT_TRUE(dents.add(file.view, tick, pose, 0));
  ASSERT_EQ(dents.count, 1);
  EXPECT_NEAR(dents.contact[0].radius, std::sqrt(kTipRadius * 0.004), 1e-6);
  std::vector<Vec3> rest;
  for (int i = -20; i <= 20; ++i) rest.push_back({0.0004 * i, 0, kTop});
  std::vector<Vec3> moved(rest.size());
  Dent dent(file.view);
  dent.bind(rest.data(), rest.size());
  dent.apply(dents, moved.data());
  for (const Vec3& point : moved) EXPECT_GE(distance(point, pose.translation), kTipRadius * (1 - 1e-6));
  EXPECT_NEAR(moved[20].z, kTop - 0.004, 1e-6);
  EXPECT_LT(moved[0].z, kTop);
}

TEST(Dents, ATickWithoutContactAddsNothingAndTheNinthHasNoRoom) {
  const Opened file(box(0));
  Dents dents;
  EXPECT_TRUE(dents.add(file.view, Tick{}, Pose{}, 0));
  EXPECT_EQ(dents.count, 0);
  Tick tick;
  tick.state = State::stick;
  for (int k = 0; k < Dents::kMost; ++k) EXPECT_TRUE(dents.add(file.view, tick, Pose{}, 0));
  EXPECT_FALSE(dents.add(file.view, tick, Pose{}, 0));
}

}  // namespace
}  // namespace palpate::dent_test
