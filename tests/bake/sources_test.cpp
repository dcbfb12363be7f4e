// SPDX-License-Identifier: GPL-3.0-or-later
// Responses that are recorded or by closed forms, alone and beside solved ones: no solve too many, the file says which.
#include <random>

#include "tests/bake/slab_sources.hpp"

namespace palpate::test {
namespace {

TEST_F(Sources, AnAnalyticSceneSolvesNothing) {
  const Pipeline p = open("[[analytic]]\nlaw = \"hertz\"\n");
  const bake::BakeReport bake = pipeline::bake(p, {}, no_solver);
  EXPECT_EQ(bake.total + bake.normal_solves + bake.tangential_solves + bake.factorisations, 0U);
  EXPECT_TRUE(read_journal(p.paths.journal, p.manifest).pairs.empty());
  const Opened file = fitted(p);
  EXPECT_EQ(file.count(layout::response_analytic), p.plan.pairs.size());
  EXPECT_EQ(file.count(layout::response_solved) + file.count(layout::response_measured), 0U);
  EXPECT_EQ(file.provenance()["sources"]["analytic"], p.plan.pairs.size());
  EXPECT_LT(file.provenance()["sources"]["analytic_fit"]["worst"].get<double>(), 1e-3);
  const bake::PlanSite& site = p.plan.sites[p.plan.pairs[nearest_pair(p, {0, 0, 0.02})].site];
  for (const double share : {0.1, 0.5, 1.0}) {
    const double d = share * kDepth;
    const Eigen::Vector3d down = -d * site.frame.n;
    EXPECT_NEAR(length(file.force(site, vec(down))) / hertz(d), 1, 0.002);
  }
}

TEST_F(Sources, AMeasuredSceneNeedsNoJournal) {
  const Pipeline p = open("[sources]\nrest = \"filled\"\n", csv({0.001, 0.002, 0.02}, pushes(1.5)));
  const fit::FitReport report = pipeline::fit(p);
  ASSERT_EQ(report.recorded.size(), 1U);
  EXPECT_TRUE(report.recorded[0].outliers.empty());
  EXPECT_LT(report.recorded[0].rms, 1e-3 * hertz(kDepth));
  EXPECT_FALSE(std::filesystem::exists(p.paths.journal));
  const Opened file(read_bytes(p.paths.response));
  EXPECT_EQ(file.count(layout::response_measured), 1U);
  EXPECT_EQ(file.count(layout::response_filled), file.view.meta->response_count - 1U);
  for (const PairPlan& pair : p.plan.pairs) {
    const bake::PlanSite& site = p.plan.sites[pair.site];
    EXPECT_NEAR(length(file.force(site, vec(-0.001 * site.frame.n))) / (1.5 * hertz(0.001)), 1, 0.01);
  }
}

// Real solves; then one response is recorded, with noise and gross errors, and put in place of the solved one.
TEST_F(Sources, ARecordingOfASolvedResponseGivesItBack) {
  // A file has as many bits for all its responses as the worst needs. With 2 % the recording changes nothing in that.
  const std::string tolerance = "[response]\ntolerance = 0.02\n";
  const Pipeline solved = open(tolerance);
  bake::BakeOptions options;
  options.threads = 1;
  ASSERT_EQ(pipeline::bake(solved, options).refused.size(), 0U);
  const Opened before = fitted(solved);
  const std::uint32_t pair = nearest_pair(solved, {0.002, 0, 0.02});
  const bake::PlanSite& site = solved.plan.sites[solved.plan.pairs[pair].site];
  const auto size = std::filesystem::file_size(solved.paths.journal);

  const double peak = length(before.force(site, vec(-kDepth * site.frame.n))), noise = 0.01 * peak;
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  std::vector<Row> rows;
  std::vector<std::string> wrong;
  for (int k = 1; k <= 400; ++k) {
    const Eigen::Vector3d down = -kDepth * k / 400 * site.frame.n;
    const Vec3 force = before.force(site, vec(down));
    rows.push_back({down, Eigen::Vector3d(force.x, force.y, force.z) +
                              noise * Eigen::Vector3d(normal(random), normal(random), normal(random))});
    if (k % 20 != 11) continue;
    rows.back().force *= k % 40 == 11 ? 0.0 : 3.0;
    rows.back().force += Eigen::Vector3d(0.3 * peak, 0, 0);
    wrong.push_back((folder_.path() / "recording.csv").string() + ":" + std::to_string(k + 2));
  }
  const Pipeline mixed = open(tolerance, csv(site.frame.origin, rows));
  EXPECT_EQ(pipeline::bake(mixed, {}, no_solver).resumed, mixed.plan.pairs.size() - 1);
  EXPECT_EQ(std::filesystem::file_size(mixed.paths.journal), size);
  const fit::FitReport report = pipeline::fit(mixed);
  ASSERT_EQ(report.recorded.size(), 1U);
  EXPECT_EQ(report.recorded[0].pair, pair);
  EXPECT_EQ(report.recorded[0].outliers, wrong);
  EXPECT_NEAR(report.recorded[0].rms, std::sqrt(3.0) * noise, 0.15 * noise);

  const Opened after(read_bytes(mixed.paths.response));
  ASSERT_EQ(after.view.meta->coef_bits, before.view.meta->coef_bits);
  EXPECT_EQ(after.count(layout::response_measured), 1U);
  EXPECT_EQ(after.count(layout::response_solved), mixed.plan.pairs.size() - 1);
  const auto measured = after.provenance()["sources"]["measured"];
  EXPECT_EQ(measured[0]["site"], mixed.plan.pairs[pair].site);
  EXPECT_EQ(measured[0]["outliers"], wrong.size());
  EXPECT_NEAR(measured[0]["residual_rms_N"].get<double>(), report.recorded[0].rms, 1e-9);
  for (int k = 1; k <= 20; ++k) {
    const Eigen::Vector3d down = -kDepth * k / 20 * site.frame.n;
    EXPECT_LT(length(after.force(site, vec(down)) - before.force(site, vec(down))), noise) << k;
  }
  for (const PairPlan& other : mixed.plan.pairs) {
    if (other.site == mixed.plan.pairs[pair].site) continue;
    const bake::PlanSite& there = mixed.plan.sites[other.site];
    const Vec3 down = vec(-0.0015 * there.frame.n);
    EXPECT_LT(length(after.force(there, down) - before.force(there, down)), 1e-4 * peak) << "solved sites stay";
  }
  // Between recorded and solved sites their responses are blended.
  runtime::BlendedResponse<> response;
  response.blend(after.view, 0, closest_point(after.view, {0.004, 0.001, 0.02}).at, {}, {1, 0, 0}, nullptr);
  EXPECT_NEAR(length(response.force(-1.4e-3 * response.normal())) / hertz(1.4e-3), 1.1, 0.25);
}

TEST_F(Sources, AllThreeOverOneBody) {
  const bake::Plan plan = open("").plan;
  const PairPlan &law = plan.pairs.front(), &recorded = plan.pairs.back();
  const Pipeline p =
      open("[[analytic]]\nlaw = \"spring\"\nstiffness = 100\nsites = [" + std::to_string(law.site) + "]\n",
           csv(recorded.frame.origin, pushes(2.0)));
  std::size_t solves = 0;
  const auto solver = [&](const PairPlan& pair, const solve::SampleSink& sink) {
    ++solves;
    PairResult result;
    for (int k = 1; k <= 8; ++k) {
      Sample s;
      s.index = static_cast<std::uint16_t>(k);
      s.deflection = {0, 0, pair.depth * k / 8};
      s.force = {0, 0, hertz(s.deflection.z())};
      sink(s);
    }
    result.outcome.accepted = true;
    return result;
  };
  bake::BakeOptions one;
  one.threads = 1;
  pipeline::bake(p, one, solver);
  EXPECT_EQ(solves, p.plan.pairs.size() - 2);
  EXPECT_GT(solves, 0U);
  const Opened file = fitted(p);
  EXPECT_EQ(file.count(layout::response_measured), 1U);
  EXPECT_EQ(file.count(layout::response_analytic), 1U);
  EXPECT_EQ(file.count(layout::response_solved), solves);
  for (const PairPlan& pair : p.plan.pairs) {
    const double got = length(file.force(p.plan.sites[pair.site], vec(-0.001 * pair.frame.n)));
    const double expected = pair.site == law.site ? 0.1 : hertz(0.001) * (pair.site == recorded.site ? 2 : 1);
    EXPECT_NEAR(got / expected, 1, 0.01) << pair.site;
  }
}

TEST_F(Sources, BadLawsSaySo) {
  const Pipeline p = open("");
  const std::string ball = "radius = 0.005\n", hertz = "[[analytic]]\nlaw = \"hertz\"\n";
  const std::string layer = "[[analytic]]\nlaw = \"layer\"\n", cone = "[[analytic]]\nlaw = \"cone\"\n";
  const std::string filled = "[sources]\nrest = \"filled\"\n";
  struct Case {
    std::string scene, tool, expected;
  };
  for (const Case& c :
       {Case{hertz, "shape = \"punch\"\n", "not for the shape"},
        {cone, ball, "not for the shape"},
        {cone, "shape = \"cone\"\nradius = 0.003\n", "from the tip's radius of 3 mm, not 2 mm"},
        {hertz + "sites = [0, 100000]\n", ball,
         ": analytic.sites: there is no site 100000; the body has " + std::to_string(p.plan.sites.size())},
        {hertz + hertz, ball, "analytic 2: holds at no site"},
        {hertz + "tool = \"probe\"\n", ball, "there is no tool 'probe'"},
        {layer + "[contact]\nfriction = 0.3\n", ball, "no closed form"},
        {layer + "thickness = 0.0039\n", ball, "up to half the layer's thickness of 3.9 mm, not 2 mm"},
        {hertz, "radius = 0.001\n", "up to the tip's radius of 1 mm"},
        {hertz, "radius = 0.005\ngrasp_depth = 0.001\n", "has to be solved"},
        {filled, ball, "needs a recording"},
        {filled + hertz + "tool = \"a\"\n", "name = \"a\"\n[[tool]]\nname = \"b\"\n",
         "nothing to fill from for contact vertex 0 of the tool 'b'"}}) {
    const std::filesystem::path file = write_scene(c.scene, c.tool);
    const Scene scene = read_scene(file);
    std::vector<tool::Tool> tools;
    for (const ToolScene& tool : scene.tools) tools.push_back(tool::make_tool(tool));
    const std::string text =
        message_of([&] { pipeline::find_sources(scene, read_sources(file), p.body, tools, p.mesh, p.plan); });
    EXPECT_NE(text.find(c.expected), std::string::npos) << text;
  }
}

TEST_F(Sources, LawsFollowPlaceAndTool) {
  const Pipeline p =
      open("[[analytic]]\nlaw = \"winkler\"\nstiffness = 1e6\ntool = \"b\"\nsites = [" +
               std::to_string(open("").plan.pairs[0].site) +
               "]\n[[analytic]]\nlaw = \"hertz\"\nmesh = \"slab\"\nyoung = 10000\n[contact]\nfriction = 0.3\n",
           {}, "name = \"a\"\nradius = 0.005\n[[tool]]\nname = \"b\"\nradius = 0.004\n");
  const Opened file = fitted(p);
  EXPECT_EQ(file.count(layout::response_analytic), p.plan.pairs.size());
  const bake::PlanSite& site = p.plan.sites[p.plan.pairs[0].site];
  const Eigen::Vector3d down = -0.001 * site.frame.n, aside = down + 0.0002 * site.frame.x;
  const auto force = [&](std::uint32_t tool, const Eigen::Vector3d& d) {
    const Vec3 f = file.force(site, tool, vec(d));
    return Eigen::Vector3d(f.x, f.y, f.z);
  };
  EXPECT_NEAR(force(0, down).norm() / (2 * hertz(0.001)), 1, 0.002);
  EXPECT_NEAR(force(1, down).norm(), 1e6 * 3.14159265 * 0.004 * 1e-6, 1e-4);
  // Mindlin: 8 G a / (2 - nu) with a = sqrt(R d).
  const double stiffness = 8 * 10000 / (2 * (1 + kPoisson)) * std::sqrt(kRadius * 0.001) / (2 - kPoisson);
  EXPECT_NEAR(-site.frame.x.dot(force(0, aside)) / (stiffness * 0.0002), 1, 0.03);
}

}  // namespace
}  // namespace palpate::test
