// SPDX-License-Identifier: GPL-3.0-or-later
// Libraries keep what is constrained as it is (CGAL) or do not bound the distance from the new surface to the old one
// (OpenMesh), so the loop is here and the mesh is OpenMesh's.
#include "precompute/mesh/surface/decimate_layout.hpp"

#include "precompute/geometry/feature_normals.hpp"
#include "precompute/mesh/surface/surface_adapter.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <functional>
#include <limits>
#include <queue>
#include <tuple>
#include <utility>

namespace palpate::mesh {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Mesh = SurfaceAdapter::Mesh;
using Vertex = Mesh::VertexHandle;
using Halfedge = Mesh::HalfedgeHandle;
using Face = Mesh::FaceHandle;

constexpr double kLeastShape = 0.1;   // of a new triangle, 1 where it is equilateral; a worse one may stay as bad
constexpr double kLeastCosine = 0.3;  // between the normals of a new triangle and of the body there
constexpr double kStiffness = 1e-3;   // of the pull to the edge's middle, where planes leave a point free
constexpr double kSidePull = 0.1;     // of a path to its side, beside that of a triangle to its plane
// Places that are tried one after the other, along the normal, of the tolerance. The quadric is of the triangles'
// planes, and with triangles on both sides of the surface each may be larger.
constexpr double kShifts[] = {0, 0.4, -0.4, 0.8, -0.8};

// Squared distances to planes, weighted by area: p.A p + 2 b.p + c.
struct Quadric {
  Matrix3d a = Matrix3d::Zero();
  Vector3d b = Vector3d::Zero();
  double c = 0;
  void add(const Quadric& q) {
    a += q.a;
    b += q.b;
    c += q.c;
  }
  [[nodiscard]] double at(const Vector3d& p) const { return p.dot(a * p) + 2 * b.dot(p) + c; }
};

Quadric plane(const Vector3d& normal, const Vector3d& point, double weight) {
  const double d = -normal.dot(point);
  return {weight * normal * normal.transpose(), weight * d * normal, weight * d * d};
}

struct Triangle {
  std::array<Vector3d, 3> p;
  [[nodiscard]] Vector3d cross() const { return (p[1] - p[0]).cross(p[2] - p[0]); }
  [[nodiscard]] double shape() const {
    const double edges = (p[1] - p[0]).squaredNorm() + (p[2] - p[1]).squaredNorm() + (p[0] - p[2]).squaredNorm();
    return edges > 0 ? 2 * std::sqrt(3.0) * cross().norm() / edges : 0;
  }
};

class Decimater {
public:
  Decimater(const PatchLayout& layout, const geometry::SurfaceQuery& body, double tolerance,
            const std::vector<char>& kept)
      : layout_(layout), body_(body), tolerance_(tolerance), kept_(kept) {
    for (const Vector3d& p : layout.points) mesh_.add_vertex(p);
    for (const auto& t : layout.triangles) mesh_.add_face(Vertex(t[0]), Vertex(t[1]), Vertex(t[2]));
    quadrics_.resize(mesh_.n_vertices());
    samples_.resize(mesh_.n_faces());
    stamps_.assign(mesh_.n_vertices(), 0);
    normals_.assign(mesh_.n_vertices(), Vector3d::Zero());
    for (const Face f : mesh_.faces()) {
      const Triangle t = triangle(f);
      const Vector3d cross = t.cross();
      if (!(cross.norm() > 0)) continue;
      const Vector3d n = cross.normalized();
      const Quadric q = plane(n, t.p[0], cross.norm() / 2);
      for (const Vertex v : mesh_.fv_range(f)) {
        quadrics_[std::size_t(v.idx())].add(q);
        normals_[std::size_t(v.idx())] += cross;
      }
      std::vector<Vector3d>& own = samples_[std::size_t(f.idx())];
      own.push_back((t.p[0] + t.p[1] + t.p[2]) / 3);
      for (int k = 0; k < 3; ++k) own.push_back((t.p[k] + t.p[(k + 1) % 3]) / 2);
    }
    for (const Vertex v : mesh_.vertices()) {
      normals_[std::size_t(v.idx())].normalize();
      if (place(v).side >= 0) pull_to_side(v);
      samples_[std::size_t((*mesh_.cvf_begin(v)).idx())].push_back(mesh_.point(v));
    }
  }

  PatchLayout run() {
    // A collapse may allow another one that was refused before it.
    while (pass()) {
    }
    return layout();
  }

private:
  // Effect of a collapse of its halfedge.
  struct Collapse {
    Vector3d target;
    std::vector<Face> faces;                                // that stay, with a corner at the target
    std::vector<Triangle> triangles;                        // that they become
    std::vector<std::pair<std::size_t, Vector3d>> samples;  // by index of `faces`
  };

  [[nodiscard]] const PathPlace& place(Vertex v) const { return layout_.places[std::size_t(v.idx())]; }
  [[nodiscard]] bool kept(Vertex v) const { return kept_[std::size_t(v.idx())] != 0; }
  [[nodiscard]] std::int32_t patch(Face f) const { return layout_.patch[std::size_t(f.idx())]; }
  [[nodiscard]] bool is_path(Halfedge h) const {
    return patch(mesh_.face_handle(h)) != patch(mesh_.opposite_face_handle(h));
  }
  [[nodiscard]] Triangle triangle(Face f) const {
    Triangle t;
    std::transform(mesh_.cfv_begin(f), mesh_.cfv_end(f), t.p.begin(), [&](Vertex v) { return mesh_.point(v); });
    return t;
  }

  [[nodiscard]] Quadric sum(Vertex a, Vertex b) const {
    Quadric q = quadrics_[std::size_t(a.idx())];
    q.add(quadrics_[std::size_t(b.idx())]);
    return q;
  }

  // A path belongs over the straight side of its patches.
  void pull_to_side(Vertex v) {
    const PatchSide& side = layout_.sides[std::size_t(place(v).side)];
    const Vector3d &start = layout_.points[std::size_t(side[0])], &end = layout_.points[std::size_t(side[1])];
    const Vector3d across = (end - start).cross(normals_[std::size_t(v.idx())]);
    if (!(across.norm() > 0)) return;
    Quadric& q = quadrics_[std::size_t(v.idx())];
    q.add(plane(across.normalized(), start, kSidePull * q.a.trace()));
  }

  // New place of the end of `h`.
  [[nodiscard]] Vector3d target(Halfedge h) const {
    const Vertex from = mesh_.from_vertex_handle(h), to = mesh_.to_vertex_handle(h);
    const Vector3d& end = mesh_.point(to);
    if (kept(to)) return end;
    const Quadric q = sum(from, to);
    if (place(to).site >= 0) {
      const Vector3d& n = normals_[std::size_t(to.idx())];
      const double curvature = n.dot(q.a * n);
      return curvature > 0 ? Vector3d(end - n.dot(q.a * end + q.b) / curvature * n) : end;
    }
    const bool alike = place(from).side == place(to).side;
    const Vector3d start = alike ? Vector3d((mesh_.point(from) + end) / 2) : end;
    const Matrix3d a = q.a + kStiffness * q.a.trace() * Matrix3d::Identity();
    const Vector3d step = a.ldlt().solve(-(q.a * start + q.b));
    return step.allFinite() ? Vector3d(start + step) : start;
  }

  // Rules of topology and of the patches.
  [[nodiscard]] bool is_allowed(Halfedge h) {
    const Vertex from = mesh_.from_vertex_handle(h), to = mesh_.to_vertex_handle(h);
    if (place(from).site >= 0 || kept(from) || !mesh_.is_collapse_ok(h)) return false;
    if (place(from).side >= 0 && !is_path(h)) return false;
    const Vertex left = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h));
    const Vertex right = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(mesh_.opposite_halfedge_handle(h)));
    for (const Halfedge spoke : mesh_.voh_range(from)) {
      const Vertex v = mesh_.to_vertex_handle(spoke);
      if (v == to || v == left || v == right || is_path(spoke)) continue;
      if (share_path(layout_.sides, place(to), place(v))) return false;
    }
    return true;
  }

  [[nodiscard]] bool is_near(const Triangle& t) const {
    const geometry::ClosestPoint on = body_.closest((t.p[0] + t.p[1] + t.p[2]) / 3);
    if (on.distance > tolerance_) return false;
    Triangle there;
    for (int k = 0; k < 3; ++k) there.p[k] = body_.surface().vertices[body_.surface().triangles[on.triangle][k]];
    const Vector3d n = t.cross(), m = there.cross();
    return n.dot(m) >= kLeastCosine * n.norm() * m.norm();
  }

  // The collapse of `h` to the first place where the new triangles are as good as they must be; false where none is.
  [[nodiscard]] bool find(Halfedge h, Collapse& found) const {
    const Vertex to = mesh_.to_vertex_handle(h);
    Vector3d normal = normals_[std::size_t(to.idx())];
    if (place(to).site < 0) normal = (normal + normals_[std::size_t(mesh_.from_vertex_handle(h).idx())]).normalized();
    const Vector3d first = target(h);
    for (const double shift : kShifts) {
      if (kept(to) && shift != 0) break;
      found = {};
      found.target = first + shift * tolerance_ * normal;
      if (check(h, found)) return true;
    }
    return false;
  }

  // True where the new triangles are as good as they must be.
  [[nodiscard]] bool check(Halfedge h, Collapse& c) const {
    const Vertex from = mesh_.from_vertex_handle(h), to = mesh_.to_vertex_handle(h);
    const Face gone[] = {mesh_.face_handle(h), mesh_.opposite_face_handle(h)};
    double worst = 1;
    std::vector<Vector3d> samples, ring;
    for (const Face f : gone) {
      worst = std::min(worst, triangle(f).shape());
      samples.insert(samples.end(), samples_[std::size_t(f.idx())].begin(), samples_[std::size_t(f.idx())].end());
    }
    for (const Vertex centre : {from, to}) {
      for (const Face f : mesh_.vf_range(centre)) {
        if (f == gone[0] || f == gone[1]) continue;
        Triangle t = triangle(f);
        worst = std::min(worst, t.shape());
        int k = 0;
        for (const Vertex v : mesh_.fv_range(f)) {
          if (v == centre) {
            t.p[k] = c.target;
            ring.push_back(mesh_.point(mesh_.to_vertex_handle(next_about(f, centre))));
          }
          ++k;
        }
        c.faces.push_back(f);
        c.triangles.push_back(t);
        samples.insert(samples.end(), samples_[std::size_t(f.idx())].begin(), samples_[std::size_t(f.idx())].end());
      }
    }
    for (const Triangle& t : c.triangles) {
      if (t.shape() < std::min(kLeastShape, worst)) return false;
    }
    for (const Vector3d& p : samples) {
      double least = std::numeric_limits<double>::infinity();
      std::size_t nearest = 0;
      for (std::size_t k = 0; k < c.triangles.size(); ++k) {
        const auto& [a, b, d] = c.triangles[k].p;
        const double away = (geometry::closest_on_triangle(p, a, b, d).point - p).squaredNorm();
        if (away < least) std::tie(least, nearest) = std::pair(away, k);
      }
      if (least > tolerance_ * tolerance_) return false;
      c.samples.emplace_back(nearest, p);
    }
    const auto far = [&](const Vector3d& p) { return body_.closest(p).distance > tolerance_; };
    if (far(c.target)) return false;
    for (const Vector3d& p : ring) {
      for (const double share : {0.5, 0.25, 0.75}) {
        if (far(c.target + share * (p - c.target))) return false;
      }
    }
    return std::all_of(c.triangles.begin(), c.triangles.end(), [&](const Triangle& t) { return is_near(t); });
  }

  [[nodiscard]] Halfedge next_about(Face f, Vertex centre) const {
    Halfedge h = mesh_.halfedge_handle(f);
    while (mesh_.from_vertex_handle(h) != centre) h = mesh_.next_halfedge_handle(h);
    return h;
  }

  void perform(Halfedge h, const Collapse& c) {
    const Vertex from = mesh_.from_vertex_handle(h), to = mesh_.to_vertex_handle(h);
    quadrics_[std::size_t(to.idx())] = sum(from, to);
    mesh_.collapse(h);
    mesh_.set_point(to, c.target);
    for (const Face f : c.faces) samples_[std::size_t(f.idx())].clear();
    for (const auto& [face, p] : c.samples) samples_[std::size_t(c.faces[face].idx())].push_back(p);
    ++stamps_[std::size_t(to.idx())];
  }

  struct Candidate {
    double error;
    std::int32_t halfedge, from_stamp, to_stamp;
    bool operator<(const Candidate& o) const {
      return std::tie(error, halfedge) > std::tie(o.error, o.halfedge);  // the least first
    }
  };

  [[nodiscard]] std::int32_t stamp(Vertex v) const { return stamps_[std::size_t(v.idx())]; }

  // Collapses what it can; true where it did any.
  bool pass() {
    std::priority_queue<Candidate> open;
    const auto push = [&](Halfedge h) {
      const Vertex from = mesh_.from_vertex_handle(h), to = mesh_.to_vertex_handle(h);
      if (place(from).site >= 0 || kept(from)) return;
      open.push({sum(from, to).at(target(h)), h.idx(), stamp(from), stamp(to)});
    };
    for (const Halfedge h : mesh_.halfedges()) push(h);
    bool any = false;
    while (!open.empty()) {
      const Candidate best = open.top();
      open.pop();
      const Halfedge h(best.halfedge);
      if (mesh_.status(mesh_.edge_handle(h)).deleted()) continue;
      const Vertex to = mesh_.to_vertex_handle(h);
      if (stamp(mesh_.from_vertex_handle(h)) != best.from_stamp || stamp(to) != best.to_stamp) continue;
      if (!is_allowed(h)) continue;
      Collapse collapse;
      if (!find(h, collapse)) continue;
      perform(h, collapse);
      any = true;
      for (const Halfedge next : mesh_.voh_range(to)) {
        push(next);
        push(mesh_.opposite_halfedge_handle(next));
      }
    }
    return any;
  }

  [[nodiscard]] PatchLayout layout() const {
    PatchLayout result;
    result.sides = layout_.sides;
    std::vector<std::int32_t> number(layout_.points.size(), -1);
    for (const Vertex v : mesh_.vertices()) {
      number[std::size_t(v.idx())] = static_cast<std::int32_t>(result.points.size());
      result.points.push_back(mesh_.point(v));
      result.places.push_back(place(v));
    }
    for (const Face f : mesh_.faces()) {
      std::array<std::int32_t, 3> t{};
      int k = 0;
      for (const Vertex v : mesh_.fv_range(f)) t[k++] = number[std::size_t(v.idx())];
      result.triangles.push_back(t);
      result.patch.push_back(patch(f));
    }
    return result;
  }

  const PatchLayout& layout_;
  const geometry::SurfaceQuery& body_;
  double tolerance_;  // m
  const std::vector<char>& kept_;
  Mesh mesh_;
  std::vector<Quadric> quadrics_;               // per vertex
  std::vector<std::vector<Vector3d>> samples_;  // per face: points of the layout for which it stands
  std::vector<Vector3d> normals_;               // per vertex, of the layout
  std::vector<std::int32_t> stamps_;            // per vertex: how often it has moved
};

}  // namespace

PatchLayout decimate(const PatchLayout& layout, const geometry::SurfaceQuery& body, double tolerance,
                     const std::vector<char>& kept) {
  return Decimater(layout, body, tolerance, kept).run();
}

}  // namespace palpate::mesh
