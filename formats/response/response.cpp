// SPDX-License-Identifier: MIT
// From a response file's content to its bytes.
#include "formats/response/response.hpp"

#include "formats/response/response_check.hpp"
#include "palpate/format/checksum.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

namespace palpate {
namespace {

using layout::Section;

void put(float (&to)[3], const Triple& from) {
  for (int k = 0; k < 3; ++k) to[k] = static_cast<float>(from[k]);
}

template <std::size_t Size>
void put(char (&to)[Size], const std::string& from) {
  std::memset(to, 0, Size);
  std::memcpy(to, from.data(), std::min(from.size(), Size - 1));
}

// Sections in ascending order of id; each is bytes and the size of one of its elements.
class Sections {
public:
  template <class Record>
  void add(Section id, const std::vector<Record>& records) {
    add(id, records.data(), sizeof(Record), records.size());
  }
  void add(Section id, const void* data, std::size_t element, std::size_t count) {
    if (count == 0) return;
    Body& body = bodies_[static_cast<std::uint32_t>(id)];
    body.element = static_cast<std::uint32_t>(element);
    body.bytes.resize(element * count);
    std::memcpy(body.bytes.data(), data, body.bytes.size());
  }

  [[nodiscard]] std::vector<std::byte> assemble(std::uint32_t features) const {
    const auto align = [](std::uint64_t at) {
      return (at + layout::kAlignment - 1) / layout::kAlignment * layout::kAlignment;
    };
    std::vector<layout::SectionEntry> table;
    std::uint64_t end = align(sizeof(layout::FileHeader) + bodies_.size() * sizeof(layout::SectionEntry));
    for (const auto& [id, body] : bodies_) {
      table.push_back({id, body.element, end, body.bytes.size(), body.bytes.size() / body.element});
      end = align(end + body.bytes.size());
    }
    layout::FileHeader header{};
    std::copy(std::begin(layout::kMagic), std::end(layout::kMagic), header.magic);
    header.version = layout::kVersion;
    header.section_count = static_cast<std::uint32_t>(table.size());
    header.file_size = end;
    header.features = features;
    std::vector<std::byte> file(end);
    std::memcpy(file.data(), &header, sizeof header);
    std::memcpy(file.data() + sizeof header, table.data(), table.size() * sizeof(layout::SectionEntry));
    for (const auto& entry : table) {
      std::memcpy(file.data() + entry.offset, bodies_.at(entry.id).bytes.data(), entry.size);
    }
    const std::uint64_t sum = checksum::of_file(reinterpret_cast<const unsigned char*>(file.data()), file.size(),
                                                offsetof(layout::FileHeader, checksum));
    std::memcpy(file.data() + offsetof(layout::FileHeader, checksum), &sum, sizeof sum);
    return file;
  }

private:
  struct Body {
    std::uint32_t element = 1;
    std::vector<std::byte> bytes;
  };
  std::map<std::uint32_t, Body> bodies_;
};

bool has_tool_patches(const ResponseFileContent& c) {
  return std::any_of(c.tools.begin(), c.tools.end(), [](const ResponseTool& t) { return t.vertices.size() > 1; });
}

std::vector<layout::ToolPatch> patch_records(const std::vector<std::array<std::uint32_t, 3>>& patches,
                                             std::uint32_t first) {
  std::vector<layout::ToolPatch> records;
  for (const auto& p : patches) records.push_back({{first + p[0], first + p[1], first + p[2]}});
  return records;
}

template <class Index>
void add_body(Sections& sections, const ResponseFileContent& c) {
  std::vector<layout::Site> sites;
  for (const ResponseSite& s : c.sites) {
    layout::Site record{};
    put(record.normal, s.normal);
    put(record.tangent, s.tangent);
    record.depth_limit = static_cast<float>(s.depth_limit);
    record.flags = s.flags;
    sites.push_back(record);
  }
  std::vector<layout::Point> points(c.surface_vertices.size());
  for (std::size_t i = 0; i < points.size(); ++i) put(points[i].xyz, c.surface_vertices[i]);
  const auto across = detail::neighbours(c);
  const std::size_t triangle = layout::triangle_size(sizeof(Index)), patch = layout::patch_size(sizeof(Index));
  std::vector<unsigned char> triangles(triangle * c.surface_triangles.size()), patches(patch * c.patches.size());
  for (std::size_t i = 0; i < c.surface_triangles.size(); ++i) {
    const ResponseTriangle& t = c.surface_triangles[i];
    layout::SurfaceTriangle record{};
    for (int k = 0; k < 3; ++k) {
      record.vertex[k] = t.vertices[k];
      record.neighbour[k] = across[i][k];
      record.grid[k][0] = t.grid[k][0];
      record.grid[k][1] = t.grid[k][1];
    }
    record.patch = t.patch;
    layout::pack_triangle<Index>(record, triangles.data() + i * triangle);
  }
  for (std::size_t i = 0; i < c.patches.size(); ++i) {
    const std::uint32_t sites_of_patch[] = {c.patches[i][0], c.patches[i][1], c.patches[i][2]};
    layout::pack_patch<Index>(sites_of_patch, patches.data() + i * patch);
  }
  sections.add(Section::sites, sites);
  sections.add(Section::surface_vertices, points);
  sections.add(Section::surface_triangles, triangles.data(), triangle, c.surface_triangles.size());
  sections.add(Section::surface_patches, patches.data(), patch, c.patches.size());
  sections.add(Section::search, c.search);
}

bool has_spins(const ResponseFileContent& c) {
  return std::any_of(c.tools.begin(), c.tools.end(), [](const ResponseTool& t) {
    return std::any_of(t.vertices.begin(), t.vertices.end(), [](const auto& v) { return v.spins != 1; });
  });
}

void add_tools(Sections& sections, const ResponseFileContent& c, layout::Meta& meta) {
  std::vector<layout::ToolRecord> tools;
  std::vector<layout::ToolVertexRecord> vertices;
  std::vector<layout::ToolPatch> patches;
  std::vector<std::uint32_t> spins;
  const bool patched = has_tool_patches(c);
  for (const ResponseTool& t : c.tools) {
    layout::ToolRecord record{};
    put(record.name, t.name);
    record.kind = static_cast<std::uint32_t>(t.kind);
    record.first_vertex = meta.tool_vertex_count;
    record.vertex_count = static_cast<std::uint32_t>(t.vertices.size());
    record.radius = static_cast<float>(t.radius);
    record.probe_radius = static_cast<float>(t.probe_radius);
    record.axis_length = static_cast<float>(t.axis_length);
    meta.tool_vertex_count += record.vertex_count;
    if (patched) {
      record.first_patch = static_cast<std::uint32_t>(patches.size());
      const std::vector<std::array<std::uint32_t, 3>> single{{0, 0, 0}};
      const auto own = patch_records(t.patches.empty() ? single : t.patches, record.first_vertex);
      record.patch_count = static_cast<std::uint32_t>(own.size());
      patches.insert(patches.end(), own.begin(), own.end());
      for (const ResponseToolVertex& v : t.vertices) {
        layout::ToolVertexRecord vertex{};
        put(vertex.point, v.point);
        put(vertex.normal, v.normal);
        put(vertex.tangent, v.tangent);
        vertex.meridian = static_cast<float>(v.meridian);
        put(vertex.name, v.name);
        vertices.push_back(vertex);
        spins.push_back(v.spins);
      }
    }
    tools.push_back(record);
  }
  meta.tool_count = static_cast<std::uint32_t>(tools.size());
  meta.tool_patch_count = static_cast<std::uint32_t>(patches.size());
  sections.add(Section::tools, tools);
  sections.add(Section::tool_vertices, vertices);
  sections.add(Section::tool_patches, patches);
  if (has_spins(c)) sections.add(Section::spins, spins);
}

void put_coefficients(std::byte* law, const ResponseFileContent& c, const Response& r) {
  const std::uint32_t bits = c.coef_bits;
  const response::Offsets offsets = response::offsets(c.degrees);
  const auto before = static_cast<std::size_t>(offsets.friction);
  std::memcpy(law, &r.unit, sizeof r.unit);
  for (std::size_t bit = 0; bit < before * bits; ++bit) {
    const bool set = (static_cast<std::uint16_t>(r.coefficients[bit / bits]) >> bit % bits & 1) != 0;
    if (set) law[sizeof r.unit + bit / 8] |= std::byte{1} << bit % 8;
  }
  if (r.coefficients.size() > before) {
    std::memcpy(law + layout::friction_offset(offsets, bits), r.coefficients.data() + before,
                (r.coefficients.size() - before) * sizeof(std::int16_t));
  }
}

void add_compliance(Sections& sections, const ResponseCompliance& c) {
  layout::ComplianceHead head{};
  head.modes = c.modes;
  head.negative = c.negative;
  head.poisson = c.poisson;
  head.rounding = c.rounding;
  head.stiffening = c.stiffening;
  sections.add(Section::compliance, &head, sizeof head, 1);
  constexpr double kLargest = 32767;
  const std::size_t size = layout::compliance_site_size(c.modes), values = std::size_t{3} * c.modes;
  std::vector<std::byte> records(size * c.shear.size());
  for (std::size_t s = 0; s < c.shear.size(); ++s) {
    const double* const from = c.values.data() + s * values;
    double most = 0;
    for (std::size_t k = 0; k < values; ++k) most = std::max(most, std::abs(from[k]));
    const layout::ComplianceSite site{static_cast<float>(c.shear[s]), static_cast<float>(most / kLargest)};
    std::vector<std::int16_t> packed(values, 0);
    const double unit = static_cast<double>(site.unit);
    for (std::size_t k = 0; k < values && unit > 0; ++k) {
      packed[k] = static_cast<std::int16_t>(std::lround(std::clamp(from[k] / unit, -kLargest, kLargest)));
    }
    std::memcpy(records.data() + s * size, &site, sizeof site);
    std::memcpy(records.data() + s * size + sizeof site, packed.data(), values * sizeof(std::int16_t));
  }
  sections.add(Section::compliance_sites, records.data(), size, c.shear.size());
}

void add_bonded(Sections& sections, const ResponseFileContent& c) {
  const std::size_t size = layout::bonded_size(c.bonded_coefs);
  std::vector<std::byte> records(size * c.responses.size());
  for (std::size_t i = 0; i < c.responses.size(); ++i) {
    const Response& r = c.responses[i];
    const layout::BondedHead head{static_cast<float>(r.bonded_depth), static_cast<float>(r.bonded_pulled)};
    std::memcpy(records.data() + i * size, &head, sizeof head);
    std::memcpy(records.data() + i * size + sizeof head, r.bonded.data(), r.bonded.size() * sizeof(float));
  }
  sections.add(Section::bonded, records.data(), size, c.responses.size());
}

void add_bonded_torque(Sections& sections, const ResponseFileContent& c) {
  const std::size_t size = layout::torque_size(c.bonded_coefs);
  std::vector<std::byte> records(size * c.responses.size());
  for (std::size_t i = 0; i < c.responses.size(); ++i) {
    const Response& r = c.responses[i];
    const layout::BondedTorqueHead head{static_cast<float>(r.rotated)};
    std::memcpy(records.data() + i * size, &head, sizeof head);
    std::memcpy(records.data() + i * size + sizeof head, r.bonded_torque.data(),
                r.bonded_torque.size() * sizeof(float));
  }
  sections.add(Section::bonded_torque, records.data(), size, c.responses.size());
}

void add_responses(Sections& sections, const ResponseFileContent& c, const layout::Meta& meta) {
  const std::size_t size = layout::response_size(meta), law = layout::response_head_size(meta);
  std::vector<std::byte> records(size * c.responses.size());
  for (std::size_t i = 0; i < c.responses.size(); ++i) {
    const Response& r = c.responses[i];
    const layout::ResponseHead head{static_cast<float>(r.depth_limit), r.flags};
    std::byte* const to = records.data() + i * size;
    std::memcpy(to, &head, sizeof head);
    if (c.slip_softening) std::memcpy(to + sizeof head, &r.softening, sizeof r.softening);
    put_coefficients(to + law, c, r);
  }
  sections.add(Section::responses, records.data(), size, c.responses.size());
  if (c.bonded_coefs > 0) add_bonded(sections, c);
  if (c.has_bonded_torque) add_bonded_torque(sections, c);
}

}  // namespace

std::uint32_t ResponseFileContent::tool_vertex_count() const {
  std::size_t count = 0;
  for (const ResponseTool& tool : tools) count += tool.vertices.size();
  return static_cast<std::uint32_t>(count);
}

std::vector<std::byte> encode(const ResponseFileContent& c) {
  detail::check_content(c);
  layout::Meta meta{};
  meta.depth_scale = c.depth_scale;
  meta.tangential_scale = c.tangential_scale;
  meta.normal_degree = static_cast<std::uint32_t>(c.degrees.normal);
  meta.bias_degree = static_cast<std::uint32_t>(c.degrees.bias);
  meta.stiffness_degree = static_cast<std::uint32_t>(c.degrees.stiffness);
  meta.friction_degree = static_cast<std::uint32_t>(c.degrees.friction);
  meta.coef_bits = c.coef_bits;
  meta.site_count = static_cast<std::uint32_t>(c.sites.size());
  meta.vertex_count = static_cast<std::uint32_t>(c.surface_vertices.size());
  meta.triangle_count = static_cast<std::uint32_t>(c.surface_triangles.size());
  meta.patch_count = static_cast<std::uint32_t>(c.patches.size());
  meta.index_bytes = layout::index_bytes(meta);
  meta.response_count = static_cast<std::uint32_t>(c.responses.size());
  meta.subdivision = c.subdivision;
  meta.bonded_coefs = c.bonded_coefs;
  meta.search_nodes = static_cast<std::uint32_t>(c.search.size());
  if (!c.search.empty()) meta.search_grid = c.search_grid;
  meta.softening_count = c.slip_softening ? 1 : 0;

  Sections sections;
  meta.index_bytes == 2 ? add_body<std::uint16_t>(sections, c) : add_body<std::uint32_t>(sections, c);
  add_tools(sections, c, meta);
  add_responses(sections, c, meta);
  if (c.compliance) add_compliance(sections, *c.compliance);
  sections.add(Section::meta, &meta, sizeof meta, 1);
  sections.add(Section::provenance, c.provenance.data(), 1, c.provenance.size());
  const std::uint32_t features =
      (c.degrees.bias > 0 ? layout::feature_tangential_bias : 0u) |
      (c.degrees.friction_families ? layout::feature_friction : 0u) |
      (has_tool_patches(c) ? layout::feature_tool_patches : 0u) | (c.search.empty() ? 0u : layout::feature_search) |
      (c.bonded_coefs > 0 ? layout::feature_bonded : 0u) | (c.has_bonded_torque ? layout::feature_bonded_torque : 0u) |
      (has_spins(c) ? layout::feature_spin : 0u) | (c.slip_softening ? layout::feature_slip_softening : 0u) |
      (c.compliance ? layout::feature_compliance : 0u);
  std::vector<std::byte> bytes = sections.assemble(features);
  detail::check_bytes(bytes);
  return bytes;
}

}  // namespace palpate
