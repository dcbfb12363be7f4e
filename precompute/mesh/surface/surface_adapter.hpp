// SPDX-License-Identifier: GPL-3.0-or-later
// The half-edge mesh behind adapt_surface: one method a remeshing operation.
#pragma once

#include "formats/surface/surface.hpp"
#include "precompute/geometry/query.hpp"
#include "precompute/mesh/size_field.hpp"

#include <OpenMesh/Core/Utils/vector_traits.hh>
// EigenVectorT.hh specialises vector_traits and does not declare it.
#include <OpenMesh/Core/Geometry/EigenVectorT.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

#include <limits>
#include <optional>
#include <vector>

namespace palpate::mesh {

struct AdapterTraits : OpenMesh::DefaultTraits {
  using Point = Eigen::Vector3d;
  using Normal = Eigen::Vector3d;
  VertexAttributes(OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge);
  FaceAttributes(OpenMesh::Attributes::Status);
};

/// A closed half-edge mesh near `original` on its way to a size field.
class SurfaceAdapter {
public:
  using Mesh = OpenMesh::TriMesh_ArrayKernelT<AdapterTraits>;

  /// Throws Error(bad_input) for a base that is not a closed manifold.
  SurfaceAdapter(const Surface& base, const geometry::SurfaceQuery& original, SizeField size, double chord);

  /// Makes a fixed vertex at exactly `point` (on the surface); gives its number.
  std::int32_t insert_anchor(const Eigen::Vector3d& point);

  void split_long();
  void collapse_short();
  void flip();
  void relax();
  /// Asks for shorter edges where the middle of a triangle is too far from the original; true when any was.
  bool shorten_where_coarse();
  /// Largest distance of a triangle's middle to the original, in target lengths.
  [[nodiscard]] double largest_stray() const;
  /// Asks for shorter edges at triangles (numbers of the last surface()).
  void shorten(const std::vector<std::int32_t>& triangles, double factor);

  /// Closes gaps in the numbering and copies the mesh out; `anchors` are renumbered.
  Surface surface(std::vector<std::int32_t>& anchors);

private:
  using Vertex = Mesh::VertexHandle;
  using Edge = Mesh::EdgeHandle;
  using Halfedge = Mesh::HalfedgeHandle;
  using Face = Mesh::FaceHandle;
  enum class Kind : char { smooth, feature, fixed };
  // Metric lengths between which edges are left alone.
  static constexpr double kShortestEdge = 4.0 / 5, kLongestEdge = 4.0 / 3;

  void find_features();
  void classify(Vertex v);
  void grow();
  void set_size(Vertex v);
  [[nodiscard]] double size_at(const Eigen::Vector3d& p) const;
  /// How many target lengths fit along an edge.
  [[nodiscard]] double metric_length(Edge e) const;
  [[nodiscard]] Eigen::Vector3d face_cross(Face f) const;
  struct Stray {
    double away, finest;  // m: of the triangle's middle to the original; smallest target at its corners
  };
  [[nodiscard]] Stray stray(Face f) const;
  /// Onto the original (its feature lines) where that faces like `normal`.
  [[nodiscard]] std::optional<Eigen::Vector3d> project(const Eigen::Vector3d& p, bool feature,
                                                       const Eigen::Vector3d& normal) const;
  Vertex split_edge(Edge e, const Eigen::Vector3d& at);
  [[nodiscard]] bool may_collapse(Halfedge h, double& error) const;
  [[nodiscard]] bool ring_stays_valid(Vertex v, const Eigen::Vector3d& to) const;
  [[nodiscard]] bool may_flip(Edge e) const;
  void collapse(Halfedge h, double error);

  Mesh mesh_;
  const geometry::SurfaceQuery& original_;
  SizeField size_;
  double chord_;
  std::vector<Kind> kind_;      // per vertex
  std::vector<double> target_;  // per vertex, size there (m)
  std::vector<double> cap_;     // per vertex, longest size allowed (m)
  std::vector<double> error_;   // per vertex, bound of the distance that collapses into it have made (m)
  std::vector<char> sharp_;     // per edge
};

}  // namespace palpate::mesh
