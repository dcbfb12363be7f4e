// SPDX-License-Identifier: GPL-3.0-or-later
// One pair from mesh to samples: the ladder of refinements and contacts, and the order of the pushes.
#include "precompute/solve/pair/pair.hpp"

#include "formats/io/error.hpp"
#include "precompute/solve/contact/gates.hpp"
#include "precompute/solve/pair/contact_size.hpp"
#include "precompute/solve/pair/pair_run.hpp"
#include "precompute/solve/pair/sample_difference.hpp"
#include "precompute/solve/push/contact_method.hpp"

#include <cstdio>

namespace palpate {
namespace {

// Meshes are made of the body free of stress, also where it has a prestress.
const Body& stress_free(const Body& body) { return body.stress_free ? *body.stress_free : body; }

struct Attempt {
  PairResult result;
  std::vector<Sample> straight;  // of the push as far as it passed, whatever came after it
  double reached = 0.0;          // m, its depth
  bool contact_failed = false;   // see PairRun
  double lost = 0.0;             // see PairOptions
};

// `last`: no finer mesh is to come, and a sideways push keeps what it answered before it failed.
Attempt attempt(const Body& body, const Tool& tool, const ToolVertex& vertex, const ContactFrame& frame,
                const PairPath& path, const PairOptions& options, const TetMesh& mesh, bool last) {
  Attempt made;
  PairResult& result = made.result;
  result.outcome.nodes = static_cast<std::uint32_t>(mesh.nodes.size());
  try {
    Push push(stress_free(body), mesh, *tool.shape, touching_pose(vertex, frame),
              {body.material.young, normal_penalty(options.method, options.penalty), options.tolerance},
              options.materials);
    PairRun run{body, tool, vertex, frame, path, options, mesh, last, push, result};
    if (!push.held_anywhere()) {
      run.refuse("support: no node of the mesh is held");
    } else if (approach(run)) {
      const bool pushed = straight_push(run);
      made.straight = result.samples;
      if (!made.straight.empty()) made.reached = run.curve.back().depth;
      if (pushed && sticking_pushes(run) && grasped_pulls(run)) {
        slipping_pushes(run);
        side_paths(run);
        result.outcome.accepted = true;
      }
    }
    if (!result.outcome.accepted) result.samples.clear();
    made.contact_failed = run.contact_failed;
    result.outcome.factorisations = push.factorisations();
    made.lost = static_cast<double>(mesh.nodes.size()) * push.lost_factorisations();
  } catch (const Error& e) {
    result.samples.clear();
    result.outcome.cause = e.what();
  }
  return made;
}

// Elements of a check, in those checked.
constexpr double kFiner = 0.75;

// One way of solving a pair after another did not.
struct Rung {
  const char* name;  // what its cause stands after
  ContactMethod method;
  double penalty;  // factor of the option's
};
constexpr Rung kLastRungs[] = {{"stiffer contact", ContactMethod::penalty, 4.0},
                               {"augmented Lagrange", ContactMethod::augmented, 1.0},
                               {"log barrier", ContactMethod::barrier, 1.0}};

void add_cause(std::string& causes, const char* name, const std::string& cause) {
  if (!causes.empty()) causes += std::string("; ") + name + ": ";
  causes += cause;
}

// The straight push on a mesh finer than the one with `scale`.
PairCheck check_of(const PairResult& result, const Body& body, const Tool& tool, const ToolVertex& vertex,
                   const ContactFrame& frame, const PairPath& path, const PairOptions& options) {
  PairPath straight = path;
  straight.tangential_depths.clear();
  straight.side_paths.clear();
  straight.tangential_directions = straight.slip_points = 0;
  straight.grasp_depth = 0.0;
  PairOptions finer = finer_options(options, body, kFiner);
  finer.check = false;
  const PairResult fine = solve_pair(body, tool, vertex, frame, straight, finer);
  PairCheck check;
  check.nodes = fine.outcome.nodes;
  check.cause = fine.outcome.cause;
  if (!fine.outcome.accepted) return check;
  PairResult pushed = result;
  std::erase_if(pushed.samples, [](const Sample& s) { return s.kind != SampleKind::normal; });
  const SampleDifference d = sample_difference(pushed.samples, fine.samples);
  check.compared = static_cast<std::uint32_t>(d.compared);
  check.foretold = static_cast<std::uint32_t>(d.foretold);
  check.difference = d.straight;
  return check;
}

}  // namespace

PairResult solve_on_mesh(const Body& body, const Tool& tool, const ToolVertex& vertex, const ContactFrame& frame,
                         const PairPath& path, const PairOptions& options, const TetMesh& mesh) {
  return attempt(body, tool, vertex, frame, path, options, mesh, true).result;
}

PairResult solve_pair(const Body& body, const Tool& tool, const ToolVertex& vertex, const ContactFrame& frame,
                      const PairPath& path, const PairOptions& options, const SampleSink& sink) {
  PairResult result;
  std::string causes;
  PairResult straight;   // the deepest and last that passed of a pair that was not accepted
  double reached = 0.0;  // m, its depth
  bool contact_failed = false, no_deeper = false;
  double lost = 0.0;
  const auto lost_too_much = [&] { return lost > options.most_lost; };
  const auto solve = [&](const TetMesh& mesh, const PairOptions& with, double scale, bool last) {
    Attempt made = attempt(body, tool, vertex, frame, path, with, mesh, last);
    result = std::move(made.result);
    if (result.outcome.accepted) straight = {};  // a check may refuse all of it yet
    if (!result.outcome.accepted && !made.straight.empty()) {
      no_deeper = !straight.samples.empty() && made.reached <= reached;
      if (made.reached >= reached) {
        straight = {result.outcome, std::move(made.straight), {}};
        reached = made.reached;
      }
    }
    contact_failed = made.contact_failed;
    lost += made.lost;
    if (!result.outcome.accepted || !options.check) return;
    PairOptions here = with;
    here.refine *= scale;
    result.check = check_of(result, body, tool, vertex, frame, path, here);
    if (const auto failed = failed_check(*result.check, GateLimits{})) {
      result.outcome.accepted = false;
      result.outcome.cause = *failed;
      result.samples.clear();
    }
  };
  VolumeMeshResult mesh;
  for (const double scale : {1.0, 0.8, 0.6}) {
    const SizeField size =
        contact_size(body, tool, vertex, frame, path.normal_depths.back(), options.refine * scale, options);
    const Eigen::Vector3d site = body.material_point(frame.origin).point;
    mesh = mesh_volume(stress_free(body), size, {site}, options.mesh);
    result = {};
    contact_failed = false;
    if (mesh.usable) {
      solve(mesh.mesh, options, scale, scale == 0.6 || !straight.samples.empty());
    } else {
      result.outcome.cause = "mesh: " + mesh.cause;
    }
    if (result.outcome.accepted) break;
    add_cause(causes, "finer", result.outcome.cause);
    if (no_deeper || lost_too_much()) break;
  }
  for (const Rung& rung : kLastRungs) {
    if (no_deeper || !contact_failed || options.method != ContactMethod::penalty || lost_too_much()) break;
    PairOptions with = options;
    with.method = rung.method;
    with.penalty *= rung.penalty;
    solve(mesh.mesh, with, 0.6, true);
    if (!result.outcome.accepted) add_cause(causes, rung.name, result.outcome.cause);
  }
  if (!result.outcome.accepted) {
    if (lost_too_much()) {
      char text[80];
      std::snprintf(text, sizeof text, "%.3g nodes times factorisations without an equilibrium", lost);
      add_cause(causes, "given up", text);
    }
    if (!straight.samples.empty()) {
      result = std::move(straight);
      result.outcome.accepted = true;
      causes = "stopped short: " + causes;
    }
    result.outcome.cause = causes;
  }
  // Samples leave only with a pair that passed: a journal never holds points of an abandoned attempt.
  if (sink) {
    for (const Sample& s : result.samples) sink(s);
  }
  return result;
}

}  // namespace palpate
