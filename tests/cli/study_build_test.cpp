// SPDX-License-Identifier: GPL-3.0-or-later
// A segmentation as hospitals have it: proposed, baked and verified by the command line, without editing.
#include "tests/cli/palpate_program.hpp"
#include "tests/image/label_files.hpp"

#include <nlohmann/json.hpp>

namespace palpate::test {
namespace {

class StudyBuild : public PalpateProgram {};

TEST_F(StudyBuild, OrganTumourAndVesselAreBakedAndVerifiedAsProposed) {
  constexpr double kHours = 3 * 3600;
  write("study.nii.gz", nifti(Study::voxels(), true));
  const RunResult proposed = run({"scene", "--from", "study.nii.gz", "--out", "study.toml"});
  ASSERT_EQ(proposed.exit_code, 0) << proposed.error;
  // 5: the interpolation between sites misses the tolerance, and says so.
  const RunResult built = run({"build", "study.toml", "--json"}, {.time_limit = kHours});
  ASSERT_TRUE(built.exit_code == 0 || built.exit_code == 5) << built.exit_code << ": " << built.error;
  const auto bake = nlohmann::json::parse(built.out).at("bake");
  EXPECT_GT(bake.at("pairs_accepted"), 0.97 * bake.at("pairs_planned").get<double>()) << bake;
  const RunResult verified = run({"verify", "study.toml", "--count", "20", "--json"}, {.time_limit = kHours});
  ASSERT_TRUE(verified.exit_code == 0 || verified.exit_code == 5) << verified.exit_code << ": " << verified.error;
  const auto report = nlohmann::json::parse(verified.out);
  EXPECT_GT(report.at("contacts").at("solved"), 17);
  std::cout << bake.at("pairs_accepted") << " of " << bake.at("pairs_planned") << " pairs, " << bake.at("bake_seconds")
            << " s; " << report.at("contacts").at("solved") << " contacts solved, error of normal forces: median "
            << report.at("error").at("median") << ", p95 " << report.at("error").at("p95") << "\n";
}

}  // namespace
}  // namespace palpate::test
