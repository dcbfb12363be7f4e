// SPDX-License-Identifier: GPL-3.0-or-later
// One contact solved by us and by CalculiX: on the same mesh, and each on meshes of several sizes.
#pragma once

#include "precompute/solve/pair/pair.hpp"
#include "precompute/verify/ccx/ccx_case.hpp"
#include "precompute/verify/ccx/ccx_run.hpp"

#include <functional>
#include <string>
#include <vector>

namespace palpate::verify {

/// A mesh of the case's body, every element `size` times as large as the base mesh's.
struct CcxMesh {
  double size = 1.0;
  bool quarter = false;  ///< of its quarter, for CalculiX alone: the rest is its mirror image
  mesh::TetMesh mesh;
  double seconds = 0.0;  ///< of processor time, to make it
};

/// One program on one mesh.
struct CcxSolve {
  double size = 1.0;
  std::size_t nodes = 0;
  std::vector<double> forces;  ///< N along the outward normal, one a depth of the case; empty: refused
  std::string cause;           ///< of a refusal
  double seconds = 0.0;        ///< of processor time, mesh aside
};

struct CcxSettings {
  double mesh_size = 0.5, growth = 0.8;  ///< of the base mesh, see SolverScene
  double facets = 0.2;                   ///< edges of the tool's facets, in tip radii
  double stiffness = 3000;               ///< of ccx' contact, in E / a (a the contact radius at full depth)
  int increments = 1;                    ///< of ccx between two depths
  double penalty = 300;                  ///< of our contact, in E / a of the current depth
  CcxLimits limits;
};

/// Throws Error(numerical) where it cannot be made.
CcxMesh ccx_mesh(const CcxCase& c, double size, const CcxSettings& settings, bool quarter = false);

/// Ours through the bake's own code, with the energy that ccx has; the forces at the case's depths are read off the
/// curve, whose depths have the penalty's give taken off. `plain`: the element of ccx, without a mean dilatation.
CcxSolve solve_ours(const CcxCase& c, const CcxMesh& mesh, bool plain, const CcxSettings& settings);

/// A quarter is solved with its cut faces held along their normals, and its force counts four times. Throws Error(io)
/// as run_ccx does.
CcxSolve solve_ccx(const std::filesystem::path& ccx, const CcxCase& c, const CcxMesh& mesh,
                   const CcxSettings& settings);

/// Largest relative difference of the forces of two solves over the depths; NaN where one was refused or is NaN.
double largest_difference(const CcxSolve& a, const CcxSolve& reference);

}  // namespace palpate::verify
