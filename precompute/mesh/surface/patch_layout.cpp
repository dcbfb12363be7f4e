// SPDX-License-Identifier: GPL-3.0-or-later
// Sites are put into the surface as vertices. Then each side of a patch is traced as the shortest path over vertices
// and edges that crosses no other path, and that leaves and reaches its sites in the order of the haptic mesh about
// them (Praun, Sweldens and Schroeder, Consistent mesh parameterizations, 2001). A spanning tree of the sites comes
// first: what it leaves of a sphere is one disk, so that every other side has a path.
#include "precompute/mesh/surface/patch_layout.hpp"

#include "formats/io/error.hpp"
#include "precompute/geometry/feature_normals.hpp"
#include "precompute/geometry/query.hpp"
#include "precompute/mesh/surface/surface_adapter.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <queue>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>

namespace palpate::mesh {
namespace {

using Eigen::Vector3d;
using Corners = std::array<std::int32_t, 3>;
using Pair = std::array<std::int32_t, 2>;  // a site and a neighbour of it

constexpr double kLongestEdge =
    0.4;  // of the surface, in mean edges of the patch there: paths then are nearly straight
constexpr std::size_t kMostTriangles = 1000000;
constexpr double kOnEdge = 2e-3;      // weight below which a site lies on an edge or a corner of its triangle
constexpr double kLeastShare = 0.05;  // of an edge, on either side of a path that crosses it

using Mesh = SurfaceAdapter::Mesh;
using Vertex = Mesh::VertexHandle;
using Edge = Mesh::EdgeHandle;
using Halfedge = Mesh::HalfedgeHandle;
using Face = Mesh::FaceHandle;

[[noreturn]] void fail(const std::string& what) { throw Error(ExitCode::numerical, "contact surface: " + what); }

std::string name(std::int32_t a, std::int32_t b) { return "sites " + std::to_string(a) + " and " + std::to_string(b); }

// A step of a path: a vertex, or a point of an edge.
struct Step {
  Vertex vertex;
  Edge edge;
  double share = 0.5;  // of the way along the edge's first halfedge
  [[nodiscard]] bool is_vertex() const { return vertex.is_valid(); }
  static Step on(Vertex v) { return {v, Edge()}; }
  static Step on(Edge e) { return {Vertex(), e}; }
  [[nodiscard]] std::int32_t key() const { return is_vertex() ? 2 * vertex.idx() : 2 * edge.idx() + 1; }
};

// The ways out of a site between the paths beside a new one.
struct Doors {
  bool all = false;
  std::set<std::int32_t> vertices, faces;
  [[nodiscard]] bool along(Vertex v) const { return all || vertices.count(v.idx()) != 0; }
  [[nodiscard]] bool through(Face f) const { return all || faces.count(f.idx()) != 0; }
};

class PatchTracer {
public:
  PatchTracer(const Surface& body, const std::vector<Vector3d>& sites, const std::vector<Corners>& patches)
      : patches_(patches), sides_(patch_sides(patches)), site_points_(sites) {
    for (const Vector3d& v : body.vertices) mesh_.add_vertex(v);
    for (const Corners& t : body.triangles) {
      if (!mesh_.add_face(Vertex(t[0]), Vertex(t[1]), Vertex(t[2])).is_valid()) {
        fail("the body's surface is not an oriented manifold");
      }
    }
    for (const Corners& t : patches) {
      for (int k = 0; k < 3; ++k) {
        after_[{t[k], t[(k + 1) % 3]}] = t[(k + 2) % 3];
        before_[{t[k], t[(k + 2) % 3]}] = t[(k + 1) % 3];
      }
    }
    split_long_edges();
    insert_sites();
  }

  PatchLayout trace() {
    for (const std::int32_t side : order()) trace_side(side);
    split_chords();
    return layout();
  }

private:
  [[nodiscard]] const Vector3d& at(Vertex v) const { return mesh_.point(v); }
  [[nodiscard]] Vertex from(Edge e) const { return mesh_.from_vertex_handle(mesh_.halfedge_handle(e, 0)); }
  [[nodiscard]] Vertex to(Edge e) const { return mesh_.to_vertex_handle(mesh_.halfedge_handle(e, 0)); }
  [[nodiscard]] Vector3d at(const Step& s) const {
    if (s.is_vertex()) return at(s.vertex);
    return at(from(s.edge)) + s.share * (at(to(s.edge)) - at(from(s.edge)));
  }
  [[nodiscard]] double length(Edge e) const { return (at(to(e)) - at(from(e))).norm(); }
  [[nodiscard]] bool is_path(Edge e) const { return mesh_.status(e).feature(); }
  [[nodiscard]] std::int32_t site(Vertex v) const { return site_[v.idx()]; }
  [[nodiscard]] bool is_free(Vertex v) const { return site(v) < 0 && side_[v.idx()] < 0; }

  Vertex add(const Vector3d& p) {
    site_.push_back(-1);
    side_.push_back(-1);
    return mesh_.add_vertex(p);
  }

  void split_long_edges() {
    Surface coarse;
    coarse.vertices = site_points_;
    coarse.triangles = patches_;
    coarse.parts.assign(patches_.size(), 0);
    coarse.part_names = {"patches"};
    const geometry::SurfaceQuery query(coarse);
    const auto excess = [&](Edge e) {
      const Corners& t = patches_[std::size_t(query.closest((at(from(e)) + at(to(e))) / 2).triangle)];
      double round = 0;
      for (int k = 0; k < 3; ++k) round += (site_points_[t[k]] - site_points_[t[(k + 1) % 3]]).norm();
      return 3 * length(e) / (kLongestEdge * round);
    };
    site_.assign(mesh_.n_vertices(), -1);
    side_.assign(mesh_.n_vertices(), -1);
    // Splits the longest edges of the triangles beside an edge that is too long first (Rivara 1997): a triangle of
    // which only shorter edges were split would become ever thinner, without end.
    std::priority_queue<std::pair<double, std::int32_t>> longest;
    const auto push = [&](Edge e) {
      if (excess(e) > 1) longest.push({length(e), e.idx()});
    };
    for (const Edge e : mesh_.edges()) push(e);
    while (!longest.empty() && mesh_.n_faces() < kMostTriangles) {
      const auto [old, index] = longest.top();
      const Edge top(index);
      if (length(top) < old) {  // it was split since
        longest.pop();
        continue;
      }
      const Edge e = longest_beside(top);
      if (e == top) longest.pop();
      const Vertex v = add((at(from(e)) + at(to(e))) / 2);
      mesh_.split(e, v);
      for (const Edge next : mesh_.ve_range(v)) push(next);
    }
  }

  /// The edge at the end of a way over ever longer edges of a triangle: the longest of both its triangles.
  [[nodiscard]] Edge longest_beside(Edge e) const {
    for (;;) {
      Edge longest = e;
      for (int side = 0; side < 2; ++side) {
        const Halfedge first = mesh_.halfedge_handle(e, side);
        for (Halfedge h = mesh_.next_halfedge_handle(first); h != first; h = mesh_.next_halfedge_handle(h)) {
          if (length(mesh_.edge_handle(h)) > length(longest)) longest = mesh_.edge_handle(h);
        }
      }
      if (longest == e) return e;
      e = longest;
    }
  }

  void insert_sites() {
    const geometry::SurfaceQuery query(surface());
    std::vector<std::vector<Face>> parts(mesh_.n_faces());  // of a triangle, what it was cut into
    for (const Face f : mesh_.faces()) parts[std::size_t(f.idx())] = {f};
    std::vector<std::int32_t> origin(mesh_.n_faces());
    for (std::size_t f = 0; f < origin.size(); ++f) origin[f] = static_cast<std::int32_t>(f);
    const auto keep_origin = [&](std::size_t fresh, std::int32_t from) {
      origin.resize(mesh_.n_faces());
      origin[fresh] = from;
      parts[std::size_t(from)].push_back(Face(static_cast<std::int32_t>(fresh)));
    };
    for (std::size_t i = 0; i < site_points_.size(); ++i) {
      const Vector3d& p = site_points_[i];
      Face nearest;
      geometry::TrianglePoint on;
      double least = std::numeric_limits<double>::infinity();
      for (const Face f : parts[std::size_t(query.closest(p).triangle)]) {
        const std::array<Vertex, 3> c = corners(f);
        const geometry::TrianglePoint q = geometry::closest_on_triangle(p, at(c[0]), at(c[1]), at(c[2]));
        if (const double d = (q.point - p).squaredNorm(); d < least) {
          least = d;
          nearest = f;
          on = q;
        }
      }
      const std::array<Vertex, 3> c = corners(nearest);
      const std::size_t fresh = mesh_.n_faces();
      Vertex v;
      for (int k = 0; k < 3 && !v.is_valid(); ++k) {
        if (on.weights[k] >= 1 - kOnEdge) v = c[k];
      }
      for (int k = 0; k < 3 && !v.is_valid(); ++k) {
        if (on.weights[k] > kOnEdge) continue;
        const Halfedge h = mesh_.find_halfedge(c[(k + 1) % 3], c[(k + 2) % 3]);
        const std::int32_t own = origin[std::size_t(nearest.idx())];
        const std::int32_t other = origin[std::size_t(mesh_.opposite_face_handle(h).idx())];
        v = add(p);
        mesh_.split(mesh_.edge_handle(h), v);
        // The two new triangles lie on either side of the edge.
        for (std::size_t f = fresh; f < fresh + 2; ++f) {
          const std::array<Vertex, 3> n = corners(Face(static_cast<std::int32_t>(f)));
          const bool mine = std::find(n.begin(), n.end(), c[k]) != n.end();
          keep_origin(f, mine ? own : other);
        }
      }
      if (!v.is_valid()) {
        v = add(p);
        const std::int32_t own = origin[std::size_t(nearest.idx())];
        mesh_.split(nearest, v);
        for (std::size_t f = fresh; f < fresh + 2; ++f) keep_origin(f, own);
      }
      if (site(v) >= 0) fail("two sites are one point of the body's surface: " + name(site(v), std::int32_t(i)));
      mesh_.set_point(v, p);
      site_[v.idx()] = static_cast<std::int32_t>(i);
      vertex_.push_back(v);
    }
  }

  [[nodiscard]] std::array<Vertex, 3> corners(Face f) const {
    std::array<Vertex, 3> c;
    std::copy(mesh_.cfv_begin(f), mesh_.cfv_end(f), c.begin());
    return c;
  }

  [[nodiscard]] Surface surface() const {
    Surface s;
    for (const Vertex v : mesh_.vertices()) s.vertices.push_back(at(v));
    for (const Face f : mesh_.faces()) {
      const std::array<Vertex, 3> c = corners(f);
      s.triangles.push_back({c[0].idx(), c[1].idx(), c[2].idx()});
    }
    s.parts.assign(s.triangles.size(), 0);
    s.part_names = {"body"};
    return s;
  }

  // A shortest spanning tree of each part from its first site on, so that all that is traced hangs together; then the
  // other sides, the shortest first.
  [[nodiscard]] std::vector<std::int32_t> order() const {
    struct Candidate {
      double length;
      std::int32_t side;
      bool operator<(const Candidate& o) const { return std::pair(length, side) > std::pair(o.length, o.side); }
    };
    std::vector<Candidate> all;
    std::vector<std::vector<std::int32_t>> at_site(site_points_.size());
    for (std::size_t k = 0; k < sides_.size(); ++k) {
      const auto side = static_cast<std::int32_t>(k);
      all.push_back({(site_points_[sides_[k][0]] - site_points_[sides_[k][1]]).norm(), side});
      for (const std::int32_t s : sides_[k]) at_site[std::size_t(s)].push_back(side);
    }
    std::vector<std::int32_t> result;
    std::vector<char> reached(site_points_.size(), 0), used(sides_.size(), 0);
    std::priority_queue<Candidate> open;
    const auto reach = [&](std::int32_t s) {
      reached[std::size_t(s)] = 1;
      for (const std::int32_t side : at_site[std::size_t(s)]) open.push(all[std::size_t(side)]);
    };
    for (std::size_t first = 0; first < reached.size(); ++first) {
      if (reached[first] != 0) continue;
      reach(static_cast<std::int32_t>(first));
      while (!open.empty()) {
        const std::int32_t side = open.top().side;
        open.pop();
        for (const std::int32_t s : sides_[std::size_t(side)]) {
          if (reached[std::size_t(s)] != 0) continue;
          used[std::size_t(side)] = 1;
          result.push_back(side);
          reach(s);
        }
      }
    }
    std::sort(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) { return b < a; });
    for (const Candidate& c : all) {
      if (used[std::size_t(c.side)] == 0) result.push_back(c.side);
    }
    return result;
  }

  // Between the nearest traced sides before and after `there` about `here`.
  [[nodiscard]] Doors doors(std::int32_t here, std::int32_t there) const {
    const auto nearest = [&](const std::map<Pair, std::int32_t>& next) {
      std::int32_t s = there;
      do s = next.at({here, s});
      while (s != there && first_.count({here, s}) == 0);
      return s;
    };
    Doors result;
    const std::int32_t before = nearest(before_), after = nearest(after_);
    if (before == there) {
      result.all = true;
      return result;
    }
    const Vertex centre = vertex_[std::size_t(here)];
    const Halfedge last = mesh_.find_halfedge(centre, first_.at({here, after}));
    Halfedge h = mesh_.find_halfedge(centre, first_.at({here, before}));
    for (;;) {
      result.faces.insert(mesh_.face_handle(h).idx());
      h = mesh_.ccw_rotated_halfedge_handle(h);
      if (h == last) return result;
      result.vertices.insert(mesh_.to_vertex_handle(h).idx());
    }
  }

  // Steps from a to b, both among them; empty where there is no path.
  [[nodiscard]] std::vector<Step> shortest_path(std::int32_t a, std::int32_t b) const {
    const Vertex start = vertex_[std::size_t(a)], end = vertex_[std::size_t(b)];
    const Doors out = doors(a, b), in = doors(b, a);
    struct Reached {
      double way;
      Step step;
      std::int32_t before;
      bool done = false;
    };
    std::unordered_map<std::int32_t, Reached> reached;
    using Entry = std::pair<double, std::int32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    const auto offer = [&](const Step& s, double way, std::int32_t before) {
      const auto [at_key, fresh] = reached.try_emplace(s.key(), Reached{way, s, before});
      if (!fresh && (at_key->second.done || at_key->second.way <= way)) return;
      at_key->second = {way, s, before};
      open.push({way + (at(s) - at(end)).norm(), s.key()});
    };
    offer(Step::on(start), 0, -1);
    while (!open.empty()) {
      const std::int32_t key = open.top().second;
      open.pop();
      Reached& now = reached.at(key);
      if (now.done) continue;
      now.done = true;
      const Step here = now.step;
      const double way = now.way;
      const Vector3d p = at(here);
      const auto go = [&](const Step& s) { offer(s, way + (at(s) - p).norm(), key); };
      const auto go_edge = [&](Edge e) {
        if (!is_path(e)) go(Step::on(e));
      };
      if (here.is_vertex() && here.vertex == end) {
        std::vector<Step> path;
        for (std::int32_t k = key; k >= 0; k = reached.at(k).before) path.push_back(reached.at(k).step);
        std::reverse(path.begin(), path.end());
        return path;
      }
      if (here.is_vertex()) {
        const Vertex u = here.vertex;
        for (const Halfedge h : mesh_.voh_range(u)) {
          const Vertex w = mesh_.to_vertex_handle(h);
          const bool leaves = u != start || out.along(w), arrives = w == end ? in.along(u) : is_free(w);
          if (leaves && arrives) go(Step::on(w));
          if (u != start || out.through(mesh_.face_handle(h)))
            go_edge(mesh_.edge_handle(mesh_.next_halfedge_handle(h)));
        }
        continue;
      }
      for (int k = 0; k < 2; ++k) {
        const Halfedge h = mesh_.halfedge_handle(here.edge, k), next = mesh_.next_halfedge_handle(h);
        const Vertex w = mesh_.to_vertex_handle(next);
        if (w == end ? in.through(mesh_.face_handle(h)) : is_free(w)) go(Step::on(w));
        go_edge(mesh_.edge_handle(next));
        go_edge(mesh_.edge_handle(mesh_.next_halfedge_handle(next)));
      }
    }
    return {};
  }

  // Pulls a path tight within the triangles that it runs through.
  void straighten(std::vector<Step>& path) const {
    constexpr int kRounds = 30;
    for (int round = 0; round < kRounds; ++round) {
      for (std::size_t k = 1; k + 1 < path.size(); ++k) {
        Step& s = path[k];
        if (s.is_vertex()) continue;
        const Vector3d a = at(from(s.edge)), along = at(to(s.edge)) - a, p = at(path[k - 1]) - a,
                       q = at(path[k + 1]) - a;
        const double size = along.squaredNorm();
        if (!(size > 0)) continue;
        const double sp = p.dot(along) / size, sq = q.dot(along) / size;
        const double dp = (p - sp * along).norm(), dq = (q - sq * along).norm();
        if (!(dp + dq > 0)) continue;
        s.share = std::clamp((sp * dq + sq * dp) / (dp + dq), kLeastShare, 1 - kLeastShare);
      }
    }
    // Held by a free vertex, the path runs through it.
    std::vector<Step> kept;
    for (const Step& s : path) {
      Step now = s;
      if (!s.is_vertex()) {
        const Vertex near = s.share <= kLeastShare ? from(s.edge) : s.share >= 1 - kLeastShare ? to(s.edge) : Vertex();
        if (near.is_valid() && is_free(near)) now = Step::on(near);
      }
      const bool again = std::any_of(kept.begin(), kept.end(), [&](const Step& k) { return k.key() == now.key(); });
      if (again) {
        while (kept.back().key() != now.key()) kept.pop_back();
      } else {
        kept.push_back(now);
      }
    }
    path = kept;
  }

  void trace_side(std::int32_t side) {
    const auto [a, b] = sides_[std::size_t(side)];
    std::vector<Step> path = shortest_path(a, b);
    if (path.empty()) fail("no path on the body's surface joins " + name(a, b));
    straighten(path);
    for (Step& s : path) {
      if (s.is_vertex()) continue;
      s.vertex = add(at(s));
      mesh_.split(s.edge, s.vertex);
    }
    for (std::size_t k = 0; k + 1 < path.size(); ++k) {
      const Halfedge h = mesh_.find_halfedge(path[k].vertex, path[k + 1].vertex);
      if (!h.is_valid()) fail("the path that joins " + name(a, b) + " is broken");
      mesh_.status(mesh_.edge_handle(h)).set_feature(true);
      if (k > 0) side_[path[k].vertex.idx()] = side;
    }
    first_[{a, b}] = path[1].vertex;
    first_[{b, a}] = path[path.size() - 2].vertex;
  }

  [[nodiscard]] PathPlace place(Vertex v) const { return {site_[v.idx()], side_[v.idx()]}; }

  // An edge that joins two points of one path, and is not part of it, gets a point between.
  void split_chords() {
    std::vector<Edge> chords;
    for (const Edge e : mesh_.edges()) {
      if (!is_path(e) && share_path(sides_, place(from(e)), place(to(e)))) chords.push_back(e);
    }
    for (const Edge e : chords) {
      const Vertex v = add((at(from(e)) + at(to(e))) / 2);
      mesh_.split(e, v);
    }
  }

  // Fills `patch` (per face) from the triangle to the left of its first side.
  void fill_patch(std::int32_t index, std::vector<std::int32_t>& patch) const {
    const Corners& sites = patches_[std::size_t(index)];
    const Halfedge first = mesh_.find_halfedge(vertex_[std::size_t(sites[0])], first_.at({sites[0], sites[1]}));
    std::vector<Face> open{mesh_.face_handle(first)};
    std::set<std::int32_t> vertices, ends;
    std::int64_t faces = 0, borders = 0;
    const auto take = [&](Face f) {
      std::int32_t& owner = patch[std::size_t(f.idx())];
      if (owner == index) return false;
      if (owner >= 0) fail("the patches of " + name(sites[0], sites[1]) + " overlap on the body's surface");
      owner = index;
      return true;
    };
    take(open.front());
    while (!open.empty()) {
      const Face f = open.back();
      open.pop_back();
      ++faces;
      for (const Halfedge h : mesh_.fh_range(f)) {
        const Vertex v = mesh_.to_vertex_handle(h);
        vertices.insert(v.idx());
        if (site(v) >= 0) ends.insert(site(v));
        if (is_path(mesh_.edge_handle(h))) {
          ++borders;
        } else if (take(mesh_.opposite_face_handle(h))) {
          open.push_back(mesh_.opposite_face_handle(h));
        }
      }
    }
    const bool disk = static_cast<std::int64_t>(vertices.size()) - (3 * faces + borders) / 2 + faces == 1;
    if (!disk || ends != std::set<std::int32_t>(sites.begin(), sites.end())) {
      fail("the patch of " + name(sites[0], sites[1]) + " is not a disk on the body's surface");
    }
  }

  [[nodiscard]] PatchLayout layout() const {
    PatchLayout result;
    result.sides = sides_;
    result.patch.assign(mesh_.n_faces(), -1);
    for (std::size_t k = 0; k < patches_.size(); ++k) fill_patch(static_cast<std::int32_t>(k), result.patch);
    if (std::find(result.patch.begin(), result.patch.end(), -1) != result.patch.end()) {
      fail("the patches leave out a part of the body's surface");
    }
    std::vector<std::int32_t> number(mesh_.n_vertices());
    auto next = static_cast<std::int32_t>(site_points_.size());
    result.points = site_points_;
    for (std::size_t k = 0; k < site_points_.size(); ++k) result.places.push_back({static_cast<std::int32_t>(k), -1});
    for (const Vertex v : mesh_.vertices()) {
      number[std::size_t(v.idx())] = site(v) >= 0 ? site(v) : next++;
      if (site(v) >= 0) continue;
      result.points.push_back(at(v));
      result.places.push_back(place(v));
    }
    for (const Face f : mesh_.faces()) {
      const std::array<Vertex, 3> c = corners(f);
      result.triangles.push_back(
          {number[std::size_t(c[0].idx())], number[std::size_t(c[1].idx())], number[std::size_t(c[2].idx())]});
    }
    return result;
  }

  Mesh mesh_;
  const std::vector<Corners>& patches_;
  std::vector<PatchSide> sides_;
  const std::vector<Vector3d>& site_points_;
  std::vector<Vertex> vertex_;           // per site
  std::vector<std::int32_t> site_;       // per vertex; -1: none
  std::vector<std::int32_t> side_;       // per vertex: whose path runs through it; -1: none
  std::map<Pair, std::int32_t> after_;   // (site, neighbour): the next neighbour, counter-clockwise from outside
  std::map<Pair, std::int32_t> before_;  // the last one
  std::map<Pair, Vertex> first_;         // (site, neighbour): first vertex of the path between them
};

}  // namespace

std::vector<PatchSide> patch_sides(const std::vector<Corners>& patches) {
  std::vector<PatchSide> sides;
  for (const Corners& t : patches) {
    for (int k = 0; k < 3; ++k) {
      if (t[k] < t[(k + 1) % 3]) sides.push_back({t[k], t[(k + 1) % 3]});
    }
  }
  std::sort(sides.begin(), sides.end());
  return sides;
}

bool share_path(const std::vector<PatchSide>& sides, const PathPlace& a, const PathPlace& b) {
  if (a.site >= 0 && b.site >= 0) {
    return std::binary_search(sides.begin(), sides.end(),
                              PatchSide{std::min(a.site, b.site), std::max(a.site, b.site)});
  }
  const auto ends_at = [&](std::int32_t side, std::int32_t site) {
    return side >= 0 && site >= 0 && (sides[std::size_t(side)][0] == site || sides[std::size_t(side)][1] == site);
  };
  return (a.side >= 0 && a.side == b.side) || ends_at(a.side, b.site) || ends_at(b.side, a.site);
}

PatchLayout lay_out_patches(const Surface& body, const std::vector<Vector3d>& sites,
                            const std::vector<Corners>& patches) {
  return PatchTracer(body, sites, patches).trace();
}

}  // namespace palpate::mesh
