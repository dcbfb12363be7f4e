// SPDX-License-Identifier: GPL-3.0-or-later
// Collapsing short edges, flipping edges and moving vertices, with the checks that keep the surface whole and close to
// its shape.
#include "precompute/geometry/feature_normals.hpp"
#include "precompute/mesh/surface/surface_adapter.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>

namespace palpate::mesh {

using Eigen::Vector3d;

namespace {

constexpr double kTurn = 0.5;      // least cosine between a triangle's normals before and after an operation
constexpr double kFlattest = 0.1;  // least height over longest edge of a new triangle, unless it was worse

// Height over longest edge.
double flatness(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return (b - a).cross(c - a).norm() / longest;
}

}  // namespace

// Would every triangle round v keep its side and a fair shape with v at `to`?
bool SurfaceAdapter::ring_stays_valid(Vertex v, const Vector3d& to) const {
  for (const Halfedge h : mesh_.voh_range(v)) {
    const Vector3d& b = mesh_.point(mesh_.to_vertex_handle(h));
    const Vector3d& c = mesh_.point(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h)));
    const Vector3d& a = mesh_.point(v);
    const Vector3d before = (b - a).cross(c - a), after = (b - to).cross(c - to);
    if (!(before.dot(after) > kTurn * before.norm() * after.norm())) return false;
    if (flatness(to, b, c) < std::min(kFlattest, flatness(a, b, c))) return false;
  }
  return true;
}

// May the half-edge's start vanish into its end? `error` gets the distance bound that the end then carries.
bool SurfaceAdapter::may_collapse(Halfedge h, double& error) const {
  const Vertex v = mesh_.from_vertex_handle(h), w = mesh_.to_vertex_handle(h);
  if (kind_[v.idx()] == Kind::fixed) return false;
  if (kind_[v.idx()] == Kind::feature && !sharp_[mesh_.edge_handle(h).idx()]) return false;
  const Vector3d gone = mesh_.point(v), to = mesh_.point(w);
  const Face left = mesh_.face_handle(h), right = mesh_.face_handle(mesh_.opposite_halfedge_handle(h));

  double away = std::numeric_limits<double>::infinity();
  for (const Halfedge r : mesh_.voh_range(v)) {
    const Vertex x = mesh_.to_vertex_handle(r);
    const Vector3d b = mesh_.point(x);
    if (x != w) {
      const double shorter = std::min(target_[x.idx()], target_[w.idx()]);
      const double longer = std::max(target_[x.idx()], target_[w.idx()]);
      // No new edge may be long enough for another split.
      if ((b - to).norm() > kLongestEdge * (0.5 * (shorter + longer)) && (b - to).norm() > (b - gone).norm())
        return false;
    }
    const Face f = mesh_.face_handle(r);
    if (f == left || f == right) continue;
    const Vector3d c = mesh_.point(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(r)));
    const Vector3d before = (b - gone).cross(c - gone), after = (b - to).cross(c - to);
    if (!(before.dot(after) > kTurn * before.norm() * after.norm())) return false;
    if (flatness(to, b, c) < std::min(kFlattest, flatness(gone, b, c))) return false;
    // The new triangle must not fold against its neighbour across its outer edge.
    const Face beyond = mesh_.face_handle(mesh_.opposite_halfedge_handle(mesh_.next_halfedge_handle(r)));
    if (!sharp_[mesh_.edge_handle(mesh_.next_halfedge_handle(r)).idx()]) {
      const Vector3d n = face_cross(beyond);
      const double turned = n.dot(after) / (n.norm() * after.norm());
      if (turned < 0.2 && turned < n.dot(before) / (n.norm() * before.norm())) return false;
    }
    away = std::min(away, (geometry::closest_on_triangle(gone, to, b, c).point - gone).norm());
  }
  const double limit = chord_ * std::min(target_[v.idx()], target_[w.idx()]);
  error = error_[v.idx()] + (std::isfinite(away) ? away : 0.0);
  if (error > limit) return false;
  if (kind_[v.idx()] == Kind::feature) {
    // Along a feature line: what it cuts off must be small, for the line is seen and felt.
    for (const Halfedge r : mesh_.voh_range(v)) {
      const Vertex x = mesh_.to_vertex_handle(r);
      if (x == w || !sharp_[mesh_.edge_handle(r).idx()]) continue;
      const Vector3d along = (mesh_.point(x) - to).normalized();
      const Vector3d off = gone - to;
      if ((off - off.dot(along) * along).norm() > 0.2 * limit) return false;
    }
  }
  return true;
}

void SurfaceAdapter::collapse(Halfedge h, double error) {
  const Vertex v = mesh_.from_vertex_handle(h), w = mesh_.to_vertex_handle(h);
  std::vector<Vertex> sharp_to;
  for (const Halfedge r : mesh_.voh_range(v)) {
    const Vertex x = mesh_.to_vertex_handle(r);
    if (x != w && sharp_[mesh_.edge_handle(r).idx()]) sharp_to.push_back(x);
  }
  for (const Halfedge r : mesh_.voh_range(w)) {
    const Vertex x = mesh_.to_vertex_handle(r);
    if (x != v && sharp_[mesh_.edge_handle(r).idx()]) sharp_to.push_back(x);
  }
  mesh_.collapse(h);
  for (const Halfedge r : mesh_.voh_range(w)) sharp_[mesh_.edge_handle(r).idx()] = 0;
  for (const Vertex x : sharp_to) sharp_[mesh_.edge_handle(mesh_.find_halfedge(w, x)).idx()] = 1;
  error_[w.idx()] = std::max(error_[w.idx()], error);
}

void SurfaceAdapter::collapse_short() {
  // Shortest first; an entry whose edge has changed since is stale and has a newer one.
  using Entry = std::tuple<double, std::int32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto push = [&](Edge e) {
    if (const double m = metric_length(e); m < kShortestEdge) queue.emplace(m, e.idx());
  };
  for (const Edge e : mesh_.edges()) push(e);
  while (!queue.empty()) {
    const auto [length, index] = queue.top();
    queue.pop();
    const Edge e(index);
    if (mesh_.status(e).deleted() || metric_length(e) != length) continue;
    const Halfedge forth = mesh_.halfedge_handle(e, 0), back = mesh_.halfedge_handle(e, 1);
    // The edge collapses towards the end with the smaller error.
    double error_forth = 0, error_back = 0;
    const bool forth_ok = may_collapse(forth, error_forth) && mesh_.is_collapse_ok(forth);
    const bool back_ok = may_collapse(back, error_back) && mesh_.is_collapse_ok(back);
    if (!forth_ok && !back_ok) continue;
    const bool take_forth = forth_ok && (!back_ok || error_forth <= error_back);
    const Halfedge h = take_forth ? forth : back;
    const Vertex w = mesh_.to_vertex_handle(h);
    collapse(h, take_forth ? error_forth : error_back);
    for (const Halfedge r : mesh_.voh_range(w)) push(mesh_.edge_handle(r));
  }
}

bool SurfaceAdapter::may_flip(Edge e) const {
  if (sharp_[e.idx()] || !mesh_.is_flip_ok(e)) return false;
  const Halfedge h = mesh_.halfedge_handle(e, 0), o = mesh_.halfedge_handle(e, 1);
  const Vertex va = mesh_.from_vertex_handle(h), vb = mesh_.to_vertex_handle(h);
  // A vertex with three triangles left is a spike.
  if (mesh_.valence(va) <= 4 || mesh_.valence(vb) <= 4) return false;
  const Vector3d a = mesh_.point(va), b = mesh_.point(vb);
  const Vector3d c = mesh_.point(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h)));
  const Vector3d d = mesh_.point(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(o)));
  const auto angle = [](const Vector3d& at, const Vector3d& p, const Vector3d& q) {
    return std::atan2((p - at).cross(q - at).norm(), (p - at).dot(q - at));
  };
  constexpr double pi = 3.14159265358979323846;
  if (angle(c, a, b) + angle(d, a, b) <= pi + 1e-6) return false;
  const Vector3d n = (b - a).cross(c - a).normalized(), m = (a - b).cross(d - b).normalized();
  const Vector3d n2 = (d - c).cross(b - c).normalized(), m2 = (c - d).cross(a - d).normalized();
  const double bend = n.dot(m), bend2 = n2.dot(m2);
  // Flipping over a ridge cuts it off: only where it stays flat or gets flatter.
  if (bend2 < std::min(0.94, bend)) return false;
  return std::min({n.dot(n2), n.dot(m2), m.dot(n2), m.dot(m2)}) > kTurn;
}

void SurfaceAdapter::flip() {
  for (int pass = 0; pass < 10; ++pass) {
    bool any = false;
    for (const Edge e : mesh_.edges()) {
      if (!may_flip(e)) continue;
      mesh_.flip(e);
      any = true;
    }
    if (!any) return;
  }
}

void SurfaceAdapter::relax() {
  for (const Vertex v : mesh_.vertices()) {
    if (kind_[v.idx()] == Kind::fixed) continue;
    const bool feature = kind_[v.idx()] == Kind::feature;
    const Vector3d here = mesh_.point(v);
    Vector3d sum = Vector3d::Zero(), normal = Vector3d::Zero();
    double weights = 0;
    for (const Halfedge h : mesh_.voh_range(v)) {
      normal += face_cross(mesh_.face_handle(h));
      if (feature && !sharp_[mesh_.edge_handle(h).idx()]) continue;
      const Vertex w = mesh_.to_vertex_handle(h);
      // Springs that pull alike at alike metric lengths keep the grading.
      const double weight = 2 / (target_[v.idx()] + target_[w.idx()]);
      sum += weight * mesh_.point(w);
      weights += weight;
    }
    Vector3d step = sum / weights - here;
    normal.normalize();
    if (!feature) step -= step.dot(normal) * normal;
    for (int attempt = 0; attempt < 3; ++attempt, step /= 2) {
      Vector3d to = here + step;
      const std::optional<Vector3d> on = project(to, feature, normal);
      if (!on) continue;
      to = *on;
      if ((to - here).norm() > 0.5 * target_[v.idx()] || !ring_stays_valid(v, to)) continue;
      mesh_.set_point(v, to);
      set_size(v);
      break;
    }
  }
}

}  // namespace palpate::mesh
