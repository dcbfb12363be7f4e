// SPDX-License-Identifier: MIT
// Checks of every record of a response file: indices, adjacency, floats, frames, curves, search tree.
#pragma once

#include "palpate/validate_responses.hpp"
#include "palpate/validate_surface.hpp"

namespace palpate::runtime::detail {

inline bool is_text(const char* p, std::size_t capacity) {
  for (std::size_t i = 0; i < capacity; ++i) {
    if (p[i] == 0) return true;
  }
  return false;
}

/// `vertex` is the first spin turned by this angle about its normal.
inline bool is_spin(const layout::ToolVertexRecord& first, const layout::ToolVertexRecord& vertex, double angle) {
  for (int k = 0; k < 3; ++k) {
    if (vertex.point[k] != first.point[k] || vertex.normal[k] != first.normal[k]) return false;
  }
  const Vec3 n = to_vec(first.normal), t = to_vec(first.tangent);
  const Vec3 off = std::cos(angle) * t + std::sin(angle) * cross(n, t) - to_vec(vertex.tangent);
  return vertex.meridian == first.meridian && dot(off, off) < 1e-6;
}

/// Spins of one point follow its first, which alone has their count and is in patches.
inline bool check_spins(const View& v, Fault& fault) {
  const std::uint32_t vertices = v.meta->tool_vertex_count;
  bool several = false;
  for (std::uint32_t i = 0; i < v.meta->tool_count; ++i) {
    const layout::ToolRecord& tool = v.tools[i];
    const std::uint32_t end = tool.first_vertex + tool.vertex_count;
    for (std::uint32_t first = tool.first_vertex; first < end; first += v.spins[first]) {
      const std::uint32_t spins = v.spins[first];
      if (spins < 1 || spins > layout::kMaxSpins || spins > end - first) {
        return fault.say("SPINS: vertex %: % spins, allowed 1 to % of its tool", first, spins, layout::kMaxSpins);
      }
      several = several || spins > 1;
      for (std::uint32_t k = 1; k < spins; ++k) {
        if (v.spins[first + k] != 0) return fault.say("SPINS: vertex %: belongs to the one before", first + k);
        if (!is_spin(v.tool_vertices[first], v.tool_vertices[first + k], kFullTurn * k / spins)) {
          return fault.say("SPINS: vertex %: is not vertex % turned about its normal", first + k, first);
        }
      }
      const bool profile = tool.kind == static_cast<std::uint32_t>(layout::ToolKind::profile);
      if (spins > 1 && profile && !(v.tool_vertices[first].tangent[2] >= 0)) {
        return fault.say("SPINS: vertex %: its tangent does not run up the profile", first);
      }
    }
  }
  for (std::uint32_t p = 0; p < v.meta->tool_patch_count; ++p) {
    for (const std::uint32_t corner : v.tool_patches[p].vertex) {
      if (corner < vertices && v.spins[corner] == 0) return fault.say("TOOL_PATCHES: patch % names a later spin", p);
    }
  }
  return several || fault.say("SPINS: there is no vertex of more than one");
}

inline bool check_tool(const View& v, std::uint32_t i, Fault& fault) {
  const layout::ToolRecord& t = v.tools[i];
  if (!is_text(t.name, sizeof t.name) || t.name[0] == 0) return fault.say("TOOLS: tool %: bad name", i);
  if (t.kind > 2) return fault.say("TOOLS: tool %: unknown kind %", i, t.kind);
  const float sizes[] = {t.radius, t.probe_radius, t.axis_length};
  for (const float s : sizes) {
    if (!(s >= 0 && s < 1e5f)) return fault.say("TOOLS: tool %: lengths must be finite and not negative", i);
  }
  const auto kind = static_cast<layout::ToolKind>(t.kind);
  // Where the contact patch on such a tool is, nothing could tell.
  if (kind != layout::ToolKind::mesh && t.axis_length == 0 && t.vertex_count != 1) {
    return fault.say("TOOLS: tool %: without an axis a sphere or profile has one vertex", i);
  }
  if (kind != layout::ToolKind::profile && t.axis_length != 0) {
    return fault.say("TOOLS: tool %: only a profile has an axis", i);
  }
  if (kind == layout::ToolKind::mesh && t.probe_radius != 0) {
    return fault.say("TOOLS: tool %: the probe radius of a mesh is 0", i);
  }
  const std::uint64_t end = std::uint64_t{t.first_patch} + t.patch_count;
  const bool patched = v.tool_patches != nullptr;
  if (patched ? t.patch_count == 0 || end > v.meta->tool_patch_count
              : t.patch_count != 0 || t.first_patch != 0 || t.vertex_count != 1) {
    return fault.say("TOOLS: tool %: patches out of range", i);
  }
  float reached = -HUGE_VALF;  // meridian at the end of the segments so far
  for (std::uint64_t p = t.first_patch; patched && p < end; ++p) {
    const auto& corner = v.tool_patches[p].vertex;
    for (const std::uint32_t c : corner) {
      if (c < t.first_vertex || c - t.first_vertex >= t.vertex_count) {
        return fault.say("TOOL_PATCHES: patch % names a vertex of another tool", p);
      }
    }
    if (kind != layout::ToolKind::profile) continue;
    const float low = v.tool_vertices[corner[0]].meridian, high = v.tool_vertices[corner[1]].meridian;
    if (low > high || low < reached) {
      return fault.say("TOOL_PATCHES: patch %: a profile's segments must ascend", p);
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
      return fault.say("TOOL_VERTICES: vertex %: point, frame, meridian or name is wrong", i);
    }
  }
  for (std::uint32_t i = 0; i < v.meta->tool_count; ++i) {
    const layout::ToolRecord& t = v.tools[i];
    if (t.first_vertex != vertices || t.vertex_count == 0 || t.first_patch != patches) {
      return fault.say("TOOLS: tool %: vertices and patches must follow those of the tool before", i);
    }
    vertices += t.vertex_count;
    patches += t.patch_count;
    if (vertices > v.meta->tool_vertex_count) return fault.say("TOOLS: tool %: vertices out of range", i);
    if (!check_tool(v, i, fault)) return false;
  }
  if (vertices != v.meta->tool_vertex_count || patches != v.meta->tool_patch_count) {
    return fault.say("TOOLS: vertices or patches belong to no tool");
  }
  return true;
}

template <std::uint32_t kFeatures>
bool check_records(const View& v, Fault& fault) {
  if (v.provenance_size < 2 || v.provenance[0] != '{' || v.provenance[v.provenance_size - 1] != '}') {
    return fault.say("PROVENANCE: not a JSON object");
  }
  if (!check_sites(v, fault) || !check_surface(v, fault) || !check_tools(v, fault)) return false;
  if constexpr ((kFeatures & layout::feature_spin) != 0) {
    if (v.spins != nullptr && !check_spins(v, fault)) return false;
  }
  if (!check_responses<kFeatures>(v, fault)) return false;
  if constexpr ((kFeatures & layout::feature_grasp) != 0) {
    if (!check_grasps(v, fault)) return false;
  }
  if constexpr ((kFeatures & layout::feature_search) != 0) return check_search(v, fault);
  return true;
}

}  // namespace palpate::runtime::detail
