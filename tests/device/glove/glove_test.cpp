// SPDX-License-Identifier: GPL-3.0-or-later
// A glove from its extreme poses to the pulls of its five cables, on a simulated hand that the calibration never sees.
#include "device/glove/glove_source.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "device/device.hpp"
#include "device/recording/replay.hpp"
#include "device/recording/run_writer.hpp"
#include "device/simulation/sim_glove.hpp"
#include "palpate/palpate.hpp"
#include "tests/device/golden.hpp"
#include "tests/device/loop/scripted_device.hpp"
#include "tests/device/seeded.hpp"
#include "tests/runtime/allocation_counter.hpp"
#include "tests/support/temporary_folder.hpp"

namespace palpate::test {
namespace {

using namespace device;

/// Largest and mean distance (m) between a calibrated fingertip and the true one.
struct Miss {
  double largest = 0, mean = 0;
};

/// Anything between the extreme poses.
HandJoints any_pose(Seeded& random) {
  const std::vector<KeyPose> ends = extreme_poses();
  HandJoints angles{};
  for (std::size_t f = 0; f < kFingers; ++f) {
    angles[f][Joint::spread] = random.between(0, ends[1].angles[f][Joint::spread]);
    angles[f][Joint::root] = random.between(0, ends[2].angles[f][Joint::root]);
    angles[f][Joint::middle] = random.between(0, ends[2].angles[f][Joint::middle]);
  }
  angles[2][Joint::spread] = 0;
  return angles;
}

Miss miss(SimHandOptions options, std::uint64_t hands) {
  Miss miss;
  Seeded random(1);
  constexpr int kPoses = 200;
  for (options.seed = 1; options.seed <= hands; ++options.seed) {
    SimHand glove(options);
    const HandCalibration found = calibrate_hand(glove.record());
    EXPECT_TRUE(found.usable()) << found.problem;
    for (int k = 0; k < kPoses; ++k) {
      const HandJoints pose = any_pose(random), angles = found.angles(glove.read(pose));
      for (std::size_t f = 0; f < kFingers; ++f) {
        const double off = length(found.hand[f].tip(angles[f]).translation - glove.tip(f, pose).translation);
        miss.largest = std::max(miss.largest, off);
        miss.mean += off / (kPoses * static_cast<double>(kFingers * hands));
      }
    }
  }
  return miss;
}

// Errors from noise and whole counts of the sensors (a count is about 0.7 degrees), for a hand of the typical shape.
TEST(HandCalibration, FindsTheFingertipsOfHandsOfAnySize) {
  for (const double size : {0.7, 1.0, 1.4}) {
    SimHandOptions options;
    options.size = size;
    const Miss off = miss(options, 10);
    EXPECT_LT(off.largest, size * 3e-3);
    EXPECT_LT(off.mean, size * 1e-3);
    options.seed = 7;
    SimHand glove(options);
    for (const double found : calibrate_hand(glove.record()).size) EXPECT_NEAR(found, size, 1e-9);
  }
}

// People's hands: bones of their own, poses missed by up to 3 degrees a joint, tips measured to 1 mm.
TEST(HandCalibration, FindsTheFingertipsOfPeople) {
  SimHandOptions options;
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
  SimHand glove({3});
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
  says(refused([](Poses& p) { p.pop_back(); }), "thumb, root: the poses move it by only 0 rad");
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
  frame.pose.translation = {0, -0.055, 0.026};
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

Sample worn(const HandJoints& raw, const Pose& wrist = {}) {
  Sample sample;
  sample.joints = raw;
  sample.pose = wrist;
  return sample;
}

TEST(Glove, PullsEachFingerOpenWithItsOwnContactsForce) {
  const Golden box("quadratic");
  SimHand glove({5});
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
    const Answer answer = source.answer(worn(raw), kTick);
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
  const Golden box("quadratic");
  SimHand glove({5});
  GloveSource source(box.view, 0, calibrate_hand(glove.record()), over_the_box());
  HandJoints straight{};
  for (std::size_t f = 0; f < kFingers; ++f) straight[f][Joint::spread] = f == 2 ? 0 : 0.1;
  std::array<double, kFingers> against{};
  for (int k = 0; k < 1000; ++k) {
    const Pose wrist = Pose::from_quaternion(0, 0, 1, 0, {0, 0, -3e-5 * k});
    const Answer answer = source.answer(worn(glove.read(straight), wrist), kTick);
    ASSERT_TRUE(answer.usable);
    ASSERT_EQ(answer.pull, Pulls{});
    for (std::size_t f = 0; f < kFingers; ++f) against[f] = std::max(against[f], source.ticks()[f].force.z);
  }
  for (std::size_t f = 1; f < kFingers; ++f) EXPECT_GT(against[f], 0.05) << finger_name(f);
}

// As it comes: never pushing, never beyond the limit, no faster than the rate; the same bits again, without memory.
TEST(Glove, IsLimitedSmoothedAndRepeatable) {
  const Golden box("quadratic");
  SimHand glove({5});
  const HandCalibration found = calibrate_hand(glove.record());
  GloveOptions options;
  options.limit = 0.3;
  options.rate = 4;
  GloveSource source(box.view, 0, found, over_the_box(), options), again(box.view, 0, found, over_the_box(), options);
  std::vector<HandJoints> recording;
  std::vector<Answer> answers;
  std::array<double, kFingers> last{};
  bool at_rate = false, at_limit = false;
  for (int k = 0; k < 4000; ++k) {
    recording.push_back(glove.read(reaching(kTick * k)));
    answers.push_back(source.answer(worn(recording.back()), kTick));
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
  again.answer(worn(recording[2000]), kTick);
  again.reset();
  const long before = allocations();
  for (std::size_t k = 0; k < recording.size(); ++k) {
    ASSERT_EQ(again.answer(worn(recording[k]), kTick).pull, answers[k].pull);
  }
  EXPECT_EQ(allocations(), before);
}

TEST(Glove, GivesNothingWhereNothingIsSure) {
  const Golden box("quadratic"), tools("three_tools");
  SimHand glove({5});
  const HandCalibration found = calibrate_hand(glove.record());
  const Pulls zero{};
  const HandJoints raw = glove.read(reaching(0.6));
  GloveOptions wrong;
  wrong.rate = NAN;
  GloveSource blank(box.view, 0, {}, over_the_box()), rod(tools.view, 1, found, over_the_box()),
      badly(box.view, 0, found, over_the_box(), wrong);
  EXPECT_STREQ(blank.problem(), "the hand was not calibrated");
  EXPECT_STREQ(rod.problem(), "the tool is no sphere");
  EXPECT_NE(badly.problem(), nullptr);
  for (GloveSource* source : {&blank, &rod, &badly}) {
    const Answer answer = source->answer(worn(raw), kTick);
    EXPECT_FALSE(answer.usable);
    EXPECT_EQ(answer.pull, zero);
  }
  // A fault in the middle of a press: zero at once, and what still overlaps begins without force.
  GloveSource source(box.view, 0, found, over_the_box());
  for (int k = 0; k < 600; ++k) source.answer(worn(glove.read(reaching(kTick * k))), kTick);
  const Pulls pressed = source.answer(worn(raw), kTick).pull;
  const auto most = std::max_element(pressed.begin(), pressed.end());
  ASSERT_GT(*most, 0.1);
  HandJoints broken = raw;
  broken[3][Joint::middle] = NAN;
  HandJoints leapt = raw;
  leapt[3][Joint::middle] = 1e9;
  Pose nowhere;
  nowhere.translation.x = NAN;
  const auto fails = [&](const Pose& wrist, const HandJoints& read, double seconds) {
    const Answer answer = source.answer(worn(read, wrist), seconds);
    EXPECT_FALSE(answer.usable);
    EXPECT_EQ(answer.pull, zero);
  };
  fails({}, broken, kTick);
  const Answer after = source.answer(worn(raw), kTick);
  EXPECT_TRUE(after.usable);
  EXPECT_NEAR(after.pull[static_cast<std::size_t>(most - pressed.begin())], 0, 1e-12);
  fails({}, leapt, kTick);
  fails(nowhere, raw, kTick);
  fails({}, raw, 0);
  fails({}, raw, NAN);
}

/// A glove that is driven by a clock that a test moves, over the sample's box; what its run left on disk.
struct GloveRun {
  GloveRun() {
    clock = FakeClock();
    SimGloveOptions options;
    options.way.fill(0.02);
    SimGlove glove(options, [] { return clock.now(); });
    const HandCalibration found = calibrate_hand(glove.record());
    EXPECT_TRUE(found.usable()) << found.problem;
    runtime::DeviceFrame frame;
    frame.scale = 0.4;
    frame.pose.translation = {0.005, -0.01, 0.02};
    RunHeader header;
    LoopOptions loop_options;
    loop_options.seconds = 3;
    loop_options.safety.limit = 1;
    set_options(header, loop_options.safety, frame);
    GloveOptions pulls;
    pulls.limit = 1;
    GloveSource source(box.view, 0, found, frame, pulls);
    StopFlags stop;
    RunWriter writer(folder.path() / "run", header, to_run_hand(found, pulls));
    ForceLoop loop(glove, source, loop_options, stop, &writer, clock);
    loop.run();
    report = loop.report();
    writer.finish();
    bytes = file_content(folder.path() / "run");
    for (std::size_t f = 0; f < kFingers; ++f) work[f] = glove.cable(f).plant().given();
    glove.close();
    closed = glove.read().phase;
  }
  [[nodiscard]] static RunLog read(const std::string& bytes) { return read_run_log(bytes.data(), bytes.size()); }

  static inline FakeClock clock;
  const Golden box{"quadratic"};
  TemporaryFolder folder;
  LoopReport report;
  std::string bytes;
  std::array<double, kFingers> work{};
  Phase closed{};
};

TEST(GloveRun, PullsOnTheHandAndReplaysToTheSameBits) {
  const GloveRun run;
  EXPECT_EQ(run.report.out.cause, Cause::asked);
  EXPECT_EQ(run.report.suspensions, 0U);
  EXPECT_GT(run.report.peak_force, 0.1);
  EXPECT_LE(run.report.peak_force, 1);
  EXPECT_EQ(run.closed, Phase::closed);
  const RunLog log = run.read(run.bytes);
  ASSERT_TRUE(log.ok) << log.error;
  EXPECT_TRUE(log.complete);
  ASSERT_EQ(log.records.size(), run.report.ticks);
  ASSERT_TRUE(log.hand);
  GloveSource source(run.box.view, 0, calibration_of(*log.hand), device_frame(log.header), glove_options(*log.hand));
  std::array<double, kFingers> most{};
  const Replay replayed = replay(log, source, [&](const RunTick&, const TickOutput& out) {
    for (std::size_t f = 0; f < kFingers; ++f) most[f] = std::max(most[f], out.command.pull[f]);
  });
  EXPECT_EQ(replayed.compared, run.report.ticks);
  EXPECT_EQ(replayed.different, 0U);
  for (std::size_t f = 1; f < kFingers; ++f) {
    EXPECT_GT(most[f], 0.05) << finger_name(f);
    EXPECT_LT(run.work[f], 0) << finger_name(f) << " closed against its cable";
  }
  // Another hand, or another cable, gives other pulls.
  GloveSource slow(run.box.view, 0, calibration_of(*log.hand), device_frame(log.header), {1, 100, 5});
  EXPECT_GT(replay(log, slow).different, 100U);
}

TEST(GloveRun, WhatIsWrongInItsRecordingIsFound) {
  GloveRun run;
  constexpr std::size_t kHead = sizeof(RunHeader) + sizeof(RunHand), kEach = sizeof(RunRecord) + sizeof(HandRecord);
  for (const std::size_t at : {sizeof(RunHeader) + 17, kHead - 3, kHead + sizeof(RunRecord) + 9, kHead + 5 * kEach - 4,
                               kHead + 7 * kEach + 40}) {
    std::string bytes = run.bytes;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    EXPECT_FALSE(run.read(bytes).ok) << at;
  }
  EXPECT_NE(run.read(run.bytes.substr(0, kHead - 1)).error.find("within its header"), std::string::npos);
  const RunLog cut = run.read(run.bytes.substr(0, kHead + 3 * kEach + 250));
  EXPECT_TRUE(cut.ok && !cut.complete);
  EXPECT_EQ(cut.records.size(), 3U);
  EXPECT_EQ(cut.torn, 250U);
  RunHand hand;
  std::memcpy(&hand, run.bytes.data() + sizeof(RunHeader), sizeof hand);
  const auto refused = [&](const char* word, RunHand changed) {
    seal(changed);
    std::string bytes = run.bytes;
    std::memcpy(bytes.data() + sizeof(RunHeader), &changed, sizeof changed);
    EXPECT_NE(run.read(bytes).error.find(word), std::string::npos) << run.read(bytes).error;
  };
  RunHand wrong = hand;
  wrong.rate = -1;
  refused("rate", wrong);
  wrong = hand;
  wrong.bones[2][1] = INFINITY;
  refused("not finite", wrong);
  wrong = hand;
  wrong.rotation[1][4] = 2;
  refused("no pose", wrong);
}

// Each finger's cable is the whole glove's: one that falls silent stops it, and what nobody renews ends in all.
TEST(SimGlove, AFaultOfOneFingerIsTheGloves) {
  SimGlove glove({}, nullptr);
  glove.advance(0.2);
  EXPECT_EQ(glove.read().phase, Phase::homing);
  glove.advance(0.4);
  EXPECT_EQ(glove.read().phase, Phase::ready);
  const HandJoints still = glove.read().joints;
  EXPECT_EQ(glove.read().joints, still) << "the sensors are read once a sample";
  Command command{0.4, {}, {}};
  command.pull = {1, 2, 9, -3, 0.5};
  glove.write(command);
  glove.advance(0.408);
  const double most = glove.kind().peak_force;
  EXPECT_EQ(glove.cable(0).plant().force().z, 1);
  EXPECT_EQ(glove.cable(2).plant().force().z, most) << "no further than the cable's own limit";
  EXPECT_EQ(glove.cable(3).plant().force().z, 0) << "a cable does not push";
  glove.cable(4).fall_silent();
  glove.advance(0.42);
  const Sample sample = glove.read();
  EXPECT_EQ(sample.phase, Phase::stopped);
  EXPECT_EQ(sample.fault, Fault::silent);
  for (std::size_t f = 0; f < kFingers; ++f) EXPECT_EQ(glove.cable(f).plant().force().z, 0) << finger_name(f);
}

}  // namespace
}  // namespace palpate::test
