// SPDX-License-Identifier: GPL-3.0-or-later
// palpate submit: bakes a scene on a Slurm cluster, as an array of shards and a job that merges and fits.
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "formats/io/error.hpp"
#include "formats/io/file.hpp"
#include "precompute/mesh/volume/child_process.hpp"
#include "tools/cli/blas.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/output.hpp"
#include "tools/pipeline/pipeline_steps.hpp"

namespace palpate::cli {
namespace {

namespace fs = std::filesystem;

struct SubmitArguments {
  std::string scene, work, output;
  std::uint32_t shards = 0;
  int cpus = 1;
  std::vector<std::string> sbatch;
  bool print = false;
};

/// A job: what sbatch is given on its command line and on its standard input.
struct Job {
  std::vector<std::string> options;
  std::string script;
};

/// One word of a shell.
std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

/// sbatch hands our environment to every node; its processors may be others.
std::string script_head() {
  const std::string names = variables_set_here();
  return names.empty() ? "#!/bin/sh\n" : "#!/bin/sh\nunset " + names + "\n";
}

/// "1-3,5": ascending numbers as sbatch takes them.
std::string ranges(const std::set<std::uint32_t>& numbers) {
  std::string text;
  for (auto at = numbers.begin(); at != numbers.end();) {
    const std::uint32_t first = *at;
    std::uint32_t last = first;
    while (++at != numbers.end() && *at == last + 1) ++last;
    text += (text.empty() ? "" : ",") + std::to_string(first) + (last > first ? "-" + std::to_string(last) : "");
  }
  return text;
}

/// "palpate COMMAND SCENE --work FOLDER" with paths that hold on every node.
std::string command_line(const pipeline::Pipeline& p, const SubmitArguments& options, const std::string& command) {
  return quoted(fs::read_symlink("/proc/self/exe").string()) + " " + command + " " +
         quoted(fs::absolute(options.scene).string()) + " --work " + quoted(fs::absolute(p.paths.work).string()) +
         " --quiet";
}

std::string log_file(const pipeline::Pipeline& p, const std::string& name) {
  return "--output=" + (fs::absolute(p.paths.shards) / name).string();
}

/// A killed worker is started again in its task, because Slurm requeues a task for a lost node only. Wrong usage, bad
/// input and a failed solve (codes 1 to 3) would end the same way again.
Job array_job(const pipeline::Pipeline& p, const SubmitArguments& options, const std::string& indices) {
  Job job;
  job.options = {
      "--job-name=palpate-bake", "--array=" + indices,        "--requeue",
      "--open-mode=append",      log_file(p, "shard-%a.log"), "--cpus-per-task=" + std::to_string(options.cpus)};
  job.options.insert(job.options.end(), options.sbatch.begin(), options.sbatch.end());
  job.script =
      script_head() + "for attempt in 1 2 3 4 5; do\n  " + command_line(p, options, "bake") +
      " --shard \"$SLURM_ARRAY_TASK_ID/" + std::to_string(options.shards) + "\" --threads " +
      std::to_string(options.cpus) +
      " && exit 0\n  code=$?\n  [ $code -ge 1 ] && [ $code -le 3 ] && exit $code\n  sleep 2\ndone\nexit $code\n";
  return job;
}

/// The last job: it runs whatever became of the shards, and says what is missing. With automatic sampling it submits
/// the next round, until none follows.
Job merge_job(const pipeline::Pipeline& p, const SubmitArguments& options, const std::string& array) {
  Job job;
  job.options = {"--job-name=palpate-merge", "--open-mode=append", log_file(p, "merge.log")};
  if (!array.empty()) job.options.push_back("--dependency=afterany:" + array);
  job.options.insert(job.options.end(), options.sbatch.begin(), options.sbatch.end());
  const bool round = p.automatic && !p.ended;
  job.script = script_head() + command_line(p, options, "merge") + " || exit $?\nexec " +
               command_line(p, options, round ? "submit" : "fit") + " --output " +
               quoted(fs::absolute(p.paths.response).string());
  if (round) {
    job.script += " --shards " + std::to_string(options.shards) + " --cpus " + std::to_string(options.cpus);
    for (const std::string& option : options.sbatch) job.script += " " + quoted("--sbatch=" + option);
  }
  job.script += "\n";
  return job;
}

/// Hands the job to sbatch; its number. Throws Error(io) with what sbatch says.
std::string hand_over(const Job& job) {
  mesh::ChildStart start;
  start.arguments = {"-c", "exec sbatch --parsable \"$@\"", "sbatch"};
  start.arguments.insert(start.arguments.end(), job.options.begin(), job.options.end());
  const mesh::ChildResult result = mesh::run_child("/bin/sh", {job.script.begin(), job.script.end()}, {}, start);
  if (!result.finished) {
    throw Error(ExitCode::io, "sbatch did not take the job (" + result.cause + "): " + result.messages);
  }
  const std::string number(result.output.begin(), result.output.end());
  return number.substr(0, number.find_first_of(";\n"));
}

std::string text(const Job& job) {
  std::string line = "sbatch";
  for (const std::string& option : job.options) line += " " + quoted(option);
  return line + " <<'END'\n" + job.script + "END\n";
}

void run_submit(const SubmitArguments& options, const Globals& globals) {
  pipeline::Pipeline p = pipeline::prepare(options.scene, {options.work, options.output});
  check_writable(p.paths.response);
  pipeline::plan(p);
  make_folder(p.paths.shards);
  pipeline::merge(p);  // an earlier array may have had another number of shards
  pipeline::resume(p);
  const pipeline::MergeReport merged = pipeline::merge(p);
  std::set<std::uint32_t> open;
  for (const std::uint32_t pair : merged.missing) open.insert(pair % options.shards + 1);
  if (options.print) {
    print((open.empty() ? "" : text(array_job(p, options, ranges(open)))) +
          text(merge_job(p, options, open.empty() ? "" : "ARRAY")));
    return;
  }
  const std::string array = open.empty() ? "" : hand_over(array_job(p, options, ranges(open)));
  const std::string merge = hand_over(merge_job(p, options, array));
  if (globals.json) {
    print_json({{"pairs_open", merged.missing.size()},
                {"pairs_planned", merged.bake.total + merged.missing.size()},
                {"shards", open},
                {"array_job", array},
                {"merge_job", merge},
                {"logs", p.paths.shards.string()},
                {"file", p.paths.response.string()}});
    return;
  }
  print(std::to_string(merged.missing.size()) + " of " + std::to_string(merged.bake.total + merged.missing.size()) +
        " pairs to solve" + (open.empty() ? "" : ", job " + array + ": " + std::to_string(open.size()) + " shards") +
        "; job " + merge + " merges and fits\nlogs: " + p.paths.shards.string() +
        "\nfile: " + p.paths.response.string() + "\n");
}

}  // namespace

void add_submit(CLI::App& app, Globals& globals) {
  auto options = std::make_shared<SubmitArguments>();
  Command command(app, "submit", "Bakes on a Slurm cluster: shards as a job array, then merge and fit; goes on, too");
  command.option("scene", options->scene, "Scene file, on a file system that all nodes share").required();
  command.option("--shards", options->shards, "Parts of the bake: tasks of the array")
      .required()
      .check(whole_in(1, bake::kMostShards));
  command.option("--cpus", options->cpus, "Processors, and threads, of a task")
      .check(whole_in(1, 1024))
      .shows_default();
  command.option("--sbatch", options->sbatch, "An option for sbatch, for every job (--sbatch=--partition=long)");
  command.option("--work", options->work, "Work folder (default: NAME.work beside the scene)");
  command.option("-o,--output", options->output, "Response file (default: NAME.palp beside the scene)");
  command.flag("--print", options->print, "Prints the jobs as shell commands and hands nothing over");
  command.runs([options, &globals] { run_submit(*options, globals); });
}

}  // namespace palpate::cli
