// SPDX-License-Identifier: MIT
// Opening a response file: header, table of contents and scales; the records are checked in validate_records.hpp.
#pragma once

#include "palpate/checksum.hpp"
#include "palpate/validate_records.hpp"
#include "palpate/view.hpp"

#include <initializer_list>

namespace palpate::runtime {
namespace detail {

using layout::Section;

inline bool check_header(const View& v, bool trusted, Fault& fault) {
  if (reinterpret_cast<std::uintptr_t>(v.bytes) % 8 != 0) return fault.say("the buffer is not aligned to 8 bytes");
  if (v.size < sizeof(layout::FileHeader)) {
    return fault.say("truncated: % bytes, the header alone has %", v.size, sizeof(layout::FileHeader));
  }
  const layout::FileHeader& h = v.header();
  for (int k = 0; k < 8; ++k) {
    if (h.magic[k] != layout::kMagic[k])
      return fault.say("not a Palpate response file: the first bytes are not PALPATE");
  }
  // No version has so many: its bytes are the other way round.
  if (h.version != 0 && (h.version & 0xffff) == 0) {
    return fault.say("of the other byte order: response files and those who read them are little-endian");
  }
  if (h.version != layout::kVersion) {
    return fault.say("version %, this reader knows %: fit its scene again (palpate fit)", h.version, layout::kVersion);
  }
  if (h.file_size != v.size) {
    return fault.say("%: the header says % bytes, there are %", h.file_size > v.size ? "truncated" : "trailing bytes",
                     h.file_size, v.size);
  }
  if (v.size % layout::kAlignment != 0) return fault.say("% bytes, not a multiple of 64", v.size);
  const std::uint64_t table =
      sizeof(layout::FileHeader) + std::uint64_t{h.section_count} * sizeof(layout::SectionEntry);
  if (h.section_count > layout::kMaxSections || table > v.size)
    return fault.say("impossible section count %", h.section_count);
  if (!trusted && checksum::of_file(v.bytes, v.size, offsetof(layout::FileHeader, checksum)) != h.checksum) {
    return fault.say("damaged: the checksum does not match");
  }
  if ((h.features & ~layout::feature_all) != 0) return fault.say("unknown feature bits %", Bits{h.features});
  for (const std::uint32_t r : h.reserved) {
    if (r != 0) return fault.say("reserved header bytes are not zero");
  }
  return true;
}

inline bool check_table(const View& v, const layout::SectionEntry* (&entry)[layout::kSectionIds], Fault& fault) {
  std::uint64_t end = sizeof(layout::FileHeader) + v.header().section_count * sizeof(layout::SectionEntry);
  std::uint32_t last = 0;
  for (std::uint32_t i = 0; i < v.header().section_count; ++i) {
    const layout::SectionEntry& e = v.sections()[i];
    if (e.id <= last || e.id >= layout::kSectionIds)
      return fault.say("table of contents: entry % has section id %", i, e.id);
    const char* name = layout::section_name(e.id);
    if (e.offset % layout::kAlignment != 0) return fault.say("section % is not aligned to 64 bytes", name);
    if (e.offset < end || e.offset > v.size || e.size > v.size - e.offset) {
      return fault.say("section % lies outside the file or over another", name);
    }
    if (e.element_size == 0 || e.count == 0 || e.count > layout::kMaxCount || e.size != e.count * e.element_size) {
      return fault.say("section %: size is not count times element size", name);
    }
    end = e.offset + e.size;
    last = e.id;
    entry[e.id] = &e;
  }
  return true;
}

inline bool check_meta(const layout::Meta& m, Fault& fault) {
  if (!(m.depth_scale >= 1e-9 && m.depth_scale < 1e3))
    return fault.say("META: depth scale must be at least 1e-9 and below 1000 m");
  const bool coupled = layout::is_coupled(m);
  if (m.model != static_cast<std::uint32_t>(layout::Model::separable) && !coupled)
    return fault.say("META: unknown model %", m.model);
  const std::uint32_t degrees[] = {m.order,        m.push_degree,    m.straight_degree, m.stiffness_degree,
                                   m.cubic_degree, m.quartic_degree, m.limit_degree};
  for (const std::uint32_t d : degrees) {
    if (!coupled && d != 0) return fault.say("META: degrees of the coupled model in a file of another");
  }
  if (coupled && !coupled::in_range(layout::coupled_degrees(m))) {
    return fault.say("META: degrees of the coupled model out of range");
  }
  const bool friction = m.friction_coefs > 0;
  if (!(friction || coupled ? m.sideways_scale >= 1e-9 && m.sideways_scale < 1e3 : m.sideways_scale == 0)) {
    return fault.say("META: sideways scale must be at least 1e-9 and below 1000 m with friction, 0 without");
  }
  const struct {
    std::uint32_t count;
    bool wanted;
    const char* name;
  } families[] = {{m.normal_coefs, !coupled, "normal"},
                  {m.lateral_coefs, !coupled && m.lateral_coefs > 0, "lateral"},
                  {m.growth_coefs, !coupled && friction, "growth"},
                  {m.sideways_coefs, !coupled && friction, "sideways"},
                  {m.friction_coefs, !coupled && friction, "friction"},
                  {m.grasp_coefs, m.grasp_coefs > 0, "grasp"}};
  for (const auto& f : families) {
    if (f.wanted ? f.count < layout::kMinCoefs || f.count > layout::kMaxCoefs : f.count != 0) {
      return fault.say("META: % % coefficients, allowed 4 to 32 or, where left out, 0", f.count, f.name);
    }
  }
  if (m.subdivision < 1 || m.subdivision > layout::kMaxSubdivision)
    return fault.say("META: subdivision %, allowed 1 to 1024", m.subdivision);
  if (m.response_count != std::uint64_t{m.site_count} * m.tool_vertex_count) {
    return fault.say("META: response count is not sites times tool vertices");
  }
  const bool rim = m.rim_share > 0 && m.rim_share < 1 && m.rim_limit > 0 && m.rim_limit < 1;
  if (rim ? !friction && !coupled : !(m.rim_share == 0 && m.rim_limit == 0)) {
    return fault.say("META: share and limit of the rim are not both 0 or, in a file with friction, in (0, 1)");
  }
  if (coupled ? m.coef_bits != 8 && m.coef_bits != 12 && m.coef_bits != 16 : m.coef_bits != 0) {
    return fault.say("META: % bits a coefficient, allowed 8, 12 or 16 in a coupled file, else 0", m.coef_bits);
  }
  if (m.relief_count > (friction || coupled ? 1u : 0u)) {
    return fault.say("META: % reliefs a response, allowed 1 in a file with friction, else 0", m.relief_count);
  }
  if (m.reserved != 0) return fault.say("META: reserved bytes are not zero");
  return true;
}

/// Every section that the scales and counts ask for, of the size they ask for; no other.
inline bool bind_sections(View& v, const layout::SectionEntry* const (&entry)[layout::kSectionIds], Fault& fault) {
  const layout::Meta& m = *v.meta;
  const bool patched = v.has(layout::feature_tool_patches), spun = v.has(layout::feature_spin);
  const bool held = m.grasp_coefs > 0, turned = v.has(layout::feature_turn);
  if (spun && !patched) return fault.say("section SPINS without TOOL_VERTICES");
  if (turned && !held) return fault.say("section TURN without GRASP");
  const struct {
    Section id;
    std::uint64_t element, count;
  } expected[] = {{Section::meta, sizeof(layout::Meta), 1},
                  {Section::sites, sizeof(layout::Site), m.site_count},
                  {Section::surface_vertices, sizeof(layout::Point), m.vertex_count},
                  {Section::surface_triangles, sizeof(layout::SurfaceTriangle), m.triangle_count},
                  {Section::tools, sizeof(layout::ToolRecord), m.tool_count},
                  {Section::tool_vertices, sizeof(layout::ToolVertexRecord), patched ? m.tool_vertex_count : 0},
                  {Section::tool_patches, sizeof(layout::ToolPatch), m.tool_patch_count},
                  {Section::spins, sizeof(std::uint32_t), spun ? m.tool_vertex_count : 0},
                  {Section::responses, layout::response_size(m), m.response_count},
                  {Section::grasp, layout::grasp_size(m.grasp_coefs), held ? m.response_count : 0},
                  {Section::turn, layout::turn_size(m.grasp_coefs), turned ? m.response_count : 0},
                  {Section::search, sizeof(layout::SearchNode), m.search_nodes}};
  const unsigned char* at[layout::kSectionIds] = {};
  for (const auto& want : expected) {
    const auto id = static_cast<std::uint32_t>(want.id);
    const layout::SectionEntry* e = entry[id];
    if (want.count == 0 && e != nullptr)
      return fault.say("section % must be absent in this file", layout::section_name(id));
    if (want.count == 0) continue;
    if (e == nullptr) return fault.say("section % is missing", layout::section_name(id));
    if (e->element_size != want.element || e->count != want.count) {
      return fault.say("section %: % elements of % bytes, expected % of %", layout::section_name(id), e->count,
                       e->element_size, want.count, want.element);
    }
    at[id] = v.bytes + e->offset;
  }
  const auto* text = entry[static_cast<std::uint32_t>(Section::provenance)];
  if (text == nullptr || text->element_size != 1) return fault.say("section PROVENANCE is missing");
  const struct {
    bool present;
    layout::Feature feature;
  } parts[] = {{m.lateral_coefs + m.straight_degree > 0, layout::feature_lateral},
               {m.friction_coefs > 0 || layout::is_coupled(m), layout::feature_friction},
               {m.tool_patch_count > 0, layout::feature_tool_patches},
               {m.search_nodes > 0, layout::feature_search},
               {layout::is_coupled(m), layout::feature_coupled},
               {held, layout::feature_grasp},
               {turned, layout::feature_turn},
               {m.rim_share > 0, layout::feature_rim},
               {spun, layout::feature_spin},
               {m.relief_count > 0, layout::feature_relief}};
  std::uint32_t features = 0;
  for (const auto& part : parts)
    if (part.present) features |= part.feature;
  if (features != v.features) return fault.say("feature bits % do not fit the sections present", Bits{v.features});
  for (const Section id :
       {Section::sites, Section::surface_vertices, Section::surface_triangles, Section::tools, Section::responses}) {
    if (at[static_cast<std::uint32_t>(id)] == nullptr) {
      return fault.say("META: sites, surface, tools and responses must not be empty");
    }
  }
  const auto bind = [&](auto& to, Section id) {
    to = reinterpret_cast<std::remove_reference_t<decltype(to)>>(at[static_cast<std::uint32_t>(id)]);
  };
  bind(v.sites, Section::sites);
  bind(v.vertices, Section::surface_vertices);
  bind(v.triangles, Section::surface_triangles);
  bind(v.tools, Section::tools);
  bind(v.tool_vertices, Section::tool_vertices);
  bind(v.tool_patches, Section::tool_patches);
  bind(v.spins, Section::spins);
  bind(v.responses, Section::responses);
  bind(v.grasps, Section::grasp);
  bind(v.turns, Section::turn);
  bind(v.search, Section::search);
  v.response_size = layout::response_size(m);
  v.head_size = layout::response_head_size(m);
  v.coupled = layout::is_coupled(m);
  v.provenance = reinterpret_cast<const char*>(v.bytes + text->offset);
  v.provenance_size = static_cast<std::size_t>(text->size);
  return true;
}

/// The features that a program leaves out are not in the file.
inline bool check_features(std::uint32_t held, std::uint32_t known, Fault& fault) {
  for (std::uint32_t bit = 0; (1u << bit) <= layout::feature_all; ++bit) {
    if ((held & ~known & (1u << bit)) == 0) continue;
    return fault.say("the file has %, which this program leaves out",
                     layout::feature_name(static_cast<layout::Feature>(1u << bit)));
  }
  return true;
}

template <std::uint32_t kFeatures>
bool open_checked(View& v, bool trusted, Fault& fault) {
  const layout::SectionEntry* entry[layout::kSectionIds] = {};
  if (!check_header(v, trusted, fault)) return false;
  v.features = v.header().features;
  if (!check_features(v.features, kFeatures, fault) || !check_table(v, entry, fault)) return false;
  const layout::SectionEntry* meta = entry[static_cast<std::uint32_t>(Section::meta)];
  if (meta == nullptr || meta->size != sizeof(layout::Meta)) return fault.say("section META is missing");
  v.meta = reinterpret_cast<const layout::Meta*>(v.bytes + meta->offset);
  return check_meta(*v.meta, fault) && bind_sections(v, entry, fault) &&
         (trusted || check_records<kFeatures>(v, fault));
}

template <std::uint32_t kFeatures>
OpenResult open(const void* data, std::size_t size, bool trusted) {
  OpenResult result;
  View v;
  v.bytes = static_cast<const unsigned char*>(data);
  v.size = data == nullptr ? 0 : size;
  Fault fault{result.error, sizeof result.error};
  result.ok = open_checked<kFeatures>(v, trusted, fault);
  if (result.ok) result.view = v;
  return result;
}

}  // namespace detail

template <std::uint32_t kFeatures>
OpenResult View::open(const void* data, std::size_t size) {
  return detail::open<kFeatures>(data, size, false);
}

template <std::uint32_t kFeatures>
OpenResult View::open_trusted(const void* data, std::size_t size) {
  return detail::open<kFeatures>(data, size, true);
}

}  // namespace palpate::runtime
