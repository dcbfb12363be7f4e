// SPDX-License-Identifier: GPL-3.0-or-later
// The cells of the stiff battery: contacts at and beyond the ends of every range that a scene allows.
#pragma once

#include "formats/scene/scene.hpp"
#include "formats/surface/surface.hpp"

#include <string>
#include <vector>

namespace palpate {

/// One contact of the first tool's first vertex, made without files.
struct StiffCell {
  std::string family;  ///< what is driven to its ends
  std::string name;    ///< the cell in that family, with its numbers
  Scene scene;         ///< friction > 0: with sideways pushes
  Surface surface;     ///< of the body
  Eigen::Vector3d site{0, 0, 0};
  Eigen::Vector3d normal{0, 0, 1};
  double depth = 0.0;  ///< m
  /// E 10 Pa to 10 MPa, nu to 0.4999, contrast 1e-3 to 1e3, depth to 60 % of the thickness, tip radius from 0.3 mm
  /// (a punch is flat: its radius is free).
  bool core = true;
};

/// All of them, in a fixed order; at least 300.
std::vector<StiffCell> stiff_cells();

}  // namespace palpate
