// SPDX-License-Identifier: GPL-3.0-or-later
// The recording of a run: the same bits when it is replayed, a disk that is slow or full, files that are damaged.
#include "device/loop/contact_source.hpp"
#include "device/recording/replay.hpp"
#include "device/recording/run_writer.hpp"
#include "tests/device/loop/scripted_device.hpp"
#include "tests/runtime/support.hpp"
#include "tests/support/temporary_folder.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <optional>
#include <thread>

namespace palpate::test {
namespace {

using device::ContactSource;
using device::CoupledSource;
using device::LoopOptions;
using device::Replay;
using device::RunHeader;
using device::RunLog;
using device::RunRecord;
using device::RunWriter;
using runtime::DeviceFrame;

RunLog read(const std::string& bytes) { return device::read_run_log(bytes.data(), bytes.size()); }

DeviceFrame over_the_ball() {
  DeviceFrame frame;
  frame.pose = Pose::from_quaternion(0.9, 0.1, -0.2, 0.3, {0, 0, kBallRadius + kTipRadius + 0.001});
  frame.scale = 0.7;
  frame.force_scale = 1.3;
  return frame;
}

/// A run of some seconds that presses, slides, loses samples, comes late and is stopped; its recording.
class Recorded : public testing::Test {
protected:
  Recorded() {
    device_.script = [](int k, Sample& sample) {
      const double t = 1e-3 * k;
      sample.pose = Pose::from_quaternion(1, 0.1 * std::sin(t), 0.05 * std::cos(3 * t), 0.2,
                                          {0.01 * std::sin(2 * t), 0.004 * std::cos(t), -0.009 * std::sin(1.5 * t)});
      sample.time -= 0.001 + 0.0005 * std::sin(40 * t);
      if (k < 100) sample.phase = Phase::homing;
      if (k > 2500 && k < 2550) sample.time -= 0.1;
    };
    clock_.oversleep = [](int k) { return k == 3600 ? 0.03 : k % 7 == 0 ? 1.3e-4 : 2e-5; };
    options_.seconds = 5;
    options_.safety.limit = 1.5;
  }

  std::string record(const std::string& name, std::size_t capacity = 1 << 14) {
    const std::string path = folder_.path() / name;
    RunHeader header;
    device::set_options(header, options_.safety, over_the_ball(), coupling_);
    RunWriter writer(path, header, {}, capacity);
    EXPECT_EQ(writer.error(), "");
    ContactSource<> rigid(ball_.view, 0, over_the_ball());
    const runtime::CouplingOptions hand = coupling_.value_or(runtime::CouplingOptions());
    CoupledSource coupled(ball_.view, 0, over_the_ball(), device::coupling_in(over_the_ball(), hand));
    device::StopFlags stop;
    device::ForceSource& source = coupling_ ? static_cast<device::ForceSource&>(coupled) : rigid;
    device::ForceLoop loop(device_, source, options_, stop, &writer, clock_);
    loop.run();
    ticks_ = loop.report().ticks;
    suspensions_ = loop.report().suspensions;
    written_ = writer.finish();
    return file_content(path);
  }

  Opened ball_{ball_content({})};
  FakeClock clock_;
  ScriptedDevice device_{clock_};
  LoopOptions options_;
  std::optional<runtime::CouplingOptions> coupling_;
  TemporaryFolder folder_;
  std::uint64_t ticks_ = 0, suspensions_ = 0;
  device::RunWritten written_;
};

TEST_F(Recorded, ReplaysToTheSameBits) {
  options_.safety.torque_limit = 0.004;
  const RunLog log = read(record("run"));
  ASSERT_TRUE(log.ok) << log.error;
  EXPECT_TRUE(log.complete);
  EXPECT_EQ(log.torn, 0U);
  ASSERT_EQ(log.records.size(), ticks_);
  EXPECT_EQ(log.end.ticks, ticks_);
  EXPECT_EQ(suspensions_, 2U);
  ContactSource<> source(ball_.view, 0, device::device_frame(log.header));
  std::size_t pressed = 0, limited = 0, turned = 0;
  const Replay replay = device::replay(log, source, [&](const RunRecord& record, const device::TickOutput& out) {
    const Command& sent = device_.commands.at(record.number - 1);
    ASSERT_EQ(std::memcmp(&sent, &out.command, sizeof sent), 0) << record.number;
    pressed += length(sent.force) > 0;
    turned += length(sent.torque) > 1e-4;
    limited += length(out.answer.force) > 1.5;
  });
  EXPECT_EQ(replay.ticks, ticks_);
  EXPECT_EQ(replay.compared, ticks_);
  EXPECT_EQ(replay.different, 0U);
  EXPECT_GT(pressed, 500U);
  EXPECT_GT(limited, 50U);
  EXPECT_GT(turned, 100U);
}

// The header has the coupling; without it, or with another, other forces come out.
TEST_F(Recorded, ReplaysACouplingToTheSameBits) {
  const std::string plain = record("plain");
  coupling_ = runtime::CouplingOptions{180, 0.2, 6};
  const RunLog log = read(record("run"));
  ASSERT_TRUE(log.ok) << log.error;
  EXPECT_FALSE(device::coupling_options(read(plain).header));
  std::optional<runtime::CouplingOptions> hand = device::coupling_options(log.header);
  ASSERT_TRUE(hand);
  EXPECT_EQ(hand->stiffness, 180);
  EXPECT_EQ(hand->damping, 0.2);
  EXPECT_EQ(hand->trials, 6);
  const DeviceFrame frame = device::device_frame(log.header);
  CoupledSource source(ball_.view, 0, frame, device::coupling_in(frame, *hand));
  const Replay replay = device::replay(log, source);
  EXPECT_EQ(replay.compared, ticks_);
  EXPECT_EQ(replay.different, 0U);
  hand->stiffness *= 1.01;
  CoupledSource other(ball_.view, 0, frame, device::coupling_in(frame, *hand));
  EXPECT_GT(device::replay(log, other).different, 100U);
  ContactSource<> rigid(ball_.view, 0, frame);
  EXPECT_GT(device::replay(log, rigid).different, 100U);
}

// A recording of before couplings is one without.
TEST_F(Recorded, ReadsTheFirstVersion) {
  options_.seconds = 0.1;
  std::string bytes = record("run");
  RunHeader header;
  std::memcpy(&header, bytes.data(), sizeof header);
  header.version = 1;
  device::seal(header);
  std::memcpy(bytes.data(), &header, sizeof header);
  const RunLog log = read(bytes);
  ASSERT_TRUE(log.ok) << log.error;
  EXPECT_FALSE(device::coupling_options(log.header));
}

// Torques were made otherwise up to version 3: what they would not replay to is refused, the rest is as it was.
TEST_F(Recorded, RefusesOldTorquesOfAScaledHand) {
  options_.seconds = 0.1;
  std::string bytes = record("run");
  const auto read_as = [&](std::uint32_t version, double torque_limit, double scale) {
    RunHeader header;
    std::memcpy(&header, bytes.data(), sizeof header);
    header.version = version;
    header.torque_limit = torque_limit;
    header.scale = scale;
    device::seal(header);
    std::memcpy(bytes.data(), &header, sizeof header);
    return read(bytes);
  };
  for (const std::uint32_t version : {1U, 2U, 3U}) {
    const RunLog log = read_as(version, 0.1, 0.7);
    EXPECT_FALSE(log.ok) << version;
    EXPECT_NE(log.error.find("torques of a scaled hand"), std::string::npos) << log.error;
    EXPECT_TRUE(read_as(version, 0, 0.7).ok);
    EXPECT_TRUE(read_as(version, 0.1, 1).ok);
  }
  EXPECT_TRUE(read_as(4, 0.1, 0.7).ok);
}

TEST_F(Recorded, AnotherBodyGivesOtherForces) {
  const RunLog log = read(record("run"));
  ResponseSampleOptions options;
  options.friction = false;
  const Opened other(ball_content(options));
  ContactSource<> source(other.view, 0, device::device_frame(log.header));
  const Replay replay = device::replay(log, source);
  EXPECT_GT(replay.different, 100U);
  EXPECT_GT(replay.largest, 1e-3);
  EXPECT_GT(replay.first_different, 100U);
}

TEST_F(Recorded, TicksThatAreMissingAreSaidAndNothingIsComparedBehindThem) {
  std::string bytes = record("run");
  const std::size_t gap = sizeof(RunHeader) + 1000 * sizeof(RunRecord);
  bytes.erase(bytes.size() - sizeof(device::RunEnd));
  bytes.erase(gap, 5 * sizeof(RunRecord));
  const RunLog log = read(bytes);
  ASSERT_TRUE(log.ok) << log.error;
  EXPECT_FALSE(log.complete);
  ContactSource<> source(ball_.view, 0, device::device_frame(log.header));
  const Replay replay = device::replay(log, source);
  EXPECT_EQ(replay.missing, 5U);
  EXPECT_EQ(replay.compared, 1000U);
  EXPECT_EQ(replay.different, 0U);
}

// A pipe that nobody empties until the run is over: 64 KiB and what waits are kept, the rest is dropped and counted.
TEST_F(Recorded, ASlowDiskDropsTicksAndHoldsUpNone) {
  const std::filesystem::path path = folder_.path() / "pipe";
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  const int reader = ::open(path.c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  std::string bytes;
  device::RunWritten written;
  {
    RunHeader header;
    device::set_options(header, options_.safety, over_the_ball());
    RunWriter writer(path, header, {}, 64);
    const auto begin = std::chrono::steady_clock::now();
    for (std::uint32_t k = 1; k <= 20000; ++k) {
      device::RunTick tick;
      tick.number = k;
      writer.put(tick);
    }
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(2));
    EXPECT_GT(writer.dropped(), 1000U);
    std::thread slow([&] {
      char part[4096];
      for (;;) {
        const ssize_t got = ::read(reader, part, sizeof part);
        if (got == 0) return;
        if (got > 0) bytes.append(part, static_cast<std::size_t>(got));
        if (got < 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    });
    written = writer.finish();
    slow.join();
  }
  ::close(reader);
  EXPECT_EQ(written.ticks, 20000U);
  EXPECT_EQ(written.error, "");
  const RunLog log = read(bytes);
  ASSERT_TRUE(log.ok) << log.error;
  EXPECT_TRUE(log.complete);
  EXPECT_EQ(log.end.dropped, written.dropped);
  EXPECT_EQ(log.records.size() + written.dropped, 20000U);
  EXPECT_GE(log.records.size(), 64U);
}

TEST_F(Recorded, AFullDiskEndsTheRecordingAndNotTheRun) {
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit small = before;
  small.rlim_cur = 100000;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string bytes = record("run");
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  EXPECT_EQ(ticks_, device_.commands.size());
  EXPECT_NEAR(static_cast<double>(ticks_), 5050, 40);
  EXPECT_NE(written_.error, "");
  EXPECT_GT(written_.dropped, 4000U);
  const RunLog log = read(bytes);
  ASSERT_TRUE(log.ok) << log.error;
  EXPECT_FALSE(log.complete);
  EXPECT_EQ(log.records.size(), (100000 - sizeof(RunHeader)) / sizeof(RunRecord));
  EXPECT_EQ(log.records.size() + written_.dropped, ticks_);
  EXPECT_EQ(log.torn, (100000 - sizeof(RunHeader)) % sizeof(RunRecord));
}

TEST_F(Recorded, AFileThatCannotBeMadeIsSaid) {
  EXPECT_NE(RunWriter(folder_.path() / "no" / "such" / "folder", {}).error(), "");
  EXPECT_NE(RunWriter("/dev/full", {}).error(), "");
  {
    const RunWriter first(folder_.path() / "run", {});
    EXPECT_EQ(first.error(), "");
    EXPECT_NE(RunWriter(folder_.path() / "run", {}).error().find("another run"), std::string::npos);
  }
  EXPECT_EQ(RunWriter(folder_.path() / "run", {}).error(), "");
}

TEST_F(Recorded, EveryTruncationKeepsItsWholeRecords) {
  options_.seconds = 0.02;
  const std::string whole = record("run");
  const std::size_t records = (whole.size() - sizeof(RunHeader) - sizeof(device::RunEnd)) / sizeof(RunRecord);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const RunLog log = read(whole.substr(0, size));
    ASSERT_EQ(log.ok, size >= sizeof(RunHeader)) << size;
    if (!log.ok) continue;
    ASSERT_FALSE(log.complete);
    ASSERT_EQ(log.records.size(), std::min(records, (size - sizeof(RunHeader)) / sizeof(RunRecord)));
    ASSERT_EQ(log.torn, size - sizeof(RunHeader) - log.records.size() * sizeof(RunRecord));
  }
}

TEST_F(Recorded, EveryWrongByteIsFound) {
  options_.seconds = 0.01;
  const std::string whole = record("run");
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    const RunLog log = read(bytes);
    ASSERT_TRUE(!log.ok || !log.complete) << at;
    if (!log.ok) {
      ASSERT_FALSE(log.error.empty());
    }
  }
}

// With right checksums and wrong content: refused by name.
TEST_F(Recorded, WhatAWriterCannotHaveWrittenIsRefused) {
  options_.seconds = 0.01;
  const std::string whole = record("run");
  const auto refused = [&](const std::string& word, auto change, std::size_t at, auto part) {
    std::string bytes = whole;
    std::memcpy(&part, bytes.data() + at, sizeof part);
    change(part);
    device::seal(part);
    std::memcpy(bytes.data() + at, &part, sizeof part);
    const RunLog log = read(bytes);
    EXPECT_FALSE(log.ok) << word;
    EXPECT_NE(log.error.find(word), std::string::npos) << log.error;
  };
  refused(
      "rate", [](RunHeader& h) { h.rate = NAN; }, 0, RunHeader());
  refused(
      "version 6", [](RunHeader& h) { h.version = 6; }, 0, RunHeader());
  refused(
      "felt neither", [](RunHeader& h) { h.several = 2; }, 0, RunHeader());
  refused(
      "felt neither", [](RunHeader& h) { h.several = 1, h.version = 4; }, 0, RunHeader());
  refused(
      "no pose", [](RunHeader& h) { h.rotation[0] = 7; }, 0, RunHeader());
  refused(
      "scale", [](RunHeader& h) { h.scale = 0; }, 0, RunHeader());
  refused(
      "name", [](RunHeader& h) { std::memset(h.device, 'x', sizeof h.device); }, 0, RunHeader());
  refused(
      "stiffness of the virtual coupling", [](RunHeader& h) { h.coupling_stiffness = -1; }, 0, RunHeader());
  refused(
      "trials of the virtual coupling", [](RunHeader& h) { h.coupling_stiffness = 1, h.coupling_trials = ~0U; }, 0,
      RunHeader());
  refused(
      "record 0 (byte 704): its number", [](RunRecord& r) { r.number = 0; }, sizeof(RunHeader), RunRecord());
  refused(
      "phase", [](RunRecord& r) { r.phase = 77; }, sizeof(RunHeader), RunRecord());
  refused(
      "ticks", [](device::RunEnd& e) { e.ticks += 1; }, whole.size() - sizeof(device::RunEnd), device::RunEnd());
}

}  // namespace
}  // namespace palpate::test
