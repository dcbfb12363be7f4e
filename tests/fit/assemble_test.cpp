// SPDX-License-Identifier: GPL-3.0-or-later
// Assembling a response file: it passes the writer's checks, its flags, sections and provenance are right.
#include "precompute/fit/assemble.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "formats/scene/scene.hpp"
#include "precompute/tool/tool.hpp"
#include "tests/fit/analytic_pair.hpp"
#include "tests/fit/ball_plan.hpp"

namespace palpate::test {
namespace {

struct Ball {
  Scene scene;
  tool::Tool tool;
  sites::HapticMesh mesh;
  bake::Plan plan;
  JournalContent journal;

  explicit Ball(double friction, int level = 1) : mesh(ball_mesh(level, 0.05, 0.005)), plan(ball_plan(mesh)) {
    scene.name = "ball";
    scene.friction = friction;
    tool.name = "tip";
    tool.vertices.resize(1);
    tool.patches.push_back({0, 0, 0});
    // The last site lies on a support.
    plan.skipped.push_back({plan.pairs.back().site, 0, 0, bake::SkipReason::support});
    plan.pairs.pop_back();
    AnalyticPair pair = power_law(500, 1.5);
    pair.friction = friction;
    pair.growth = [](double z) { return std::sqrt(z / 0.005); };
    pair.tangential_x = pair.tangential_y = [](double x) { return -70 * x; };
    for (std::uint32_t k = 0; k < plan.pairs.size(); ++k) {
      journal.pairs[k].samples = samples_of(pair, plan.pairs[k].depth);
      journal.pairs[k].outcome.emplace();
      journal.pairs[k].outcome->accepted = true;
    }
  }

  [[nodiscard]] ResponseFileContent content() const {
    fit::FitSettings settings;
    settings.depth_scale = scene.sampling.depth;
    settings.friction = scene.friction > 0;
    const fit::FittedResponses fitted = fit::fit_responses(plan, mesh.triangles, {1}, journal, settings);
    return fit::assemble_response(scene, {tool}, ball_surface(mesh), plan, hash128("manifest"), fitted);
  }
};

TEST(Assemble, FrictionlessFileHasNoFrictionAndNoSearch) {
  const ResponseFileContent content = Ball(0.0).content();
  EXPECT_FALSE(content.degrees.friction_families);
  EXPECT_EQ(content.degrees.bias, 0);
  EXPECT_TRUE(content.search.empty());
  EXPECT_EQ(content.tangential_scale, 0.0);
  EXPECT_FALSE(encode(content).empty()) << "the writer checks everything";
}

TEST(Assemble, FileWithFrictionPassesTheWritersChecks) {
  const ResponseFileContent content = Ball(0.4).content();
  EXPECT_TRUE(content.degrees.friction_families);
  EXPECT_NEAR(content.tangential_scale, 0.4 * 0.005, 1e-12);
  EXPECT_EQ(encode(content), encode(Ball(0.4).content())) << "the same inputs, the same bytes";
}

TEST(Assemble, SupportIsMarked) {
  const ResponseFileContent content = Ball(0.0).content();
  const std::size_t last = content.sites.size() - 1;
  EXPECT_EQ(content.sites[last].flags, layout::site_held);
  EXPECT_EQ(content.sites[0].flags, 0U);
  EXPECT_EQ(content.responses[last].flags, layout::response_filled);
  EXPECT_EQ(content.responses[0].flags, layout::response_solved);
}

TEST(Assemble, SearchFollowsTheScene) {
  using Search = ResponseScene::Search;
  Ball small(0.0), large(0.0, 2);
  EXPECT_LE(small.mesh.triangles.size(), kSearchThreshold);
  EXPECT_GT(large.mesh.triangles.size(), kSearchThreshold);
  EXPECT_TRUE(small.content().search.empty());
  EXPECT_FALSE(large.content().search.empty());
  small.scene.response.search = Search::bvh;
  large.scene.response.search = Search::none;
  EXPECT_FALSE(small.content().search.empty());
  EXPECT_FALSE(encode(small.content()).empty());
  EXPECT_TRUE(large.content().search.empty());
}

TEST(Assemble, ProvenanceNamesInputsAndErrors) {
  const nlohmann::json json = nlohmann::json::parse(Ball(0.4).content().provenance);
  EXPECT_EQ(json.at("inputs").at("manifest"), to_hex(hash128("manifest")));
  EXPECT_EQ(json.at("pairs").at("planned"), 17);
  EXPECT_EQ(json.at("pairs").at("support"), 1);
  EXPECT_LT(json.at("fit").at("normal").at("p95").get<double>(), 0.05);
  EXPECT_LT(json.at("fit").at("tangential").at("p95").get<double>(), 0.05);
}

}  // namespace
}  // namespace palpate::test
