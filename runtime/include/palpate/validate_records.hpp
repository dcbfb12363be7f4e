// SPDX-License-Identifier: MIT
// Checks of every record of a response file: indices, adjacency, floats, frames, curves, search tree.
#pragma once

#include "palpate/coupled_check.hpp"
#include "palpate/math3.hpp"
#include "palpate/spline.hpp"
#include "palpate/turn_check.hpp"
#include "palpate/view.hpp"

#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace palpate::runtime::detail {

/// Collects the one message that opening ends with.
struct Fault {
  char* text;
  std::size_t capacity;

#if defined(__GNUC__)
  __attribute__((format(printf, 2, 3)))
#endif
  bool
  say(const char* format, ...) {
    std::va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(text, capacity, format, arguments);
    va_end(arguments);
    return false;
  }
};

inline bool in_range(const float (&p)[3]) {
  for (const float v : p) {
    if (!(std::fabs(v) < 1e5f)) return false;
  }
  return true;
}

inline bool is_frame(const float (&normal)[3], const float (&tangent)[3]) {
  const Vec3 n = to_vec(normal), t = to_vec(tangent);
  return std::fabs(dot(n, n) - 1) < 1e-3 && std::fabs(dot(t, t) - 1) < 1e-3 && std::fabs(dot(n, t)) < 1e-3;
}

inline bool is_text(const char* p, std::size_t capacity) {
  for (std::size_t i = 0; i < capacity; ++i) {
    if (p[i] == 0) return true;
  }
  return false;
}

inline bool is_limit(float limit, double scale) { return limit > 0 && limit <= scale * (1 + 1e-5); }

inline bool check_sites(const View& v, Fault& fault) {
  for (std::uint32_t i = 0; i < v.meta->site_count; ++i) {
    const layout::Site& s = v.sites[i];
    if (!in_range(s.position)) return fault.say("SITES: site %u: position is not finite", i);
    if (!is_frame(s.normal, s.tangent)) return fault.say("SITES: site %u: frame is not orthonormal", i);
    if (!is_limit(s.depth_limit, v.meta->depth_scale)) return fault.say("SITES: site %u: depth limit out of range", i);
    if ((s.flags & ~layout::site_all) != 0 || s.reserved != 0) return fault.say("SITES: site %u: unknown flags", i);
  }
  for (std::uint32_t i = 0; i < v.meta->patch_count; ++i) {
    const auto& p = v.patches[i].vertex;
    if (p[0] >= v.meta->site_count || p[1] >= v.meta->site_count || p[2] >= v.meta->site_count || p[0] == p[1] ||
        p[1] == p[2] || p[2] == p[0]) {
      return fault.say("PATCHES: patch %u: corners must be three different sites", i);
    }
  }
  return true;
}

/// Corner `k` of triangle `t` as whole-number weights of sites.
inline void site_weights(const View& v, std::uint32_t t, int k, std::uint32_t (&site)[3], std::uint32_t (&weight)[3]) {
  const layout::SurfaceTriangle& triangle = v.triangles[t];
  for (int i = 0; i < 3; ++i) site[i] = v.patches[triangle.patch].vertex[i];
  weight[0] = triangle.grid[k][0];
  weight[1] = triangle.grid[k][1];
  weight[2] = v.meta->subdivision - weight[0] - weight[1];
}

/// The same weights of the same sites; both sum to the subdivision, so one direction is enough.
inline bool same_weights(const View& v, std::uint32_t t, int k, std::uint32_t other, int j) {
  const layout::SurfaceTriangle &triangle = v.triangles[t], &neighbour = v.triangles[other];
  if (triangle.patch == neighbour.patch) {  // its sites are three different ones, in one order
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

/// Neighbours share the edge the other way round, know each other, and agree on the weights at its ends: of one edge,
/// weights are compared from the triangle that comes first alone, for its corners, all different, name one edge.
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
    return fault.say("SURFACE_TRIANGLES: triangles %u and %u disagree on the weights along their edge", t, other);
  }
  return fault.say("SURFACE_TRIANGLES: triangle %u: triangle %u is not its neighbour", t, other);
}

inline bool check_surface(const View& v, Fault& fault) {
  for (std::uint32_t i = 0; i < v.meta->vertex_count; ++i) {
    if (!in_range(v.vertices[i].xyz)) return fault.say("SURFACE_VERTICES: vertex %u is not finite", i);
  }
  for (std::uint32_t i = 0; i < v.meta->triangle_count; ++i) {
    const layout::SurfaceTriangle& t = v.triangles[i];
    const auto& c = t.vertex;
    if (c[0] >= v.meta->vertex_count || c[1] >= v.meta->vertex_count || c[2] >= v.meta->vertex_count || c[0] == c[1] ||
        c[1] == c[2] || c[2] == c[0]) {
      return fault.say("SURFACE_TRIANGLES: triangle %u: corners must be three different vertices", i);
    }
    if (t.patch >= v.meta->patch_count) return fault.say("SURFACE_TRIANGLES: triangle %u: no patch %u", i, t.patch);
    for (int k = 0; k < 3; ++k) {
      if (std::uint32_t{t.grid[k][0]} + t.grid[k][1] > v.meta->subdivision ||
          t.neighbour[k] >= v.meta->triangle_count) {
        return fault.say("SURFACE_TRIANGLES: triangle %u: grid or neighbour out of range", i);
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

inline bool check_tool(const View& v, std::uint32_t i, Fault& fault) {
  const layout::ToolRecord& t = v.tools[i];
  if (!is_text(t.name, sizeof t.name) || t.name[0] == 0) return fault.say("TOOLS: tool %u: bad name", i);
  if (t.kind > 2) return fault.say("TOOLS: tool %u: unknown kind %u", i, t.kind);
  const float sizes[] = {t.radius, t.probe_radius, t.axis_length};
  for (const float s : sizes) {
    if (!(s >= 0 && s < 1e5f)) return fault.say("TOOLS: tool %u: lengths must be finite and not negative", i);
  }
  const auto kind = static_cast<layout::ToolKind>(t.kind);
  // Where the contact patch on such a tool is, nothing could tell.
  if (kind != layout::ToolKind::mesh && t.axis_length == 0 && t.vertex_count != 1) {
    return fault.say("TOOLS: tool %u: without an axis a sphere or profile has one vertex", i);
  }
  if (kind != layout::ToolKind::profile && t.axis_length != 0) {
    return fault.say("TOOLS: tool %u: only a profile has an axis", i);
  }
  if (kind == layout::ToolKind::mesh && t.probe_radius != 0) {
    return fault.say("TOOLS: tool %u: the probe radius of a mesh is 0", i);
  }
  const std::uint64_t end = std::uint64_t{t.first_patch} + t.patch_count;
  const bool patched = v.tool_patches != nullptr;
  if (patched ? t.patch_count == 0 || end > v.meta->tool_patch_count
              : t.patch_count != 0 || t.first_patch != 0 || t.vertex_count != 1) {
    return fault.say("TOOLS: tool %u: patches out of range", i);
  }
  float reached = -HUGE_VALF;  // meridian at the end of the segments so far
  for (std::uint64_t p = t.first_patch; patched && p < end; ++p) {
    const auto& corner = v.tool_patches[p].vertex;
    for (const std::uint32_t c : corner) {
      if (c < t.first_vertex || c - t.first_vertex >= t.vertex_count) {
        return fault.say("TOOL_PATCHES: patch %u names a vertex of another tool", static_cast<unsigned>(p));
      }
    }
    if (kind != layout::ToolKind::profile) continue;
    const float low = v.tool_vertices[corner[0]].meridian, high = v.tool_vertices[corner[1]].meridian;
    if (low > high || low < reached) {
      return fault.say("TOOL_PATCHES: patch %u: a profile's segments must ascend", static_cast<unsigned>(p));
    }
    reached = high;
  }
  return true;
}

inline bool check_tools(const View& v, Fault& fault) {
  std::uint64_t vertices = 0, patches = 0;
  for (std::uint32_t i = 0; v.tool_vertices != nullptr && i < v.meta->tool_vertex_count; ++i) {
    const layout::ToolVertexRecord& r = v.tool_vertices[i];
    if (!in_range(r.point) || !is_frame(r.normal, r.tangent) || !(std::fabs(r.meridian) < 1e5f) ||
        !is_text(r.name, sizeof r.name)) {
      return fault.say("TOOL_VERTICES: vertex %u: point, frame, meridian or name is wrong", i);
    }
  }
  for (std::uint32_t i = 0; i < v.meta->tool_count; ++i) {
    const layout::ToolRecord& t = v.tools[i];
    if (t.first_vertex != vertices || t.vertex_count == 0 || t.first_patch != patches) {
      return fault.say("TOOLS: tool %u: vertices and patches must follow those of the tool before", i);
    }
    vertices += t.vertex_count;
    patches += t.patch_count;
    if (vertices > v.meta->tool_vertex_count) return fault.say("TOOLS: tool %u: vertices out of range", i);
    if (!check_tool(v, i, fault)) return false;
  }
  if (vertices != v.meta->tool_vertex_count || patches != v.meta->tool_patch_count) {
    return fault.say("TOOLS: vertices or patches belong to no tool");
  }
  return true;
}

/// First `zeros` exactly 0, all inside [low, high], and not falling (direction 1) or not rising (-1).
inline bool is_curve(const float* c, std::uint32_t count, std::uint32_t zeros, float low, float high, int direction) {
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!(c[i] >= low && c[i] <= high)) return false;
    if (i < zeros && c[i] != 0) return false;
    if (i > 0 && static_cast<float>(direction) * (c[i] - c[i - 1]) < 0) return false;
  }
  return true;
}

inline bool is_sideways(const float* c, std::uint32_t count, float high) {
  if (!is_curve(c, count, 0, -high, high, -1)) return false;
  const double size = std::fmax(std::fabs(c[0]), std::fabs(c[count - 1]));
  return std::fabs(spline::value(c, static_cast<int>(count), 0.5)) <= 2e-5 * size;
}

inline bool check_coupled(const View& v, std::uint32_t i, float largest, Fault& fault) {
  const coupled::Degrees degrees = layout::coupled_degrees(*v.meta);
  const float unit = v.coupled_unit(i);
  const std::int16_t* coefs = v.coupled_coefs(i);
  const int count = coupled::count(degrees);
  if (!(unit >= 0 && unit <= largest / 32768)) return fault.say("COUPLED: response %u: the unit is out of range", i);
  if (const char* broken = coupled::broken_rule(coefs, degrees, 10 / layout::kLimitUnit)) {
    return fault.say("COUPLED: response %u: %s", i, broken);
  }
  if (count % 2 != 0 && coefs[count] != 0) return fault.say("COUPLED: response %u: padding is not zero", i);
  return true;
}

inline bool check_responses(const View& v, Fault& fault) {
  constexpr float kLargest = 1e12f;  // N; products of two curves and of extrapolations stay finite
  const layout::Meta& m = *v.meta;
  for (std::uint32_t i = 0; i < m.response_count; ++i) {
    const layout::ResponseHead& head = v.response_head(i);
    if (!is_limit(head.depth_limit, m.depth_scale))
      return fault.say("RESPONSES: response %u: depth limit out of range", i);
    if (head.flags != layout::response_solved && head.flags != layout::response_covered &&
        head.flags != layout::response_measured && head.flags != layout::response_analytic) {
      return fault.say("RESPONSES: response %u: must be one of solved, covered, measured, analytic", i);
    }
    if (v.coupled_laws != nullptr) {
      if (!check_coupled(v, i, kLargest, fault)) return false;
      continue;
    }
    if (!is_curve(v.normal_coefs(i), m.normal_coefs, 2, 0, kLargest, 1)) {
      return fault.say("RESPONSES: response %u: normal force must start at zero and not decrease", i);
    }
    for (std::uint32_t axis = 0; v.lateral != nullptr && axis < 2; ++axis) {
      if (!is_curve(v.lateral_coefs(i) + axis * m.lateral_coefs, m.lateral_coefs, 2, -kLargest, kLargest, 0)) {
        return fault.say("LATERAL: response %u: must start at zero and be finite", i);
      }
    }
    if (v.friction == nullptr) continue;
    const float* growth = v.friction_coefs(i);
    const float* sideways = growth + 2 * m.growth_coefs;
    for (std::uint32_t axis = 0; axis < 2; ++axis) {
      if (!is_curve(growth + axis * m.growth_coefs, m.growth_coefs, 1, 0, 1e3f, 0)) {
        return fault.say("FRICTION: response %u: growth must start at zero and not be negative", i);
      }
      if (!is_sideways(sideways + axis * m.sideways_coefs, m.sideways_coefs, kLargest)) {
        return fault.say("FRICTION: response %u: sideways force must oppose the deflection and vanish at zero", i);
      }
    }
    if (!is_curve(sideways + 2 * m.sideways_coefs, m.friction_coefs, 0, 0, 10, 0)) {
      return fault.say("FRICTION: response %u: friction limit out of 0 to 10", i);
    }
  }
  return true;
}

/// A response of a tool that holds on has its curves; that of another is zero.
inline bool check_grasp(const View& v, std::uint64_t index, bool holds, Fault& fault) {
  constexpr float kLargest = 1e12f;  // N, N/m
  const auto i = static_cast<std::uint32_t>(index);
  const std::uint32_t n = v.grasp_coefs;
  const layout::GraspHead& head = v.grasp_head(index);
  const float* c = v.grasp_curves(index);
  const double most = v.meta->depth_scale;
  if (holds ? !is_limit(head.depth, most) || !(head.pulled == 0 || is_limit(head.pulled, most))
            : head.depth != 0 || head.pulled != 0) {
    return fault.say("GRASP: response %u: depth or pull out of range, or not as the tool's others", i);
  }
  for (std::uint32_t k = 0; k < layout::kGraspCurves; ++k) {
    if (!is_curve(c + k * n, n, holds ? 0 : n, -kLargest, kLargest, k == 2 ? 1 : 0)) {
      return fault.say("GRASP: response %u: curves must be finite, and the normal force not decrease", i);
    }
  }
  for (std::uint32_t k = 3; k < layout::kGraspCurves; ++k) {
    const float* curve = c + k * n;
    if (curve[0] != curve[1] || curve[n - 1] != curve[n - 2]) {
      return fault.say("GRASP: response %u: stiffness must be level at its ends", i);
    }
  }
  const float *xx = c + 3 * n, *xy = c + 4 * n, *yy = c + 5 * n;
  for (std::uint32_t k = 0; k < n; ++k) {
    if (xx[k] < 0 || yy[k] < 0 || double{xy[k]} * xy[k] > double{xx[k]} * yy[k]) {
      return fault.say("GRASP: response %u: stiffness must be positive semidefinite", i);
    }
  }
  return true;
}

/// The same of a grasped tool that is turned.
inline bool check_turn(const View& v, std::uint64_t index, bool turns, Fault& fault) {
  const auto i = static_cast<std::uint32_t>(index);
  const float turned = v.turn_head(index).turned, *curves = v.turn_curves(index);
  if (!turns) {
    if (turned == 0 &&
        is_curve(curves, layout::kTurnCurves * v.grasp_coefs, layout::kTurnCurves * v.grasp_coefs, 0, 0, 0))
      return true;
    return fault.say("TURN: response %u: must be zero as the tool's others", i);
  }
  if (!is_limit(turned, layout::kLargestTurn)) return fault.say("TURN: response %u: angle out of range", i);
  if (!(v.grasp_head(index).depth > 0)) return fault.say("TURN: response %u: has no grasp", i);
  if (const char* broken = grasp::broken_turn(v.grasp_curves(index), curves, static_cast<int>(v.grasp_coefs))) {
    return fault.say("TURN: response %u: %s", i, broken);
  }
  return true;
}

/// All responses of a tool have a grasp, or none; and turns, or none.
inline bool check_grasps(const View& v, Fault& fault) {
  for (std::uint32_t t = 0; v.grasps != nullptr && t < v.meta->tool_count; ++t) {
    const layout::ToolRecord& tool = v.tools[t];
    const bool holds = v.grasp_head(tool.first_vertex).depth != 0;
    const bool turns = v.turns != nullptr && v.turn_head(tool.first_vertex).turned != 0;
    for (std::uint32_t site = 0; site < v.meta->site_count; ++site) {
      for (std::uint32_t k = 0; k < tool.vertex_count; ++k) {
        const std::uint64_t index = layout::response_index(*v.meta, site, tool.first_vertex + k);
        if (!check_grasp(v, index, holds, fault)) return false;
        if (v.turns != nullptr && !check_turn(v, index, turns, fault)) return false;
      }
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

/// The tree holds every triangle once, in order, no deeper than the walk's stack, inside its boxes.
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
      return fault.say("SEARCH: not a tree, or too deep");
    if (n.count == 0) {
      if (n.first <= at.node || n.first >= v.meta->search_nodes - 1)
        return fault.say("SEARCH: node %u: bad children", at.node);
      for (std::uint32_t child = n.first; child < n.first + 2; ++child) {
        if (!is_inside(n, v.search[child].lower) || !is_inside(n, v.search[child].upper)) {
          return fault.say("SEARCH: node %u does not hold its children", at.node);
        }
      }
      stack[top++] = {n.first + 1, at.depth + 1};
      stack[top++] = {n.first, at.depth + 1};
      continue;
    }
    if (n.first != next || n.count > v.meta->triangle_count - next)
      return fault.say("SEARCH: node %u: bad triangles", at.node);
    next += n.count;
    for (std::uint32_t t = n.first; t < next; ++t) {
      for (const std::uint32_t c : v.triangles[t].vertex) {
        if (!is_inside(n, v.vertices[c].xyz)) return fault.say("SEARCH: node %u does not hold its triangles", at.node);
      }
    }
  }
  if (visited != v.meta->search_nodes || next != v.meta->triangle_count)
    return fault.say("SEARCH: nodes or triangles left out");
  return true;
}

inline bool check_records(const View& v, Fault& fault) {
  if (v.provenance_size < 2 || v.provenance[0] != '{' || v.provenance[v.provenance_size - 1] != '}') {
    return fault.say("PROVENANCE: not a JSON object");
  }
  return check_sites(v, fault) && check_surface(v, fault) && check_tools(v, fault) && check_responses(v, fault) &&
         check_grasps(v, fault) && check_search(v, fault);
}

}  // namespace palpate::runtime::detail
