// SPDX-License-Identifier: GPL-3.0-or-later
// Set-up, features, sizes and output of the half-edge mesh. Its operations are in surface_adapter_split.cpp and
// surface_adapter_ops.cpp.
#include "precompute/mesh/surface/surface_adapter.hpp"

#include "formats/io/error.hpp"
#include "precompute/geometry/feature_normals.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

namespace palpate::mesh {

using Eigen::Vector3d;

namespace {

constexpr double kAgree = 0.3;  // least cosine between a mesh normal and the original's where it is projected to

}  // namespace

SurfaceAdapter::SurfaceAdapter(const Surface& base, const geometry::SurfaceQuery& original, SizeField size,
                               double chord)
    : original_(original), size_(std::move(size)), chord_(chord) {
  mesh_.reserve(base.vertices.size(), base.triangles.size() * 3 / 2, base.triangles.size());
  for (const Vector3d& v : base.vertices) mesh_.add_vertex(v);
  for (std::size_t i = 0; i < base.triangles.size(); ++i) {
    const auto& t = base.triangles[i];
    if (!mesh_.add_face(Vertex(t[0]), Vertex(t[1]), Vertex(t[2])).is_valid()) {
      throw Error(ExitCode::bad_input, "base triangle " + std::to_string(i) + ": surface is not an oriented manifold");
    }
  }
  for (const Edge e : mesh_.edges()) {
    if (mesh_.is_boundary(e)) {
      throw Error(ExitCode::bad_input, "base surface is open at vertex " +
                                           std::to_string(mesh_.from_vertex_handle(mesh_.halfedge_handle(e, 0)).idx()));
    }
  }
  for (const Vertex v : mesh_.vertices()) {
    if (mesh_.is_isolated(v)) mesh_.delete_vertex(v, false);
  }
  mesh_.garbage_collection();
  grow();
  find_features();
  for (const Vertex v : mesh_.vertices()) set_size(v);
}

void SurfaceAdapter::grow() {
  kind_.resize(mesh_.n_vertices(), Kind::smooth);
  target_.resize(mesh_.n_vertices(), 0.0);
  cap_.resize(mesh_.n_vertices(), std::numeric_limits<double>::infinity());
  error_.resize(mesh_.n_vertices(), 0.0);
  sharp_.resize(mesh_.n_edges(), 0);
}

// An edge of the base is a feature where it is sharp and lies along one of the original: a coarse base of a
// smooth organ has sharp edges that are none.
void SurfaceAdapter::find_features() {
  const double flattest = std::cos(geometry::kFeatureAngle * std::numbers::pi / 180);
  for (const Edge e : mesh_.edges()) {
    const Halfedge h = mesh_.halfedge_handle(e, 0), o = mesh_.halfedge_handle(e, 1);
    const Vector3d n = face_cross(mesh_.face_handle(h)).normalized(), m = face_cross(mesh_.face_handle(o)).normalized();
    if (n.dot(m) > flattest) continue;
    const Vector3d a = mesh_.point(mesh_.from_vertex_handle(h)), b = mesh_.point(mesh_.to_vertex_handle(h));
    const double near = 0.1 * (b - a).norm();
    const auto on_feature = [&](const Vector3d& p) {
      const auto q = original_.closest_on_feature(p);
      return q && (*q - p).norm() <= near;
    };
    sharp_[e.idx()] = on_feature(a) && on_feature(b) && on_feature((a + b) / 2);
  }
  for (const Vertex v : mesh_.vertices()) classify(v);
}

void SurfaceAdapter::classify(Vertex v) {
  std::vector<Vector3d> along;
  for (const Halfedge h : mesh_.voh_range(v)) {
    if (sharp_[mesh_.edge_handle(h).idx()]) {
      along.push_back((mesh_.point(mesh_.to_vertex_handle(h)) - mesh_.point(v)).normalized());
    }
  }
  if (along.empty()) {
    kind_[v.idx()] = Kind::smooth;
  } else {
    const bool straight = along.size() == 2 && -along[0].dot(along[1]) > std::cos(40 * std::numbers::pi / 180);
    kind_[v.idx()] = straight ? Kind::feature : Kind::fixed;
  }
}

double SurfaceAdapter::size_at(const Vector3d& p) const {
  const double h = size_(p);
  if (!std::isfinite(h) || !(h > 0)) {
    throw Error(ExitCode::numerical, "size field gives " + std::to_string(h) + " m, allowed > 0");
  }
  return h;
}

void SurfaceAdapter::set_size(Vertex v) { target_[v.idx()] = std::min(size_at(mesh_.point(v)), cap_[v.idx()]); }

double SurfaceAdapter::metric_length(Edge e) const {
  const Halfedge h = mesh_.halfedge_handle(e, 0);
  const Vertex a = mesh_.from_vertex_handle(h), b = mesh_.to_vertex_handle(h);
  const double ha = target_[a.idx()], hb = target_[b.idx()];
  // Sizes grow linearly with distance: the integral of 1 / h is logarithmic.
  const double mean = std::abs(hb - ha) > 1e-3 * ha ? (hb - ha) / std::log(hb / ha) : 0.5 * (ha + hb);
  return (mesh_.point(b) - mesh_.point(a)).norm() / mean;
}

Vector3d SurfaceAdapter::face_cross(Face f) const {
  const Halfedge h = mesh_.halfedge_handle(f);
  const Vector3d a = mesh_.point(mesh_.from_vertex_handle(h)), b = mesh_.point(mesh_.to_vertex_handle(h));
  return (b - a).cross(mesh_.point(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h))) - a);
}

std::optional<Vector3d> SurfaceAdapter::project(const Vector3d& p, bool feature, const Vector3d& normal) const {
  if (feature) return original_.closest_on_feature(p);
  const geometry::ClosestPoint on = original_.closest(p);
  const auto& t = original_.surface().triangles[on.triangle];
  const auto& v = original_.surface().vertices;
  const Vector3d there = (v[t[1]] - v[t[0]]).cross(v[t[2]] - v[t[0]]);
  // In a thin or folded part the nearest point may lie on another wall.
  if (there.dot(normal) < kAgree * there.norm() * normal.norm()) return std::nullopt;
  return on.point;
}

SurfaceAdapter::Stray SurfaceAdapter::stray(Face f) const {
  Vector3d middle = Vector3d::Zero();
  double finest = std::numeric_limits<double>::infinity();
  for (const Vertex v : mesh_.fv_range(f)) {
    middle += mesh_.point(v) / 3;
    finest = std::min(finest, target_[v.idx()]);
  }
  return {original_.closest(middle).distance, finest};
}

bool SurfaceAdapter::shorten_where_coarse() {
  bool any = false;
  for (const Face f : mesh_.faces()) {
    const auto [away, finest] = stray(f);
    if (away <= chord_ * finest) continue;
    any = true;
    // The distance goes with the square of the edge length.
    const double factor = std::clamp(std::sqrt(chord_ * finest / away), 0.5, 0.9);
    for (const Vertex v : mesh_.fv_range(f)) {
      cap_[v.idx()] = std::min(cap_[v.idx()], factor * target_[v.idx()]);
    }
  }
  for (const Vertex v : mesh_.vertices()) target_[v.idx()] = std::min(target_[v.idx()], cap_[v.idx()]);
  return any;
}

double SurfaceAdapter::largest_stray() const {
  double largest = 0;
  for (const Face f : mesh_.faces()) {
    const auto [away, finest] = stray(f);
    largest = std::max(largest, away / finest);
  }
  return largest;
}

void SurfaceAdapter::shorten(const std::vector<std::int32_t>& triangles, double factor) {
  std::vector<double> cap = cap_;
  for (const std::int32_t t : triangles) {
    for (const Vertex v : mesh_.fv_range(Face(t))) {
      cap[v.idx()] = std::min(cap[v.idx()], factor * target_[v.idx()]);
      for (const Vertex w : mesh_.vv_range(v)) cap[w.idx()] = std::min(cap[w.idx()], 1.5 * factor * target_[w.idx()]);
    }
  }
  cap_ = std::move(cap);
  for (const Vertex v : mesh_.vertices()) target_[v.idx()] = std::min(target_[v.idx()], cap_[v.idx()]);
}

Surface SurfaceAdapter::surface(std::vector<std::int32_t>& anchors) {
  // Status bits mark what goes; per-element arrays follow by hand.
  std::vector<Kind> kind;
  std::vector<double> target, cap, error;
  std::vector<char> sharp;
  std::vector<std::int32_t> number(mesh_.n_vertices(), -1);
  Surface s;
  std::vector<std::pair<std::int32_t, std::int32_t>> sharp_ends;
  for (const Vertex v : mesh_.vertices()) {
    number[v.idx()] = static_cast<std::int32_t>(s.vertices.size());
    s.vertices.push_back(mesh_.point(v));
    kind.push_back(kind_[v.idx()]);
    target.push_back(target_[v.idx()]);
    cap.push_back(cap_[v.idx()]);
    error.push_back(error_[v.idx()]);
  }
  for (const Face f : mesh_.faces()) {
    std::array<std::int32_t, 3> t{};
    int k = 0;
    for (const Vertex v : mesh_.fv_range(f)) t[k++] = number[v.idx()];
    s.triangles.push_back(t);
  }
  for (const Edge e : mesh_.edges()) {
    if (!sharp_[e.idx()]) continue;
    const Halfedge h = mesh_.halfedge_handle(e, 0);
    sharp_ends.emplace_back(number[mesh_.from_vertex_handle(h).idx()], number[mesh_.to_vertex_handle(h).idx()]);
  }
  s.parts.assign(s.triangles.size(), 0);
  s.part_names = {"adapted"};
  for (std::int32_t& a : anchors) a = number[a];

  mesh_.clear();
  for (const Vector3d& v : s.vertices) mesh_.add_vertex(v);
  for (const auto& t : s.triangles) mesh_.add_face(Vertex(t[0]), Vertex(t[1]), Vertex(t[2]));
  kind_ = std::move(kind);
  target_ = std::move(target);
  cap_ = std::move(cap);
  error_ = std::move(error);
  sharp_.assign(mesh_.n_edges(), 0);
  for (const auto& [a, b] : sharp_ends) {
    sharp_[mesh_.edge_handle(mesh_.find_halfedge(Vertex(a), Vertex(b))).idx()] = 1;
  }
  return s;
}

}  // namespace palpate::mesh
