// SPDX-License-Identifier: GPL-3.0-or-later
// The property test in short: every golden with every driver and motion, presses and slides on a concave body, slides onto
// harder tissue, rest, same bits. runtime_property is the same at any length.
#include "tests/runtime/property/property.hpp"

#include <algorithm>
#include <filesystem>

#include "palpate/format/mapped_file.hpp"
#include "tests/runtime/property/hand.hpp"
#include "tests/runtime/property/organ_motions.hpp"
#include "tests/runtime/support.hpp"
#include "tests/support/concave_samples.hpp"

namespace palpate::property_test {
namespace {

using namespace test;
using runtime::Contact;

std::vector<std::filesystem::path> goldens() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(PALPATE_GOLDENS)) {
    if (entry.path().extension() == ".palp") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Runs all drivers over every tool of every golden.
void expect_promises(const std::vector<Motion>& motions) {
  std::uint64_t ticks = 0;
  ASSERT_GT(goldens().size(), 8U);
  for (const std::filesystem::path& file : goldens()) {
    const runtime::MappedFile bytes(file.c_str());
    const runtime::OpenResult opened = runtime::View::open(bytes.data(), bytes.size());
    ASSERT_TRUE(opened) << opened.error;
    for (std::uint32_t tool = 0; tool < opened.view.meta->tool_count; ++tool) {
      const double friction = stiffest(opened.view, tool).friction;
      PropertyResult all;
      for (const Driver driver : kDrivers) {
        for (const Motion motion : motions) {
          const PropertyCase c{motion, driver, tool, 1000, 3};
          const PropertyResult r = run_property(opened.view, c);
          EXPECT_EQ(broken_promise(c, r, friction), "")
              << file << " tool " << tool << ' ' << name(driver) << ' ' << name(motion) << ": force " << r.force
              << ", step " << r.step << ", jump " << r.jump << ", gain " << r.gain;
          all.add(r);
        }
      }
      EXPECT_GT(all.touching, 250 * motions.size()) << file;
      ticks += all.ticks;
    }
  }
  EXPECT_GT(ticks, 60000 * motions.size());
}

TEST(PropertyTest, EveryGoldenKeepsThePromises) {
  expect_promises({Motion::press, Motion::graze, Motion::corner, Motion::turn});
}

TEST(PropertyTest, FastHandKeepsThePromises) { expect_promises({Motion::fast}); }

TEST(PropertyTest, PressesAndSlidesOnAConcaveBodyKeepThePromises) {
  for (const ConcaveShape& shape : concave_shapes()) {
    if (shape.name != "dent" && shape.name != "saddle" && shape.name != "sheet") continue;
    for (const double mu : {0.0, 0.3}) {
      Options options;
      options.search = true;
      options.friction = mu > 0;
      options.bias = false;
      const Opened body(concave_content(shape, options));
      SlideOptions slide;
      slide.runs = 6;
      slide.ticks = 2000;
      OrganResult r = press_sites(body.view, 0);
      EXPECT_GT(r.presses, 20U) << shape.name;
      r.add(slide_round(body.view, 0, slide));
      EXPECT_GT(r.travel, 0.1) << shape.name;
      EXPECT_EQ(broken_promise(r), "") << shape.name << ' ' << mu << ": " << r.stepped << " steps (" << r.step << "), "
                                       << r.lifts_off << " lifts (" << r.lift << "), " << r.lost_early << " early, weak "
                                       << r.longest_weak << " overlaps, touch changes " << r.touch_changes_per_size();
    }
  }
}

/// Least share of the place's own force on a slide at constant depth from tissue to tissue twice as stiff, over 10 mm.
double least_share(bool friction) {
  Options options = flat(friction);
  options.cells = 12;
  ResponseFileContent content = box_content(options);
  for (std::size_t i = 0; i < content.sites.size(); ++i) {
    const double share = std::clamp((content.surface_vertices[i][0] + 0.005) / 0.01, 0.0, 1.0);
    content.responses[i].unit *= static_cast<float>(1 + share);
  }
  const Opened box(std::move(content));
  Contact contact(box.view, 0);
  constexpr double kDepth = 0.0025;
  move(contact, centre(-1e-4, -0.015), centre(kDepth, -0.015));
  double least = 1;
  move(contact, centre(kDepth, -0.015), centre(kDepth, 0.015), 1e-5, [&](const Pose&, const Tick& tick) {
    const double own = contact.response().law().at(kDepth).normal_force;
    least = std::min(least, tick.force.z / own);
  });
  return least;
}

TEST(PropertyTest, SlideOntoTissueTwiceAsStiffFeelsItsForce) {
  EXPECT_GT(least_share(false), 0.83);
  EXPECT_GT(least_share(true), 0.95);
}

// From any state of a fast hand.
TEST(PropertyTest, ForceIsConstantWhileTheToolRests) {
  for (const std::filesystem::path& file : goldens()) {
    const runtime::MappedFile bytes(file.c_str());
    const runtime::OpenResult opened = runtime::View::open(bytes.data(), bytes.size());
    ASSERT_TRUE(opened) << opened.error;
    for (std::uint32_t tool = 0; tool < opened.view.meta->tool_count; ++tool) {
      for (const Motion motion : {Motion::fast, Motion::turn}) {
        property::Hand hand(opened.view, {motion, Driver::alone, tool, 0, 1 + tool, 0.25});
        Contact contact(opened.view, tool);
        int rested = 0;
        for (int i = 0; i < 4000; ++i) {
          const Pose pose = hand.next();
          const Tick tick = contact.tick(pose);
          if (i % 10 != 0 || !tick.touches()) continue;
          Contact still = contact;
          const Tick first = still.tick(pose);
          ASSERT_LE(distance(first.force, tick.force), 1e-12 * (1 + length(tick.force))) << file << ' ' << tool << ' ' << i;
          for (int k = 0; k < 5; ++k) {
            const Tick again = still.tick(pose);
            ASSERT_EQ(distance(again.force, first.force), 0) << file << ' ' << tool << ' ' << i << ' ' << k;
            ASSERT_EQ(distance(again.torque, first.torque), 0) << file << ' ' << tool << ' ' << i;
            ASSERT_EQ(again.state, first.state) << file << ' ' << tool << ' ' << i;
          }
          ++rested;
        }
        EXPECT_GT(rested, 30) << file << ' ' << tool;
      }
    }
  }
}

TEST(PropertyTest, SameMotionHasTheSameBits) {
  Options options;
  options.tools = Options::Tools::all;
  const Opened ball(ball_content(options));
  for (std::uint32_t tool = 0; tool < 3; ++tool) {
    for (const Driver driver : kDrivers) {
      const PropertyCase c{Motion::turn, driver, tool, 2000, 5};
      EXPECT_EQ(run_property(ball.view, c).hash, run_property(ball.view, c).hash);
    }
  }
}

}  // namespace
}  // namespace palpate::property_test
