// SPDX-License-Identifier: GPL-3.0-or-later
// Adding vertices to the half-edge mesh: splitting long edges, and anchors at given points.
#include "precompute/mesh/surface/surface_adapter.hpp"

#include "formats/io/error.hpp"
#include "precompute/geometry/feature_normals.hpp"
#include "precompute/mesh/surface/adapt_surface.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace palpate::mesh {

using Eigen::Vector3d;

namespace {

constexpr std::size_t kMostTriangles = 300000;

}  // namespace

SurfaceAdapter::Vertex SurfaceAdapter::split_edge(Edge e, const Vector3d& at) {
  if (mesh_.n_faces() > kMostTriangles) {
    throw TooFine(ExitCode::numerical, "size field needs more than 300 000 triangles");
  }
  const Halfedge h = mesh_.halfedge_handle(e, 0);
  const Vertex a = mesh_.from_vertex_handle(h), b = mesh_.to_vertex_handle(h);
  const bool sharp = sharp_[e.idx()] != 0;
  const Vertex v = mesh_.add_vertex(at);
  mesh_.split(e, v);
  grow();
  sharp_[e.idx()] = 0;
  if (sharp) {
    for (const Vertex end : {a, b}) sharp_[mesh_.edge_handle(mesh_.find_halfedge(v, end)).idx()] = 1;
  }
  kind_[v.idx()] = sharp ? Kind::feature : Kind::smooth;
  cap_[v.idx()] = std::max(cap_[a.idx()], cap_[b.idx()]);
  error_[v.idx()] = std::max(error_[a.idx()], error_[b.idx()]);
  set_size(v);
  return v;
}

std::int32_t SurfaceAdapter::insert_anchor(const Vector3d& point) {
  // The base is a few thousand triangles and anchors are few: a plain search.
  Face nearest;
  geometry::TrianglePoint on;
  double least = std::numeric_limits<double>::infinity();
  std::array<Vertex, 3> corners;
  for (const Face f : mesh_.faces()) {
    std::array<Vertex, 3> c;
    std::copy(mesh_.cfv_begin(f), mesh_.cfv_end(f), c.begin());
    const geometry::TrianglePoint p =
        geometry::closest_on_triangle(point, mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]));
    if (const double d = (p.point - point).squaredNorm(); d < least) {
      least = d;
      nearest = f;
      on = p;
      corners = c;
    }
  }
  // On an edge or a corner up to rounding, else sliver triangles would be born.
  constexpr double close = 1e-6;
  Vertex v;
  for (int k = 0; k < 3 && !v.is_valid(); ++k) {
    if (on.weights[k] >= 1 - close) v = corners[k];
  }
  for (int k = 0; k < 3 && !v.is_valid(); ++k) {
    if (on.weights[k] <= close) {
      v = split_edge(mesh_.edge_handle(mesh_.find_halfedge(corners[(k + 1) % 3], corners[(k + 2) % 3])), point);
    }
  }
  if (!v.is_valid()) {
    v = mesh_.add_vertex(point);
    mesh_.split(nearest, v);
    grow();
  }
  mesh_.set_point(v, point);
  kind_[v.idx()] = Kind::fixed;
  set_size(v);
  return v.idx();
}

void SurfaceAdapter::split_long() {
  struct Long {
    double length;
    Edge edge;
  };
  for (int pass = 0; pass < 30; ++pass) {
    std::vector<Long> longer;
    for (const Edge e : mesh_.edges()) {
      const Halfedge h = mesh_.halfedge_handle(e, 0);
      const Vertex a = mesh_.from_vertex_handle(h), b = mesh_.to_vertex_handle(h);
      double metric = metric_length(e);
      if (metric <= kLongestEdge) {
        // A fine spot between the ends shows at the middle only.
        const Vector3d middle = (mesh_.point(a) + mesh_.point(b)) / 2;
        const double length = (mesh_.point(a) - mesh_.point(b)).norm();
        const double there = std::min(size_at(middle), std::max(cap_[a.idx()], cap_[b.idx()]));
        metric = length / 6 * (1 / target_[a.idx()] + 4 / there + 1 / target_[b.idx()]);
      }
      if (metric > kLongestEdge) longer.push_back({metric, e});
    }
    if (longer.empty()) return;
    std::stable_sort(longer.begin(), longer.end(), [](const Long& a, const Long& b) { return a.length > b.length; });
    std::vector<char> touched(mesh_.n_faces(), 0);
    bool any = false;
    for (const Long& l : longer) {
      // One split a triangle and pass, the longest edge first: keeps triangles fat.
      const Halfedge h = mesh_.halfedge_handle(l.edge, 0), o = mesh_.halfedge_handle(l.edge, 1);
      const auto f = static_cast<std::size_t>(mesh_.face_handle(h).idx());
      const auto g = static_cast<std::size_t>(mesh_.face_handle(o).idx());
      if (f >= touched.size() || g >= touched.size() || touched[f] || touched[g]) continue;
      touched[f] = touched[g] = 1;
      const Vector3d middle = (mesh_.point(mesh_.from_vertex_handle(h)) + mesh_.point(mesh_.to_vertex_handle(h))) / 2;
      const Vector3d across = face_cross(mesh_.face_handle(h)) + face_cross(mesh_.face_handle(o));
      const double length = (mesh_.point(mesh_.from_vertex_handle(h)) - middle).norm();
      const Vertex v = split_edge(l.edge, middle);
      const std::optional<Vector3d> to = project(middle, kind_[v.idx()] == Kind::feature, across);
      if (to && *to != middle && (*to - middle).norm() < length && ring_stays_valid(v, *to)) {
        mesh_.set_point(v, *to);
        set_size(v);
      }
      any = true;
    }
    if (!any) return;
  }
}

}  // namespace palpate::mesh
