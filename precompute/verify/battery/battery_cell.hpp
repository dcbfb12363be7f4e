// SPDX-License-Identifier: GPL-3.0-or-later
// One contact of a battery, made without files, and the bake's answer to it.
#pragma once

#include "formats/journal/samples.hpp"
#include "formats/scene/scene.hpp"
#include "formats/surface/surface.hpp"
#include "precompute/solve/pair/pair.hpp"

#include <functional>
#include <string>
#include <vector>

namespace palpate::verify {

/// One contact of the first tool's first vertex.
struct BatteryCell {
  std::string family;  ///< stiff: what is driven to its ends; random: the kind of body
  std::string name;    ///< the cell in that family, with its numbers
  Scene scene;         ///< friction > 0: with tangential pushes
  Surface surface;     ///< of the body
  Eigen::Vector3d site{0, 0, 0};
  Eigen::Vector3d normal{0, 0, 1};
  double depth = 0.0;  ///< m
  /// Stiff: E 10 Pa to 10 MPa, nu to 0.4999, contrast 1e-3 to 1e3, depth to 60 % of the thickness, tip radius from
  /// 0.3 mm (a punch is flat: its radius is free).
  bool core = true;
};

/// A solved or refused cell.
struct CellSolve {
  bool accepted = false;
  std::string cause;            ///< of a refusal, or of an accepted one that stopped short
  std::vector<Sample> samples;  ///< of an accepted cell
  double seconds = 0.0;         ///< wall clock, the body's preparation included
  double processor = 0.0;       ///< s of processor time of this thread and TetGen
  double megabytes = 0.0;       ///< peak of the whole process while it was solved
  std::uint32_t nodes = 0;      ///< of its mesh
};

/// Changes how the cell's scene is solved; `body` is the prepared one.
using CellChange = std::function<void(solve::PairOptions& options, solve::PairPath& path, const Body& body)>;

/// Bake's own entry point (pair.hpp) along the scene's path. `change` empty: as the scene says. A cell whose force is
/// not finite is refused by name. Throws Error(io) where the installation is broken, and std::bad_alloc.
CellSolve solve_cell(const BatteryCell& cell, const CellChange& change = {});

}  // namespace palpate::verify
