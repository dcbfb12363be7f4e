// SPDX-License-Identifier: MIT
// Checks sites, the contact surface and its search tree.
#pragma once

#include "palpate/format/validate_common.hpp"

namespace palpate::runtime::detail {

inline bool check_sites(const View& v, Fault& fault) {
  for (std::uint32_t i = 0; i < v.meta->site_count; ++i) {
    const layout::Site& s = v.sites[i];
    if (!is_frame(s.normal, s.tangent)) return fault.fail("SITES: site %: frame is not orthonormal", i);
    if (!is_limit(s.depth_limit, v.meta->depth_scale)) return fault.fail("SITES: site %: depth limit out of range", i);
    if ((s.flags & ~layout::site_all) != 0) return fault.fail("SITES: site %: unknown flags", i);
  }
  return true;
}

/// Writes the whole-number weights of the patch's sites at corner `k` of a triangle.
inline void site_weights(const View& v, const layout::SurfaceTriangle& triangle, int k, std::uint32_t (&weight)[3]) {
  weight[0] = triangle.grid[k][0];
  weight[1] = triangle.grid[k][1];
  weight[2] = v.meta->subdivision - weight[0] - weight[1];
}

/// True when both corners give the same weights to the same sites. One direction is compared, because the weights of
/// each corner sum to the subdivision.
inline bool same_weights(const View& v, std::uint32_t t, int k, std::uint32_t other, int j) {
  const layout::SurfaceTriangle triangle = v.triangle(t), neighbour = v.triangle(other);
  if (triangle.patch == neighbour.patch) {
    return triangle.grid[k][0] == neighbour.grid[j][0] && triangle.grid[k][1] == neighbour.grid[j][1];
  }
  std::uint32_t weight_a[3], weight_b[3];
  site_weights(v, triangle, k, weight_a);
  site_weights(v, neighbour, j, weight_b);
  for (int a = 0; a < 3; ++a) {
    bool found = weight_a[a] == 0;
    for (int b = 0; b < 3; ++b) found = found || (triangle.site[a] == neighbour.site[b] && weight_a[a] == weight_b[b]);
    if (!found) return false;
  }
  return true;
}

/// Checks that neighbours run along their edge in opposite directions, name each other, and give the same weights at its
/// ends. The weights of an edge are compared once, from the triangle of lower index.
inline bool check_edge(const View& v, std::uint32_t t, int corner, Fault& fault) {
  const layout::SurfaceTriangle triangle = v.triangle(t);
  const std::uint32_t other = triangle.neighbour[corner];
  const int from = (corner + 1) % 3, to = (corner + 2) % 3;
  for (int j = 0; j < 3; ++j) {
    const layout::SurfaceTriangle n = v.triangle(other);
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

/// Checks that a corner is at a site exactly where it is the site's vertex.
inline bool check_corners(const View& v, std::uint32_t t, Fault& fault) {
  const layout::SurfaceTriangle triangle = v.triangle(t);
  for (int k = 0; k < 3; ++k) {
    std::uint32_t weight[3], at = v.meta->site_count;
    site_weights(v, triangle, k, weight);
    for (int i = 0; i < 3; ++i) {
      if (weight[i] == v.meta->subdivision) at = triangle.site[i];
    }
    if (at < v.meta->site_count ? triangle.vertex[k] != at : triangle.vertex[k] < v.meta->site_count) {
      return fault.fail("SURFACE_TRIANGLES: triangle %: a corner at a site must have its vertex, any other must not",
                        t);
    }
  }
  return true;
}

inline bool check_triangle(const View& v, std::uint32_t t, Fault& fault) {
  const layout::SurfaceTriangle triangle = v.bare_triangle(t);
  if (!are_different(triangle.vertex, v.meta->vertex_count)) {
    return fault.fail("SURFACE_TRIANGLES: triangle %: corners must be three different vertices", t);
  }
  if (triangle.patch >= v.meta->patch_count) {
    return fault.fail("SURFACE_TRIANGLES: triangle %: no patch %", t, triangle.patch);
  }
  for (int k = 0; k < 3; ++k) {
    if (std::uint32_t{triangle.grid[k][0]} + triangle.grid[k][1] > v.meta->subdivision ||
        triangle.neighbour[k] >= v.meta->triangle_count) {
      return fault.fail("SURFACE_TRIANGLES: triangle %: grid or neighbour out of range", t);
    }
  }
  return check_corners(v, t, fault);
}

inline bool check_surface(const View& v, Fault& fault) {
  for (std::uint32_t i = 0; i < v.meta->vertex_count; ++i) {
    if (!in_range(v.vertices[i].xyz)) return fault.fail("SURFACE_VERTICES: vertex % is not finite", i);
  }
  for (std::uint32_t i = 0; i < v.meta->patch_count; ++i) {
    std::uint32_t site[3];
    v.patch_sites(i, site);
    if (!are_different(site, v.meta->site_count)) {
      return fault.fail("SURFACE_PATCHES: patch %: must have three different sites", i);
    }
  }
  for (std::uint32_t i = 0; i < v.meta->triangle_count; ++i) {
    if (!check_triangle(v, i, fault)) return false;
  }
  for (std::uint32_t i = 0; i < v.meta->triangle_count; ++i) {
    for (int k = 0; k < 3; ++k) {
      if (!check_edge(v, i, k, fault)) return false;
    }
  }
  return true;
}

inline bool is_inside(const layout::SearchGrid& grid, const layout::SearchNode& box, const float (&p)[3]) {
  for (int k = 0; k < 3; ++k) {
    const double x = double{p[k]};
    if (!(x >= layout::grid_position(grid, k, box.lower[k]) && x <= layout::grid_position(grid, k, box.upper[k]))) {
      return false;
    }
  }
  return true;
}

inline bool holds(const layout::SearchNode& box, const layout::SearchNode& inner) {
  for (int k = 0; k < 3; ++k) {
    if (inner.lower[k] < box.lower[k] || inner.upper[k] > box.upper[k]) return false;
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
    const std::uint32_t first = n.first(), count = n.count();
    if (count == 0) {
      if (first <= at.node || first >= v.meta->search_nodes - 1)
        return fault.fail("SEARCH: node %: bad children", at.node);
      for (std::uint32_t child = first; child < first + 2; ++child) {
        if (!holds(n, v.search[child])) {
          return fault.fail("SEARCH: node % does not hold its children", at.node);
        }
      }
      stack[top++] = {first + 1, at.depth + 1};
      stack[top++] = {first, at.depth + 1};
      continue;
    }
    if (first != next || count > v.meta->triangle_count - next)
      return fault.fail("SEARCH: node %: bad triangles", at.node);
    next += count;
    for (std::uint32_t t = first; t < next; ++t) {
      for (const std::uint32_t c : v.triangle(t).vertex) {
        if (!is_inside(v.search_grid, n, v.vertices[c].xyz))
          return fault.fail("SEARCH: node % does not hold its triangles", at.node);
      }
    }
  }
  if (visited != v.meta->search_nodes || next != v.meta->triangle_count)
    return fault.fail("SEARCH: nodes or triangles left out");
  return true;
}

}  // namespace palpate::runtime::detail
