// SPDX-License-Identifier: GPL-3.0-or-later
// palpate drive on the simulated device, its recording replayed by palpate play, and where a device is placed.
#include "tools/drive/drive_frame.hpp"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "device/recording/run_record.hpp"
#include "formats/io/error.hpp"
#include "tests/cli/palpate_program.hpp"
#include "tests/runtime/two_lobes.hpp"
#include "tests/support/response_samples.hpp"
#include "tools/drive/drive_view.hpp"

namespace palpate::test {
namespace {

using Json = nlohmann::json;
using runtime::Vec3;

using Drive = PalpateProgram;

class DriveRun : public ::testing::Test {
protected:
  // A machine that does much else may miss any number of deadlines: one run is made until it has force, and used by
  // all.
  static void SetUpTestSuite() {
    shared_ = new TemporaryFolder;
    ResponseSampleOptions options;
    options.tools = ResponseSampleOptions::Tools::all;
    write_response_file(shared_->path() / "box.palp", encode(box_content(options)));
    for (int k = 0; k < 5; ++k) {
      driven_ = run_program(PALPATE_PROGRAM,
                            {"drive", "box.palp", "--device", "sim", "--seconds", "2", "--ramp", "0.05", "--limit", "2",
                             "--rate", "1000", "--json"},
                            {.folder = shared_->path()});
      if (driven_.exit_code == 0) return;
    }
  }
  static void TearDownTestSuite() { delete shared_; }

  RunResult in_shared(const std::vector<std::string>& arguments) const {
    return run_program(PALPATE_PROGRAM, arguments, {.folder = shared_->path()});
  }

  static inline TemporaryFolder* shared_ = nullptr;
  static inline RunResult driven_;
};

TEST_F(DriveRun, LeavesStatisticsARecordingAndAPlot) {
  ASSERT_EQ(driven_.exit_code, 0) << driven_.error;
  const Json json = Json::parse(driven_.out);
  EXPECT_EQ(json["device"], "sim");
  EXPECT_EQ(json["tool"], "ball");
  EXPECT_EQ(json["ended"], "stop requested");
  EXPECT_GT(json["peak_force"].get<double>(), 0.05) << "the simulated hand presses the body";
  EXPECT_LE(json["peak_force"].get<double>(), 2 * (1 + 1e-12));
  EXPECT_GT(json["rate"].get<double>(), 300);
  EXPECT_EQ(json["ticks_not_recorded"], 0);
  EXPECT_GT(json["sample_age"]["count"].get<int>(), 100);
  EXPECT_NE(driven_.error.find("position"), std::string::npos) << "no line a second where there is no terminal";
  const auto ticks = json["ticks"].get<std::uintmax_t>();
  EXPECT_EQ(std::filesystem::file_size(shared_->path() / "box.palprun"),
            sizeof(device::RunHeader) + ticks * sizeof(device::RunRecord) + sizeof(device::RunEnd));
  EXPECT_NE(file_content(shared_->path() / "box-run.svg").find("force on the hand (N)"), std::string::npos);
}

TEST_F(DriveRun, PlayGivesTheSameForcesBitForBit) {
  const Json driven = Json::parse(driven_.out);
  for (const auto& arguments : {std::vector<std::string>{"play", "box.palprun", "--json", "--out", "forces.csv"},
                                std::vector<std::string>{"play", "box.palp", "box.palprun", "--json"}}) {
    const RunResult result = in_shared(arguments);
    ASSERT_EQ(result.exit_code, 0) << result.error;
    const Json json = Json::parse(result.out);
    EXPECT_EQ(json["ticks"], driven["ticks"]);
    EXPECT_EQ(json["run"]["ticks_compared"], driven["ticks"]);
    EXPECT_EQ(json["run"]["ticks_different"], 0);
    EXPECT_EQ(json["run"]["same_response"], true);
    EXPECT_GE(json["contacts"], 1);
    EXPECT_GT(json["peak_force"].get<double>(), 0.05);
    EXPECT_EQ(result.error, "");
  }
  EXPECT_EQ(file_content(shared_->path() / "forces.csv").rfind("t,fx,fy,fz", 0), 0U);
  const RunResult text = in_shared({"play", "box.palprun"});
  EXPECT_NE(text.out.find("of the run compared: 0 differ"), std::string::npos) << text.out;
}

TEST_F(DriveRun, PlayFindsTheResponseFileBesideTheRun) {
  ASSERT_EQ(driven_.exit_code, 0) << driven_.error;
  const TemporaryFolder elsewhere;
  const auto play = [&](const std::filesystem::path& recording) {
    return run_program(PALPATE_PROGRAM, {"play", recording.string()}, {.folder = elsewhere.path()});
  };
  EXPECT_EQ(play(shared_->path() / "box.palprun").exit_code, 0);
  std::filesystem::copy(shared_->path() / "box.palprun", elsewhere.path() / "alone.palprun");
  expect_failure(play("alone.palprun"), 4,
                 {"box.palp: there is no such file", "alone.palprun names it", "palpate play FILE.palp alone.palprun"});
  expect_failure(in_shared({"play", "box.palprun", "--out", "box.palprun"}), 1, {"box.palprun", "which is read"});
  expect_failure(in_shared({"play", "box.palprun", "--plot", "box.palp"}), 1, {"box.palp", "which is read"});
}

TEST_F(DriveRun, PlaySaysWhenTheResponseFileIsAnother) {
  ResponseSampleOptions options;
  options.tools = ResponseSampleOptions::Tools::all;
  options.friction = false;
  write_response_file(shared_->path() / "other.palp", encode(box_content(options)));
  const RunResult result = in_shared({"play", "other.palp", "box.palprun", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  EXPECT_NE(result.error.find("its hash differs"), std::string::npos) << result.error;
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json["run"]["same_response"], false);
  EXPECT_GT(json["run"]["ticks_different"], 0);
}

TEST_F(DriveRun, PlayRefusesARecordingThatDoesNotGiveItsForces) {
  std::string bytes = file_content(shared_->path() / "box.palprun");
  const std::size_t at = sizeof(device::RunHeader) + 700 * sizeof(device::RunRecord);
  device::RunRecord record;
  std::memcpy(&record, bytes.data() + at, sizeof record);
  record.force[2] += 1e-15;
  device::seal(record);
  std::memcpy(bytes.data() + at, &record, sizeof record);
  shared_->write("forged.palprun", bytes);
  const RunResult forged = in_shared({"play", "box.palp", "forged.palprun", "--json"});
  EXPECT_EQ(forged.exit_code, 5);
  EXPECT_NE(forged.error.find("tick 701 "), std::string::npos) << forged.error;
  EXPECT_EQ(Json::parse(forged.out)["run"]["ticks_different"], 1);
  bytes[at + 20] ^= 1;
  shared_->write("damaged.palprun", bytes);
  expect_failure(in_shared({"play", "box.palp", "damaged.palprun"}), 2, {"damaged.palprun: record 700", "checksum"});
  shared_->write("cut.palprun", bytes.substr(0, at - 100));
  const RunResult cut = in_shared({"play", "box.palp", "cut.palprun"});
  EXPECT_EQ(cut.exit_code, 0);
  EXPECT_NE(cut.error.find("cut short after 699 ticks"), std::string::npos) << cut.error;
}

// A body fifty times as stiff in the hand: the coupling is what verify --device says, the run's recording holds it.
TEST_F(Drive, ACouplingIsChosenRecordedAndReplayed) {
  write_response_file(folder() / "box.palp", encode(box_content({})));
  const auto drive = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments{"drive", "box.palp", "--device", "sim", "--force-scale", "50", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  };
  const RunResult result = drive({"--seconds", "1.5", "--ramp", "0.05", "--coupling", "auto"});
  if (result.exit_code == 5) GTEST_SKIP() << "the machine is too busy: " << result.error;
  ASSERT_EQ(result.exit_code, 0) << result.error;
  EXPECT_NE(result.error.find("virtual coupling: 4"), std::string::npos) << result.error;
  const Json json = Json::parse(result.out);
  EXPECT_GT(json["peak_force"].get<double>(), 0.05);
  // Hold and delay leave 417 N/m on this device at 1 kHz.
  EXPECT_NEAR(json["coupling"].get<double>(), 425, 15);
  const RunResult played = run({"play", "box.palprun", "--json"});
  ASSERT_EQ(played.exit_code, 0) << played.error;
  EXPECT_EQ(Json::parse(played.out)["run"]["ticks_different"], 0);
  EXPECT_EQ(Json::parse(played.out)["run"]["ticks_compared"], json["ticks"]);
  const RunResult stiff = drive({"--seconds", "0.1", "--no-record", "--coupling", "9000"});
  if (stiff.exit_code == 5) GTEST_SKIP() << "the machine is too busy: " << stiff.error;
  EXPECT_NE(stiff.error.find("warning: --coupling 9000: safe in any hand on sim are 4"), std::string::npos)
      << stiff.error;
  EXPECT_EQ(Json::parse(stiff.out)["coupling"], 9000);
  expect_failure(drive({"--coupling", "auto", "--coupling-damping", "2"}), 5, {"--coupling-damping"});
}

// Pressed down between two balls. A run gives its forces again with the contacts that it was felt with, and other
// forces with the other kind.
TEST_F(Drive, AToolBetweenTwoLobesIsFeltAtBothUnlessSingle) {
  write_response_file(folder() / "lobes.palp", encode(two_lobes(smooth(false))));
  for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--coupling", "300"}}) {
    std::vector<std::string> arguments{
        "drive", "lobes.palp", "--device", "sim",  "--seconds",
        "1",     "--ramp",     "0.05",     "--at", "0,0," + std::to_string(between() + 0.007),
        "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    for (const bool single : {false, true}) {
      if (single) arguments.emplace_back("--single");
      const RunResult driven = run(arguments);
      if (driven.exit_code == 5) GTEST_SKIP() << "the machine is too busy: " << driven.error;
      ASSERT_EQ(driven.exit_code, 0) << driven.error;
      const RunResult played = run({"play", "lobes.palprun", "--json"});
      ASSERT_EQ(played.exit_code, 0) << played.error;
      const Json json = Json::parse(played.out);
      EXPECT_EQ(json["run"]["ticks_different"], 0);
      EXPECT_EQ(json["run"]["ticks_compared"], Json::parse(driven.out)["ticks"]);
      EXPECT_EQ(json["rows_other_contacts"] > 0, single) << played.error;
      EXPECT_EQ(played.error.find("another wall, which --single leaves out") != std::string::npos, single)
          << played.error;
      std::string bytes = file_content(folder() / "lobes.palprun");
      device::RunHeader header;
      std::memcpy(&header, bytes.data(), sizeof header);
      EXPECT_EQ(header.several, single ? 0U : 1U);
      header.several = single ? 1 : 0;
      device::seal(header);
      std::memcpy(bytes.data(), &header, sizeof header);
      write("other.palprun", bytes);
      const RunResult other = run({"play", "lobes.palp", "other.palprun", "--json"});
      EXPECT_EQ(other.exit_code, 5);
      const double difference = Json::parse(other.out)["run"]["largest_difference"];
      EXPECT_GT(difference, 0.1 * json["peak_force"].get<double>());
    }
  }
  expect_failure(run({"play", "lobes.palprun", "--single"}), 1, {"--single", "as it was recorded"});
}

TEST_F(Drive, AGloveIsCalibratedDrivenAndReplayed) {
  ResponseSampleOptions options;
  options.tools = ResponseSampleOptions::Tools::all;
  write_response_file(folder() / "box.palp", encode(box_content(options)));
  const RunResult result = run({"drive", "box.palp", "--device", "sim-glove", "--scale", "0.4", "--seconds", "1.3",
                                "--ramp", "0.05", "--limit", "2", "--json"});
  if (result.exit_code == 5) GTEST_SKIP() << "the machine is too busy: " << result.error;
  ASSERT_EQ(result.exit_code, 0) << result.error;
  EXPECT_NE(result.error.find("hand calibrated: fingers of 0.9"), std::string::npos) << result.error;
  EXPECT_NE(result.error.find("s  pulls 0.000"), std::string::npos) << result.error;
  const Json json = Json::parse(result.out);
  EXPECT_GT(json["peak_force"].get<double>(), 0.05) << "the simulated fingers press the body";
  EXPECT_LE(json["peak_force"].get<double>(), 2);
  EXPECT_NE(file_content(folder() / "box-run.svg").find("pull on the finger (N)"), std::string::npos);
  const RunResult played = run({"play", "box.palprun", "--json", "--out", "forces.csv", "--plot", "forces.svg"});
  ASSERT_EQ(played.exit_code, 0) << played.error;
  const Json again = Json::parse(played.out);
  EXPECT_EQ(again["run"]["ticks_different"], 0);
  EXPECT_EQ(again["run"]["ticks_compared"], json["ticks"]);
  EXPECT_EQ(again["rows"], 5 * json["ticks"].get<int>());
  EXPECT_GE(again["contacts"], 3);
  EXPECT_EQ(file_content(folder() / "forces.csv").rfind("t,finger,fx,fy,fz", 0), 0U);
  EXPECT_NE(file_content(folder() / "forces.svg").find("little"), std::string::npos);
  expect_failure(run({"drive", "box.palp", "--device", "sim-glove", "--coupling", "auto"}), 1, {"--coupling", "glove"});
  expect_failure(run({"drive", "box.palp", "--device", "sim-glove", "--tool", "rod"}), 1, {"--tool rod", "no sphere"});
  expect_failure(run({"play", "box.palprun", "--tool", "rod"}), 2, {"'rod'", "no sphere", "a glove's"});
}

TEST_F(Drive, NoCouplingWhereNoneIsNeeded) {
  write_response_file(folder() / "ball.palp", encode(ball_content()));
  const RunResult result = run({"drive", "ball.palp", "--device", "sim", "--seconds", "0.1", "--force-scale", "0.1",
                                "--no-record", "--json", "--coupling", "auto"});
  if (result.exit_code == 5) GTEST_SKIP() << "the machine is too busy: " << result.error;
  EXPECT_NE(result.error.find("no virtual coupling"), std::string::npos) << result.error;
  EXPECT_TRUE(Json::parse(result.out)["coupling"].is_null());
}

TEST_F(Drive, CtrlCStopsItCleanly) {
  write_response_file(folder() / "ball.palp", encode(ball_content()));
  const RunResult result = run({"drive", "ball.palp", "--device", "sim", "--json", "--no-record", "--tool", "ball"},
                               {.time_limit = 60, .interrupt = std::chrono::milliseconds(1000)});
  EXPECT_FALSE(result.timed_out);
  EXPECT_EQ(result.signal, 0) << result.error;
  if (result.exit_code == 5) GTEST_SKIP() << "the machine is too busy: " << result.error;
  ASSERT_EQ(result.exit_code, 0) << result.error;
  EXPECT_EQ(Json::parse(result.out)["ended"], "stop requested");
  EXPECT_FALSE(std::filesystem::exists(folder() / "ball.palprun"));
}

TEST_F(Drive, WhatCannotBeIsNamed) {
  write_response_file(folder() / "ball.palp", encode(ball_content()));
  const auto fails = [&](int code, std::vector<std::string> arguments, const std::vector<std::string>& cause) {
    arguments.insert(arguments.begin(), "drive");
    expect_failure(run(arguments), code, cause);
  };
  fails(1, {}, {"which response file"});
  fails(1, {"ball.palp", "--device", "elephant"}, {"no device is called 'elephant'", "falcon", "sim"});
  fails(1, {"ball.palp", "--device", "sim", "--rate", "5"}, {"--rate", "got 5"});
  fails(1, {"ball.palp", "--device", "sim", "--at", "1,2"}, {"--at", "X,Y,Z"});
  fails(1, {"ball.palp", "--device", "sim", "--up", "w"}, {"--up", "-z"});
  fails(1, {"ball.palp", "--device", "sim", "--coupling", "stiff"}, {"--coupling", "got 'stiff'", "auto"});
  fails(1, {"ball.palp", "--device", "sim", "--coupling", "-3"}, {"--coupling"});
  fails(1, {"ball.palp", "--device", "sim", "--coupling", "9", "--force-scale", "0"}, {"--force-scale above 0"});
  fails(1, {"ball.palp", "--device", "sim", "--coupling-damping", "1"}, {"--coupling-damping", "--coupling"});
  fails(2, {"ball.palp", "--device", "sim", "--tool", "spoon"}, {"there is no tool 'spoon'", "ball"});
  fails(4, {"none.palp", "--device", "sim"}, {"none.palp"});
  fails(4, {"ball.palp", "--device", "sim", "--record", "no/such/run"}, {"no/such/run"});
  fails(4, {"ball.palp", "--device", "sim", "--plot", "no/such/run.svg"}, {"no/such/run.svg: cannot be written: No such"});
  fails(1, {"ball.palp", "--device", "sim", "--plot", "run.svg", "--no-record"}, {"--no-record", "--plot"});
  fails(4, {"ball.palp", "--device", "sim", "--firmware", "none.bin"}, {"none.bin", "--firmware"});
  const RunResult list = run({"drive", "--list"});
  EXPECT_EQ(list.exit_code, 0);
  for (const char* name : {"falcon", "wooden-mbed", "sim"}) EXPECT_NE(list.out.find(name), std::string::npos) << name;
}

TEST_F(Drive, AFullDiskIsSaidAndTheRunGoesOn) {
  write_response_file(folder() / "ball.palp", encode(ball_content()));
  RunOptions options;
  options.folder = folder();
  options.file_limit = 60000;  // some 240 ticks
  const RunResult result = run({"drive", "ball.palp", "--device", "sim", "--seconds", "1", "--json"}, options);
  if (result.exit_code == 5) GTEST_SKIP() << "the machine is too busy: " << result.error;
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_NE(result.error.find("ball.palprun"), std::string::npos) << result.error;
  const Json json = Json::parse(result.out);
  EXPECT_GT(json["ticks_not_recorded"], 0);
  EXPECT_GT(json["ticks"], 300);
}

/// A terminal that nobody looks at; what is written to it is read and forgotten.
class Terminal {
public:
  Terminal() : ours_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    EXPECT_EQ(::grantpt(ours_) + ::unlockpt(ours_), 0);
    theirs_ = ::open(::ptsname(ours_), O_RDWR | O_NOCTTY);
    EXPECT_GE(theirs_, 0);
  }
  ~Terminal() {
    ::close(theirs_);
    ::close(ours_);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// In the child: standard input, output and error, and with `session` the terminal that its session's jobs share.
  void take(bool session) const {
    if (session && (::setsid() < 0 || ::ioctl(theirs_, TIOCSCTTY, 0) != 0)) ::_exit(125);
    for (const int descriptor : {0, 1, 2}) ::dup2(theirs_, descriptor);
  }
  /// Whether it edits lines and shows what is typed.
  [[nodiscard]] bool is_cooked() const {
    termios now = {};
    return ::tcgetattr(theirs_, &now) == 0 && (now.c_lflag & ICANON) != 0 && (now.c_lflag & ECHO) != 0;
  }
  /// Reads what is there until `enough`, or for a minute.
  template <class Enough>
  bool forget_until(const Enough& enough) const {
    char bytes[4096];
    for (int k = 0; k < 12000; ++k) {
      while (::read(ours_, bytes, sizeof bytes) > 0) {
      }
      if (enough()) return true;
      ::usleep(5000);
    }
    return false;
  }

private:
  int ours_, theirs_ = -1;
};

class DriveTerminal : public Drive {
protected:
  void drive(const char* seconds) const {
    if (::chdir(folder().c_str()) != 0) ::_exit(125);
    ::execl(PALPATE_PROGRAM, "palpate", "drive", "ball.palp", "--device", "sim", "--no-record", "--seconds", seconds,
            nullptr);
    ::_exit(125);
  }
  /// How `child` ended.
  int end_of(pid_t child) const {
    int status = -1;
    if (!terminal.forget_until([&] { return ::waitpid(child, &status, WNOHANG) == child; })) {
      ::kill(child, SIGKILL);
      ::waitpid(child, &status, 0);
    }
    return status;
  }

  Terminal terminal;
};

TEST_F(DriveTerminal, IsAsItWasWhateverEndsTheRun) {
  write_response_file(folder() / "ball.palp", encode(ball_content()));
  for (const int signal : {SIGTERM, SIGSEGV, SIGABRT}) {
    ASSERT_TRUE(terminal.is_cooked());
    const pid_t child = ::fork();
    if (child == 0) {
      terminal.take(false);
      drive("1000");
    }
    EXPECT_TRUE(terminal.forget_until([&] { return !terminal.is_cooked(); })) << "keys are read as they are pressed";
    ::kill(child, signal);
    const int status = end_of(child);
    EXPECT_TRUE(signal == SIGTERM ? WIFEXITED(status) : WIFSIGNALED(status) && WTERMSIG(status) == signal) << status;
    EXPECT_TRUE(terminal.is_cooked()) << "after signal " << signal;
  }
}

// A broken pipe would end the program at once, with whatever force it gave last.
TEST_F(DriveTerminal, TheRunEndsInOrderWhereNobodyReadsItsOutput) {
  write_response_file(folder() / "ball.palp", encode(ball_content()));
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    terminal.take(false);
    ::dup2(ends[1], STDERR_FILENO);
    ::close(ends[0]);
    ::close(ends[1]);
    drive("1000");
  }
  ::close(ends[0]);
  ::close(ends[1]);
  EXPECT_TRUE(WIFEXITED(end_of(child)));
}

// A job in the background that touches the terminal is suspended, with whatever force it gave last.
TEST_F(DriveTerminal, IsLeftAloneInTheBackground) {
  write_response_file(folder() / "ball.palp", encode(ball_content()));
  const pid_t shell = ::fork();
  if (shell == 0) {
    terminal.take(true);
    const pid_t job = ::fork();
    if (job == 0) {
      ::setpgid(0, 0);
      drive("0.5");
    }
    int status = 0;
    ::waitpid(job, &status, WUNTRACED);
    ::kill(job, SIGKILL);
    ::_exit(WIFSTOPPED(status) ? 100 : WEXITSTATUS(status));
  }
  const int status = end_of(shell);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_NE(WEXITSTATUS(status), 100) << "it was suspended";
  EXPECT_TRUE(WEXITSTATUS(status) == 0 || WEXITSTATUS(status) == 5) << WEXITSTATUS(status);  // 5: a busy machine
}

TEST(DriveFrame, StandsOverTheTopWithAGap) {
  ResponseSampleOptions options;
  options.tools = ResponseSampleOptions::Tools::all;
  const std::vector<std::byte> bytes = encode(box_content(options));
  const runtime::View view = runtime::View::open(bytes.data(), bytes.size()).view;
  for (const char* up : {"x", "-x", "y", "-y", "z", "-z"}) {
    for (const char* device_up : {"y", "z", "-z"}) {
      for (std::uint32_t tool = 0; tool < 3; ++tool) {
        cli::FrameOptions placing;
        placing.up = *cli::axis_named(up);
        placing.device_up = *cli::axis_named(device_up);
        placing.scale = 0.5;
        placing.gap = 0.02;
        const runtime::DeviceFrame frame = cli::place_device(view, tool, placing);
        EXPECT_TRUE(frame.pose.valid());
        EXPECT_NEAR(length(frame.pose.rotate(placing.device_up) - placing.up), 0, 1e-12);
        EXPECT_NEAR(runtime::search(view, tool, frame.pose).touch.clearance, 0.01, 1e-4) << up;
        // A metre of the hand is half one of the scene: the gap downwards, it touches.
        const runtime::Pose down = frame.to_scene({{1, 0, 0, 0, 1, 0, 0, 0, 1}, -0.0205 * placing.device_up});
        EXPECT_LT(runtime::search(view, tool, down).touch.clearance, 0) << up << device_up << tool;
      }
    }
  }
}

TEST(DriveFrame, IsWhereItIsToldToBe) {
  const std::vector<std::byte> bytes = encode(ball_content());
  const runtime::View view = runtime::View::open(bytes.data(), bytes.size()).view;
  cli::FrameOptions placing;
  placing.at = Vec3{1, 2, 3};
  EXPECT_EQ(length(cli::place_device(view, 0, placing).pose.translation - Vec3{1, 2, 3}), 0);
}

TEST(DriveView, ShowsModeCauseAndForce) {
  device::LoopReport report;
  report.ticks = 100;
  report.elapsed = 0.1;
  report.seen.sample.pose.translation = {0.0123, 0, -0.004};
  report.out.command.force = {0, 0, 1.25};
  report.out.mode = device::Mode::suspended;
  report.out.cause = device::Cause::stale;
  const std::string screen = cli::drive_screen({"a.palp", "ball", "sim", 2.5}, report, 7);
  for (const char* part : {"12.30", "1.250 N", "###############...............", "suspended: the sample is stale",
                           "not recorded 7", "1000.0 Hz"}) {
    EXPECT_NE(screen.find(part), std::string::npos) << part << "\n" << screen;
  }
  EXPECT_NE(cli::drive_line({}, report).find("1.250 N"), std::string::npos);
}

}  // namespace
}  // namespace palpate::test
