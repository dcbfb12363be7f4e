// SPDX-License-Identifier: GPL-3.0-or-later
// Solves one pair: mesh, normal curve, tangential pushes, gates. The only entry point to contact solves:
// bake, verify and the closed-form tests all come through here.
#pragma once

#include "formats/journal/samples.hpp"
#include "precompute/common/body.hpp"
#include "precompute/fem/materials/material.hpp"
#include "precompute/mesh/volume/volume_mesh.hpp"
#include "precompute/solve/pair/contact_case.hpp"
#include "precompute/solve/push/contact_method.hpp"
#include "precompute/tool/tool.hpp"

#include <functional>
#include <limits>
#include <vector>

namespace palpate::solve {

/// A way of the tool that sticks and goes deeper or less deep while it is held at a tangential deflection. It starts at
/// a normal indentation.
struct SidePath {
  struct Point {
    double tangential = 0.0, depth = 0.0;  ///< m
  };
  double from = 0.0;          ///< m, depth of the normal indentation: the first accepted one from there on
  double angle = 0.0;         ///< rad, of the tangential direction from +x
  std::vector<Point> points;  ///< solved one after the other, at most kPathStride - 1
};
inline constexpr int kPathStride = 8;

/// The solves at a pair. Depths in m along -n from first touch, increasing.
struct PairPath {
  std::vector<double> normal_depths;
  std::vector<double>
      tangential_depths;           ///< at most the last normal depth; each takes the first accepted one from there on
  int tangential_directions = 0;   ///< evenly spaced; 0: no tangential pushes
  double tangential_start = 0.0;   ///< rad, of the first direction from +x
  int tangential_points = 3;       ///< per push
  double tangential_reach = 0.4;   ///< largest tangential deflection over the depth of the push
  double friction = 0.0;           ///< Coulomb coefficient; > 0: the push is solved sticking
  bool form_frictionless = false;  ///< push frictionless, then stick (Mindlin's conditions)
  int slip_points = 0;             ///< of further pushes from the same depths, in which the contact slips where
                                   ///< Coulomb's law lets it: samples of kind slipping. One that fails ends short and
                                   ///< refuses nothing. 0: none
  int slip_directions = 0;         ///< of those, evenly spaced; 0: as of the tangential ones
  double slip_reach = 0.0;         ///< their largest tangential deflection over the depth (see gross_slip_reach)
  std::vector<SidePath> side_paths{};  ///< samples of kind path, first its start on the normal curve; number k's
                                       ///< indices from k kPathStride on. One that fails ends short and refuses nothing
  double grasp_depth = 0.0;  ///< m; > 0: the contact of the first accepted normal depth from there on is bonded, and
                             ///< what follows are samples of kind grasped, at least at three depths; what fails beyond
                             ///< ends short and refuses nothing
  std::vector<double> grasp_depths;  ///< m, of either sign: the bonded tool is moved to each, out or further in
  int grasp_directions = 0;  ///< evenly spaced; tangential moves from the deepest push, depth 0 and the furthest pull
  int grasp_points = 2;      ///< per tangential move
  double grasp_reach = 0.0;  ///< m, of a tangential move
  std::vector<Eigen::Vector3d> grasp_turns;  ///< rad, axis times angle in (x, y, n), angle in (0, 1]: the bonded tool
                                             ///< is turned so, the point by which it touched resting, from where the
                                             ///< tangential moves begin
};

/// The path the bake uses for a pair of this scene: depths evenly spaced in sqrt(depth).
PairPath bake_path(const Scene& scene, double depth);

/// The path of a pair of role normal: the indentation alone, at the same depths, because a contact that sticks where it
/// lands shears more the more steps a push has.
PairPath normal_path(const Scene& scene, double depth);

/// Adds the grasp of a tool that holds on: its grasp depth (all of `depth` where that is less) among the normal ones,
/// its bonded contact evenly from as far out as `depth` is deep to the bottom; turned about x, y and n, both ways, by
/// the tool's angle.
void add_grasp(PairPath& path, const Scene& scene, const ToolScene& tool, double depth);

/// Paths that only test: diagonal, side then deeper, lift under side load, within `path`'s depths and reach.
std::vector<SidePath> test_paths(const PairPath& path, double angle);

struct PairOptions {
  double refine = 1.0;      ///< factor of every element size, the tools' edges and the supports' rim included
  double mesh_size = 0.35;  ///< see SolverScene
  double growth = 0.65;
  double max_size = 0.0;  ///< m; 0: see longest_edge (contact_size.hpp)
  double rim_size = 0.0;  ///< element edge at the rim of the deepest contact, in contact radii; 0: no ring of its own.
                          ///< The traction of a contact that is sheared after it stuck is singular there
  ContactMethod method = ContactMethod::penalty;
  double penalty = 300.0;   ///< contact penalty in units of E / a (a the current contact radius)
  double tolerance = 1e-3;  ///< a step has converged when its energy error is below its square times E a d^2
  double time_limit = std::numeric_limits<double>::infinity();    ///< s of processor time, over all stages and attempts
  double memory_limit = std::numeric_limits<double>::infinity();  ///< bytes of a factor
  /// Nodes times factorisations, of steps that found no equilibrium: a pair that lost more is given up after the
  /// attempt that it is at. A punch 5 mm deep at nu 0.4999 lost 4.1 million on three meshes, in seven minutes of a
  /// processor; the three further ways of solving it took another six, and failed as well.
  double most_lost = 3.5e6;
  /// Also solve the normal indentation on a finer mesh (finer_options); far from it is a gate that fails.
  bool check = false;
  /// Also push on a coarser mesh: the samples' error estimates hold what the mesh leaves, and a pair that is too far
  /// off is solved on a finer one. pair_options() sets it.
  bool mesh_errors = false;
  mesh::VolumeMeshOptions mesh;
  std::vector<fem::Material> materials;  ///< per region, for comparisons; empty: the body's
  /// Called with the mesh, the node positions (m) and the depth (m) of every accepted state of a normal indentation; a
  /// pair that is tried again begins anew. Changes nothing.
  std::function<void(const mesh::TetMesh&, const Eigen::VectorXd&, double)> watch;
};

PairOptions pair_options(const Scene& scene);

/// For references: neither limits nor an error estimate of the mesh.
void without_limits(PairOptions& options);

/// For a check: elements `refine` times as large at the contact, that grow slower and stay smaller far away.
PairOptions finer_options(PairOptions options, const Body& body, double refine);

/// Called with every accepted sample, in path order.
using SampleSink = std::function<void(const Sample&)>;

/// Part of a plan's identity: raise it whenever the same inputs give other samples, so that a journal never mixes
/// solves of two programs.
inline constexpr int kSolverRevision = 23;

/// Solves a contact along `path`. A solve that fails a gate or finds no equilibrium is tried again on finer meshes,
/// then on the finest with a stiffer penalty, with multipliers and with a log barrier, until one reaches no deeper than
/// the one before, too much was lost, or a limit is reached. The depths that passed of the normal indentation are then
/// accepted alone, "stopped short", if there are GateLimits::curve_points of them. Never throws for a numerical
/// failure: the outcome names the cause of every attempt. Deterministic: the same inputs give the same bits.
PairResult solve_pair(const ContactCase& contact, const PairPath& path, const PairOptions& options,
                      const SampleSink& sink = {});

/// solve_pair on this one mesh of the body: a refusal is not tried again on another, and the samples' error estimates
/// lack the mesh's share.
PairResult solve_on_mesh(const ContactCase& contact, const PairPath& path, const PairOptions& options,
                         const mesh::TetMesh& mesh);

}  // namespace palpate::solve
