// SPDX-License-Identifier: GPL-3.0-or-later
// The property battery, short, on every golden file; runtime_battery is the same at any length.
#include "tests/runtime/battery.hpp"

#include <algorithm>
#include <filesystem>

#include "palpate/format/mapped_file.hpp"
#include "tests/runtime/battery_hand.hpp"
#include "tests/runtime/support.hpp"

namespace palpate {
namespace {

using namespace test;

TEST(Battery, EveryGoldenFileKeepsThePromises) {
  std::uint64_t ticks = 0;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(PALPATE_GOLDENS)) {
    if (entry.path().extension() == ".palp") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  ASSERT_GT(files.size(), 8U);
  for (const std::filesystem::path& file : files) {
    const runtime::MappedFile bytes(file.c_str());
    const runtime::OpenResult opened = runtime::View::open(bytes.data(), bytes.size());
    ASSERT_TRUE(opened) << opened.error;
    for (std::uint32_t tool = 0; tool < opened.view.meta->tool_count; ++tool) {
      BatteryResult all;
      for (const Driver driver : {Driver::alone, Driver::late, Driver::online, Driver::animated}) {
        for (const Motion motion : {Motion::press, Motion::graze, Motion::corner, Motion::turn, Motion::fast}) {
          const BatteryCase c{motion, driver, tool, 1000, 3};
          const BatteryResult r = run_battery(opened.view, c);
          EXPECT_EQ(broken_promise(c, r), "") << file << " tool " << tool << ' ' << name(driver) << ' ' << name(motion)
                                              << ": step " << r.step << ", gain " << r.gain;
          all.add(r);
        }
      }
      EXPECT_GT(all.touching, 1000U) << file;
      EXPECT_GT(all.sliding, 500U) << file;
      ticks += all.ticks;
    }
  }
  EXPECT_GT(ticks, 150000U);
}

BatteryResult run_golden(const char* file, const BatteryCase& c) {
  const runtime::MappedFile bytes((PALPATE_GOLDENS + std::string("/") + file).c_str());
  const runtime::OpenResult opened = runtime::View::open(bytes.data(), bytes.size());
  EXPECT_TRUE(opened) << opened.error;
  const BatteryResult r = opened ? run_battery(opened.view, c) : BatteryResult{};
  EXPECT_EQ(broken_promise(c, r), "") << "step " << r.step;
  return r;
}

// A rod behind old searches is held at a corner that its c cannot leave: what friction bears must not turn round there.
TEST(Battery, ACornerThatHoldsAContactTurnsNoForceRound) {
  EXPECT_GT(run_golden("grasp.palp", {Motion::fast, Driver::late, 1, 22000, 2, 0.25}).touching, 5000U);
}

// A ball rolls over the edge of a body that swells and turns, to where the surface that c would go to is not touched: 4
// N must not end there at once.
TEST(Battery, AContactThatIsDrawnOffTheBodyLetsGoAsTheToolMoves) {
  const BatteryResult r = run_golden("coupled_2.palp", {Motion::fast, Driver::animated, 0, 39000, 1, 0.25});
  EXPECT_LT(r.begin, 5e-3);
  EXPECT_GT(r.force, 0.5);  // it pressed hard
}

// A gem drawn deep through a body whose vertices move leaps over to its far side, where the body as it is lies so that
// the tool is off it: half of stiffness times depth scale must not end there at once.
TEST(Battery, AContactThatLeapsOverABodyThatMovesGoesOn) {
  EXPECT_LT(run_golden("spin.palp", {Motion::fast, Driver::animated, 2, 28000, 14, 0.25}).begin, 5e-3);
}

// Where c goes on over a body that swells, the body lies otherwise about it: what is stored more by that nobody gave.
TEST(Battery, ABodyThatSwellsGivesBackNoMoreThanItTook) {
  EXPECT_LT(run_golden("frictionless.palp", {Motion::press, Driver::animated, 0, 40000, 14, 0.25}).gain, 2e-3);
  EXPECT_LT(run_golden("coupled_2.palp", {Motion::press, Driver::animated, 0, 40000, 14, 0.25}).gain, 2e-3);
  EXPECT_LT(run_golden("three_tools.palp", {Motion::press, Driver::animated, 1, 40000, 12, 0.25}).gain, 2e-3);
}

// A hand that goes a depth scale in one tick: what c's way stores is no gift either, nor what a law would have stored
// of a way on which friction slipped.
TEST(Battery, AFastHandGetsBackNoMoreThanItGave) {
  for (const char* file : {"frictionless.palp", "linear.palp", "coupled_4.palp", "separable.palp"}) {
    EXPECT_LT(run_golden(file, {Motion::fast, Driver::alone, 0, 40000, 1, 0.25}).gain, 2e-3) << file;
  }
  EXPECT_LT(run_golden("spin_coupled.palp", {Motion::fast, Driver::animated, 2, 20000, 11, 0.25}).gain, 2e-3);
}

// Nor what a rim would have stored, which paid what the contact owed: up to half of what went through it came back.
TEST(Battery, AFastHandGetsNothingOfARimThatSlips) {
  for (const bool relief : {false, true}) {
    Options options;
    options.coupled = 2;
    options.cells = 2;
    options.lateral = false;
    options.rim = true;
    options.relief = relief;
    const Opened box(box_content(options));
    EXPECT_LT(run_battery(box.view, {Motion::fast, Driver::alone, 0, 60000, 1, 0.25}).gain, 2e-3);
  }
}

// Wherever a fast hand comes to rest, the account takes nothing more and the force changes as c goes on only: what slid
// in one leap from first touch to beyond the limit, or at a corner that holds c up, has given way in that tick.
TEST(Battery, AtRestTheForceStaysWhereCDoes) {
  for (const char* file : {"grasp.palp", "linear.palp", "spin_coupled.palp", "coupled_4.palp", "relief.palp"}) {
    const runtime::MappedFile bytes((PALPATE_GOLDENS + std::string("/") + file).c_str());
    const runtime::OpenResult opened = runtime::View::open(bytes.data(), bytes.size());
    ASSERT_TRUE(opened) << opened.error;
    for (std::uint32_t tool = 0; tool < opened.view.meta->tool_count; ++tool) {
      const double k = stiffest(opened.view, tool).within;
      const double nothing = 1e-12 * k * opened.view.meta->depth_scale * opened.view.meta->depth_scale;  // J
      battery::Hand hand(opened.view, {Motion::fast, Driver::alone, tool, 0, 1 + tool, 0.25});
      runtime::Contact contact(opened.view, tool);
      int slid = 0;
      for (int i = 0; i < 25000; ++i) {
        const Pose pose = hand.next();
        Tick last = contact.tick(pose);
        slid += last.state == State::slide;
        runtime::Contact still = contact;
        const double lost = still.lost();
        for (int j = 0; j < 2 && last.state == State::slide; ++j) {
          const Tick tick = still.tick(pose);
          if (tick.state == State::released) break;
          const double crept = distance(tick.body_point, last.body_point);
          ASSERT_LE(distance(tick.force, last.force), k * (2.5 * crept + 1e-9 * opened.view.meta->depth_scale))
              << file << " tool " << tool << ", tick " << i;
          ASSERT_NEAR(still.lost(), lost, nothing) << file << " tool " << tool << ", tick " << i;
          last = tick;
        }
      }
      EXPECT_GT(slid, 100);
    }
  }
}

TEST(Battery, SameBitsEveryRun) {
  Options options;
  options.coupled = 4;
  options.tools = Options::Tools::all;
  const Opened ball(ball_content(options));
  for (std::uint32_t tool = 0; tool < 3; ++tool) {
    for (const Driver driver : {Driver::alone, Driver::late, Driver::online, Driver::animated}) {
      const BatteryCase c{Motion::turn, driver, tool, 3000, 5};
      EXPECT_EQ(run_battery(ball.view, c).hash, run_battery(ball.view, c).hash);
    }
  }
}

// A frictionless tool drawn over a body that grows harder stores more than it was given: without the account a lift at
// the hard end gives all of that back.
TEST(Battery, ALiftAtAHarderPlaceGivesBackWhatTheHandGave) {
  Options options = uniform();
  options.friction = options.lateral = false;
  ResponseFileContent content = box_content(options);
  for (std::size_t i = 0; i < content.sites.size(); ++i) {
    const double factor = 1 + (content.sites[i].position[0] + kBoxSize / 2) / kBoxSize;
    for (float& c : content.responses[i].normal) c = static_cast<float>(c * factor);
  }
  const Opened box(std::move(content));
  runtime::Contact contact(box.view, 0);
  runtime::EnergyMeter meter;
  const auto tick = [&](double x, double depth) {
    const Pose pose = upright({x, 0, kTop + kTipRadius - depth});
    const Tick t = contact.tick(pose);
    meter.add(pose, t);
    return t;
  };
  for (double z = -1e-4; z < 0.003; z += 2e-6) tick(-0.012, z);
  const double soft = meter.given();
  EXPECT_NEAR(contact.stored(), soft, 1e-3 * soft);
  Tick t;
  for (double x = -0.012; x < 0.012; x += 5e-6) t = tick(x, 0.003);
  EXPECT_NEAR(t.force.z, hertz(0.003) * 1.7, 1e-3) << "it feels as hard as it is";
  EXPECT_NEAR(contact.stored() - contact.owed(), meter.given() - meter.returned(), 1e-3 * soft);
  const double owed = contact.owed();
  EXPECT_GT(owed, 0.3 * soft);
  EXPECT_EQ(contact.lost(), 0) << "what is owed is not taken before something comes back";
  double last = t.force.z, lost = 0;
  for (double z = 0.003; z > -1e-4; z -= 2e-6) {
    t = tick(0.012, z);
    lost = std::max(lost, contact.lost());  // of one contact: where the force ends early another one begins
    EXPECT_LE(t.force.z, last);
    EXPECT_LT(last - t.force.z, 4e-6 * 2 * 3 * hertz(kDepthScale) / kDepthScale);
    last = t.force.z;
  }
  EXPECT_EQ(last, 0);
  EXPECT_NEAR(lost, owed, 1e-3 * soft);
  EXPECT_GE(meter.dissipated(0), -1e-3 * soft);
  EXPECT_LT(meter.dissipated(0), 0.02 * soft) << "and no less than it gave";
}

// The field is replaced (a rod lies otherwise) before the lift of the same tick is told: half of what that lift took
// out of the store still has to be paid.
TEST(EnergyAccount, HoldingBackHidesNoMotion) {
  runtime::EnergyAccount account;
  EXPECT_EQ(account.replaced(1, 2, false, 0), 0) << "half of what is stored may be owed";
  EXPECT_EQ(account.owed(), 1);
  // A lift to 1.5 J, and there to a place that is harder.
  EXPECT_EQ(account.replaced(1.5, 2, false, 0), 1);
  account.held_back(1);
  EXPECT_EQ(account.owed(), 0.5);
  EXPECT_EQ(account.due(1), 0.25);
  account.paid(0.25, 0.75);
  EXPECT_EQ(account.lost(), 1.25);
}

// Of 5 J that seemed to be stored before a slide the hand did not give 4: the slide stores 1 J more than it got.
TEST(EnergyAccount, WhatTheHandDidNotGiveIsNotLost) {
  runtime::EnergyAccount account;
  EXPECT_EQ(account.replaced(5, 2, true, -4), 0);
  EXPECT_EQ(account.owed(), 1);
  EXPECT_EQ(account.replaced(2, 2, true, 0.25), 0) << "friction pays";
  EXPECT_EQ(account.owed(), 0.75);
  account.reset();
  EXPECT_EQ(account.replaced(5, 2, true, -2), 0);
  EXPECT_EQ(account.owed(), 0) << "with friction a loss buys nothing";
  EXPECT_EQ(account.replaced(-4, -3.75, true, 0), 0) << "what is stored may be less than nothing";
  EXPECT_EQ(account.owed(), 0.25);
}

}  // namespace
}  // namespace palpate
