// SPDX-License-Identifier: MIT
// Checks sites, the contact surface and its search tree.
#pragma once

#include "palpate/format/validate_common.hpp"

namespace palpate::runtime::detail {

inline bool check_sites(const View& v, Fault& fault) {
  for (std::uint32_t i = 0; i < v.meta->site_count; ++i) {
    const layout::Site& s = v.sites[i];
    if (!in_range(s.position)) return fault.fail("SITES: site %: position is not finite", i);
    if (!is_frame(s.normal, s.tangent)) return fault.fail("SITES: site %: frame is not orthonormal", i);
    if (!is_limit(s.depth_limit, v.meta->depth_scale)) return fault.fail("SITES: site %: depth limit out of range", i);
    if ((s.flags & ~layout::site_all) != 0 || s.reserved != 0) return fault.fail("SITES: site %: unknown flags or reserved bytes that are not zero", i);
  }
  return true;
}

/// Writes the whole-number weights of the sites at corner `k` of triangle `t`.
inline void site_weights(const View& v, std::uint32_t t, int k, std::uint32_t (&site)[3], std::uint32_t (&weight)[3]) {
  const layout::SurfaceTriangle& triangle = v.triangles[t];
  for (int i = 0; i < 3; ++i) site[i] = triangle.site[i];
  weight[0] = triangle.grid[k][0];
  weight[1] = triangle.grid[k][1];
  weight[2] = v.meta->subdivision - weight[0] - weight[1];
}

/// True when both corners give the same weights to the same sites. One direction is compared, because the weights of
/// each corner sum to the subdivision.
inline bool same_weights(const View& v, std::uint32_t t, int k, std::uint32_t other, int j) {
  const layout::SurfaceTriangle &triangle = v.triangles[t], &neighbour = v.triangles[other];
  const auto &own = triangle.site, &theirs = neighbour.site;
  if (own[0] == theirs[0] && own[1] == theirs[1] && own[2] == theirs[2]) {  // three different ones, in one order
    return triangle.grid[k][0] == neighbour.grid[j][0] && triangle.grid[k][1] == neighbour.grid[j][1];
  }
  std::uint32_t site_a[3], weight_a[3], site_b[3], weight_b[3];
  site_weights(v, t, k, site_a, weight_a);
  site_weights(v, other, j, site_b, weight_b);
  for (int a = 0; a < 3; ++a) {
    bool found = weight_a[a] == 0;
    for (int b = 0; b < 3; ++b) found = found || (site_a[a] == site_b[b] && weight_a[a] == weight_b[b]);
    if (!found) return false;
  }
  return true;
}

/// Checks that neighbours run along their edge in opposite directions, name each other, and give the same weights at its
/// ends. The weights of an edge are compared once, from the triangle of lower index.
inline bool check_edge(const View& v, std::uint32_t t, int corner, Fault& fault) {
  const layout::SurfaceTriangle& triangle = v.triangles[t];
  const std::uint32_t other = triangle.neighbour[corner];
  const int from = (corner + 1) % 3, to = (corner + 2) % 3;
  for (int j = 0; j < 3; ++j) {
    const layout::SurfaceTriangle& n = v.triangles[other];
    const int their_from = (j + 1) % 3, their_to = (j + 2) % 3;
    if (n.neighbour[j] != t || n.vertex[their_from] != triangle.vertex[to] ||
        n.vertex[their_to] != triangle.vertex[from])
      continue;
    if (other < t) return true;
    if (same_weights(v, t, from, other, their_to) && same_weights(v, t, to, other, their_from)) return true;
    return fault.fail("SURFACE_TRIANGLES: triangles % and % disagree on the weights along their edge", t, other);
  }
  return fault.fail("SURFACE_TRIANGLES: triangle %: triangle % is not its neighbour", t, other);
}

inline bool are_different(const std::uint32_t (&corner)[3], std::uint32_t count) {
  return corner[0] < count && corner[1] < count && corner[2] < count && corner[0] != corner[1] &&
         corner[1] != corner[2] && corner[2] != corner[0];
}

inline bool check_surface(const View& v, Fault& fault) {
  for (std::uint32_t i = 0; i < v.meta->vertex_count; ++i) {
    if (!in_range(v.vertices[i].xyz)) return fault.fail("SURFACE_VERTICES: vertex % is not finite", i);
  }
  for (std::uint32_t i = 0; i < v.meta->triangle_count; ++i) {
    const layout::SurfaceTriangle& t = v.triangles[i];
    if (!are_different(t.vertex, v.meta->vertex_count)) {
      return fault.fail("SURFACE_TRIANGLES: triangle %: corners must be three different vertices", i);
    }
    if (!are_different(t.site, v.meta->site_count)) {
      return fault.fail("SURFACE_TRIANGLES: triangle %: its patch must have three different sites", i);
    }
    for (int k = 0; k < 3; ++k) {
      if (std::uint32_t{t.grid[k][0]} + t.grid[k][1] > v.meta->subdivision ||
          t.neighbour[k] >= v.meta->triangle_count) {
        return fault.fail("SURFACE_TRIANGLES: triangle %: grid or neighbour out of range", i);
      }
    }
  }
  for (std::uint32_t i = 0; i < v.meta->triangle_count; ++i) {
    for (int k = 0; k < 3; ++k) {
      if (!check_edge(v, i, k, fault)) return false;
    }
  }
  return true;
}

inline bool is_inside(const layout::SearchNode& box, const float (&p)[3]) {
  for (int k = 0; k < 3; ++k) {
    if (!(p[k] >= box.lower[k] && p[k] <= box.upper[k])) return false;
  }
  return true;
}

/// Checks that the tree holds every triangle once, in order, inside its boxes, and no deeper than a search's stack.
inline bool check_search(const View& v, Fault& fault) {
  struct Visit {
    std::uint32_t node, depth;
  } stack[layout::kMaxSearchDepth + 2];
  if (v.search == nullptr) return true;
  std::uint32_t visited = 0, next = 0;
  int top = 0;
  stack[top++] = {0, 1};
  while (top > 0) {
    const Visit at = stack[--top];
    const layout::SearchNode& n = v.search[at.node];
    if (++visited > v.meta->search_nodes || at.depth > layout::kMaxSearchDepth)
      return fault.fail("SEARCH: not a tree, or too deep");
    if (n.count == 0) {
      if (n.first <= at.node || n.first >= v.meta->search_nodes - 1)
        return fault.fail("SEARCH: node %: bad children", at.node);
      for (std::uint32_t child = n.first; child < n.first + 2; ++child) {
        if (!is_inside(n, v.search[child].lower) || !is_inside(n, v.search[child].upper)) {
          return fault.fail("SEARCH: node % does not hold its children", at.node);
        }
      }
      stack[top++] = {n.first + 1, at.depth + 1};
      stack[top++] = {n.first, at.depth + 1};
      continue;
    }
    if (n.first != next || n.count > v.meta->triangle_count - next)
      return fault.fail("SEARCH: node %: bad triangles", at.node);
    next += n.count;
    for (std::uint32_t t = n.first; t < next; ++t) {
      for (const std::uint32_t c : v.triangles[t].vertex) {
        if (!is_inside(n, v.vertices[c].xyz)) return fault.fail("SEARCH: node % does not hold its triangles", at.node);
      }
    }
  }
  if (visited != v.meta->search_nodes || next != v.meta->triangle_count)
    return fault.fail("SEARCH: nodes or triangles left out");
  return true;
}

}  // namespace palpate::runtime::detail
