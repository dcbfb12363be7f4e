// SPDX-License-Identifier: GPL-3.0-or-later
// The worker process and its client: garbage, crashes and time limits become causes.
#include "precompute/mesh/child_process.hpp"
#include "precompute/mesh/tetgen_client.hpp"
#include "precompute/mesh/tetgen_protocol.hpp"
#include "tests/support/shapes.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <limits>
#include <thread>

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

TetgenInput input_of(const Surface& s, double size) {
  TetgenInput input;
  input.vertices = s.vertices;
  input.facets = s.triangles;
  input.sizes.assign(s.vertices.size(), size);
  input.switches = "pq1.4mYAQ";
  return input;
}

std::vector<char> bytes_of(const char* text) { return {text, text + std::strlen(text)}; }

TEST(ChildProcess, OutputAndMessagesComeBack) {
  const ChildResult r = run_child("/bin/cat", bytes_of("to and fro"), 10, 1 << 20);
  EXPECT_TRUE(r.finished) << r.cause;
  EXPECT_EQ(std::string(r.output.begin(), r.output.end()), "to and fro");
}

TEST(ChildProcess, MoreThanAPipeHoldsGoesBothWays) {
  const std::vector<char> much(5 << 20, 'x');
  const ChildResult r = run_child("/bin/cat", much, 20, 1 << 24);
  EXPECT_TRUE(r.finished) << r.cause;
  EXPECT_EQ(r.output, much);
}

TEST(ChildProcess, ChildThatReadsNothingDoesNotKillUs) {
  const std::vector<char> much(5 << 20, 'x');
  EXPECT_TRUE(run_child("/bin/true", much, 10, 1 << 20).finished);
  const ChildResult r = run_child("/bin/false", much, 10, 1 << 20);
  EXPECT_FALSE(r.finished);
  EXPECT_EQ(r.cause, "exit status 1");
}

TEST(ChildProcess, TimeLimitKills) {
  const auto start = Clock::now();
  // cat with nothing on its input yet: yes never ends.
  const ChildResult r = run_child("/usr/bin/yes", {}, 0.3, std::numeric_limits<std::size_t>::max());
  EXPECT_FALSE(r.finished);
  EXPECT_EQ(r.cause, "time limit reached");
  EXPECT_LT(seconds_since(start), 5);
}

TEST(ChildProcess, TooMuchOutputKills) {
  const ChildResult r = run_child("/usr/bin/yes", {}, 10, 1 << 20);
  EXPECT_EQ(r.cause, "more output than expected");
}

TEST(ChildProcess, MissingProgramIsACause) {
  const ChildResult r = run_child("/nowhere/at-all", {}, 10, 1 << 20);
  EXPECT_FALSE(r.finished);
  EXPECT_NE(r.cause.find("/nowhere/at-all"), std::string::npos);
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
    const ChildResult r = run_child(worker, garbage, 10, 1 << 20);
    EXPECT_FALSE(r.finished);
    EXPECT_EQ(r.cause, "exit status 2");
    EXPECT_NE(r.messages.find("request"), std::string::npos);
  }
  // Counts that promise more than comes.
  const tetgen::RequestHeader header{tetgen::kRequestMagic, 1000, 1000, 5};
  std::vector<char> early(sizeof header);
  std::memcpy(early.data(), &header, sizeof header);
  EXPECT_NE(run_child(worker, early, 10, 1 << 20).messages.find("ends early"), std::string::npos);
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

TEST(TetgenWorker, KilledAtItsTimeLimit) {
  // Sizes a thousand times smaller than the ball want a billion tetrahedra.
  const auto start = Clock::now();
  const MesherAnswer a = run_tetgen(input_of(test::sphere_surface({0, 0, 0}, 0.05, 3), 5e-5), 0.5);
  EXPECT_NE(a.cause.find("time limit"), std::string::npos) << a.cause;
  EXPECT_LT(seconds_since(start), 8);
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
}  // namespace palpate
