// SPDX-License-Identifier: GPL-3.0-or-later
// Recordings from the file to the response: which site they belong to, what is passed over, what is refused by name.
#include <cmath>

#include "tests/bake/slab_sources.hpp"

namespace palpate::test {
namespace {

class Recordings : public Sources {
protected:
  /// Message of a fit of `p` with this recording in place of its own.
  std::string refused(Pipeline& p, const std::string& recording) const {
    p.scene_sources.measured = {{folder_.write("bad.csv", recording), {}, 0.0}};
    return message_of([&] {
      p.sources = pipeline::find_sources(p.scene, p.scene_sources, p.body, p.tools, p.mesh, p.plan);
      pipeline::fit(p);
    });
  }
};

const std::string kFilled = "[sources]\nrest = \"filled\"\n[contact]\nfriction = 0.3\n";

/// Normal indentations, then pushes aside to `directions` evenly spaced sides, held as Mindlin's contact is.
std::vector<Row> pushed_aside(int directions) {
  std::vector<Row> rows = pushes(1);
  for (int depth = 1; depth <= 5; ++depth) {
    const double d = kDepth * depth / 5;
    const double stiffness = 8 * kYoung / (2 * (1 + kPoisson)) * std::sqrt(kRadius * d) / (2 - kPoisson);
    for (int k = 0; k < directions; ++k) {
      const double angle = 0.1 + 2 * 3.14159265 * k / directions;
      for (const double way : {0.1 * d, 0.2 * d, 0.3 * d}) {
        const Eigen::Vector3d aside(way * std::cos(angle), way * std::sin(angle), 0);
        rows.push_back({aside - Eigen::Vector3d(0, 0, d), -stiffness * aside + Eigen::Vector3d(0, 0, hertz(d))});
      }
    }
  }
  return rows;
}

TEST_F(Recordings, BadRecordingsNameLineAndCause) {
  Pipeline p = open("[[analytic]]\nlaw = \"hertz\"\n");
  const std::string head = "x,y,z,dx,dy,dz,fx,fy,fz";
  const auto one = [&](const std::string& columns, const std::string& row) {
    return "#\n" + head + columns + "\n0,0,0.02,0,0,-0.001,0,0,0.1" + row + "\n";
  };
  struct Case {
    std::string recording, expected;
  };
  for (const Case& c : {
           Case{head + "\n0,0,0.03,0,0,-0.001,0,0,0.1\n",
                "csv:2: the contact lies 10 mm off the body's surface, allowed 3 mm"},
           {one(",tool", ",probe"), "csv:3: there is no tool 'probe'; the scene has 'tool'"},
           {one(",tool_vertex", ",1"), "csv:3: the tool 'tool' has 1 contact vertices"},
           {"site,dx,dy,dz,fx,fy,fz\n100000,0,0,-0.001,0,0,0.1\n", "csv:2: there is no site 100000"},
           {head + "\n0,0,0,0,0,0.001,0,0,-0.1\n", "is on or beside a support: no response"},
           {head + "\n0.0295,0.0295,0.02,0,0,-0.001,0,0,0.1\n", "is outside the region that is sampled: no response"},
           {head + "\n0,0,0.02,0.001,0,-0.001,0,0,0.1\n",
            "there are 0; 1 rows passed over: 0 not in contact, 0 deeper than sampling.depth, 1 too far aside"},
           {head + "\n0,0,0.02,0,0,-0.0021,0,0,0.1\n0,0,0.02,0,0,-0.001,0,0,0.1\n",
            "there are 1; 1 rows passed over: 0 not in contact, 1 deeper than sampling.depth, 0 too far aside"},
           {head + ",weight\n0,0,0.02,0,0,-0.001,0,0,0.1,0\n", "0 too far aside, 1 of weight 0"},
           {csv({0, 0, 0.02}, pushes(1, 60, 0.4 * kDepth)), "less than half of the 2 mm"},
           {csv({0, 0, 0.02}, pushes(1, 6)), "at least 8 rows"},
           {csv({0, 0, 0.02}, pushes(-1)), "off any fit"},
           {csv({0, 0, 0.02}, pushes(0)), "with a force"},
           {head + "\n0,0,0.02,0,0,0.001,0,0,0\n",
            "at least 8 rows of normal indentations; there are 0; 1 rows passed over: 1 not in contact"},
       }) {
    const std::string text = refused(p, c.recording);
    EXPECT_NE(text.find(c.expected), std::string::npos) << text;
  }
}

TEST_F(Recordings, WithFrictionEverySideIsAskedFor) {
  Pipeline p = open(kFilled, csv({0, 0, 0.02}, pushed_aside(8)));
  const std::string one = refused(p, csv({0, 0, 0.02}, pushed_aside(1)));
  EXPECT_NE(one.find("recorded pair "), std::string::npos) << one;
  EXPECT_NE(one.find("at least 4 rows pushed aside to each of four sides; there are "), std::string::npos) << one;
  EXPECT_NE(refused(p, csv({0, 0, 0.02}, pushes(1))).find("there are 0, 0, 0 and 0 to"), std::string::npos);
}

TEST_F(Recordings, AloneChooseTheDegrees) {
  const Pipeline p = open(kFilled, csv({0, 0, 0.02}, pushed_aside(8)));
  const pipeline::FittedFile file = pipeline::fit_file(p, {}, pipeline::fit_settings(p));
  EXPECT_TRUE(file.fitted.scales.degrees.friction_families);
  EXPECT_GT(file.fitted.report.held_out.samples, 5U);
  EXPECT_LT(file.fitted.report.held_out.p95, 0.05);
  EXPECT_TRUE(file.fitted.report.recorded[0].outliers.empty());
}

// Springs alone would choose the degrees of a spring, which no tissue follows.
TEST_F(Recordings, HaveASayInTheDegreesBesideALaw) {
  const std::string springs = "[[analytic]]\nlaw = \"spring\"\nstiffness = 100\n[contact]\nfriction = 0.3\n";
  const Pipeline p = open(springs, csv({0, 0, 0.02}, pushed_aside(8)));
  const pipeline::FittedFile file = pipeline::fit_file(p, {}, pipeline::fit_settings(p));
  EXPECT_GT(file.fitted.report.analytic, 1U);
  EXPECT_GT(response::count(file.fitted.scales.degrees), response::count(response::kSpring));
  EXPECT_LT(file.fitted.report.recorded[0].rms, 0.05 * hertz(kDepth));
}

TEST_F(Recordings, TheOtherFaceOfAThinWallIsNotMeant) {
  Pipeline p = open("");
  const Eigen::Vector3d touched(0.001, 0.002, 0.02);
  const std::uint32_t expected = nearest_pair(p, touched);
  p.scene_sources.measured = {{folder_.write("wall.csv", csv(touched, pushes(1))), {}, 0.0}};
  const auto sources = [&] {
    return pipeline::find_sources(p.scene, p.scene_sources, p.body, p.tools, p.mesh, p.plan);
  };
  // As if the slab were a sheet: a site of its lower face right below.
  bake::PlanSite below = p.plan.sites[p.plan.pairs[expected].site];
  below.frame.origin = touched - Eigen::Vector3d(0, 0, 1e-4);
  below.frame.n = -below.frame.n;
  p.plan.sites.push_back(below);
  const fit::PairSources found = sources();
  ASSERT_EQ(found.external.size(), 1U);
  EXPECT_EQ(found.external.begin()->first, expected);
  for (bake::PlanSite& site : p.plan.sites) site.frame.n = {0, 0, -1};
  EXPECT_NE(message_of(sources).find("csv:3: no site of the body faces as"), std::string::npos);
}

TEST_F(Recordings, WhatIsPassedOverIsCounted) {
  std::vector<Row> rows = pushes(1);
  rows.push_back({{0, 0, 1e-4}, {0, 0, 0}});
  rows.push_back({{0, 0, 0}, {0, 0, 0}});
  rows.push_back({{0, 0, -1.1 * kDepth}, {0, 0, 1}});
  rows.push_back({{0.001, 0, -0.001}, {0, 0, 1}});
  const fit::FitReport report = pipeline::fit(open("[sources]\nrest = \"filled\"\n", csv({0, 0, 0.02}, rows)));
  ASSERT_EQ(report.recorded.size(), 1U);
  EXPECT_EQ(report.recorded[0].rows, 60U);
  EXPECT_EQ(fit::to_text(report.recorded[0].passed),
            "4 rows passed over: 2 not in contact, 1 deeper than sampling.depth, 1 too far aside");
}

}  // namespace
}  // namespace palpate::test
