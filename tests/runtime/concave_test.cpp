// SPDX-License-Identifier: GPL-3.0-or-later
// Hollows, grooves, fissures, sheets and ridges: a ball drawn slowly over them, and the battery's motions.
#include "tests/support/concave_samples.hpp"

#include <cmath>

#include "tests/runtime/drawn.hpp"

namespace palpate {
namespace {

using namespace test;
using runtime::Contact;
using runtime::SeveralContacts;

ResponseFileContent rubbed(const ConcaveShape& shape, double mu) {
  Options options = uniform();
  options.friction = mu > 0;
  options.lateral = false;
  options.search = true;
  ResponseFileContent content = concave_content(shape, options);
  set_friction(content, mu);
  return content;
}

const ConcaveShape& named(const std::vector<ConcaveShape>& shapes, const std::string& name) {
  return *std::find_if(shapes.begin(), shapes.end(), [&](const ConcaveShape& s) { return s.name == name; });
}

// Closed and turned outward: every edge is passed once each way, and the volume is positive.
TEST(Concave, TheShapesAreClosedSurfaces) {
  for (const ConcaveShape& shape : concave_shapes()) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    double volume = 0;
    for (const auto& t : shape.triangles) {
      const Triple &a = shape.points[t[0]], &b = shape.points[t[1]], &c = shape.points[t[2]];
      volume += dot(Vec3{a[0], a[1], a[2]}, cross(Vec3{b[0], b[1], b[2]}, Vec3{c[0], c[1], c[2]}));
      for (int k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
    }
    EXPECT_GT(volume, 0) << shape.name;
    for (const auto& [edge, count] : edges) {
      ASSERT_EQ(count, 1) << shape.name;
      ASSERT_EQ(edges.count({edge.second, edge.first}), 1U) << shape.name;
    }
  }
}

// In steps of a thousandth of the depth scale, across and along, there and back. Of the tool's way alone the force
// changes by at most three times the stiffness a metre, with a friction of 1, where what sticks may be pulled to
// several times the overlap, by 25 times. A contact point may leap only where the body is concave or thinner than the
// tool.
template <class Loop>
void draw_over_all(double most_free, double most_rough) {
  for (const ConcaveShape& shape : concave_shapes()) {
    for (const double mu : {0.0, 0.3, 1.0}) {
      const Opened body(rubbed(shape, mu));
      for (const double overlap : {0.02 * kDepthScale, 0.5 * kDepthScale}) {
        for (const bool along : {false, true}) {
          const Vec3 end = along ? Vec3{0, 0.012, 0} : Vec3{shape.reach, 0, 0}, aside{0, along ? 0 : 1e-3, 0};
          const DrawReport r =
              draw(body.view, over(body.view, aside - end, aside + end, overlap), overlap, Loop(body.view, 0));
          const auto where = [&] {
            return shape.name + (along ? " along, mu " : " across, mu ") + std::to_string(mu) + ", overlap " +
                   std::to_string(overlap);
          };
          EXPECT_GT(r.way, 0.8e-2) << where();
          EXPECT_LT(r.step, mu < 1 ? most_free : most_rough) << where();
          EXPECT_LT(r.trapped, 1) << where() << ": free within what it was deep and stuck";
          EXPECT_LT(r.held, 0.21) << where() << ": let go once the skin is clear";
          if (shape.name == "sheet") {
            EXPECT_EQ(r.hand_overs, 0) << where() << ": never through a sheet";
          }
          // Pressed lightly a contact may end and begin anew where it has given all back that the hand gave: 2 %.
          if (overlap < 0.1 * kDepthScale) {
            EXPECT_LT(r.lost, 0.05) << where();
          }
        }
      }
    }
  }
}

TEST(Concave, DrawnOverAllShapesTheForceNeitherStepsNorHolds) { draw_over_all<Contact>(3, 25); }
TEST(Concave, SoItDoesWithSeveralContacts) { draw_over_all<SeveralContacts<3>>(9, 25); }

// Down one wall, over the bottom and up the other one: the force turns and goes on, and c leaps once each way.
TEST(Concave, OneContactIsHandedFromWallToWall) {
  const std::vector<ConcaveShape> shapes = concave_shapes();
  for (const char* name : {"groove_90", "groove_40", "slit", "fissure"}) {
    for (const double mu : {0.3, 1.0}) {
      const Opened body(rubbed(named(shapes, name), mu));
      const double overlap = 0.5 * kDepthScale;
      const DrawReport r =
          draw(body.view, over(body.view, {-0.02, 1e-3, 0}, {0.02, 1e-3, 0}, overlap), overlap, Contact(body.view, 0));
      EXPECT_LT(r.lost, 0.05) << name << ' ' << mu;
      EXPECT_GT(r.weakest, 0.05) << name << ' ' << mu << ": felt all the way";
      EXPECT_GE(r.hand_overs, 2) << name << ' ' << mu;
      EXPECT_LE(r.hand_overs / r.way, 60) << name << ' ' << mu << ": not to and fro";
    }
  }
}

// Pressed straight into a groove: two contacts, one a wall, whose sum is along the bisector until their points c are so
// near that they merge. One contact alone answers with the wall that it met first.
TEST(Concave, TwoContactsBearATipInAGroove) {
  const std::vector<ConcaveShape> shapes = concave_shapes();
  for (const char* name : {"groove_90", "groove_40"}) {
    const Opened body(rubbed(named(shapes, name), 0));
    SeveralContacts<3> several(body.view, 0);
    Contact one(body.view, 0);
    const double bottom = over(body.view, {0, 0, 0}, {0, 0, 0}, 1e-7).front().z;
    int pressed = 0;
    for (double z = bottom + 1e-3; z > bottom - 3e-3; z -= 5e-6) {
      const runtime::SeveralTick<3> t = several.tick(upright({0, 0, z}));
      const Tick alone = one.tick(upright({0, 0, z}));
      if (z > bottom - 5e-4) continue;
      ASSERT_EQ(t.touching, 2) << name << ' ' << z;
      ASSERT_LT(distance(t.each[0].force + t.each[1].force, t.force), 1e-12) << name;
      ASSERT_GT(std::fabs(alone.force.x), 0.9 * std::fabs(alone.force.z)) << name;
      if (distance(t.each[0].body_point, t.each[1].body_point) < 0.005) break;
      ASSERT_LT(std::fabs(t.force.x), 0.01 * t.force.z) << name << ' ' << z;
      ++pressed;
    }
    EXPECT_GT(pressed, 20) << name;
  }
}

// What it does not keep (battery.md): with coupled responses friction drives at the corners of slit and saddle, and
// fast motions find steps.
TEST(Concave, TheBatteryKeepsItsPromisesOverThem) {
  std::uint64_t ticks = 0;
  for (const ConcaveShape& shape : concave_shapes()) {
    for (const int coupled : {0, 2}) {
      Options options;
      options.coupled = coupled;
      options.search = true;
      options.tools = Options::Tools::all;
      const Opened body(concave_content(shape, options));
      for (std::uint32_t tool = 0; tool < 3; ++tool) {
        for (const Driver driver : {Driver::alone, Driver::late, Driver::online, Driver::animated, Driver::several}) {
          for (const Motion motion : {Motion::press, Motion::graze, Motion::corner, Motion::turn}) {
            if (coupled > 0 && (motion == Motion::corner || shape.name == "slit")) continue;
            const BatteryCase c{motion, driver, tool, 400, 4};
            const BatteryResult r = run_battery(body.view, c);
            EXPECT_EQ(broken_promise(c, r), "") << shape.name << " tool " << tool << ' ' << name(driver) << ' '
                                                << name(motion) << ": step " << r.step << ", gain " << r.gain;
            ticks += r.ticks;
          }
        }
      }
    }
  }
  EXPECT_GT(ticks, 350000U);
}

}  // namespace
}  // namespace palpate
