// SPDX-License-Identifier: MIT
// The response file in memory and its writer. The reader is palpate/format/open.hpp.
#pragma once

#include "palpate/format/response_layout.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

using Triple = std::array<double, 3>;

/// From anything with operator[] of three numbers (Eigen vectors among them).
template <class Vector>
Triple to_triple(const Vector& v) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

/// A vertex of the haptic mesh: where responses live. It lies at the surface vertex of the same index.
struct ResponseSite {
  Triple normal{0, 0, 1};    ///< outward unit
  Triple tangent{1, 0, 0};   ///< unit, orthogonal to normal: the responses' x axis (ContactFrame::x)
  double depth_limit = 0.0;  ///< m, > 0, at most depth_scale
  std::uint32_t flags = 0;   ///< layout::SiteFlag bits
};

/// A triangle of the contact surface: corner i has the patch's weights (grid[i][0], grid[i][1], k - both) / k.
struct ResponseTriangle {
  std::array<std::uint32_t, 3> vertices{};  ///< counter-clockwise seen from outside
  std::uint32_t patch = 0;
  std::array<std::array<std::uint8_t, 2>, 3> grid{};
};

struct ResponseToolVertex {
  std::string name;  ///< at most 23 bytes
  Triple point{0, 0, 0};
  Triple normal{0, 0, -1};
  Triple tangent{1, 0, 0};
  double meridian = 0.0;  ///< m; ascending along a profile
  /// Number of spins of its point, [1, 64]. The others follow it, with 0 here. The tangent of the k-th is rotated by
  /// k / spins of a circle about the normal. Patches name the first.
  std::uint32_t spins = 1;
};

struct ResponseTool {
  std::string name;  ///< at most 31 bytes, not empty, unique in the file
  layout::ToolKind kind = layout::ToolKind::point_sphere;
  double radius = 0.0;        ///< m, as in the scene
  double probe_radius = 0.0;  ///< m, axis to surface: sphere and capsule their radius, punch and mesh 0
  double axis_length = 0.0;   ///< m, capsule: distance of the cap centres; else 0
  std::vector<ResponseToolVertex> vertices;
  /// Corners index `vertices` above: {v, v, v}, a profile's segment {a, b, b}, or a triangle.
  std::vector<std::array<std::uint32_t, 3>> patches;
};

/// The response of one (site, tool vertex). formats/response/response-file.md says what each value means. Components
/// are in the site's frame (x, y, n).
struct Response {
  double depth_limit = 0.0;  ///< m, > 0, at most depth_scale
  std::uint32_t flags = layout::response_solved;
  float softening = 0.0f;                  ///< [0, layout::kMaxSoftening]; 0 in a file without softening
  float unit = 0.0f;                       ///< N of one unit of the coefficients, those of mu excepted
  std::vector<std::int16_t> coefficients;  ///< count(degrees) of them, which meet response::broken_rule
  // In a file with bonded contacts:
  double bonded_depth = 0.0, bonded_pulled = 0.0;  ///< m; depth 0: this tool does not bond
  std::vector<float> bonded;                       ///< curves Fx, Fy, Fn (N), kxx, kxy, kyy (N/m), one after the other
  // In a file with torques of bonded contacts:
  double rotated = 0.0;              ///< rad; 0: this tool was not rotated
  std::vector<float> bonded_torque;  ///< layout::kTorqueCurves curves, one after the other
};

/// The compliance between points of the surface (formats/response/response-file.md, COMPLIANCE).
struct ResponseCompliance {
  std::uint32_t modes = 0;     ///< a multiple of layout::kModeStep, up to layout::kMaxModes
  std::uint32_t negative = 0;  ///< the last modes of negative sign
  double poisson = 0.0;        ///< of the half-space, [0, 0.5)
  double rounding = 0.0;       ///< m, > 0
  double stiffening = 0.0;     ///< b, [0, 1]: layout::ComplianceHead
  std::vector<double> shear;   ///< Pa, a site
  std::vector<double> values;  ///< sqrt(m/N): x, y, z of mode m at site s from index 3 (modes s + m) on
};

/// Everything that a file holds.
struct ResponseFileContent {
  double depth_scale = 0.0;         ///< Z, m, > 0
  double tangential_scale = 0.0;    ///< X, m; > 0 with friction, 0 without
  response::Degrees degrees;        ///< friction_families exactly where tangential_scale > 0
  std::uint32_t coef_bits = 16;     ///< 8, 12 or 16: of a coefficient, those of mu excepted
  bool slip_softening = false;      ///< only with friction
  std::uint32_t bonded_coefs = 0;   ///< 0 or [4, 32]: of a curve of a bonded contact
  bool has_bonded_torque = false;   ///< torques of bonded contacts, by curves of bonded_coefs; only with bonded_coefs

  std::vector<ResponseSite> sites;
  std::vector<std::array<std::uint32_t, 3>> patches;  ///< of the haptic mesh; corners index sites
  std::uint32_t subdivision = 1;                      ///< k: weights of sites are multiples of 1 / k
  std::vector<Triple> surface_vertices;  ///< m, contact surface, closed and manifold; those of the sites come first
  std::vector<ResponseTriangle> surface_triangles;
  std::vector<ResponseTool> tools;
  std::vector<Response> responses;         ///< index = site * tool_vertex_count() + tool vertex over all tools
  std::vector<layout::SearchNode> search;  ///< filled by add_search
  layout::SearchGrid search_grid{};        ///< filled by add_search
  std::optional<ResponseCompliance> compliance;
  std::string provenance = "{}";  ///< a JSON object, UTF-8: inputs' hashes, settings, errors, units; no clock time

  [[nodiscard]] std::uint32_t tool_vertex_count() const;
};

/// A triangle grid over each patch with `k` steps a side, shared along edges. `content.surface_vertices` holds those of
/// the sites; the others are added, flat on the patches. Returns, for every vertex, its weights of sites, so that the
/// caller can place it on the true surface. Sets subdivision and triangles too. Throws Error(bad_input) where k is
/// outside [1, 255].
struct GridVertex {
  std::array<std::uint32_t, 3> sites{};
  std::array<double, 3> weights{};
};
std::vector<GridVertex> subdivide_surface(ResponseFileContent& content, std::uint32_t k);

/// Builds the search tree; puts the triangles of the contact surface into the tree's order.
void add_search(ResponseFileContent& content);

/// Triangles above which a scene that leaves the choice to Palpate gets a search section. A search without takes some
/// 20 ns a triangle, with it a fifth of a microsecond on bodies of up to two thousand; it adds a tenth to a lean file.
inline constexpr std::size_t kSearchThreshold = 32;

/// The file's bytes, opened once by the reader: no command will refuse them. The same content gives the same bytes.
/// Throws Error that names the first element that breaks the specification: numerical where a fitted curve does,
/// else bad_input.
std::vector<std::byte> encode(const ResponseFileContent& content);

/// Writes beside the target, syncs, renames: a reader sees the old file or the whole new one. Throws Error(io).
void write_response_file(const std::filesystem::path& path, const std::vector<std::byte>& bytes);

/// A whole file. Throws Error(io) when it cannot be read.
std::vector<std::byte> read_bytes(const std::filesystem::path& path);

}  // namespace palpate
