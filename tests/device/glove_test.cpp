// SPDX-License-Identifier: GPL-3.0-or-later
// A glove from its extreme poses to the pulls of its five cables, on a simulated hand that the calibration never sees.
#include "device/glove_source.hpp"

#include <gtest/gtest.h>

#include "device/device.hpp"
#include "palpate/runtime.hpp"
#include "tests/device/golden.hpp"
#include "tests/device/simulated_glove.hpp"
#include "tests/runtime/allocation_counter.hpp"

namespace palpate::test {
namespace {

using namespace device;

/// Largest and mean distance (m) between a calibrated fingertip and the true one.
struct Miss {
  double largest = 0, mean = 0;
};

Miss miss(const SimulatedGloveOptions& options, std::uint64_t hands) {
  Miss miss;
  constexpr int kPoses = 200;
  for (std::uint64_t seed = 1; seed <= hands; ++seed) {
    SimulatedGlove glove(seed, options);
    const HandCalibration found = calibrate_hand(glove.record());
    EXPECT_TRUE(found.usable()) << found.problem;
    for (int k = 0; k < kPoses; ++k) {
      const HandJoints pose = glove.any_pose(), angles = found.angles(glove.read(pose));
      for (std::size_t f = 0; f < kFingers; ++f) {
        const double off = length(found.hand[f].tip(angles[f]).translation - glove.tip(f, pose));
        miss.largest = std::max(miss.largest, off);
        miss.mean += off / (kPoses * static_cast<double>(kFingers * hands));
      }
    }
  }
  return miss;
}

// What noise and whole counts of the sensors leave (a count is about 0.7 degrees): a hand of the typical shape.
TEST(HandCalibration, FindsTheFingertipsOfHandsOfAnySize) {
  for (const double size : {0.7, 1.0, 1.4}) {
    SimulatedGloveOptions options;
    options.size = size;
    const Miss off = miss(options, 10);
    EXPECT_LT(off.largest, size * 3e-3);
    EXPECT_LT(off.mean, size * 1e-3);
    SimulatedGlove glove(7, options);
    for (const double found : calibrate_hand(glove.record()).size) EXPECT_NEAR(found, size, 1e-9);
  }
}

// People's hands: bones of their own, poses missed by up to 3 degrees a joint, tips measured to 1 mm.
TEST(HandCalibration, FindsTheFingertipsOfPeople) {
  SimulatedGloveOptions options;
  options.size = 0.9;
  options.shape = 0.05;
  options.astray = 0.05;
  options.measured = 1e-3;
  const Miss calibrated = miss(options, 30);
  EXPECT_LT(calibrated.largest, 9e-3);
  EXPECT_LT(calibrated.mean, 3e-3);
}

// Kinematics against plain trigonometry: straight, and each bone at a right angle to the one before.
TEST(HandModel, BendsAsAHandDoes) {
  FingerModel finger;
  finger.bones = {0.04, 0.03, 0.02};
  finger.coupling = 1;
  const auto near = [](const Vec3& a, const Vec3& b) { EXPECT_LT(length(a - b), 1e-15); };
  near(finger.tip({0, 0, 0}).translation, {0, 0.09, 0});
  near(finger.tip({0, kPi / 2, 0}).translation, {0, 0, -0.09});
  near(finger.tip({0, 0, kPi / 2}).translation, {0, 0.02, -0.03});
  near(finger.tip({kPi / 2, 0, 0}).translation, {-0.09, 0, 0});
  near(finger.tip({0, kPi / 2, 0}).rotate({0, 0, 1}), {0, 1, 0});
  EXPECT_TRUE(finger.tip({0.3, 0.7, 0.2}).valid());
  for (const FingerModel& each : typical_hand()) EXPECT_TRUE(each.tip({0.3, 0.7, 0.2}).valid());
}

// A right hand, palm down: the thumb at -x; fingers spread apart and close under the palm.
TEST(HandModel, IsARightHand) {
  const HandModel hand = typical_hand();
  const std::vector<KeyPose> poses = extreme_poses();
  const auto tip = [&](std::size_t pose, std::size_t f) { return hand[f].tip(poses[pose].angles[f]).translation; };
  for (std::size_t f = 1; f < kFingers; ++f) {
    for (const std::size_t pose : {0, 1}) EXPECT_LT(tip(pose, f - 1).x + 0.01, tip(pose, f).x) << finger_name(f);
    const double flat = length(tip(0, f) - tip(0, f - 1)), spread = length(tip(1, f) - tip(1, f - 1));
    EXPECT_GT(spread, flat + 0.005) << finger_name(f);
    EXPECT_LT(tip(2, f).z, -0.01) << finger_name(f);
    EXPECT_LT(tip(2, f).y, hand[f].base.translation.y + 0.01) << finger_name(f);
  }
  EXPECT_GT(tip(2, 0).x, tip(0, 0).x + 0.02);
  EXPECT_LT(tip(2, 0).z, tip(0, 0).z);
}

/// The problem that a spoilt recording is refused with.
template <class Spoil>
std::string refused(const Spoil& spoil) {
  SimulatedGlove glove(3, {});
  std::vector<KeyPose> poses = glove.record();
  spoil(poses);
  const HandCalibration found = calibrate_hand(poses);
  EXPECT_FALSE(found.usable());
  return found.problem;
}

TEST(HandCalibration, NamesWhatIsWrong) {
  using Poses = std::vector<KeyPose>;
  const auto says = [](const std::string& problem, const std::string& part) {
    EXPECT_NE(problem.find(part), std::string::npos) << problem;
  };
  says(HandCalibration().problem, "not calibrated");
  says(refused([](Poses& p) { p.resize(1); }), "1 poses");
  says(refused([](Poses& p) { p[1].frames.resize(3); }), "pose spread: 3 frames");
  says(refused([](Poses& p) { p[2].frames[4][1][Joint::root] = NAN; }),
       "pose fist: index, root: a reading is not finite");
  says(refused([](Poses& p) { p[2].frames[4][1][Joint::root] = 255; }),
       "pose fist: index, root: the sensor is saturated");
  says(refused([](Poses& p) { p[0].angles[4][Joint::root] = NAN; }), "little finger, root: the angle");
  says(refused([](Poses& p) { p[2].frames = p[0].frames; }), "thumb, root: it did not move enough");
  says(refused([](Poses& p) { p.pop_back(); }), "thumb, root: the poses ask only 0 rad");
  says(refused([](Poses& p) { p[2].frames[0] = p[0].frames[0]; }), "moved while a pose was held");
  says(refused([](Poses& p) { p[1].angles[1][Joint::root] = 1; }), "contradict");
  says(refused([](Poses& p) { p[0].tips.reset(), p[1].tips.reset(); }), "thumb: its tip was measured in fewer");
  says(refused([](Poses& p) { p[2].tips.reset(); }), "middle finger: its tip hardly moves");
  says(refused([](Poses& p) { (*p[0].tips)[3].x = NAN; }), "pose flat: ring finger: its tip is not finite");
  says(refused([](Poses& p) { (*p[0].tips)[3].x += 0.05; }), "ring finger: the measured tips fit no size");
  says(refused([](Poses& p) {
         for (KeyPose& pose : p) (*pose.tips)[1] = 3.0 * (*pose.tips)[1];
       }),
       "index: 3 times as long");
  CalibrationOptions options;
  options.sensor_low = 300;
  says(calibrate_hand({}, options).problem, "sensor_low is 300");
}

/// A hand of two fifths its size over the sample's box (its top at 15 mm), palm down.
runtime::DeviceFrame over_the_box() {
  runtime::DeviceFrame frame;
  frame.scale = 0.4;
  frame.turn.translation = {0, -0.055, 0.026};
  return frame;
}

/// Reaches into the box and out again, each finger at its own time.
HandJoints reaching(double time) {
  HandJoints angles{};
  for (std::size_t f = 0; f < kFingers; ++f) {
    const double bend = 0.5 - 0.5 * std::cos(5 * time + 0.4 * static_cast<double>(f));
    angles[f] = {f == 2 ? 0 : 0.1, 0.2 + 0.25 * bend, 0.15 + 0.1 * bend};
  }
  return angles;
}

constexpr double kTick = 1e-3;

TEST(Glove, PullsEachFingerOpenWithItsOwnContactsForce) {
  const Golden box("separable");
  SimulatedGlove glove(5, {});
  const HandCalibration found = calibrate_hand(glove.record());
  GloveOptions slack;
  slack.limit = 100;
  slack.rate = 1e9;
  slack.frequency = 1e9;
  GloveSource source(box.view, 0, found, over_the_box(), slack);
  ASSERT_EQ(source.problem(), nullptr);
  std::vector<runtime::Contact> alone(kFingers, runtime::Contact(box.view, 0));
  std::array<double, kFingers> most{};
  for (int k = 0; k < 4000; ++k) {
    const HandJoints raw = glove.read(reaching(kTick * k));
    const GloveAnswer answer = source.answer({}, raw, kTick);
    ASSERT_TRUE(answer.usable);
    for (std::size_t f = 0; f < kFingers; ++f) {
      const Pose tip = found.hand[f].tip(found.angles(raw)[f]);
      const runtime::Tick tick = alone[f].tick(over_the_box().to_scene(tip));
      const double along = dot(tick.force, tip.rotate({0, 0, 1}));
      ASSERT_NEAR(answer.pull[f], std::max(0.0, along), 1e-9);
      most[f] = std::max(most[f], answer.pull[f]);
    }
  }
  for (std::size_t f = 1; f < kFingers; ++f) EXPECT_GT(most[f], 0.1) << finger_name(f);
}

// Palm up, nails into the box: what would close the hand is no cable's.
TEST(Glove, NeverPushes) {
  const Golden box("separable");
  SimulatedGlove glove(5, {});
  GloveSource source(box.view, 0, calibrate_hand(glove.record()), over_the_box());
  HandJoints straight{};
  for (std::size_t f = 0; f < kFingers; ++f) straight[f][Joint::spread] = f == 2 ? 0 : 0.1;
  std::array<double, kFingers> against{};
  for (int k = 0; k < 1000; ++k) {
    const Pose wrist = Pose::from_quaternion(0, 0, 1, 0, {0, 0, -3e-5 * k});
    const GloveAnswer answer = source.answer(wrist, glove.read(straight), kTick);
    ASSERT_TRUE(answer.usable);
    ASSERT_EQ(answer.pull, GloveAnswer::Pulls{});
    for (std::size_t f = 0; f < kFingers; ++f) against[f] = std::max(against[f], source.ticks()[f].force.z);
  }
  for (std::size_t f = 1; f < kFingers; ++f) EXPECT_GT(against[f], 0.1) << finger_name(f);
}

// As it comes: never pushing, never beyond the limit, no faster than the rate; the same bits again, without memory.
TEST(Glove, IsLimitedSmoothedAndRepeatable) {
  const Golden box("separable");
  SimulatedGlove glove(5, {});
  const HandCalibration found = calibrate_hand(glove.record());
  GloveOptions options;
  options.limit = 0.3;
  options.rate = 4;
  GloveSource source(box.view, 0, found, over_the_box(), options), again(box.view, 0, found, over_the_box(), options);
  std::vector<HandJoints> recording;
  std::vector<GloveAnswer> answers;
  std::array<double, kFingers> last{};
  bool at_rate = false, at_limit = false;
  for (int k = 0; k < 4000; ++k) {
    recording.push_back(glove.read(reaching(kTick * k)));
    answers.push_back(source.answer({}, recording.back(), kTick));
    ASSERT_TRUE(answers.back().usable);
    for (std::size_t f = 0; f < kFingers; ++f) {
      const double pull = answers.back().pull[f], change = std::fabs(pull - last[f]);
      ASSERT_GE(pull, 0);
      ASSERT_LE(pull, options.limit * (1 + 1e-12));
      ASSERT_LE(change, options.rate * kTick * (1 + 1e-9));
      at_rate |= change > 0.999 * options.rate * kTick;
      at_limit |= pull > 0.99 * options.limit;
      last[f] = pull;
    }
  }
  EXPECT_TRUE(at_rate);
  EXPECT_TRUE(at_limit);
  again.answer({}, recording[2000], kTick);
  again.reset();
  const long before = allocations();
  for (std::size_t k = 0; k < recording.size(); ++k) {
    ASSERT_EQ(again.answer({}, recording[k], kTick).pull, answers[k].pull);
  }
  EXPECT_EQ(allocations(), before);
}

TEST(Glove, GivesNothingWhereNothingIsSure) {
  const Golden box("separable"), tools("three_tools");
  SimulatedGlove glove(5, {});
  const HandCalibration found = calibrate_hand(glove.record());
  const GloveAnswer::Pulls zero{};
  const HandJoints raw = glove.read(reaching(0.6));
  GloveOptions wrong;
  wrong.rate = NAN;
  GloveSource blank(box.view, 0, {}, over_the_box()), rod(tools.view, 1, found, over_the_box()),
      badly(box.view, 0, found, over_the_box(), wrong);
  EXPECT_STREQ(blank.problem(), "the hand was not calibrated");
  EXPECT_STREQ(rod.problem(), "the tool is no sphere");
  EXPECT_NE(badly.problem(), nullptr);
  for (GloveSource* source : {&blank, &rod, &badly}) {
    const GloveAnswer answer = source->answer({}, raw, kTick);
    EXPECT_FALSE(answer.usable);
    EXPECT_EQ(answer.pull, zero);
  }
  // A fault in the middle of a press: zero at once, and what still overlaps begins without force.
  GloveSource source(box.view, 0, found, over_the_box());
  for (int k = 0; k < 600; ++k) source.answer({}, glove.read(reaching(kTick * k)), kTick);
  ASSERT_GT(source.answer({}, raw, kTick).pull[2], 0.05);
  HandJoints broken = raw;
  broken[3][Joint::middle] = NAN;
  HandJoints leapt = raw;
  leapt[3][Joint::middle] = 1e9;
  Pose nowhere;
  nowhere.translation.x = NAN;
  const auto fails = [&](const Pose& wrist, const HandJoints& read, double seconds) {
    const GloveAnswer answer = source.answer(wrist, read, seconds);
    EXPECT_FALSE(answer.usable);
    EXPECT_EQ(answer.pull, zero);
  };
  fails({}, broken, kTick);
  const GloveAnswer after = source.answer({}, raw, kTick);
  EXPECT_TRUE(after.usable);
  EXPECT_NEAR(after.pull[2], 0, 1e-12);
  fails({}, leapt, kTick);
  fails(nowhere, raw, kTick);
  fails({}, raw, 0);
  fails({}, raw, NAN);
}

}  // namespace
}  // namespace palpate::test
