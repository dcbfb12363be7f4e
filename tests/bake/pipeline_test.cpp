// SPDX-License-Identifier: GPL-3.0-or-later
// From a scene file to a response file with real contact solves: sections, threads, kill -9, changed scenes.
#include "precompute/pipeline/pipeline.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <fstream>
#include <random>

#include "formats/io/error.hpp"
#include "formats/io/file.hpp"
#include "palpate/contact/bonded_contact.hpp"
#include "palpate/format/open.hpp"
#include "tests/bake/kill_driver.hpp"
#include "tests/support/label_ball.hpp"
#include "tests/support/slab.hpp"

namespace palpate::test {
namespace {

using pipeline::Pipeline;

/// A slab of 60 x 60 x 20 mm whose middle is probed at a few sites, coarse enough to bake in about two seconds.
class SlabPipeline : public testing::Test {
protected:
  void SetUp() override {
    folder_ =
        std::filesystem::path(testing::TempDir()) / ("palpate_pipeline_" + std::to_string(::getpid()) + "_" +
                                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    std::ofstream(folder_ / "slab.off") << kSlabOff;
    write_scene(5000);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// Sites within `half` (m) of the middle, the more the wider.
  void write_scene(double young, const std::string& more = {}, double mesh_size = 0.7, double half = 0.011) const {
    std::ofstream(folder_ / "slab.toml") << "[body]\nsurface = \"slab.off\"\n[material]\nyoung = " << young << "\n"
                                         << R"([[support]]
half_space = {point = [0, 0, 0.0001], normal = [0, 0, 1]}
[[tool]]
shape = "sphere"
radius = 0.005
[sampling]
spacing = 0.012
depth = 0.002
normal_points = 4
within_box = {min = [)" << -half << ", " << -half
                                         << ", 0.019], max = [" << half << ", " << half << R"(, 0.021]}
[solver]
max_size = 0.03
growth = 1
check_share = 0
mesh_size = )" << mesh_size << "\n" << more;
  }

  [[nodiscard]] Pipeline open(const std::string& work) const {
    Pipeline p = pipeline::prepare(folder_ / "slab.toml", {folder_ / work, folder_ / (work + ".palp")});
    pipeline::plan(p);
    return p;
  }
  void bake(const std::string& work, unsigned threads) const {
    bake::BakeOptions options;
    options.threads = threads;
    const Pipeline p = open(work);
    pipeline::bake(p, options);
  }
  /// The pipeline of the scene as written, every pair accepted.
  [[nodiscard]] Pipeline baked() const {
    Pipeline p = open("work");
    bake::BakeOptions options;
    options.threads = 1;
    const bake::BakeReport report = pipeline::bake(p, options);
    EXPECT_EQ(report.refused.size(), 0U) << (report.refused.empty() ? "" : report.refused[0].cause);
    return p;
  }
  [[nodiscard]] std::vector<std::byte> file(const std::string& work) const {
    const Pipeline p = open(work);
    pipeline::fit(p);
    return read_bytes(p.paths.response);
  }

  std::filesystem::path folder_;
};

TEST_F(SlabPipeline, FrictionlessSlabLeavesOutWhatItDoesNotNeed) {
  const Pipeline p = open("work");
  EXPECT_GE(p.plan.pairs.size(), 3U);
  bake::BakeOptions options;
  options.threads = 1;
  const bake::BakeReport bake = pipeline::bake(p, options);
  EXPECT_EQ(bake.refused.size(), 0U) << (bake.refused.empty() ? "" : bake.refused[0].cause);
  EXPECT_GE(bake.normal_solves, 4 * p.plan.pairs.size());
  EXPECT_EQ(bake.tangential_solves, 0U);
  EXPECT_GT(pipeline::bake_seconds(p), 0.0);
  for (const auto& [pair, data] : read_journal(p.paths.journal, p.manifest).pairs) {
    EXPECT_EQ(data.outcome->tangential_solves, 0U);
    for (const Sample& s : data.samples) EXPECT_EQ(s.kind, SampleKind::normal);
  }
  const fit::FitReport fit = pipeline::fit(p);
  EXPECT_LT(fit.normal.p95, 0.02);
  const std::vector<std::byte> bytes = read_bytes(p.paths.response);
  ASSERT_GE(bytes.size(), sizeof(layout::FileHeader));
  layout::FileHeader header;
  std::memcpy(&header, bytes.data(), sizeof header);
  EXPECT_EQ(header.features & (layout::feature_friction | layout::feature_tool_patches), 0U);
}

// One tool that only presses and one that can hold on and turn: solved, fitted, stored and answered again.
TEST_F(SlabPipeline, AToolThatHoldsOnHasItsPullsAndTurnsInTheFile) {
  write_scene(5000, "[[tool]]\nname = \"forceps\"\nradius = 0.004\ngrasp_depth = 0.001\ngrasp_turn = 0.2\n", 0.55);
  const Pipeline p = baked();
  const fit::FitReport fit = pipeline::fit(p);
  EXPECT_TRUE(fit.grasp);
  EXPECT_GT(fit.grasped.samples, 10 * p.plan.pairs.size() / 2);
  EXPECT_LT(fit.grasped.median, 0.03);
  EXPECT_GE(fit.turned.samples, 12 * p.plan.pairs.size() / 2);
  EXPECT_LT(fit.turned.median, 0.03);
  EXPECT_LT(fit.turned.worst, 0.15);
  const std::vector<std::byte> bytes = read_bytes(p.paths.response);
  const runtime::OpenResult opened = runtime::View::open(bytes.data(), bytes.size());
  ASSERT_TRUE(opened) << opened.error;
  const JournalContent journal = read_journal(p.paths.journal, p.manifest);
  int pulls = 0, turns = 0;
  for (const auto& [pair, data] : journal.pairs) {
    const PairPlan& plan = p.plan.pairs[pair];
    const runtime::Location at =
        closest_point(opened.view, {plan.frame.origin.x(), plan.frame.origin.y(), plan.frame.origin.z()});
    const runtime::BondedResponse<true> response(opened.view, plan.tool, at.at, {});
    EXPECT_EQ(response.depth() > 0, plan.tool == 1);
    EXPECT_EQ(response.rotated() > 0, plan.tool == 1);
    double given = 0;
    for (const Sample& s : data.samples) {
      EXPECT_TRUE(s.kind == SampleKind::normal || plan.tool == 1);
      if (s.kind != SampleKind::grasped) continue;
      const Eigen::Vector3d d = plan.frame.to_world({s.deflection.x(), s.deflection.y(), -s.deflection.z()});
      const Eigen::Vector3d r = plan.frame.to_world(s.rotation);
      const runtime::BondedForce answer = response.at({d.x(), d.y(), d.z()}, {r.x(), r.y(), r.z()});
      if (r.norm() > 0) {
        const Eigen::Vector3d torque(answer.torque.x, answer.torque.y, answer.torque.z);
        EXPECT_LT((torque - plan.frame.to_world(s.torque)).norm(), 0.15 * s.torque.norm());
        given += s.torque.dot(s.rotation);
        ++turns;
      }
      if (s.deflection.z() > -0.001) continue;
      const runtime::Vec3& force = answer.force;
      EXPECT_LT((Eigen::Vector3d(force.x, force.y, force.z) - plan.frame.to_world(s.force)).norm(),
                0.1 * s.force.norm());
      EXPECT_LT(s.force.z(), 0);
      ++pulls;
    }
    EXPECT_LE(given, 0) << "turned to and fro it resists, whatever torque it has at rest";
  }
  EXPECT_GT(pulls, 0);
  EXPECT_GT(turns, 0);
}

// Delays are shares of a whole run as measured here, so that the kills hit real work on any machine; a run that was
// done before its kill begins anew.
TEST_F(SlabPipeline, KillsAndThreadsEndInTheSameFile) {
  write_scene(5000, "", 1.0);
  ASSERT_EQ(run_child([this] { bake("one", 1); }), ChildEnd::done);
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(run_child([this] { bake("two", 2); }), ChildEnd::done);
  const std::chrono::duration<double, std::micro> whole_run = std::chrono::steady_clock::now() - start;
  const std::vector<std::byte> whole = file("one");
  EXPECT_TRUE(file("two") == whole) << "two threads";

  std::mt19937 random(9);
  std::uniform_real_distribution<double> share(0.05, 0.7);
  constexpr int kKills = 5;  // tests/bake/faults.py has more
  int kills = 0;
  for (int attempt = 0; attempt < 30 && kills < kKills; ++attempt) {
    const std::chrono::microseconds delay(static_cast<long>(share(random) * whole_run.count()));
    const ChildEnd end = run_and_kill([this] { bake("killed", 2); }, delay);
    ASSERT_NE(end, ChildEnd::failed);
    if (end == ChildEnd::killed) {
      ++kills;
      continue;
    }
    EXPECT_TRUE(file("killed") == whole) << "after " << kills << " kills";
    std::filesystem::remove_all(folder_ / "killed");
  }
  EXPECT_EQ(kills, kKills);
  ASSERT_EQ(run_child([this] { bake("killed", 2); }), ChildEnd::done);
  EXPECT_TRUE(file("killed") == whole) << "after " << kills << " kills";
}

TEST_F(SlabPipeline, ASolvedPlanIsNotOverwritten) {
  {
    const Pipeline p = open("work");
    EXPECT_TRUE(std::filesystem::exists(p.paths.manifest));
    const std::string text = bake::manifest_text(p.plan);
    EXPECT_EQ(bake::parse_manifest(text, "manifest").pairs.size(), p.plan.pairs.size());
  }
  write_scene(6000);
  EXPECT_NO_THROW(open("work")) << "nothing was solved for the old plan yet";
  {
    const Pipeline p = open("work");
    Journal(p.paths.journal, p.manifest).append(0, Sample{});
  }
  write_scene(7000);
  try {
    static_cast<void>(open("work"));
    FAIL() << "the samples of the old plan would be orphaned";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    EXPECT_NE(std::string(error.what()).find("another plan"), std::string::npos);
  }
}

TEST_F(SlabPipeline, SamplesOfAnotherSolverAreNotTakenForThoseOfThisOne) {
  std::filesystem::path manifest;
  {
    const Pipeline p = open("work");
    Journal(p.paths.journal, p.manifest).append(0, Sample{});
    manifest = p.paths.manifest;
  }
  std::string text = read_file(manifest, "manifest", 1 << 24);
  const std::string now = "\"solver\": " + std::to_string(solve::kSolverRevision);
  ASSERT_NE(text.find(now), std::string::npos);
  text.replace(text.find(now), now.size(), "\"solver\": 1");
  write_file(manifest, text);
  try {
    static_cast<void>(open("work"));
    FAIL() << "the samples would be mixed with other ones";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    EXPECT_NE(std::string(error.what()).find("another solver (revision 1;"), std::string::npos) << error.what();
  }
}

// A solve depends on the content of the files, not on their names: a changed image or centreline is another plan.
TEST_F(SlabPipeline, AChangedLabelImageOrCentrelineIsAnotherPlan) {
  const Eigen::Vector3d centre(0, 0, 0.01);
  const auto image = [&](double radius, int label) {
    std::ofstream(folder_ / "lump.nrrd") << nrrd(label_ball(centre, radius, 0.001), label);
  };
  const auto curve = [&](double bow) {
    std::ofstream(folder_ / "muscle.csv") << "-0.05,0,0.01\n0," << bow << ",0.01\n0.05,0,0.01\n";
  };
  const std::string more =
      "[[region]]\nlabels = {image = \"lump.nrrd\", value = 2}\nlaw = \"holzapfel-ogden\"\n"
      "young = 20000\nk1 = 5000\nk2 = 1\nfibre = {centreline = \"muscle.csv\"}\n";
  image(0.005, 2);
  curve(0);
  write_scene(5000, more);
  {
    const Pipeline p = open("work");
    ASSERT_EQ(p.body.inclusions.size(), 1U);
    ASSERT_NE(p.body.inclusions[0].fibres, nullptr);
    Journal(p.paths.journal, p.manifest).append(0, Sample{});
    Pipeline other = pipeline::prepare(folder_ / "." / "slab.toml", {folder_ / "other", {}});
    pipeline::plan(other);
    EXPECT_EQ(to_hex(other.manifest), to_hex(p.manifest)) << "by another path to the same files";
  }
  const auto refused = [&] {
    try {
      static_cast<void>(open("work"));
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("taken up");
  };
  image(0.0055, 2);
  EXPECT_NE(refused().find("another plan"), std::string::npos) << refused();
  image(0.005, 3);
  EXPECT_NE(refused().find("lump.nrrd: no voxel has the label 2"), std::string::npos) << refused();
  image(0.005, 2);
  EXPECT_NO_THROW(open("work"));
  curve(0.002);
  EXPECT_NE(refused().find("another plan"), std::string::npos) << refused();
  std::filesystem::remove(folder_ / "muscle.csv");
  EXPECT_NE(refused().find("muscle.csv"), std::string::npos) << refused();
}

// A bake is hours: what only the fit reads must not throw it away.
TEST_F(SlabPipeline, ANewFitTakesUpTheOldSolves) {
  {
    const Pipeline p = open("work");
    Journal(p.paths.journal, p.manifest).append(0, Sample{});
  }
  write_scene(5000, "[response]\nsearch = \"bvh\"\ntolerance = 0.01\n");
  EXPECT_NO_THROW(open("work"));
}

// Rays and paths are solved, degrees chosen, coefficients written and read again.
TEST_F(SlabPipeline, ASceneWithFrictionIsBakedAndFitted) {
  write_scene(5000, "[contact]\nfriction = 0.3\n[response]\npath_share = 1\ntolerance = 0.015\n",
              0.6, 0.009);
  const Pipeline p = baked();
  const fit::FitReport fit = pipeline::fit(p);
  EXPECT_LT(fit.normal.p95, 0.025);
  EXPECT_LT(fit.tangential.p95, 0.025);  // so coarse elements scatter by as much
  EXPECT_LT(fit.held_out.p95, 0.025);
  EXPECT_GE(fit.paths.samples, 10 * p.plan.pairs.size());
  EXPECT_LT(fit.paths.worst, 0.1);
  const std::vector<std::byte> bytes = read_bytes(p.paths.response);
  const runtime::OpenResult opened = runtime::View::open(bytes.data(), bytes.size());
  ASSERT_TRUE(opened) << opened.error;
  EXPECT_TRUE(opened.view.has(layout::feature_friction));
  EXPECT_LE(opened.view.response_size, 80U);
  for (const auto& [pair, solved] : pipeline::samples(p).pairs) {
    const auto tangential = std::count_if(solved.samples.begin(), solved.samples.end(),
                                          [](const Sample& s) { return s.kind == SampleKind::tangential; });
    EXPECT_LE(tangential, 36) << pair;
  }
}

// A folder whose manifest has the text of an earlier program keeps its samples.
TEST_F(SlabPipeline, AFolderOfAnEarlierProgramIsFittedAgain) {
  const auto write = [&](const std::string& sampling) {
    write_scene(5000, "[contact]\nfriction = 0.3\n");
    std::string text = read_file(folder_ / "slab.toml", "scene", 10000);
    text.insert(text.find("normal_points"), sampling);
    std::ofstream(folder_ / "slab.toml") << text;
  };
  write("tangential_depths = 2\n");
  const Pipeline before = baked();
  const Hash128 manifest = before.manifest;
  write("");
  const Pipeline after = open("work");
  EXPECT_EQ(after.manifest, manifest);
  EXPECT_GT(pipeline::fit(after).accepted, 0U);
}

TEST_F(SlabPipeline, AFitWithoutABakeSaysSo) {
  try {
    pipeline::fit(open("work"));
    FAIL() << "there is no journal";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::io);
    EXPECT_NE(std::string(error.what()).find("palpate bake"), std::string::npos);
  }
}

}  // namespace
}  // namespace palpate::test
