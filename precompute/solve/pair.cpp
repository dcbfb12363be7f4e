// SPDX-License-Identifier: GPL-3.0-or-later
// One pair from mesh to samples: the ladder of mesh refinements, and the order of the pushes.
#include "precompute/solve/pair.hpp"

#include "formats/error.hpp"
#include "precompute/solve/contact_size.hpp"
#include "precompute/solve/pair_run.hpp"

namespace palpate {
namespace {

// Meshes are made of the body free of stress, whatever it has to bear.
const Body& stress_free(const Body& body) { return body.stress_free ? *body.stress_free : body; }

// `last`: no finer mesh is to come, and a sideways push keeps what it answered before it failed.
PairResult attempt(const Body& body, const Tool& tool, const ToolVertex& vertex, const ContactFrame& frame,
                   const PairPath& path, const PairOptions& options, const TetMesh& mesh, bool last) {
  PairResult result;
  result.outcome.nodes = static_cast<std::uint32_t>(mesh.nodes.size());
  try {
    Push push(stress_free(body), mesh, *tool.shape, touching_pose(vertex, frame),
              {body.material.young, options.penalty, options.tolerance}, options.materials);
    PairRun run{body, tool, vertex, frame, path, options, mesh, last, push, result};
    if (!push.held_anywhere()) {
      run.refuse("support: no node of the mesh is held");
    } else if (approach(run) && straight_push(run) && sticking_pushes(run)) {
      slipping_pushes(run);
      side_paths(run);
      result.outcome.accepted = true;
    }
    result.outcome.factorisations = push.factorisations();
  } catch (const Error& e) {
    result.samples.clear();
    result.outcome.cause = e.what();
  }
  return result;
}

}  // namespace

PairResult solve_on_mesh(const Body& body, const Tool& tool, const ToolVertex& vertex, const ContactFrame& frame,
                         const PairPath& path, const PairOptions& options, const TetMesh& mesh) {
  return attempt(body, tool, vertex, frame, path, options, mesh, true);
}

PairResult solve_pair(const Body& body, const Tool& tool, const ToolVertex& vertex, const ContactFrame& frame,
                      const PairPath& path, const PairOptions& options, const SampleSink& sink) {
  PairResult result;
  std::string causes;
  for (const double scale : {1.0, 0.8, 0.6}) {
    const SizeField size =
        contact_size(body, tool, vertex, frame, path.normal_depths.back(), options.refine * scale, options);
    const Eigen::Vector3d site = body.material_point(frame.origin).point;
    const VolumeMeshResult mesh = mesh_volume(stress_free(body), size, {site}, options.mesh);
    result = {};
    if (mesh.usable) {
      result = attempt(body, tool, vertex, frame, path, options, mesh.mesh, scale == 0.6);
    } else {
      result.outcome.cause = "mesh: " + mesh.cause;
    }
    if (result.outcome.accepted) break;
    if (!causes.empty()) causes += "; finer: ";
    causes += result.outcome.cause;
  }
  if (!result.outcome.accepted) result.outcome.cause = causes;
  // Samples leave only with a pair that passed: a journal never holds points of an abandoned attempt.
  if (sink) {
    for (const Sample& s : result.samples) sink(s);
  }
  return result;
}

}  // namespace palpate
