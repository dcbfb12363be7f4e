// SPDX-License-Identifier: GPL-3.0-or-later
// The worker process and its client: garbage, crashes and time limits become causes.
#include "formats/io/error.hpp"
#include "precompute/mesh/volume/child_process.hpp"
#include "precompute/mesh/volume/tetgen_client.hpp"
#include "precompute/mesh/volume/tetgen_protocol.hpp"
#include "precompute/mesh/volume/volume_mesh.hpp"
#include "tests/mesh/bodies.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>
#include <thread>

namespace palpate::mesh {
namespace {

TetgenInput input_of(const Surface& s, double size) {
  TetgenInput input;
  input.vertices = s.vertices;
  input.facets = s.triangles;
  input.sizes.assign(s.vertices.size(), size);
  input.switches = "pq1.4mYAQ";
  return input;
}

std::vector<char> bytes_of(const char* text) { return {text, text + std::strlen(text)}; }

ChildLimits at_most(double cpu_time, std::size_t output = std::size_t{1} << 24U) {
  ChildLimits limits;
  limits.cpu_time = cpu_time;
  limits.output = output;
  return limits;
}

// A program that does what the lines say.
std::filesystem::path script(const test::TemporaryFolder& folder, const std::string& lines) {
  const auto file = folder.write("script", "#!/bin/sh\n" + lines + "\n");
  std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  return file;
}

TEST(ChildProcess, OutputAndMessagesComeBack) {
  const ChildResult r = run_child("/bin/cat", bytes_of("to and fro"), at_most(10));
  EXPECT_TRUE(r.finished) << r.cause;
  EXPECT_EQ(std::string(r.output.begin(), r.output.end()), "to and fro");
}

TEST(ChildProcess, StartsWithArgumentsInAFolderWithVariables) {
  const test::TemporaryFolder folder;
  ChildStart start;
  start.arguments = {"one two", "three"};
  start.folder = folder.path();
  start.environment = {"HOME=/elsewhere"};
  const ChildResult r = run_child(script(folder, "echo \"$#,$1,$(pwd -P),$HOME\""), {}, at_most(10), start);
  EXPECT_EQ(std::string(r.output.begin(), r.output.end()),
            "2,one two," + std::filesystem::canonical(folder.path()).string() + ",/elsewhere\n");
}

TEST(ChildProcess, ProcessorTimeIsTold) {
  const test::TemporaryFolder folder;
  const ChildResult r =
      run_child(script(folder, "i=0; while [ $i -lt 300000 ]; do i=$((i+1)); done; sleep 1"), {}, at_most(30));
  EXPECT_TRUE(r.finished) << r.cause;
  EXPECT_GT(r.cpu_time, 0.05);
  EXPECT_LT(r.cpu_time, 20);
  EXPECT_LT(run_child(script(folder, "sleep 1"), {}, at_most(10)).cpu_time, 0.5);
}

TEST(ChildProcess, MoreThanAPipeHoldsGoesBothWays) {
  const std::vector<char> much(5 << 20, 'x');
  const ChildResult r = run_child("/bin/cat", much, at_most(20));
  EXPECT_TRUE(r.finished) << r.cause;
  EXPECT_EQ(r.output, much);
}

TEST(ChildProcess, ChildThatReadsNothingDoesNotKillUs) {
  const std::vector<char> much(5 << 20, 'x');
  EXPECT_TRUE(run_child("/bin/true", much, at_most(10)).finished);
  const ChildResult r = run_child("/bin/false", much, at_most(10));
  EXPECT_FALSE(r.finished);
  EXPECT_EQ(r.cause, "exit status 1");
}

TEST(ChildProcess, TimeLimitKillsWhoWorksAndWhoSleeps) {
  const test::TemporaryFolder folder;
  for (const char* lines : {"while :; do :; done", "sleep 1000"}) {
    const ChildResult r = run_child(script(folder, lines), {}, at_most(0.2));
    EXPECT_FALSE(r.finished);
    EXPECT_EQ(r.cause, "time limit reached") << lines;
  }
}

TEST(ChildProcess, TimeLimitIsOfProcessorTime) {
  const test::TemporaryFolder folder;
  const ChildResult r = run_child(script(folder, "sleep 2; echo rested"), {}, at_most(1.5));
  EXPECT_TRUE(r.finished) << r.cause;
  EXPECT_EQ(std::string(r.output.begin(), r.output.end()), "rested\n");
}

TEST(ChildProcess, LimitsAreSetBeforeTheInputEnds) {
  const test::TemporaryFolder folder;
  ChildLimits limits = at_most(6.5);
  limits.memory = std::size_t{1000000} * 1024;
  const ChildResult r =
      run_child(script(folder, "cat > /dev/null; ulimit -S -t; ulimit -H -t; ulimit -v"), bytes_of("x"), limits);
  EXPECT_EQ(std::string(r.output.begin(), r.output.end()), "7\n8\n1000000\n") << r.cause << r.messages;
}

TEST(ChildProcess, TooMuchOutputKills) {
  const ChildResult r = run_child("/usr/bin/yes", {}, at_most(10, 1 << 20));
  EXPECT_EQ(r.cause, "more output than expected");
}

TEST(ChildProcess, ProgramThatCannotStartIsAnIoError) {
  const test::TemporaryFolder folder;
  for (const auto& program : {std::filesystem::path("/nowhere/at-all"), folder.write("plain", "no program")}) {
    try {
      run_child(program, {}, at_most(10));
      ADD_FAILURE() << "started";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::io);
      EXPECT_NE(std::string(error.what()).find(program.string()), std::string::npos) << error.what();
    }
  }
}

TEST(TetgenWorker, FillsABallAndKeepsItsSurface) {
  const Surface ball = test::sphere_surface({0, 0, 0}, 0.05, 2);
  const MesherAnswer a = run_tetgen(input_of(ball, 0.02), 20);
  EXPECT_EQ(a.cause, "");
  EXPECT_GT(a.tets.tets.size(), 100u);
  ASSERT_GE(a.tets.points.size(), ball.vertices.size());
  for (std::size_t v = 0; v < ball.vertices.size(); ++v) EXPECT_EQ(a.tets.points[v], ball.vertices[v]);
}

TEST(TetgenWorker, GarbageIsRefused) {
  const std::filesystem::path worker = find_helper("palpate-tetgen");
  ASSERT_FALSE(worker.empty());
  for (const std::vector<char>& garbage :
       {std::vector<char>{}, bytes_of("hello"), std::vector<char>(100000, '\xff'), std::vector<char>(16, '\0')}) {
    const ChildResult r = run_child(worker, garbage, at_most(10));
    EXPECT_FALSE(r.finished);
    EXPECT_EQ(r.cause, "exit status 2");
    EXPECT_NE(r.messages.find("request"), std::string::npos);
  }
  // Counts that promise more than comes.
  const tetgen::RequestHeader header{tetgen::kRequestMagic, 1000, 1000, 5};
  std::vector<char> early(sizeof header);
  std::memcpy(early.data(), &header, sizeof header);
  EXPECT_NE(run_child(worker, early, at_most(10)).messages.find("ends early"), std::string::npos);
}

TEST(TetgenWorker, BadSurfacesGiveCauses) {
  const Surface ball = test::sphere_surface({0, 0, 0}, 0.05, 2);
  const auto cause = [](const TetgenInput& input) {
    const MesherAnswer a = run_tetgen(input, 10);
    EXPECT_TRUE(a.cause.empty() || a.tets.tets.empty());
    return a.cause;
  };
  TetgenInput crossing = input_of(ball, 0.02);
  crossing.vertices[0] = -2 * crossing.vertices[0];
  EXPECT_NE(cause(crossing), "");
  TetgenInput open = input_of(ball, 0.02);
  open.facets.resize(open.facets.size() / 2);
  EXPECT_NE(cause(open), "");
  TetgenInput nan = input_of(ball, 0.02);
  nan.vertices[3].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(cause(nan), "");
  TetgenInput out_of_range = input_of(ball, 0.02);
  out_of_range.facets[0][0] = 100000;
  EXPECT_NE(cause(out_of_range).find("out of range"), std::string::npos);
  TetgenInput empty;
  empty.switches = "pmYQ";
  EXPECT_NE(cause(empty).find("fewer than 4"), std::string::npos);
}

// A copy of this program where no worker is beside it runs this test again.
TEST(TetgenWorker, MissingWorkerIsAnIoErrorOfTheWholeMesh) {
  if (!find_helper("palpate-tetgen").empty()) {
    const test::TemporaryFolder folder;
    const auto alone = folder.path() / "alone";
    std::filesystem::copy_file("/proc/self/exe", alone);
    EXPECT_EQ(std::system((alone.string() + " --gtest_filter=TetgenWorker.MissingWorker* >&2").c_str()), 0);
    return;
  }
  const Body block = test::block_body(0.005);
  try {
    mesh_volume(block, test::size_round({0, 0, 0}, 0.004, 0.01), {});
    FAIL() << "meshed";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::io);
    EXPECT_NE(std::string(error.what()).find("palpate-tetgen"), std::string::npos) << error.what();
  }
}

TEST(TetgenWorker, KilledAtItsTimeLimit) {
  // Sizes a thousand times smaller than the ball want a billion tetrahedra.
  const MesherAnswer a = run_tetgen(input_of(test::sphere_surface({0, 0, 0}, 0.05, 3), 5e-5), 0.5);
  EXPECT_NE(a.cause.find("time limit"), std::string::npos) << a.cause;
}

TEST(TetgenWorker, ManyAtOnce) {
  const TetgenInput input = input_of(test::sphere_surface({0, 0, 0}, 0.05, 2), 0.02);
  const MesherAnswer alone = run_tetgen(input, 20);
  ASSERT_EQ(alone.cause, "");
  std::vector<MesherAnswer> answers(8);
  std::vector<std::thread> threads;
  for (MesherAnswer& a : answers) threads.emplace_back([&] { a = run_tetgen(input, 30); });
  for (std::thread& t : threads) t.join();
  for (const MesherAnswer& a : answers) {
    EXPECT_EQ(a.cause, "");
    EXPECT_EQ(a.tets.points, alone.tets.points);
    EXPECT_EQ(a.tets.tets, alone.tets.tets);
  }
}

}  // namespace
}  // namespace palpate::mesh
