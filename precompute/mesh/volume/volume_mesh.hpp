// SPDX-License-Identifier: GPL-3.0-or-later
// From a body and a size field to a quadratic tetrahedral mesh, by TetGen in a child process or CGAL Mesh_3.
#pragma once

#include "precompute/common/body.hpp"
#include "precompute/common/processor_time.hpp"
#include "precompute/mesh/size_field.hpp"
#include "precompute/mesh/tet_mesh.hpp"

#include <string>
#include <vector>

namespace palpate::mesh {

struct VolumeMeshOptions {
  enum class Backend { tetgen, mesh3, tetgen_then_mesh3 };
  Backend backend = Backend::tetgen_then_mesh3;
  double radius_edge = 1.2;       ///< TetGen -q bound on circumradius over shortest edge
  double min_dihedral = 15.0;     ///< TetGen -q second bound (degrees)
  double accept_dihedral = 3.0;   ///< a mesh whose smallest dihedral angle is below this is refused (degrees)
  double accept_volume = 0.2;     ///< a mesh whose volume is off the surface's by more than this share is refused
  double accept_inclusion = 0.4;  ///< the same for the volume of an inclusion
  double time_limit = 60.0;       ///< s of processor time for one meshing attempt
  Deadline* deadline = nullptr;   ///< of all attempts together, which take from it; null: none
};

struct MeshQuality {
  double min_dihedral = 0.0;  ///< degrees
  double volume = 0.0;        ///< m^3
  double volume_error = 0.0;  ///< relative to the body's surface volume
};

struct VolumeMeshResult {
  bool usable = false;
  std::string cause;    ///< why not
  std::string backend;  ///< which mesher made it
  TetMesh mesh;
  MeshQuality quality;
};

/// Meshes `body` so that edges follow `size` and every point of `anchors` (on the body's surface) is a
/// corner node. Deterministic; safe to call from several threads. Never throws for a mesher's failure, but
/// Error(io) where TetGen's program is missing or cannot be started: that is a broken installation.
VolumeMeshResult mesh_volume(const Body& body, const SizeField& size, const std::vector<Eigen::Vector3d>& anchors,
                             const VolumeMeshOptions& options = {});

}  // namespace palpate::mesh
