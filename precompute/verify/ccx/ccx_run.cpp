// SPDX-License-Identifier: GPL-3.0-or-later
// A temporary folder, the child process, and the checks of its output.
#include "precompute/verify/ccx/ccx_run.hpp"

#include "formats/io/error.hpp"
#include "precompute/mesh/volume/child_process.hpp"
#include "precompute/verify/ccx/ccx_dat.hpp"
#include "precompute/verify/ccx/ccx_deck.hpp"

#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string_view>
#include <system_error>

namespace palpate::verify {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr double kNewtons = 1e-3;    // a millinewton, the deck's force
constexpr double kBalanced = 0.005;  // of the force: the held nodes take what the tool gives

class Folder {
public:
  Folder() {
    std::string pattern = (fs::temp_directory_path() / "palpate-ccx-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) {
      throw Error(ExitCode::io, pattern + ": cannot be created: " + std::generic_category().message(errno));
    }
    path = pattern;
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  fs::path path;
};

std::string content(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return std::move(text).str();
}

// The last complaint on its standard output, and the line after it: ccx breaks its messages.
std::string complaint(const std::vector<char>& output) {
  const std::string_view text(output.data(), output.size());
  const std::size_t at = text.rfind("*ERROR");
  if (at == std::string_view::npos) return {};
  std::istringstream words{std::string(text.substr(at, 300))};
  std::string line, all;
  for (int k = 0; k < 2 && std::getline(words, line); ++k) {
    const std::size_t start = line.find_first_not_of(' ');
    if (start == std::string::npos) break;
    if (!all.empty()) all += ' ';
    all += line.substr(start);
  }
  return all;
}

// Columns of the .sta file: step, increment, attempt, iterations, times.
int iterations(const std::string& sta) {
  std::istringstream lines(sta);
  int sum = 0;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream in(line);
    int step = 0, increment = 0, count = 0;
    std::string attempt;
    if (in >> step >> increment >> attempt >> count) sum += count;
  }
  return sum;
}

std::string forces(const std::string& dat, std::size_t steps, CcxResult& result) {
  std::vector<Vector3d> tool(steps, Vector3d::Zero()), held = tool;
  std::vector<int> seen(steps, 0);
  for (const CcxTotal& total : read_ccx_totals(dat)) {
    const double step = std::round(total.time) - 1;
    if (std::abs(total.time - 1 - step) > 1e-4 || step < 0 || step >= double(steps)) continue;
    const auto k = static_cast<std::size_t>(step);
    (total.set == kCcxTool ? tool : held)[k] = kNewtons * total.force;
    ++seen[k];
  }
  for (std::size_t k = 0; k < steps; ++k) {
    const std::string where = " after step " + std::to_string(k + 1);
    if (seen[k] != 2) return "no forces" + where + " in its .dat file";
    if (!((tool[k] + held[k]).norm() < kBalanced * tool[k].norm())) {
      return "tool and support do not balance" + where + ": off by " +
             std::to_string(100 * (tool[k] + held[k]).norm() / tool[k].norm()) + " % of the force";
    }
    result.forces.emplace_back(-tool[k]);
  }
  return {};
}

}  // namespace

fs::path find_ccx() {
  const char* path = ::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path at = fs::path(folder) / "ccx";
    std::error_code ignored;
    if (fs::is_regular_file(at, ignored) && ::access(at.c_str(), X_OK) == 0) return at;
  }
  return {};
}

CcxResult run_ccx(const fs::path& ccx, const std::string& deck, std::size_t steps, const CcxLimits& limits) {
  const Folder folder;
  std::ofstream file(folder.path / "push.inp", std::ios::binary);
  file << deck;
  file.close();
  if (!file) throw Error(ExitCode::io, (folder.path / "push.inp").string() + ": cannot be written");

  mesh::ChildLimits child_limits;
  child_limits.cpu_time = limits.cpu_time;
  child_limits.memory = limits.memory;
  mesh::ChildStart start;
  start.arguments = {"-i", "push"};
  start.folder = folder.path;
  start.environment = {"OMP_NUM_THREADS=1", "CCX_NPROC_RESULTS=1", "CCX_NPROC_EQUATION_SOLVER=1"};
  const mesh::ChildResult child = mesh::run_child(fs::absolute(ccx), {}, child_limits, start);

  CcxResult result;
  result.seconds = child.cpu_time;
  result.iterations = iterations(content(folder.path / "push.sta"));
  const std::string said = complaint(child.output);
  if (!child.finished) {
    result.cause = child.cause;
  } else {
    try {
      result.cause = forces(content(folder.path / "push.dat"), steps, result);
    } catch (const Error& error) {
      result.cause = error.what();
    }
  }
  if (!result.cause.empty() && !said.empty()) result.cause.append(": ").append(said);
  result.usable = result.cause.empty();
  if (!result.usable) {
    result.cause.insert(0, "CalculiX: ");
    result.forces.clear();
  }
  return result;
}

}  // namespace palpate::verify
