// SPDX-License-Identifier: GPL-3.0-or-later
// Shards: parts of a bake, their journals, and the merge into one.
#include "precompute/bake/shard.hpp"

#include <gtest/gtest.h>

#include <set>

#include "formats/io/error.hpp"
#include "tests/bake/fake_pairs.hpp"
#include "tests/support/temporary_folder.hpp"

namespace palpate::test {
namespace {

constexpr std::uint32_t kPairs = 40;

class Shards : public testing::Test {
protected:
  void bake(const bake::Shard& shard, const FakeSolver& solver) const {
    std::filesystem::create_directories(folder_.path() / "shards");
    Journal journal(folder_.path() / "shards" / (shard.name() + ".journal"), manifest_);
    bake::BakeOptions options;
    options.threads = 2;
    options.wanted = [&](std::uint32_t pair) { return shard.holds(pair); };
    bake::bake_pairs(pairs_, std::cref(solver), journal, options);
  }
  bake::BakeReport merge(const JournalContent& shards) const {
    Journal journal(folder_.path() / "samples.journal", manifest_);
    bake::BakeOptions options;
    options.wanted = [&](std::uint32_t pair) { return journal.content().finished(pair) || shards.finished(pair); };
    return bake::bake_pairs(pairs_, bake::recorded_solver(pairs_, shards), journal, options);
  }
  [[nodiscard]] JournalContent shards() const { return bake::read_shards(folder_.path() / "shards", manifest_); }
  [[nodiscard]] JournalContent content(const char* name) const {
    return read_journal(folder_.path() / name, manifest_);
  }

  TemporaryFolder folder_;
  Hash128 manifest_ = hash128("shards");
  std::vector<PairPlan> pairs_ = fake_plan(kPairs);
};

void expect_same(const JournalContent& a, const JournalContent& b) {
  ASSERT_EQ(a.pairs.size(), b.pairs.size());
  for (const auto& [pair, x] : a.pairs) {
    const JournalPair& y = b.pairs.at(pair);
    ASSERT_TRUE(x.outcome && y.outcome);
    EXPECT_EQ(x.outcome->cause, y.outcome->cause);
    EXPECT_EQ(x.outcome->nodes, y.outcome->nodes);
    ASSERT_EQ(x.samples.size(), y.samples.size());
    for (std::size_t k = 0; k < x.samples.size(); ++k) EXPECT_TRUE(same_bits(x.samples[k], y.samples[k]));
  }
}

TEST_F(Shards, TogetherHoldEveryPairOnce) {
  for (const std::uint32_t count : {1U, 3U, 8U, 40U, 41U}) {
    for (std::uint32_t pair = 0; pair < kPairs; ++pair) {
      int holders = 0;
      for (std::uint32_t index = 1; index <= count; ++index) holders += bake::Shard{index, count}.holds(pair) ? 1 : 0;
      EXPECT_EQ(holders, 1) << pair << " of " << count;
    }
  }
}

TEST_F(Shards, ANameIsReadOrRefusedWithWhatIsAllowed) {
  const bake::Shard shard = bake::parse_shard("3/8");
  EXPECT_EQ(shard.index, 3U);
  EXPECT_EQ(shard.count, 8U);
  for (const char* text : {"", "3", "/", "3/", "/8", "0/8", "9/8", "-1/8", "3/8/1", " 3/8", "3/8 ", "3.0/8", "1/100001",
                           "1/99999999999"}) {
    try {
      static_cast<void>(bake::parse_shard(text));
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::usage);
      EXPECT_NE(std::string(error.what()).find("allowed I/N"), std::string::npos) << error.what();
    }
  }
}

TEST_F(Shards, MergedHoldWhatOneBakeHolds) {
  FakeSolver solver;
  solver.refused_sites = {7, 31};
  {
    Journal journal(folder_.path() / "whole", manifest_);
    bake::bake_pairs(pairs_, std::cref(solver), journal);
  }
  for (const std::uint32_t index : {1U, 3U}) bake({index, 3}, solver);
  const bake::BakeReport first = merge(shards());
  EXPECT_EQ(first.total, 27U);
  // The rest in other parts, which hold some pairs a second time.
  for (const std::uint32_t index : {1U, 2U}) bake({index, 2}, solver);
  const bake::BakeReport second = merge(shards());
  EXPECT_EQ(second.total, kPairs);
  EXPECT_EQ(second.resumed, 27U);
  EXPECT_EQ(second.refused.size(), 2U);
  expect_same(content("samples.journal"), content("whole"));
  const auto size = std::filesystem::file_size(folder_.path() / "samples.journal");
  EXPECT_EQ(merge(shards()).resumed, kPairs);
  EXPECT_EQ(std::filesystem::file_size(folder_.path() / "samples.journal"), size);
}

TEST_F(Shards, PairsOfSeveralRolesAtOneSiteAreNotConfused) {
  for (std::uint32_t k = kPairs / 2; k < kPairs; ++k) {
    pairs_[k].site = k - kPairs / 2;
    pairs_[k].role = k % 2 == 0 ? PairRole::normal : PairRole::hidden;
  }
  const FakeSolver solver;
  {
    Journal journal(folder_.path() / "whole", manifest_);
    bake::bake_pairs(pairs_, std::cref(solver), journal);
  }
  for (const std::uint32_t index : {1U, 2U}) bake({index, 2}, solver);
  merge(shards());
  expect_same(content("whole"), content("samples.journal"));
}

TEST_F(Shards, APairWithoutAnOutcomeIsNotMerged) {
  bake({1, 1}, FakeSolver{});
  const auto file = folder_.path() / "shards" / "1-of-1.journal";
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2 + 3);
  const JournalContent cut = shards();
  EXPECT_GT(cut.torn_bytes, 0U);
  EXPECT_LT(cut.pairs.size(), kPairs);
  EXPECT_EQ(merge(cut).total, cut.pairs.size());
  for (const auto& [pair, recorded] : content("samples.journal").pairs) EXPECT_TRUE(recorded.outcome) << pair;
  bake({1, 1}, FakeSolver{});
  EXPECT_EQ(merge(shards()).total, kPairs);
}

TEST_F(Shards, AnUnfinishedPairOfTheSamplesThatDiffersIsRefused) {
  {
    FakeSolver other;
    other.friction = 0.4;
    Journal journal(folder_.path() / "samples.journal", manifest_);
    other(pairs_[5], [&](const Sample& sample) { journal.append(5, sample); });
  }
  bake({1, 1}, FakeSolver{});
  try {
    merge(shards());
    FAIL() << "two different samples were merged";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::numerical);
    EXPECT_NE(std::string(error.what()).find("pair 5"), std::string::npos) << error.what();
  }
}

TEST_F(Shards, AnotherManifestIsRefused) {
  bake({1, 2}, FakeSolver{});
  EXPECT_THROW(bake::read_shards(folder_.path() / "shards", hash128("another")), Error);
  EXPECT_TRUE(bake::read_shards(folder_.path() / "none", manifest_).pairs.empty());
}

}  // namespace
}  // namespace palpate::test
