// SPDX-License-Identifier: MIT
// Opens a response file: checks header, table of contents and META here, the records in validate.hpp.
#pragma once

#include "palpate/format/checksum.hpp"
#include "palpate/format/response_view.hpp"
#include "palpate/format/validate.hpp"

#include <initializer_list>

namespace palpate::runtime {
namespace detail {

using layout::Section;

inline bool check_header(const View& v, bool trusted, Fault& fault) {
  if (reinterpret_cast<std::uintptr_t>(v.bytes) % 8 != 0) return fault.fail("the buffer is not aligned to 8 bytes");
  if (v.size < sizeof(layout::FileHeader)) {
    return fault.fail("truncated: % bytes, the header alone has %", v.size, sizeof(layout::FileHeader));
  }
  const layout::FileHeader& h = v.header();
  for (int k = 0; k < 8; ++k) {
    if (h.magic[k] != layout::kMagic[k])
      return fault.fail("not a Palpate response file: the first bytes are not PALPATE");
  }
  // No version number is that large, so its bytes are reversed.
  if (h.version != 0 && (h.version & 0xffff) == 0) {
    return fault.fail("wrong byte order: response files are little-endian, this file is big-endian");
  }
  if (h.version != layout::kVersion) {
    return fault.fail(
        "version %; this reader reads version %: %", h.version, layout::kVersion,
        h.version < layout::kVersion ? "make it again with `palpate build SCENE`" : "a newer Palpate wrote it");
  }
  if (h.file_size != v.size) {
    return fault.fail("%: the header gives % bytes, the file has %", h.file_size > v.size ? "truncated" : "trailing bytes",
                     h.file_size, v.size);
  }
  if (v.size % layout::kAlignment != 0) return fault.fail("% bytes, not a multiple of 64", v.size);
  const std::uint64_t table =
      sizeof(layout::FileHeader) + std::uint64_t{h.section_count} * sizeof(layout::SectionEntry);
  if (h.section_count > layout::kMaxSections || table > v.size)
    return fault.fail("section count %, allowed at most 32 and as many as the file has room for", h.section_count);
  if (!trusted && checksum::of_file(v.bytes, v.size, offsetof(layout::FileHeader, checksum)) != h.checksum) {
    return fault.fail("damaged: the checksum does not match the bytes");
  }
  if ((h.features & ~layout::feature_all) != 0) return fault.fail("unknown feature bits %", Bits{h.features});
  for (const std::uint32_t r : h.reserved) {
    if (r != 0) return fault.fail("reserved header bytes are not zero");
  }
  return true;
}

inline bool check_table(const View& v, const layout::SectionEntry* (&entry)[layout::kSectionIds], Fault& fault) {
  std::uint64_t end = sizeof(layout::FileHeader) + v.header().section_count * sizeof(layout::SectionEntry);
  std::uint32_t last = 0;
  for (std::uint32_t i = 0; i < v.header().section_count; ++i) {
    const layout::SectionEntry& e = v.sections()[i];
    if (e.id <= last || e.id >= layout::kSectionIds)
      return fault.fail("table of contents: entry % has section id %", i, e.id);
    const char* name = layout::section_name(e.id);
    if (e.offset % layout::kAlignment != 0) return fault.fail("section % is not aligned to 64 bytes", name);
    if (e.offset < end || e.offset > v.size || e.size > v.size - e.offset) {
      return fault.fail("section % lies outside the file or over another", name);
    }
    if (e.element_size == 0 || e.count == 0 || e.count > layout::kMaxCount || e.size != e.count * e.element_size) {
      return fault.fail("section %: size is not count times element size", name);
    }
    end = e.offset + e.size;
    last = e.id;
    entry[e.id] = &e;
  }
  return true;
}

inline bool check_meta(const layout::Meta& m, Fault& fault) {
  if (!(m.depth_scale >= 1e-9 && m.depth_scale < 1e3)) {
    return fault.fail("META: depth_scale must be at least 1e-9 and below 1000 m");
  }
  const bool friction = layout::has_friction(m);
  if (!(m.tangential_scale == 0) && !(m.tangential_scale >= 1e-9 && m.tangential_scale < 1e3)) {
    return fault.fail("META: tangential_scale must be at least 1e-9 and below 1000 m with friction, 0 without");
  }
  if (const char* broken = response::broken_degree(response::degrees(m))) {
    return fault.fail("META: degrees %, %, %, % (normal, bias, stiffness, friction): %", m.normal_degree, m.bias_degree,
                      m.stiffness_degree, m.friction_degree, broken);
  }
  if (m.coef_bits != 8 && m.coef_bits != 12 && m.coef_bits != 16) {
    return fault.fail("META: % bits a coefficient, allowed 8, 12 or 16", m.coef_bits);
  }
  if (m.bonded_coefs != 0 && (m.bonded_coefs < layout::kMinCoefs || m.bonded_coefs > layout::kMaxCoefs)) {
    return fault.fail("META: % coefficients of a curve of BONDED, allowed 4 to 32 or 0", m.bonded_coefs);
  }
  if (m.subdivision < 1 || m.subdivision > layout::kMaxSubdivision) {
    return fault.fail("META: subdivision %, allowed 1 to 255", m.subdivision);
  }
  if (m.response_count != std::uint64_t{m.site_count} * m.tool_vertex_count) {
    return fault.fail("META: response count % is not % sites times % tool vertices", m.response_count, m.site_count,
                      m.tool_vertex_count);
  }
  if (m.softening_count > (friction ? 1u : 0u)) {
    return fault.fail("META: softening_count %, allowed 0 or 1 with friction, 0 without", m.softening_count);
  }
  if (m.vertex_count < m.site_count) return fault.fail("META: % vertices for % sites", m.vertex_count, m.site_count);
  if (m.index_bytes != layout::index_bytes(m)) {
    return fault.fail("META: indices of % bytes, the counts need %", m.index_bytes, layout::index_bytes(m));
  }
  const float(&origin)[3] = m.search_grid.origin;
  const bool grid = in_range(origin) && m.search_grid.unit > 0 && m.search_grid.unit < 1e5f;
  const bool no_grid = origin[0] == 0 && origin[1] == 0 && origin[2] == 0 && m.search_grid.unit == 0;
  if (!(m.search_nodes > 0 ? grid : no_grid)) {
    return fault.fail("META: the search grid is out of range, or there without a search tree");
  }
  for (const std::uint32_t r : m.reserved) {
    if (r != 0) return fault.fail("META: reserved bytes are not zero");
  }
  return true;
}

/// The feature bits that the header's and META's numbers imply.
inline std::uint32_t implied_features(const View& v) {
  const layout::Meta& m = *v.meta;
  const struct {
    bool present;
    layout::Feature feature;
  } parts[] = {{m.bias_degree > 0, layout::feature_tangential_bias},
               {layout::has_friction(m), layout::feature_friction},
               {m.tool_patch_count > 0, layout::feature_tool_patches},
               {m.search_nodes > 0, layout::feature_search},
               {m.bonded_coefs > 0, layout::feature_bonded},
               {v.has(layout::feature_bonded_torque), layout::feature_bonded_torque},
               {v.has(layout::feature_spin), layout::feature_spin},
               {m.softening_count > 0, layout::feature_slip_softening},
               {v.has(layout::feature_compliance), layout::feature_compliance}};
  std::uint32_t features = 0;
  for (const auto& part : parts) {
    if (part.present) features |= part.feature;
  }
  return features;
}

/// Checks what one section needs of another. Writes the number of modes of COMPLIANCE, 0 without it: the size of an
/// element of COMPLIANCE_SITES follows from it.
inline bool check_companions(const View& v, const layout::SectionEntry* compliance, std::uint32_t& modes, Fault& fault) {
  if (v.has(layout::feature_spin) && !v.has(layout::feature_tool_patches)) {
    return fault.fail("section SPINS without TOOL_VERTICES");
  }
  if (v.has(layout::feature_bonded_torque) && v.meta->bonded_coefs == 0) {
    return fault.fail("section BONDED_TORQUE without BONDED");
  }
  if (compliance == nullptr || compliance->size != sizeof(layout::ComplianceHead)) return true;  // refused by its size
  modes = reinterpret_cast<const layout::ComplianceHead*>(v.bytes + compliance->offset)->modes;
  return (modes <= layout::kMaxModes && modes % layout::kModeStep == 0) ||
         fault.fail("COMPLIANCE: % modes, allowed a multiple of 8 up to 128", modes);
}

/// Checks that exactly the sections that META implies are present, each of the implied size, and binds them.
inline bool bind_sections(View& v, const layout::SectionEntry* const (&entry)[layout::kSectionIds], Fault& fault) {
  const layout::Meta& m = *v.meta;
  const bool patched = v.has(layout::feature_tool_patches), spun = v.has(layout::feature_spin);
  const bool bonded = m.bonded_coefs > 0, torque = v.has(layout::feature_bonded_torque);
  const bool shared = v.has(layout::feature_compliance);
  std::uint32_t modes = 0;
  if (!check_companions(v, entry[static_cast<std::uint32_t>(Section::compliance)], modes, fault)) return false;
  const struct {
    Section id;
    std::uint64_t element, count;
  } expected[] = {{Section::meta, sizeof(layout::Meta), 1},
                  {Section::sites, sizeof(layout::Site), m.site_count},
                  {Section::surface_vertices, sizeof(layout::Point), m.vertex_count},
                  {Section::surface_triangles, layout::triangle_size(m.index_bytes), m.triangle_count},
                  {Section::surface_patches, layout::patch_size(m.index_bytes), m.patch_count},
                  {Section::tools, sizeof(layout::ToolRecord), m.tool_count},
                  {Section::tool_vertices, sizeof(layout::ToolVertexRecord), patched ? m.tool_vertex_count : 0},
                  {Section::tool_patches, sizeof(layout::ToolPatch), m.tool_patch_count},
                  {Section::spins, sizeof(std::uint32_t), spun ? m.tool_vertex_count : 0},
                  {Section::responses, layout::response_size(m), m.response_count},
                  {Section::bonded, layout::bonded_size(m.bonded_coefs), bonded ? m.response_count : 0},
                  {Section::bonded_torque, layout::torque_size(m.bonded_coefs), torque ? m.response_count : 0},
                  {Section::search, sizeof(layout::SearchNode), m.search_nodes},
                  {Section::compliance, sizeof(layout::ComplianceHead), shared ? 1u : 0u},
                  {Section::compliance_sites, layout::compliance_site_size(modes), shared ? m.site_count : 0}};
  const unsigned char* at[layout::kSectionIds] = {};
  for (const auto& want : expected) {
    const auto id = static_cast<std::uint32_t>(want.id);
    const layout::SectionEntry* e = entry[id];
    if (want.count == 0 && e != nullptr)
      return fault.fail("section % must be absent in this file", layout::section_name(id));
    if (want.count == 0) continue;
    if (e == nullptr) return fault.fail("section % is missing", layout::section_name(id));
    if (e->element_size != want.element || e->count != want.count) {
      return fault.fail("section %: % elements of % bytes, expected % of %", layout::section_name(id), e->count,
                       e->element_size, want.count, want.element);
    }
    at[id] = v.bytes + e->offset;
  }
  const auto* text = entry[static_cast<std::uint32_t>(Section::provenance)];
  if (text == nullptr || text->element_size != 1) return fault.fail("section PROVENANCE is missing");
  const std::uint32_t features = implied_features(v);
  if (features != v.features) return fault.fail("feature bits %, the sections and META imply %", Bits{v.features}, Bits{features});
  for (const Section id : {Section::sites, Section::surface_vertices, Section::surface_triangles,
                           Section::surface_patches, Section::tools, Section::responses}) {
    if (at[static_cast<std::uint32_t>(id)] == nullptr) {
      return fault.fail("META: sites, surface, tools and responses must not be empty");
    }
  }
  const auto bind = [&](auto& to, Section id) {
    to = reinterpret_cast<std::remove_reference_t<decltype(to)>>(at[static_cast<std::uint32_t>(id)]);
  };
  bind(v.sites, Section::sites);
  bind(v.vertices, Section::surface_vertices);
  bind(v.triangles, Section::surface_triangles);
  bind(v.patches, Section::surface_patches);
  v.small_indices = m.index_bytes == 2;
  bind(v.tools, Section::tools);
  bind(v.tool_vertices, Section::tool_vertices);
  bind(v.tool_patches, Section::tool_patches);
  bind(v.spins, Section::spins);
  bind(v.responses, Section::responses);
  bind(v.bonded, Section::bonded);
  bind(v.bonded_torque, Section::bonded_torque);
  bind(v.search, Section::search);
  v.search_grid = m.search_grid;
  bind(v.compliance, Section::compliance);
  bind(v.compliance_sites, Section::compliance_sites);
  v.response_size = layout::response_size(m);
  v.head_size = layout::response_head_size(m);
  v.provenance = reinterpret_cast<const char*>(v.bytes + text->offset);
  v.provenance_size = static_cast<std::size_t>(text->size);
  return true;
}

/// Refuses a file with a feature that the program leaves out.
inline bool check_features(std::uint32_t held, std::uint32_t known, Fault& fault) {
  for (std::uint32_t bit = 0; (1u << bit) <= layout::feature_all; ++bit) {
    if ((held & ~known & (1u << bit)) == 0) continue;
    return fault.fail("the file has %, which this program leaves out",
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
  if (meta == nullptr || meta->size != sizeof(layout::Meta)) return fault.fail("section META is missing");
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
