// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/verify/ccx/ccx_compare.hpp"

#include "formats/io/error.hpp"
#include "precompute/solve/pair/contact_size.hpp"
#include "precompute/solve/pair/sample_difference.hpp"
#include "precompute/solve/push/push.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::verify {
namespace {

double processor_time(int who) {
  rusage used{};
  getrusage(who, &used);
  const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

solve::PairOptions pair_options(const CcxMesh& mesh, const CcxCase& c, const CcxSettings& settings) {
  solve::PairOptions options;
  options.mesh_size = settings.mesh_size;
  // So that with contact_size's factor the whole of the size field is this many times as large.
  const double factor = c.base * mesh.size;
  options.growth = settings.growth * factor;
  options.max_size = c.body.diagonal / 8 * std::sqrt(factor);
  options.penalty = settings.penalty;
  return options;
}

}  // namespace

CcxMesh ccx_mesh(const CcxCase& c, double size, const CcxSettings& settings, bool quarter) {
  CcxMesh mesh;
  mesh.size = size;
  mesh.quarter = quarter;
  const double before = processor_time(RUSAGE_THREAD) + processor_time(RUSAGE_CHILDREN);
  const solve::PairOptions options = pair_options(mesh, c, settings);
  // The quarter takes the sizes of the whole.
  const mesh::SizeField sizes = solve::contact_size({c.body, c.tool, c.tool.vertices.at(0), ContactFrame{}},
                                                    c.depths.back(), c.base * size, options);
  mesh::VolumeMeshResult made =
      mesh::mesh_volume(quarter ? c.quarter : c.body, sizes, {ContactFrame{}.origin}, options.mesh);
  if (!made.usable) throw Error(ExitCode::numerical, c.name + ": mesh: " + made.cause);
  mesh.mesh = std::move(made.mesh);
  mesh.seconds = processor_time(RUSAGE_THREAD) + processor_time(RUSAGE_CHILDREN) - before;
  return mesh;
}

CcxSolve solve_ours(const CcxCase& c, const CcxMesh& mesh, bool plain, const CcxSettings& settings) {
  solve::PairPath path;
  path.normal_depths = c.depths;
  solve::PairOptions options = pair_options(mesh, c, settings);
  options.materials = {plain ? c.material.plain() : c.material};
  CcxSolve solve;
  solve.size = mesh.size;
  solve.nodes = mesh.mesh.nodes.size();
  const double before = processor_time(RUSAGE_THREAD);
  const PairResult result =
      solve::solve_on_mesh({c.body, c.tool, c.tool.vertices.at(0), ContactFrame{}}, path, options, mesh.mesh);
  solve.seconds = processor_time(RUSAGE_THREAD) - before;
  if (!result.outcome.accepted) {
    solve.cause = result.outcome.cause;
  } else if (result.samples.size() != c.depths.size() || c.depths.size() < 2) {
    solve.cause = std::to_string(result.samples.size()) + " of " + std::to_string(c.depths.size()) + " depths resolved";
  } else {
    for (std::size_t k = 0; k < c.depths.size(); ++k) {
      solve.forces.push_back(solve::force_at(result.samples[k], result.samples[k > 0 ? k - 1 : 1], c.depths[k]).z());
    }
  }
  return solve;
}

CcxSolve solve_ccx(const std::filesystem::path& ccx, const CcxCase& c, const CcxMesh& mesh,
                   const CcxSettings& settings) {
  const double radius = c.tool.scene.radius;
  const ContactFrame frame;
  std::vector<char> held = solve::fixed_nodes(c.body, mesh.mesh);
  for (std::size_t n = 0; n < held.size(); ++n) {
    held[n] = held[n] != 0 ? 7 : 0;
    for (int k = 0; k < 2 && mesh.quarter; ++k) {
      if (std::abs(mesh.mesh.nodes[n][k]) < 1e-9 * c.body.diagonal) held[n] |= static_cast<char>(1 << k);
    }
  }
  const ToolFacets facets = tool_facets(c.tool, settings.facets * radius);
  CcxContact contact;
  contact.stiffness =
      settings.stiffness * c.body.material.young / tool::contact_radius(c.tool.vertices.at(0), c.depths.back());
  contact.increments = settings.increments;
  contact.reach = 1.3 * radius;
  const std::string deck = ccx_deck(
      {mesh.mesh, held, c.law, facets, tool::touching_pose(c.tool.vertices.at(0), frame), frame, c.depths, contact});
  const CcxResult result = run_ccx(ccx, deck, c.depths.size(), settings.limits);
  CcxSolve solve;
  solve.size = mesh.size;
  solve.nodes = mesh.mesh.nodes.size();
  solve.seconds = result.seconds;
  solve.cause = result.cause;
  for (const Eigen::Vector3d& f : result.forces) solve.forces.push_back((mesh.quarter ? 4 : 1) * f.dot(frame.n));
  return solve;
}

double largest_difference(const CcxSolve& a, const CcxSolve& reference) {
  if (a.forces.empty() || a.forces.size() != reference.forces.size()) return std::numeric_limits<double>::quiet_NaN();
  double largest = 0;
  for (std::size_t k = 0; k < a.forces.size(); ++k) {
    const double difference = std::abs(a.forces[k] / reference.forces[k] - 1);
    if (std::isnan(difference)) return difference;
    largest = std::max(largest, difference);
  }
  return largest;
}

}  // namespace palpate::verify
