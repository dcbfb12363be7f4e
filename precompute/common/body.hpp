// SPDX-License-Identifier: GPL-3.0-or-later
// A prepared body: clean closed surface in metres, inclusions, materials, and where it is held.
#pragma once

#include "formats/scene/scene.hpp"
#include "formats/surface/surface.hpp"
#include "precompute/geometry/curve_query.hpp"
#include "precompute/geometry/query.hpp"

#include <memory>
#include <string>
#include <vector>

namespace palpate {

/// Results of surface preparation, for the user to see before a bake.
struct SurfaceReport {
  std::string action;                 ///< "used as it is" | "repaired" | "wrapped", then ", smoothed"
  std::vector<std::string> findings;  ///< what validation found of the input, one line each
  std::size_t vertices = 0, triangles = 0;
  double largest_move = 0.0, mean_move = 0.0;                               ///< m, from the result to the input surface
  Eigen::Vector3d extents{0, 0, 0};                                         ///< m, of the bounding box
  double volume = 0.0, area = 0.0;                                          ///< m^3, m^2
  double thickness_min = 0.0, thickness_median = 0.0, thickness_p05 = 0.0;  ///< m
  double facet_depth = 0.0;  ///< m, mean distance of the facets' middles to the round surface that they stand for
  bool thin_bag = false;     ///< looks like a thin closed shell rather than a solid
};

/// One inclusion: a closed surface strictly inside the body.
struct Inclusion {
  std::string name;
  std::shared_ptr<const geometry::SurfaceQuery> query;
  Surface base;  ///< coarse remeshed copy that the volume meshes start from
  MaterialScene material;
  /// The curves that the material's fibres run along; null: none, or one direction.
  std::shared_ptr<const geometry::CurveQuery> fibres;
  SurfaceReport report;
};

/// The edge of the held part of the surface, and the edge length (m) that resolves it; see support_rim.hpp.
struct SupportRim {
  std::vector<Eigen::Vector3d> points;  ///< m
  double size = 0.0;
};

/// A point of a body's surface where its stress-free surface had it.
struct MaterialPoint {
  Eigen::Vector3d point{0, 0, 0};  ///< m, on the stress-free surface
  double stretch = 1.0;            ///< of lengths in the surface round it, by prestress: the root of the ratio of areas
};

/// Immutable after preparation; shared by all threads.
struct Body {
  /// The clean surface (query->surface()), parts kept per triangle.
  std::shared_ptr<const geometry::SurfaceQuery> query;
  Surface base;            ///< coarse remeshed copy, edge about base_size
  double base_size = 0.0;  ///< m
  MaterialScene material;
  std::shared_ptr<const geometry::CurveQuery> fibres;   ///< as of an inclusion, in the stress-free body
  double capsule_thickness = 0.0, capsule_young = 0.0;  ///< m, Pa; of a thin sheet on the outside, 0: none
  std::vector<Inclusion> inclusions;
  std::vector<SupportScene> supports;
  /// Per support; null unless kind is distance.
  std::vector<std::shared_ptr<const geometry::SurfaceQuery>> support_surfaces;
  std::vector<char> cavity;  ///< per triangle of the clean surface: on a wall that faces inward; empty: none is
  SupportRim support_rim;
  SurfaceReport report;
  double diagonal = 0.0;  ///< m, of the bounding box
  PrestressScene prestress;
  /// The same body without its prestress, of which volume meshes are made. `query` and `base` then
  /// are the surfaces as the loads leave them, triangle by triangle those of the stress-free body; inclusions, supports
  /// and their rim stay where that one has them. Null: the body is free of stress.
  std::shared_ptr<const Body> stress_free;

  /// The closest point of the surface in the stress-free state; the point itself where the body is free of stress.
  [[nodiscard]] MaterialPoint material_point(const Eigen::Vector3d& point) const;
  /// The first support that holds a point on the body's surface; null where none does.
  [[nodiscard]] const SupportScene* support_at(const Eigen::Vector3d& surface_point) const;
  /// True where the closest part of the surface is the wall of a cavity, which no tool reaches from outside.
  [[nodiscard]] bool in_cavity(const Eigen::Vector3d& point) const {
    return !cavity.empty() && cavity[std::size_t(query->closest(point).triangle)] != 0;
  }
  [[nodiscard]] bool held(const Eigen::Vector3d& surface_point) const { return support_at(surface_point) != nullptr; }
};

/// Loads, validates, repairs and joins the scene's surfaces. Throws Error(bad_input) that names file and fault.
Body prepare_body(const Scene& scene);
/// The same of a surface (m) that is in memory already.
Body prepare_body(const Scene& scene, const Surface& surface);

}  // namespace palpate
