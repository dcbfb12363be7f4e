// SPDX-License-Identifier: GPL-3.0-or-later
// The input deck of a rigid tool pressed into a hyperelastic mesh, for CalculiX (ccx 2.20).
#pragma once

#include "precompute/mesh/tet_mesh.hpp"
#include "precompute/verify/ccx/ccx_tool.hpp"

#include <string>
#include <vector>

namespace palpate::verify {

/// W = c10 (J^(-2/3) I1 - 3) + c01 (J^(-4/3) I2 - 3) + bulk/2 (J - 1)^2: what ccx has under MOONEY-RIVLIN, and under
/// NEO HOOKE where c01 is 0 (its manual prints another power of J for I2; its source, rubber.f, has this one).
struct CcxMaterial {
  double c10 = 0.0, c01 = 0.0;  ///< Pa
  double bulk = 0.0;            ///< Pa
};

/// How finely contact is computed. Face-to-face contact keeps pairs and normals through an increment.
struct CcxContact {
  double stiffness = 0.0;  ///< Pa/m, of pressure over overlap
  int increments = 1;      ///< of each depth
  double reach = 0.0;      ///< m from the site; faces of the body with a corner within it may touch
};

/// A push along -n at the site `frame.origin`. The tool stands at `pose` (tool frame to body frame) when it first
/// touches, and is pushed through `depths` (m, increasing), a step each.
struct CcxPush {
  const mesh::TetMesh& mesh;
  const std::vector<char>& held;  ///< per node: bit k set where its component k does not move
  CcxMaterial material;
  const ToolFacets& tool;
  Eigen::Isometry3d pose;
  ContactFrame frame;
  std::vector<double> depths;
  CcxContact contact;
};

/// Names of the node sets whose total forces the deck prints.
inline constexpr const char* kCcxTool = "TOOL";
inline constexpr const char* kCcxHeld = "HELD";

/// Lengths in mm, stresses in kPa, so forces in mN: ccx has absolute tolerances, and ours are far from 1. Throws
/// std::invalid_argument where no face of the body may touch.
std::string ccx_deck(const CcxPush& push);

}  // namespace palpate::verify
