// SPDX-License-Identifier: GPL-3.0-or-later
// The bake loop: every pair once, resume, stop, refusals, a solver that changes its mind, errors in a worker.
#include "precompute/bake/bake.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <set>

#include "formats/io/error.hpp"
#include "precompute/bake/progress.hpp"
#include "tests/bake/fake_pairs.hpp"

namespace palpate::test {
namespace {

class BakeLoop : public testing::Test {
protected:
  void SetUp() override {
    folder_ =
        std::filesystem::path(testing::TempDir()) / ("palpate_bake_" + std::to_string(::getpid()) + "_" +
                                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  bake::BakeReport bake(const bake::PairSolver& solver, const bake::BakeOptions& options = {}) {
    Journal journal(folder_ / "samples.journal", manifest_);
    return bake::bake_pairs(pairs_, solver, journal, options);
  }
  [[nodiscard]] JournalContent content() const { return read_journal(folder_ / "samples.journal", manifest_); }

  /// Everything of the journal that a fit sees, as one text.
  [[nodiscard]] std::string digest() const {
    Hasher hasher;
    for (const auto& [pair, data] : content().pairs) {
      hasher.number(std::int64_t{pair}).number(std::int64_t{data.outcome.has_value()});
      for (const Sample& s : data.samples) {
        for (int i = 0; i < 3; ++i) hasher.number(s.deflection[i]).number(s.force[i]);
        hasher.number(s.friction_limit);
      }
    }
    return to_hex(hasher.digest());
  }

  std::filesystem::path folder_;
  Hash128 manifest_ = hash128("plan");
  std::vector<PairPlan> pairs_ = fake_plan(40);
};

TEST_F(BakeLoop, SolvesEveryPairOnce) {
  FakeSolver solver;
  solver.refused_sites = {7, 31};
  bake::BakeOptions options;
  options.threads = 4;
  const bake::BakeReport report = bake(std::cref(solver), options);
  EXPECT_EQ(solver.calls, 40);
  EXPECT_EQ(report.total, 40U);
  EXPECT_EQ(report.accepted, 38U);
  EXPECT_FALSE(report.stopped);
  ASSERT_EQ(report.refused.size(), 2U);
  EXPECT_EQ(report.refused[0].pair, 7U);
  EXPECT_NE(report.refused[1].cause.find("penetration"), std::string::npos);
  EXPECT_EQ(report.normal_solves, 38U * 12U);
  EXPECT_EQ(report.tangential_solves, 38U * 24U);
  const JournalContent journal = content();
  EXPECT_EQ(journal.pairs.size(), 40U);
  EXPECT_EQ(journal.records, 38U * 37U + 2U);
}

TEST_F(BakeLoop, AFinishedBakeSolvesNothing) {
  FakeSolver solver;
  bake(std::cref(solver));
  const std::string before = digest();
  const bake::BakeReport again = bake(std::cref(solver));
  EXPECT_EQ(solver.calls, 40);
  EXPECT_EQ(again.resumed, 40U);
  EXPECT_EQ(again.accepted, 40U);
  EXPECT_EQ(digest(), before);
}

TEST_F(BakeLoop, FrictionlessPairsRunNoTangentialSolve) {
  FakeSolver solver;
  solver.friction = 0;
  EXPECT_EQ(bake(std::cref(solver)).tangential_solves, 0U);
}

TEST_F(BakeLoop, ThreadsGiveTheSameContent) {
  FakeSolver solver;
  solver.per_sample = std::chrono::microseconds(20);
  bake::BakeOptions options;
  options.threads = 1;
  bake(std::cref(solver), options);
  const std::string one = digest();
  std::filesystem::remove(folder_ / "samples.journal");
  options.threads = 3;
  bake(std::cref(solver), options);
  EXPECT_EQ(digest(), one);
}

TEST_F(BakeLoop, StopLosesNothingAndGoesOn) {
  FakeSolver solver;
  solver.per_sample = std::chrono::microseconds(200);
  bake::BakeOptions options;
  options.threads = 2;
  std::atomic<int> polls{0};
  options.stop = [&polls] { return ++polls > 2; };
  const bake::BakeReport stopped = bake(std::cref(solver), options);
  EXPECT_TRUE(stopped.stopped);
  EXPECT_LT(stopped.accepted, 40U);
  const JournalContent half = content();
  std::size_t finished = 0;
  for (const auto& [pair, data] : half.pairs) finished += data.outcome.has_value() ? 1U : 0U;
  EXPECT_EQ(finished, stopped.accepted);
  EXPECT_EQ(half.records, finished * 37U) << "pairs that ran when the stop came are finished and kept";
  EXPECT_EQ(finished, static_cast<std::size_t>(solver.calls));
  EXPECT_GT(finished, 0U);

  const bake::BakeReport rest = bake(std::cref(solver));
  EXPECT_EQ(rest.resumed, stopped.accepted);
  EXPECT_EQ(rest.accepted, 40U);
  const JournalContent whole = content();
  EXPECT_EQ(whole.records, 40U * 37U);
  const std::string resumed = digest();
  std::filesystem::remove(folder_ / "samples.journal");
  bake(std::cref(solver));
  EXPECT_EQ(digest(), resumed);
}

/// The error of a bake as (code, text).
template <class Run>
std::pair<ExitCode, std::string> error_of(Run&& run) {
  try {
    run();
  } catch (const Error& error) {
    return {error.code(), error.what()};
  }
  return {ExitCode::done, {}};
}

TEST_F(BakeLoop, AReSolvedPairThatDiffersIsAnError) {
  const FakeSolver solver;
  {
    // Pair 3 has two samples and no outcome, as a kill leaves it.
    Journal journal(folder_ / "samples.journal", manifest_);
    std::vector<Sample> samples;
    solver(pairs_[3], [&](const Sample& s) { samples.push_back(s); });
    samples[1].force.z() = std::nextafter(samples[1].force.z(), 1e9);
    journal.append(3, samples[0]);
    journal.append(3, samples[1]);
  }
  const auto [code, text] = error_of([&] { bake(std::cref(solver)); });
  EXPECT_EQ(code, ExitCode::numerical);
  EXPECT_NE(text.find("pair 3 (site 3"), std::string::npos) << text;
}

TEST_F(BakeLoop, AReSolvedPairThatLosesASampleIsAnError) {
  FakeSolver solver;
  {
    Journal journal(folder_ / "samples.journal", manifest_);
    solver(pairs_[5], [&](const Sample& s) { journal.append(5, s); });
  }
  solver.refused_sites = {5};
  const auto [code, text] = error_of([&] { bake(std::cref(solver)); });
  EXPECT_EQ(code, ExitCode::numerical);
  EXPECT_NE(text.find("36 samples"), std::string::npos) << text;
}

TEST_F(BakeLoop, ChecksAreKeptAndMustComeAgain) {
  const FakeSolver solver;
  double difference = 0.02;
  const bake::PairSolver checked = [&](const PairPlan& plan, const solve::SampleSink& sink) {
    PairResult result = solver(plan, sink);
    if (plan.site % 4 == 0) result.check = PairCheck{5000, 12, 12, difference, {}};
    return result;
  };
  bake(checked);
  std::size_t count = 0;
  for (const auto& [pair, data] : content().pairs) count += data.check && data.check->difference == difference;
  EXPECT_EQ(count, 10U);

  // Pair 8 has its check and no outcome, as a kill leaves it.
  std::filesystem::remove(folder_ / "samples.journal");
  Journal(folder_ / "samples.journal", manifest_).append(8, PairCheck{5000, 12, 12, difference, {}});
  EXPECT_EQ(bake(checked).accepted, 40U);
  std::filesystem::remove(folder_ / "samples.journal");
  Journal(folder_ / "samples.journal", manifest_).append(8, PairCheck{5000, 12, 12, 2 * difference, {}});
  const auto [code, text] = error_of([&] { bake(checked); });
  EXPECT_EQ(code, ExitCode::numerical);
  EXPECT_NE(text.find("its check differs"), std::string::npos) << text;
}

TEST_F(BakeLoop, AWorkersErrorEndsTheBakeAndKeepsTheRest) {
  FakeSolver solver;
  const bake::PairSolver broken = [&](const PairPlan& plan, const solve::SampleSink& sink) {
    if (plan.site == 20) throw Error(ExitCode::io, "no more memory for pair 20");
    return solver(plan, sink);
  };
  bake::BakeOptions options;
  options.threads = 2;
  const auto [code, text] = error_of([&] { bake(broken, options); });
  EXPECT_EQ(code, ExitCode::io);
  EXPECT_EQ(text, "no more memory for pair 20");
  EXPECT_GE(content().pairs.size(), 18U);
  EXPECT_EQ(bake(std::cref(solver)).accepted, 40U);
}

TEST_F(BakeLoop, AJournalOfAShorterPlanIsRefused) {
  const FakeSolver solver;
  bake(std::cref(solver));
  pairs_.resize(10);
  EXPECT_EQ(error_of([&] { bake(std::cref(solver)); }).first, ExitCode::bad_input);
}

TEST_F(BakeLoop, NothingToDoIsDone) {
  pairs_.clear();
  FakeSolver solver;
  const bake::BakeReport report = bake(std::cref(solver));
  EXPECT_EQ(solver.calls, 0);
  EXPECT_EQ(report.total, 0U);
  EXPECT_FALSE(report.stopped);
}

TEST_F(BakeLoop, ProgressTellsRateAndTimeLeft) {
  FakeSolver solver;
  solver.per_sample = std::chrono::microseconds(100);
  solver.refused_sites = {0};
  bake::BakeOptions options;
  options.threads = 2;
  options.interval = 0.0;
  std::vector<bake::BakeProgress> seen;
  options.progress = [&seen](const bake::BakeProgress& p) { seen.push_back(p); };
  bake(std::cref(solver), options);
  ASSERT_FALSE(seen.empty());
  EXPECT_EQ(seen.back().done, 40U);
  EXPECT_EQ(seen.back().refused, 1U);
  EXPECT_GT(seen.back().per_hour, 0.0);
  for (std::size_t k = 1; k < seen.size(); ++k) EXPECT_GE(seen[k].done, seen[k - 1].done);
}

TEST(Progress, TextAndPlainLines) {
  const bake::BakeProgress half{200, 50, 3, 100.0, 1800.0, 300.0};
  EXPECT_EQ(bake::progress_text(half), "bake 50/200 pairs (25.0 %), 3 refused, 1800 pairs/h, 5 min 0 s left");
  EXPECT_EQ(bake::duration_text(59.2), "1 min 0 s");
  EXPECT_EQ(bake::duration_text(7500), "2 h 5 min");
  std::FILE* stream = std::tmpfile();
  ASSERT_NE(stream, nullptr);
  bake::ProgressPrinter printer(stream, 10.0);
  for (std::size_t second = 1; second <= 25; ++second)
    printer({25, second, 0, double(second), 3600.0, 25.0 - double(second)});
  std::rewind(stream);
  int lines = 0;
  for (int c = std::fgetc(stream); c != EOF; c = std::fgetc(stream)) {
    EXPECT_NE(c, '\r');
    lines += c == '\n' ? 1 : 0;
  }
  std::fclose(stream);
  EXPECT_EQ(lines, 4) << "at 1, 11, 21 s and the last";
}

}  // namespace
}  // namespace palpate::test
