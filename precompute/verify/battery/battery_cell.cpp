// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/verify/battery/battery_cell.hpp"

#include "formats/io/error.hpp"
#include "precompute/common/processor_time.hpp"

#include <malloc.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <fstream>
#include <new>

namespace palpate::verify {
namespace {

// TetGen's processor time (s), of all threads' children that ended.
double children_seconds() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  const auto seconds = [](const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * double(t.tv_usec); };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// Peak memory of the process since construction. Linux alone forgets an earlier peak; elsewhere it counts.
class PeakMemory {
public:
  PeakMemory() {
    malloc_trim(0);
    std::ofstream("/proc/self/clear_refs") << 5;
  }
  [[nodiscard]] double megabytes() const {
    std::ifstream status("/proc/self/status");
    std::string key;
    double kilobytes = 0;
    while (status >> key) {
      if (key == "VmHWM:") status >> kilobytes;
    }
    return kilobytes / 1024;
  }
};

bool finite(const std::vector<Sample>& samples) {
  return std::all_of(samples.begin(), samples.end(),
                     [](const Sample& s) { return s.force.allFinite() && s.deflection.allFinite(); });
}

PairResult solve(const BatteryCell& cell, const CellChange& change) {
  const Body body = prepare_body(cell.scene, cell.surface);
  const tool::Tool tool = tool::make_tool(cell.scene.tools.at(0));
  ContactFrame frame;
  frame.origin = body.query->closest(cell.site).point;
  frame.n = cell.normal;
  frame.x = frame.n.unitOrthogonal();
  frame.y = frame.n.cross(frame.x);
  solve::PairOptions options = solve::pair_options(cell.scene);
  solve::PairPath path = solve::bake_path(cell.scene, cell.depth);
  if (change) change(options, path, body);
  return solve::solve_pair({body, tool, tool.vertices.at(0), frame}, path, options);
}

}  // namespace

CellSolve solve_cell(const BatteryCell& cell, const CellChange& change) {
  CellSolve result;
  const PeakMemory peak;
  const auto start = std::chrono::steady_clock::now();
  const double thread = thread_seconds(), children = children_seconds();
  try {
    PairResult solved = solve(cell, change);
    result.nodes = solved.outcome.nodes;
    result.cause = solved.outcome.cause;
    result.accepted = solved.outcome.accepted && finite(solved.samples);
    if (result.accepted) {
      result.samples = std::move(solved.samples);
    } else if (solved.outcome.accepted) {
      result.cause = "a force or a deflection is not finite";
    }
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const Error& error) {
    // A refusal is a result; a missing worker is the machine's fault.
    if (error.code() == ExitCode::io) throw;
    result.cause = error.what();
  } catch (const std::exception& error) {
    result.cause = error.what();
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  result.processor = thread_seconds() - thread + children_seconds() - children;
  result.megabytes = peak.megabytes();
  return result;
}

}  // namespace palpate::verify
