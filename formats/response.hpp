// SPDX-License-Identifier: MIT
// The response file in memory and its writer; the reader is the runtime (runtime/include/palpate/view.hpp).
#pragma once

#include "palpate/response_layout.hpp"
#include "palpate/spline.hpp"

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

/// A vertex of the haptic mesh: where responses live.
struct ResponseSite {
  Triple position{0, 0, 0};  ///< m
  Triple normal{0, 0, 1};    ///< outward unit
  Triple tangent{1, 0, 0};   ///< unit, orthogonal to normal: the responses' x axis (ContactFrame::x)
  double depth_limit = 0.0;  ///< m, > 0, at most depth_scale
  std::uint32_t flags = 0;   ///< layout::SiteFlag bits
};

/// A triangle of the contact surface: corner i has the patch's weights (grid[i][0], grid[i][1], k - both) / k.
struct ResponseTriangle {
  std::array<std::uint32_t, 3> vertices{};  ///< counter-clockwise seen from outside
  std::uint32_t patch = 0;
  std::array<std::array<std::uint16_t, 2>, 3> grid{};
};

struct ResponseToolVertex {
  std::string name;  ///< at most 23 bytes
  Triple point{0, 0, 0};
  Triple normal{0, 0, -1};
  Triple tangent{1, 0, 0};
  double meridian = 0.0;  ///< m; ascending along a profile
  /// How many spins its point has, [1, 64]; the others follow it, with 0 here, the k-th with the tangent turned by
  /// k / spins of a circle about the normal. Patches name the first.
  std::uint32_t spins = 1;
};

struct ResponseTool {
  std::string name;  ///< at most 31 bytes, not empty, unique in the file
  layout::ToolKind kind = layout::ToolKind::point_sphere;
  double radius = 0.0;        ///< m, as in the scene
  double probe_radius = 0.0;  ///< m, axis to skin: sphere and capsule their radius, punch and mesh 0
  double axis_length = 0.0;   ///< m, capsule: distance of the cap centres; else 0
  std::vector<ResponseToolVertex> vertices;
  /// Corners index `vertices` above: {v, v, v}, a profile's segment {a, b, b}, or a triangle.
  std::vector<std::array<std::uint32_t, 3>> patches;
};

/// Curves of one (site, tool vertex), as spline coefficients; lengths are the content's counts. See
/// formats/response-file.md for what each means. Components are in the site's frame (x, y, n).
struct Response {
  double depth_limit = 0.0;  ///< m, > 0, at most depth_scale
  std::uint32_t flags = layout::response_solved;
  float relief = 0.0f;        ///< in a file with reliefs: see palpate/relief.hpp; 0 to layout::kMostRelief
  std::vector<float> normal;  ///< Fn(s), N; [0] = [1] = 0, non-decreasing
  std::vector<float> lateral_x, lateral_y;    ///< Fx(s), Fy(s), N; [0] = [1] = 0
  std::vector<float> growth_x, growth_y;      ///< gx(s), gy(s); [0] = 0, >= 0
  std::vector<float> sideways_x, sideways_y;  ///< phi(x / X), N; non-increasing, phi(0) = 0
  std::vector<float> friction;                ///< mu(s); in [0, 10]
  // The coupled model, in place of all these: see palpate/coupled_layout.hpp.
  float unit = 0.0f;                  ///< N of one unit of the coefficients (those of mu: layout::kLimitUnit)
  std::vector<std::int16_t> coupled;  ///< count(degrees) of them, which meet coupled::broken_rule
  // In a file with grasps: see palpate/grasp_law.hpp.
  double grasp_depth = 0.0, grasp_pulled = 0.0;  ///< m; depth 0: this tool does not hold on
  std::vector<float> grasp;                      ///< curves Fx, Fy, Fn (N), kxx, kxy, kyy (N/m), one after the other
  // In a file with turns: see palpate/turn_law.hpp.
  double turned = 0.0;      ///< rad; 0: turns of this tool have no torque
  std::vector<float> turn;  ///< layout::kTurnCurves curves, one after the other
};

/// Everything a file holds. A count of 0 leaves the family, and its section, out.
struct ResponseFileContent {
  double depth_scale = 0.0;         ///< Z, m, > 0
  double sideways_scale = 0.0;      ///< X, m; > 0 with friction, 0 without
  std::uint32_t normal_coefs = 10;  ///< [4, 32]
  std::uint32_t lateral_coefs = 0;  ///< 0 or [4, 32]
  std::uint32_t growth_coefs = 0;   ///< 0 or [4, 32]; growth, sideways and friction all 0 or none
  std::uint32_t sideways_coefs = 0;
  std::uint32_t friction_coefs = 0;
  std::optional<palpate::coupled::Degrees>
      coupled;                              ///< a file of the coupled model, all counts above 0; none: separable
  std::uint32_t coupled_bits = 16;          ///< 8, 12 or 16: of a coefficient of Response::coupled but the limit's
  std::uint32_t grasp_coefs = 0;            ///< 0 or [4, 32]
  double rim_share = 0.0, rim_limit = 0.0;  ///< see palpate/rim.hpp: both 0, or with friction both in (0, 1)
  bool reliefs = false;                     ///< contacts push less where they slip; only with friction
  bool turns = false;  ///< grasped tools that are turned, by curves of grasp_coefs; only with grasps

  std::vector<ResponseSite> sites;
  std::vector<std::array<std::uint32_t, 3>> patches;  ///< of the haptic mesh; corners index sites
  std::uint32_t subdivision = 1;                      ///< k
  std::vector<Triple> surface_vertices;               ///< contact surface, closed and manifold
  std::vector<ResponseTriangle> surface_triangles;
  std::vector<ResponseTool> tools;
  std::vector<Response> responses;         ///< index = site * tool_vertex_count() + tool vertex over all tools
  std::vector<layout::SearchNode> search;  ///< filled by add_search
  std::string provenance = "{}";  ///< a JSON object, UTF-8: inputs' hashes, settings, errors, units; no clock time

  [[nodiscard]] std::uint32_t tool_vertex_count() const;
};

/// A triangle grid over each patch with `k` steps a side, shared along edges: returns, for every new vertex,
/// its weights of sites, so that the caller can place it on the true surface. Sets subdivision, triangles and
/// (flat, on the patches) vertices. Throws Error(bad_input) where k is outside [1, 1024].
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
