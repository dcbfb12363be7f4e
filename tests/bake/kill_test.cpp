// SPDX-License-Identifier: GPL-3.0-or-later
// kill -9 at ten random moments of a bake: nothing accepted is lost, and it ends in the same response file.
#include <gtest/gtest.h>

#include <filesystem>
#include <random>

#include "formats/scene/scene.hpp"
#include "precompute/fit/assemble.hpp"
#include "precompute/tool/tool.hpp"
#include "tests/bake/fake_pairs.hpp"
#include "tests/bake/kill_driver.hpp"
#include "tests/fit/ball_plan.hpp"

namespace palpate::test {
namespace {

using std::chrono::microseconds;

class KilledBake : public testing::Test {
protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) / ("palpate_kill_" + std::to_string(::getpid()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    scene_.name = "ball";
    scene_.friction = solver_.friction;
    tool_.name = "tip";
    tool_.vertices.resize(1);
    tool_.patches.push_back({0, 0, 0});
    solver_.refused_sites = {13};
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void bake(const std::string& name, unsigned threads, microseconds per_sample) {
    solver_.per_sample = per_sample;
    Journal journal(folder_ / name, manifest_);
    bake::BakeOptions options;
    options.threads = threads;
    bake::bake_pairs(plan_.pairs, std::cref(solver_), journal, options);
  }
  [[nodiscard]] JournalContent content(const std::string& name) const {
    return read_journal(folder_ / name, manifest_);
  }
  [[nodiscard]] std::vector<std::byte> response_bytes(const std::string& name) const {
    fit::FitSettings settings;
    settings.depth_scale = scene_.sampling.depth;
    settings.friction = true;
    const fit::FittedResponses fitted = fit::fit_responses(plan_, mesh_.triangles, {1}, content(name), settings);
    return encode(fit::assemble_response(scene_, {tool_}, ball_surface(mesh_), plan_, manifest_, fitted));
  }

  std::filesystem::path folder_;
  Hash128 manifest_ = hash128("kill");
  Scene scene_;
  tool::Tool tool_;
  sites::HapticMesh mesh_ = ball_mesh(2, 0.05, 0.005);
  bake::Plan plan_ = ball_plan(mesh_);
  FakeSolver solver_;
};

TEST_F(KilledBake, TenKillsEndInTheSameFile) {
  bake("whole", 1, microseconds(0));
  const std::vector<std::byte> whole = response_bytes("whole");

  std::mt19937 random(20260);
  int kills = 0;
  JournalContent before;
  for (int attempt = 0; attempt < 100 && kills < 10; ++attempt) {
    const microseconds delay(1000 + static_cast<long>(random() % 60000));
    const ChildEnd end = run_and_kill([this] { bake("killed", 2, microseconds(500)); }, delay);
    ASSERT_NE(end, ChildEnd::failed);
    if (end == ChildEnd::done) break;
    ++kills;
    if (!std::filesystem::exists(folder_ / "killed")) continue;
    const JournalContent after = content("killed");
    for (const auto& [pair, data] : before.pairs) {
      const JournalPair& now = after.pairs.at(pair);
      EXPECT_TRUE(!data.outcome || now.outcome);
      for (std::size_t k = 0; k < data.samples.size(); ++k) EXPECT_TRUE(same_bits(now.samples.at(k), data.samples[k]));
    }
    before = after;
  }
  EXPECT_EQ(kills, 10) << "the bake must last long enough to be killed ten times";
  EXPECT_GT(before.records, 0U);
  bake("killed", 2, microseconds(0));
  EXPECT_EQ(content("killed").records, content("whole").records);
  EXPECT_EQ(response_bytes("killed"), whole);
}

TEST_F(KilledBake, OneThreadAndTwoGiveTheSameFile) {
  bake("one", 1, microseconds(20));
  bake("two", 2, microseconds(20));
  EXPECT_EQ(response_bytes("one"), response_bytes("two"));
}

}  // namespace
}  // namespace palpate::test
