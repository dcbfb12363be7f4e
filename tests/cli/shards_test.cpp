// SPDX-License-Identifier: GPL-3.0-or-later
// Shards by the command line: they end in the file of one process, what is missing is said, and submit makes the jobs.
#include "tests/cli/palpate_program.hpp"

#include <fstream>
#include <nlohmann/json.hpp>

namespace palpate::test {
namespace {

using Arguments = std::vector<std::string>;

class ShardCommands : public PalpateProgram {
protected:
  void SetUp() override {
    ASSERT_EQ(run({"synth", "slab", "--out", ".", "--scale", "0.5", "--friction", "0", "--tool-radius", "0.003",
                   "--depth", "0.001", "--spacing", "0.02"})
                  .exit_code,
              0);
    std::ofstream(folder() / "scene.toml", std::ios::app)
        << "normal_points = 4\n[solver]\nmesh_size = 1\ngrowth = 1\nmax_size = 0.025\n";
  }
  RunResult done(Arguments arguments, RunOptions options = {}) const {
    arguments.insert(arguments.end(), {"--quiet", "--json"});
    const RunResult result = run(arguments, options);
    EXPECT_EQ(result.exit_code, 0) << arguments[0] << ": " << result.error;
    return result;
  }
  [[nodiscard]] std::string whole() const {
    done({"build", "scene.toml", "--work", "one", "-o", "one.palp"});
    return file_content(folder() / "one.palp");
  }
};

TEST_F(ShardCommands, EndInTheFileOfOneProcess) {
  done({"bake", "scene.toml", "--shard", "2/2", "--threads", "1"});
  const RunResult early = run({"merge", "scene.toml", "--json"});
  EXPECT_EQ(early.exit_code, 4);
  const auto missing = nlohmann::json::parse(early.out).at("missing");
  ASSERT_FALSE(missing.empty());
  for (const auto& pair : missing) EXPECT_EQ(pair.get<int>() % 2, 0);
  for (const char* part : {"samples.journal", "are missing: pair 0 (site ", "run the shards again"}) {
    EXPECT_NE(early.error.find(part), std::string::npos) << early.error;
  }
  expect_failure(run({"fit", "scene.toml"}), 2, {"have no outcome yet"});
  // The rest in parts of another size: what is merged is not solved again.
  std::size_t solved = 0;
  for (const char* shard : {"1/3", "2/3", "3/3"}) {
    solved += nlohmann::json::parse(done({"bake", "scene.toml", "--shard", shard}).out)
                  .at("pairs_planned")
                  .get<std::size_t>();
  }
  EXPECT_EQ(solved, missing.size());
  const auto merged = nlohmann::json::parse(done({"merge", "scene.toml"}).out);
  EXPECT_EQ(merged.at("pairs_accepted"), merged.at("pairs_planned"));
  EXPECT_GT(merged.at("bake_seconds"), 0);
  done({"fit", "scene.toml", "-o", "shards.palp"});
  EXPECT_TRUE(file_content(folder() / "shards.palp") == whole());
}

// A sbatch that runs what it is handed at once, one task after the other.
TEST_F(ShardCommands, SubmittedJobsEndInTheFileOfOneProcess) {
  std::filesystem::create_directory(folder() / "bin");
  write("bin/sbatch", R"(#!/bin/sh
cat > job.sh; tasks=1
for option; do
  case $option in --array=*) tasks=${option#--array=};; esac
  echo "$option" >> options
done
echo "$(wc -l < options);cluster"
exec > job.log 2>&1
for task in $(echo $tasks | tr , ' ' | sed 's/1-3/1 2 3/'); do SLURM_ARRAY_TASK_ID=$task sh job.sh; done
)");
  std::filesystem::permissions(folder() / "bin/sbatch", std::filesystem::perms::owner_all);
  const RunOptions path{.environment = {"PATH=" + (folder() / "bin").string() + ":" + std::getenv("PATH")}};
  const Arguments submit{"submit", "scene.toml", "--shards", "3", "--sbatch=--partition=long", "-o", "it's.palp"};
  const auto first = nlohmann::json::parse(done(submit, path).out);
  EXPECT_EQ(first.at("shards"), nlohmann::json::array({1, 2, 3})) << first;
  const std::string options = file_content(folder() / "options");
  for (const char* option :
       {"--array=1-3\n", "--requeue\n", "--cpus-per-task=1\n", "--partition=long\n", "--dependency=afterany:"}) {
    EXPECT_NE(options.find(option), std::string::npos) << options;
  }
  EXPECT_EQ(options.find("cluster"), std::string::npos) << "a job's number ends before the cluster's name";
  EXPECT_TRUE(file_content(folder() / "it's.palp") == whole()) << file_content(folder() / "job.log");
  const auto again = nlohmann::json::parse(done(submit, path).out);
  EXPECT_EQ(again.at("pairs_open"), 0);
  EXPECT_TRUE(again.at("shards").empty());
}

TEST_F(ShardCommands, WhatCannotBeIsSaid) {
  for (const char* shard : {"0/4", "5/4", "1", "a/b"}) {
    expect_failure(run({"bake", "scene.toml", "--shard", shard}), 1, {std::string("'") + shard, "allowed I/N"});
  }
  expect_failure(run({"submit", "scene.toml", "--shards", "2"}, {.environment = {"PATH=/nowhere"}}), 4,
                 {"sbatch", "not found"});
  const RunResult printed =
      run({"submit", "scene.toml", "--shards", "2", "--print"},
          {.environment = {"PATH=/nowhere", "PALPATE_BLAS_CHOSEN=OPENBLAS_CORETYPE PALPATE_BLAS_CHOSEN"}});
  EXPECT_EQ(printed.exit_code, 0) << printed.error;
  for (const char* part :
       {"unset OPENBLAS_CORETYPE PALPATE_BLAS_CHOSEN\n", "sbatch '--job-name=palpate-bake' '--array=1-2'",
        "--shard \"$SLURM_ARRAY_TASK_ID/2\"", "'--dependency=afterany:ARRAY'"}) {
    EXPECT_NE(printed.out.find(part), std::string::npos) << printed.out;
  }
  write("scene.work/shards/1-of-2.journal", "no journal");
  expect_failure(run({"merge", "scene.toml"}), 2, {"1-of-2.journal", "is not a Palpate journal"});
}

}  // namespace
}  // namespace palpate::test
