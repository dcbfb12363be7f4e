// SPDX-License-Identifier: MIT
// A response file read in place. It is validated once when it is opened, so that evaluation needs no checks.
#pragma once

#include "palpate/format/response_layout.hpp"

#include <cstddef>
#include <cstdint>

namespace palpate::runtime {

struct OpenResult;

namespace detail {

/// The tool without extent that stands for a tool index that the file does not have.
inline constexpr layout::ToolRecord kNoTool{};
/// Records of a view that was not opened or was refused: it has no tool, and its surface is one point.
inline constexpr layout::Meta kNoMeta{};
inline constexpr unsigned char kNoTriangle[layout::triangle_size(4)] = {};
inline constexpr layout::Point kNoPoint{};

}  // namespace detail

/// Pointers into the bytes of a response file. Copyable. The bytes must outlive the view and must not change.
struct View {
  const unsigned char* bytes = nullptr;
  std::size_t size = 0;
  std::uint32_t features = 0;  ///< layout::Feature bits
  const layout::Meta* meta = &detail::kNoMeta;
  const layout::Site* sites = nullptr;
  const layout::Point* vertices = &detail::kNoPoint;
  const unsigned char* triangles = detail::kNoTriangle;
  const unsigned char* patches = detail::kNoTriangle;
  bool small_indices = false;  ///< of two bytes in triangles and patches, not four
  const layout::ToolRecord* tools = nullptr;
  const layout::ToolVertexRecord* tool_vertices = nullptr;  ///< null when every tool has one vertex
  const layout::ToolPatch* tool_patches = nullptr;          ///< null with tool_vertices
  const std::uint32_t* spins = nullptr;                     ///< a tool vertex; null when every point has one spin
  const unsigned char* responses = nullptr;
  std::uint32_t response_size = 0;               ///< bytes of one response
  std::uint32_t head_size = 0;                   ///< bytes of a response before its unit
  const unsigned char* bonded = nullptr;         ///< null when no tool bonds to the body
  const unsigned char* bonded_torque = nullptr;  ///< null when no bonded tool was rotated
  const layout::SearchNode* search = nullptr;
  layout::SearchGrid search_grid{};                    ///< of its boxes
  const layout::ComplianceHead* compliance = nullptr;  ///< null when the scene has no [compliance]
  const unsigned char* compliance_sites = nullptr;     ///< null with compliance
  const char* provenance = nullptr;  ///< JSON text, not zero-terminated
  std::size_t provenance_size = 0;

  /// Checks `size` bytes at `data` (aligned to 8) against the specification. Defined in open.hpp.
  /// `kFeatures` (layout::Feature bits): what the program supports; a file that holds more is refused by name.
  /// Depth scales from 1e-9 m on are opened, but thresholds are made for 1e-6 m and more: a vector shorter than 1e-12 m
  /// has no direction.
  template <std::uint32_t kFeatures = layout::feature_all>
  static OpenResult open(const void* data, std::size_t size);
  /// Checks header, table of contents and META, but neither the checksum nor a record. It takes microseconds for a file
  /// of any size. The bytes must be bytes that open() has accepted; with others the behaviour is undefined.
  template <std::uint32_t kFeatures = layout::feature_all>
  static OpenResult open_trusted(const void* data, std::size_t size);

  [[nodiscard]] const layout::FileHeader& header() const { return *reinterpret_cast<const layout::FileHeader*>(bytes); }
  [[nodiscard]] const layout::SectionEntry* sections() const {
    return reinterpret_cast<const layout::SectionEntry*>(bytes + sizeof(layout::FileHeader));
  }
  /// Bytes of a section, 0 when it is absent.
  [[nodiscard]] std::uint64_t section_bytes(layout::Section id) const {
    for (std::uint32_t i = 0; i < header().section_count; ++i) {
      if (sections()[i].id == static_cast<std::uint32_t>(id)) return sections()[i].size;
    }
    return 0;
  }

  /// A triangle of the contact surface. `index`: below meta->triangle_count.
  [[nodiscard]] layout::SurfaceTriangle triangle(std::uint32_t index) const {
    layout::SurfaceTriangle t = bare_triangle(index);
    patch_sites(t.patch, t.site);
    return t;
  }
  /// The same without its sites: its patch may be one that the file does not have.
  [[nodiscard]] layout::SurfaceTriangle bare_triangle(std::uint32_t index) const {
    return small_indices
               ? layout::unpack_triangle<std::uint16_t>(triangles + std::size_t{index} * layout::triangle_size(2))
               : layout::unpack_triangle<std::uint32_t>(triangles + std::size_t{index} * layout::triangle_size(4));
  }
  /// Writes the three sites of a patch to `site`. `patch`: below meta->patch_count.
  void patch_sites(std::uint32_t patch, std::uint32_t (&site)[3]) const {
    small_indices ? layout::unpack_patch<std::uint16_t>(patches + std::size_t{patch} * layout::patch_size(2), site)
                  : layout::unpack_patch<std::uint32_t>(patches + std::size_t{patch} * layout::patch_size(4), site);
  }

  /// Head of a response. `index`, here and below: layout::response_index() of site and tool vertex, below
  /// meta->response_count.
  [[nodiscard]] const layout::ResponseHead& response_head(std::uint64_t index) const {
    return *reinterpret_cast<const layout::ResponseHead*>(responses + index * response_size);
  }
  /// Share of the normal force that the response loses once all of the contact slips. Requires feature_slip_softening.
  [[nodiscard]] double softening(std::uint64_t index) const {
    return static_cast<double>(*reinterpret_cast<const float*>(&response_head(index) + 1));
  }
  /// N that one unit of a coefficient stands for, those of mu excepted (layout::kFrictionUnit).
  [[nodiscard]] float coefficient_unit(std::uint64_t index) const {
    return *reinterpret_cast<const float*>(packed_coefficients(index));
  }
  /// Writes response::count(response::degrees(*meta)) integers to `to`.
  void coefficients(std::uint64_t index, std::int16_t* to) const {
    layout::unpack_coefficients(packed_coefficients(index), response::offsets(response::degrees(*meta)), meta->coef_bits,
                                to);
  }
  /// The unit and the packed coefficients that follow it.
  [[nodiscard]] const unsigned char* packed_coefficients(std::uint64_t index) const {
    return responses + index * response_size + head_size;
  }

  /// Depths of a bonded response. Requires feature_bonded.
  [[nodiscard]] const layout::BondedHead& bonded_head(std::uint64_t index) const {
    return *reinterpret_cast<const layout::BondedHead*>(bonded + index * layout::bonded_size(meta->bonded_coefs));
  }
  /// Coefficients of Fx, Fy, Fn, kxx, kxy, kyy: meta->bonded_coefs of each. Requires feature_bonded.
  [[nodiscard]] const float* bonded_curves(std::uint64_t index) const {
    return reinterpret_cast<const float*>(&bonded_head(index) + 1);
  }
  /// Range of the rotations of a bonded response. Requires feature_bonded_torque.
  [[nodiscard]] const layout::BondedTorqueHead& torque_head(std::uint64_t index) const {
    return *reinterpret_cast<const layout::BondedTorqueHead*>(bonded_torque +
                                                        index * layout::torque_size(meta->bonded_coefs));
  }
  /// Coefficients of T, K and C, meta->bonded_coefs of each of layout::kTorqueCurves. Requires feature_bonded_torque.
  [[nodiscard]] const float* torque_curves(std::uint64_t index) const {
    return reinterpret_cast<const float*>(&torque_head(index) + 1);
  }

  /// A site's part of the compliance. `site`: below meta->site_count. Requires feature_compliance.
  [[nodiscard]] const layout::ComplianceSite& compliance_site(std::uint32_t site) const {
    return *reinterpret_cast<const layout::ComplianceSite*>(
        compliance_sites + std::size_t{site} * layout::compliance_site_size(compliance->modes));
  }
  /// x, y, z (body frame) of each of compliance->modes modes, in units of compliance_site(site).unit. `site`: below
  /// meta->site_count. Requires feature_compliance.
  [[nodiscard]] const std::int16_t* compliance_modes(std::uint32_t site) const {
    return reinterpret_cast<const std::int16_t*>(&compliance_site(site) + 1);
  }

  [[nodiscard]] bool has(layout::Feature feature) const { return (features & feature) != 0; }
  /// The tool of that index, or a tool without extent where the file has none of that index.
  [[nodiscard]] const layout::ToolRecord& tool(std::uint32_t index) const {
    return index < meta->tool_count ? tools[index] : detail::kNoTool;
  }
  /// Index of the tool of that name, or tool_count where the file has none.
  [[nodiscard]] std::uint32_t find_tool(const char* name) const {
    for (std::uint32_t i = 0; i < meta->tool_count; ++i) {
      const char *a = tools[i].name, *b = name;
      while (*a != 0 && *a == *b) ++a, ++b;
      if (*a == *b) return i;
    }
    return meta->tool_count;
  }
};

/// Result of opening: a view, or the fault.
struct OpenResult {
  View view;
  bool ok = false;
  char error[200] = {};  ///< names the fault and its place; empty when ok
  explicit operator bool() const { return ok; }
};

}  // namespace palpate::runtime
