// SPDX-License-Identifier: GPL-3.0-or-later
// Manifests: doubles come back to the bit, other files are refused with a reason.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "formats/io/error.hpp"
#include "precompute/bake/plan.hpp"

namespace palpate::test {
namespace {

bake::Plan awkward_plan() {
  std::mt19937_64 random(3);
  const auto number = [&random] {
    return std::ldexp(static_cast<double>(random()), -64 - static_cast<int>(random() % 40));
  };
  bake::Plan plan;
  plan.inputs.scene = hash128("scene");
  plan.inputs.body = hash128("body");
  plan.inputs.haptic_mesh = hash128("mesh");
  plan.inputs.tools = {hash128("tip"), hash128("stem")};
  for (std::uint32_t k = 0; k < 200; ++k) {
    PairPlan pair;
    pair.site = k;
    pair.tool = k % 2;
    pair.tool_vertex = k % 7;
    for (auto* v : {&pair.frame.origin, &pair.frame.x, &pair.frame.y, &pair.frame.n}) {
      *v = {number(), -number(), 1.0 / 3.0};
    }
    pair.depth = number();
    plan.pairs.push_back(pair);
  }
  plan.skipped = {{3, 0, 1, bake::SkipReason::support}, {9, 1, 0, bake::SkipReason::outside}};
  return plan;
}

TEST(Manifest, ReadsBackToTheBit) {
  const bake::Plan plan = awkward_plan();
  const std::string text = bake::manifest_text(plan);
  EXPECT_EQ(bake::manifest_text(plan), text);
  const bake::Manifest back = bake::parse_manifest(text, "manifest.json");
  EXPECT_EQ(back.inputs, plan.inputs);
  EXPECT_EQ(back.skipped, plan.skipped);
  ASSERT_EQ(back.pairs.size(), plan.pairs.size());
  for (std::size_t k = 0; k < plan.pairs.size(); ++k) {
    EXPECT_EQ(back.pairs[k].site, plan.pairs[k].site);
    EXPECT_EQ(back.pairs[k].tool, plan.pairs[k].tool);
    EXPECT_EQ(back.pairs[k].tool_vertex, plan.pairs[k].tool_vertex);
    EXPECT_EQ(back.pairs[k].frame.origin, plan.pairs[k].frame.origin);
    EXPECT_EQ(back.pairs[k].frame.x, plan.pairs[k].frame.x);
    EXPECT_EQ(back.pairs[k].frame.y, plan.pairs[k].frame.y);
    EXPECT_EQ(back.pairs[k].frame.n, plan.pairs[k].frame.n);
    EXPECT_EQ(back.pairs[k].depth, plan.pairs[k].depth);
  }
}

// Journals are bound to the hash of the text.
TEST(Manifest, RolesKeepTheNamesOfVersionOne) {
  bake::Plan plan = awkward_plan();
  plan.pairs[1].role = PairRole::normal;
  plan.pairs[2].role = PairRole::hidden;
  const std::string text = bake::manifest_text(plan);
  EXPECT_NE(text.find("\"role\": \"straight\""), std::string::npos) << text.substr(0, 2000);
  const bake::Manifest back = bake::parse_manifest(text, "manifest.json");
  EXPECT_EQ(back.pairs[0].role, PairRole::full);
  EXPECT_EQ(back.pairs[1].role, PairRole::normal);
  EXPECT_EQ(back.pairs[2].role, PairRole::hidden);
}

TEST(Manifest, AnyChangeChangesItsHash) {
  bake::Plan plan = awkward_plan();
  const Hash128 hash = bake::manifest_hash(bake::manifest_text(plan));
  plan.pairs[150].depth = std::nextafter(plan.pairs[150].depth, 1.0);
  EXPECT_FALSE(bake::manifest_hash(bake::manifest_text(plan)) == hash);
  plan = awkward_plan();
  plan.inputs.scene = hash128("another");
  EXPECT_FALSE(bake::manifest_hash(bake::manifest_text(plan)) == hash);
}

TEST(Manifest, OtherFilesAreRefused) {
  const std::string good = bake::manifest_text(awkward_plan());
  const auto replaced = [&good](const std::string& from, const std::string& to) {
    std::string text = good;
    return text.replace(text.find(from), from.size(), to);
  };
  for (const std::string& text :
       {std::string(), std::string("{}"), std::string("\x01\x02\xff garbage"), good.substr(0, good.size() / 2),
        replaced("palpate manifest", "something else"), replaced("\"version\": 1", "\"version\": 2"),
        replaced("\"site\": 0", "\"site\": \"zero\""), replaced("\"depth\"", "\"deep\"")}) {
    try {
      bake::parse_manifest(text, "manifest.json");
      ADD_FAILURE() << "accepted: " << text.substr(0, 60);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::bad_input);
      EXPECT_EQ(std::string(error.what()).find("manifest.json: "), 0U) << error.what();
    }
  }
}

}  // namespace
}  // namespace palpate::test
