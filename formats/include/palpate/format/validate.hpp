// SPDX-License-Identifier: MIT
// Checks every record of a response file: indices, adjacency, floats, frames, coefficients, search tree.
#pragma once

#include "palpate/format/full_turn.hpp"
#include "palpate/format/validate_responses.hpp"
#include "palpate/format/validate_surface.hpp"

namespace palpate::runtime::detail {

inline bool is_text(const char* p, std::size_t capacity) {
  for (std::size_t i = 0; i < capacity; ++i) {
    if (p[i] == 0) return true;
  }
  return false;
}

/// True when `vertex` is `first` rotated by this angle (rad) about its normal.
inline bool is_spin(const layout::ToolVertexRecord& first, const layout::ToolVertexRecord& vertex, double angle) {
  for (int k = 0; k < 3; ++k) {
    if (vertex.point[k] != first.point[k] || vertex.normal[k] != first.normal[k]) return false;
  }
  const auto& n = first.normal;
  const auto& t = first.tangent;
  double square = 0;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const double cross = double{n[i]} * double{t[j]} - double{n[j]} * double{t[i]};
    const double off = std::cos(angle) * double{t[k]} + std::sin(angle) * cross - double{vertex.tangent[k]};
    square += off * off;
  }
  return vertex.meridian == first.meridian && square < 1e-6;
}

/// Checks that the spins of a point follow its first, and that the first alone has their count and is in patches.
inline bool check_spins(const View& v, Fault& fault) {
  const std::uint32_t vertices = v.meta->tool_vertex_count;
  bool several = false;
  for (std::uint32_t i = 0; i < v.meta->tool_count; ++i) {
    const layout::ToolRecord& tool = v.tools[i];
    const std::uint32_t end = tool.first_vertex + tool.vertex_count;
    for (std::uint32_t first = tool.first_vertex; first < end; first += v.spins[first]) {
      const std::uint32_t spins = v.spins[first];
      if (spins < 1 || spins > layout::kMaxSpins || spins > end - first) {
        return fault.fail("SPINS: vertex %: % spins, allowed 1 to % and no more than its tool has vertices", first, spins, layout::kMaxSpins);
      }
      several = several || spins > 1;
      for (std::uint32_t k = 1; k < spins; ++k) {
        if (v.spins[first + k] != 0) return fault.fail("SPINS: vertex %: is a later spin of the vertex before, its count must be 0", first + k);
        if (!is_spin(v.tool_vertices[first], v.tool_vertices[first + k], kFullTurn * k / spins)) {
          return fault.fail("SPINS: vertex %: is not vertex % rotated about its normal", first + k, first);
        }
      }
      const bool profile = tool.kind == static_cast<std::uint32_t>(layout::ToolKind::profile);
      if (spins > 1 && profile && !(v.tool_vertices[first].tangent[2] >= 0)) {
        return fault.fail("SPINS: vertex %: the z component of its tangent must not be negative", first);
      }
    }
  }
  for (std::uint32_t p = 0; p < v.meta->tool_patch_count; ++p) {
    for (const std::uint32_t corner : v.tool_patches[p].vertex) {
      if (corner < vertices && v.spins[corner] == 0) return fault.fail("TOOL_PATCHES: patch % names a later spin of a vertex", p);
    }
  }
  return several || fault.fail("SPINS: no vertex has more than one spin; the section must be absent");
}

inline bool check_tool(const View& v, std::uint32_t i, Fault& fault) {
  const layout::ToolRecord& t = v.tools[i];
  if (!is_text(t.name, sizeof t.name) || t.name[0] == 0) return fault.fail("TOOLS: tool %: its name must be 1 to 31 bytes and end with a zero", i);
  if (t.kind > 2) return fault.fail("TOOLS: tool %: kind %, allowed 0 to 2", i, t.kind);
  const float sizes[] = {t.radius, t.probe_radius, t.axis_length};
  for (const float s : sizes) {
    if (!(s >= 0 && s < 1e5f)) return fault.fail("TOOLS: tool %: lengths must be finite and not negative", i);
  }
  const auto kind = static_cast<layout::ToolKind>(t.kind);
  // Without an axis a pose does not determine the contact patch of such a tool.
  if (kind != layout::ToolKind::mesh && t.axis_length == 0 && t.vertex_count != 1) {
    return fault.fail("TOOLS: tool %: without an axis a sphere or profile has one vertex", i);
  }
  if (kind != layout::ToolKind::profile && t.axis_length != 0) {
    return fault.fail("TOOLS: tool %: only a profile has an axis", i);
  }
  if (kind == layout::ToolKind::mesh && t.probe_radius != 0) {
    return fault.fail("TOOLS: tool %: the probe radius of a mesh is 0", i);
  }
  const std::uint64_t end = std::uint64_t{t.first_patch} + t.patch_count;
  const bool patched = v.tool_patches != nullptr;
  if (patched ? t.patch_count == 0 || end > v.meta->tool_patch_count
              : t.patch_count != 0 || t.first_patch != 0 || t.vertex_count != 1) {
    return fault.fail("TOOLS: tool %: patches out of range", i);
  }
  float reached = -HUGE_VALF;  // meridian at the end of the segments so far
  for (std::uint64_t p = t.first_patch; patched && p < end; ++p) {
    const auto& corner = v.tool_patches[p].vertex;
    for (const std::uint32_t c : corner) {
      if (c < t.first_vertex || c - t.first_vertex >= t.vertex_count) {
        return fault.fail("TOOL_PATCHES: patch % names a vertex of another tool", p);
      }
    }
    if (kind != layout::ToolKind::profile) continue;
    const float low = v.tool_vertices[corner[0]].meridian, high = v.tool_vertices[corner[1]].meridian;
    if (low > high || low < reached) {
      return fault.fail("TOOL_PATCHES: patch %: a profile's segments must ascend", p);
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
      return fault.fail("TOOL_VERTICES: vertex %: point, frame, meridian or name is wrong", i);
    }
  }
  for (std::uint32_t i = 0; i < v.meta->tool_count; ++i) {
    const layout::ToolRecord& t = v.tools[i];
    if (t.first_vertex != vertices || t.vertex_count == 0 || t.first_patch != patches) {
      return fault.fail("TOOLS: tool %: vertices and patches must follow those of the tool before", i);
    }
    vertices += t.vertex_count;
    patches += t.patch_count;
    if (vertices > v.meta->tool_vertex_count) return fault.fail("TOOLS: tool %: vertices out of range", i);
    if (!check_tool(v, i, fault)) return false;
  }
  if (vertices != v.meta->tool_vertex_count || patches != v.meta->tool_patch_count) {
    return fault.fail("TOOLS: vertices or patches belong to no tool");
  }
  return true;
}

/// Checks the numbers of COMPLIANCE and COMPLIANCE_SITES. The bounds keep every compliance finite.
inline bool check_compliance(const View& v, Fault& fault) {
  if (v.compliance == nullptr) return true;
  const layout::ComplianceHead& head = *v.compliance;
  if (head.negative > head.modes) return fault.fail("COMPLIANCE: % of % modes are negative", head.negative, head.modes);
  if (!(head.poisson >= 0 && head.poisson < 0.5))
    return fault.fail("COMPLIANCE: poisson must be at least 0 and below 0.5");
  if (!(head.rounding >= 1e-9 && head.rounding < 1e3)) {
    return fault.fail("COMPLIANCE: rounding must be at least 1e-9 and below 1000 m");
  }
  if (!(head.stiffening >= 0 && head.stiffening <= 1)) {
    return fault.fail("COMPLIANCE: stiffening must be at least 0 and at most 1");
  }
  for (const std::uint32_t r : head.reserved) {
    if (r != 0) return fault.fail("COMPLIANCE: reserved bytes are not zero");
  }
  for (std::uint32_t i = 0; i < v.meta->site_count; ++i) {
    const layout::ComplianceSite& site = v.compliance_site(i);
    if (!(site.shear >= 1e-6f && site.shear < 1e15f)) {
      return fault.fail("COMPLIANCE_SITES: site %: shear must be at least 1e-6 and below 1e15 Pa", i);
    }
    if (!(site.unit >= 0 && site.unit < 1e6f)) {
      return fault.fail("COMPLIANCE_SITES: site %: unit must be at least 0 and below 1e6", i);
    }
  }
  return true;
}

template <std::uint32_t kFeatures>
bool check_records(const View& v, Fault& fault) {
  if (v.provenance_size < 2 || v.provenance[0] != '{' || v.provenance[v.provenance_size - 1] != '}') {
    return fault.fail("PROVENANCE: not a JSON object");
  }
  if (!check_sites(v, fault) || !check_surface(v, fault) || !check_tools(v, fault)) return false;
  if constexpr ((kFeatures & layout::feature_spin) != 0) {
    if (v.spins != nullptr && !check_spins(v, fault)) return false;
  }
  if (!check_responses<kFeatures>(v, fault)) return false;
  if constexpr ((kFeatures & layout::feature_bonded) != 0) {
    if (!check_bonded_contacts(v, fault)) return false;
  }
  if constexpr ((kFeatures & layout::feature_compliance) != 0) {
    if (!check_compliance(v, fault)) return false;
  }
  if constexpr ((kFeatures & layout::feature_search) != 0) return check_search(v, fault);
  return true;
}

}  // namespace palpate::runtime::detail
