// SPDX-License-Identifier: MIT
// The bytes of a .palp response file, version 4. formats/response/response-file.md is the specification in prose.
#pragma once

#include "palpate/format/response_coefficients.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

/// C++17 and the standard library alone: shared by the writer (formats/response/response.cpp) and the runtime.
/// Little-endian, IEEE 754; every section starts at a multiple of kAlignment bytes. Lengths in metres, forces in
/// newtons.
namespace palpate::layout {

inline constexpr unsigned char kMagic[8] = {'P', 'A', 'L', 'P', 'A', 'T', 'E', 0};
inline constexpr std::uint32_t kVersion = 4;
inline constexpr std::uint64_t kAlignment = 64;
inline constexpr std::uint32_t kMinCoefs = 4;   ///< of a curve of BONDED: a cubic needs four
inline constexpr std::uint32_t kMaxCoefs = 32;  ///< of a curve of BONDED: a blend fits a fixed buffer
inline constexpr std::uint32_t kMaxSections = 32;
inline constexpr std::uint32_t kMaxSearchDepth = 48;
inline constexpr std::uint32_t kMaxSubdivision = 255;
inline constexpr std::uint32_t kMaxCount = 0x7fffffff;  ///< of anything
inline constexpr std::uint32_t kMaxSpins = 64;          ///< of one point of a tool

enum class Section : std::uint32_t {
  meta = 1,               ///< one Meta
  sites = 2,              ///< Site
  surface_vertices = 3,   ///< Point: contact surface; those of the sites come first
  surface_triangles = 4,  ///< packed SurfaceTriangle
  tools = 5,              ///< ToolRecord
  tool_vertices = 6,      ///< ToolVertexRecord; absent when every tool has one vertex
  tool_patches = 7,       ///< ToolPatch; absent with tool_vertices
  spins = 8,              ///< uint32 a tool vertex; absent when every point of a tool has one spin
  responses = 9,          ///< ResponseHead, float[softening_count], float unit, packed coefficients
  bonded = 10,            ///< BondedHead, float[6 * coefs]; absent when no tool bonds to the body
  bonded_torque = 11,     ///< BondedTorqueHead, float[15 * coefs]; absent when no bonded tool was rotated
  search = 12,            ///< SearchNode; absent when the scene leaves the search tree out
  provenance = 13,        ///< UTF-8 JSON text
  compliance = 14,        ///< one ComplianceHead; absent when the scene has no [compliance]
  compliance_sites = 15,  ///< ComplianceSite, int16[3 * modes]; absent with compliance
  surface_patches = 16    ///< three indices of sites
};

inline constexpr std::uint32_t kSectionIds = 17;  ///< ids are below this

/// The section's name as the specification spells it. "?" stands for an unknown id.
inline constexpr const char* section_name(std::uint32_t id) {
  constexpr const char* kNames[kSectionIds] = {"?",
                                               "META",
                                               "SITES",
                                               "SURFACE_VERTICES",
                                               "SURFACE_TRIANGLES",
                                               "TOOLS",
                                               "TOOL_VERTICES",
                                               "TOOL_PATCHES",
                                               "SPINS",
                                               "RESPONSES",
                                               "BONDED",
                                               "BONDED_TORQUE",
                                               "SEARCH",
                                               "PROVENANCE",
                                               "COMPLIANCE",
                                               "COMPLIANCE_SITES",
                                               "SURFACE_PATCHES"};
  return id < kSectionIds ? kNames[id] : kNames[0];
}

enum Feature : std::uint32_t {
  feature_tangential_bias = 1u << 0,
  feature_friction = 1u << 1,
  feature_tool_patches = 1u << 2,
  feature_search = 1u << 3,
  feature_bonded = 1u << 4,
  feature_bonded_torque = 1u << 5,
  feature_spin = 1u << 6,
  feature_slip_softening = 1u << 7,
  feature_compliance = 1u << 8,
  feature_all = 511u
};

/// Features that change no single contact.
inline constexpr std::uint32_t kFeaturesBesideContacts = feature_bonded | feature_bonded_torque | feature_compliance;

/// The feature in words, for messages. "?" stands for an unknown bit.
inline constexpr const char* feature_name(Feature feature) {
  constexpr const char* kNames[] = {"tangential forces of normal indentations",
                                    "friction",
                                    "tools of several vertices",
                                    "a search tree",
                                    "bonded contacts",
                                    "torques of bonded contacts",
                                    "spins of tools",
                                    "softening of contacts that slip",
                                    "compliance between contacts"};
  for (std::uint32_t bit = 0; bit < sizeof kNames / sizeof *kNames; ++bit) {
    if (feature == 1u << bit) return kNames[bit];
  }
  return "?";
}

enum SiteFlag : std::uint32_t {
  site_held = 1u << 0,     ///< the vertex lies on a support
  site_outside = 1u << 1,  ///< outside the region that was sampled
  site_all = 3u
};

/// Source of a response. Exactly one is set.
enum ResponseFlag : std::uint32_t {
  response_solved = 1u << 0,    ///< fitted to the solves of its own pair
  response_filled = 1u << 1,    ///< refused or never planned: filled from neighbours
  response_measured = 1u << 2,  ///< fitted to recordings of a real tool
  response_analytic = 1u << 3   ///< fitted to a closed form
};

/// "solved", "filled", "measured" or "analytic".
inline constexpr const char* source_name(std::uint32_t flags) {
  return flags == response_solved     ? "solved"
         : flags == response_filled   ? "filled"
         : flags == response_measured ? "measured"
                                      : "analytic";
}

enum class ToolKind : std::uint32_t { point_sphere = 0, profile = 1, mesh = 2 };
inline constexpr float kMaxSoftening = 0.2f;         ///< share of F that a slipping contact may lose
inline constexpr double kFrictionUnit = 1.0 / 3200;  ///< value of one unit of a coefficient of mu
inline constexpr double kMaxFriction = 10;           ///< of mu

struct FileHeader {
  unsigned char magic[8];
  std::uint32_t version;
  std::uint32_t section_count;
  std::uint64_t file_size;  ///< bytes
  std::uint64_t checksum;   ///< XXH64, seed 0, of the whole file with this field zero
  std::uint32_t features;   ///< Feature bits
  std::uint32_t reserved[7];
};

/// The table of contents follows the header; ids ascend, each at most once.
struct SectionEntry {
  std::uint32_t id;
  std::uint32_t element_size;  ///< bytes
  std::uint64_t offset;        ///< bytes from the start of the file
  std::uint64_t size;          ///< bytes, count * element_size
  std::uint64_t count;         ///< elements, at least 1
};

/// Grid of the boxes of SEARCH: a coordinate c of a box means origin + c unit.
struct SearchGrid {
  float origin[3];  ///< m
  float unit;       ///< m
};

struct Meta {
  double depth_scale;       ///< Z (m)
  double tangential_scale;  ///< X (m); 0 in a frictionless file
  std::uint32_t site_count, vertex_count, triangle_count;
  std::uint32_t tool_count, tool_vertex_count, tool_patch_count;
  std::uint32_t response_count;  ///< site_count * tool_vertex_count
  std::uint32_t subdivision;     ///< k: weights of sites are multiples of 1 / k
  std::uint32_t bonded_coefs;    ///< of each curve of BONDED and BONDED_TORQUE; 0 when no tool bonds
  std::uint32_t search_nodes;
  std::uint32_t normal_degree, bias_degree, stiffness_degree, friction_degree;  ///< response::Degrees
  std::uint32_t coef_bits;        ///< of a coefficient, those of mu excepted: 8, 12 or 16
  std::uint32_t softening_count;  ///< floats of slip softening a response: 1, or 0 when no response softens
  std::uint32_t patch_count;
  std::uint32_t index_bytes;  ///< of an index in SURFACE_TRIANGLES and SURFACE_PATCHES: index_bytes()
  SearchGrid search_grid;     ///< zero without SEARCH
  std::uint32_t reserved[6];
};

/// Lies at the surface vertex of the same index.
struct Site {
  float normal[3];    ///< outward unit
  float tangent[3];   ///< unit, orthogonal to normal: the x axis of the responses; y = normal cross tangent
  float depth_limit;  ///< m, how deep this site was sampled
  std::uint32_t flags;
};

struct Point {
  float xyz[3];
};

/// A triangle as View::triangle() unpacks it.
struct SurfaceTriangle {
  std::uint32_t vertex[3];     ///< counter-clockwise seen from outside
  std::uint32_t neighbour[3];  ///< triangle across the edge opposite each corner
  std::uint32_t patch;         ///< the triangle of sites whose responses are blended on it
  std::uint32_t site[3];       ///< of its patch
  std::uint8_t grid[3][2];     ///< per corner: k times its weights of the patch's first two sites
};

struct ToolRecord {
  char name[32];  ///< zero-terminated UTF-8
  std::uint32_t kind;
  std::uint32_t first_vertex, vertex_count;
  std::uint32_t first_patch, patch_count;  ///< both 0 when the file has no tool patches
  float radius;                            ///< m, the scene's (for display)
  float probe_radius;                      ///< m, from the axis to the surface; 0 for a punch and a mesh
  float axis_length;                       ///< m, the axis runs from (0,0,0) to (0,0,axis_length) in the tool's frame
};

struct ToolVertexRecord {
  float point[3];
  float normal[3];  ///< outward unit
  float tangent[3];
  float meridian;  ///< m, arc length from the tip's pole (profile tools)
  char name[24];
};

struct ToolPatch {
  std::uint32_t vertex[3];
};

struct ResponseHead {
  float depth_limit;  ///< m, how deep this pair was sampled
  std::uint32_t flags;
};

/// Depths of one bonded response. Both are 0 when its tool does not bond.
struct BondedHead {
  float depth;   ///< m, at which the contact was bonded
  float pulled;  ///< m, how far out of the body it was sampled
};

/// Range of the rotations of one bonded response. 0 when its tool was not rotated.
struct BondedTorqueHead {
  float rotated;  ///< rad, largest angle by which the bonded tool was rotated
};

/// The compliance between two points of the surface: a half-space in closed form and modes of the rest.
struct ComplianceHead {
  std::uint32_t modes;     ///< r, a multiple of kModeStep up to kMaxModes
  std::uint32_t negative;  ///< the last modes of negative sign, at most r
  double poisson;          ///< of the half-space, [0, 0.5)
  double rounding;         ///< m, > 0: half_space::compliance
  double stiffening;       ///< b, [0, 1]: a contact at depth d makes a dent of C f / (1 + b d / depth_scale)
  std::uint32_t reserved[8];
};
inline constexpr std::uint32_t kModeStep = 8, kMaxModes = 128;

/// A site's part of the compliance. Its modes follow as int16 x, y, z (body frame) of each mode.
struct ComplianceSite {
  float shear;  ///< Pa, of the half-space here
  float unit;   ///< sqrt(m/N) of one unit of a mode's value
};

/// Box over the triangles below a node, in steps of the SearchGrid. count() 0: its children are the nodes first() and
/// first() + 1; else a leaf: triangles first() to first() + count() - 1.
struct SearchNode {
  std::uint16_t lower[3], upper[3];
  std::uint32_t place;  ///< first() + 2^27 count()

  [[nodiscard]] constexpr std::uint32_t first() const { return place & (kMaxTreeCount - 1); }
  [[nodiscard]] constexpr std::uint32_t count() const { return place / kMaxTreeCount; }
  constexpr void set(std::uint32_t first, std::uint32_t count) { place = first + count * kMaxTreeCount; }
  static constexpr std::uint32_t kMaxTreeCount = 1u << 27;  ///< of nodes, and of triangles, of a tree
  static constexpr std::uint32_t kMaxLeaf = 31;             ///< triangles of a leaf
};

/// m, of a coordinate of a box along an axis.
inline constexpr double grid_position(const SearchGrid& grid, int axis, std::uint32_t coordinate) {
  return double{grid.origin[axis]} + double{grid.unit} * coordinate;
}

/// The finest grid over points, of which there is at least one.
inline SearchGrid grid_over(const Point* points, std::size_t count) {
  constexpr double kSteps = 65533;  // of 65535: rounding must not lead beyond the last
  SearchGrid grid{{points->xyz[0], points->xyz[1], points->xyz[2]}, 1e-30f};
  for (int axis = 0; axis < 3; ++axis) {
    float upper = grid.origin[axis];
    for (std::size_t i = 1; i < count; ++i) {
      const float x = points[i].xyz[axis];
      if (x < grid.origin[axis]) grid.origin[axis] = x;
      if (x > upper) upper = x;
    }
    const auto unit = static_cast<float>((double{upper} - double{grid.origin[axis]}) / kSteps);
    if (unit > grid.unit) grid.unit = unit;
  }
  return grid;
}

/// Makes a node's box hold a point (m) of the grid's box.
inline void hold_point(const SearchGrid& grid, const float (&point)[3], SearchNode& node) {
  for (int axis = 0; axis < 3; ++axis) {
    const double steps = (double{point[axis]} - double{grid.origin[axis]}) / double{grid.unit};
    auto low = static_cast<std::uint32_t>(steps > 0 ? (steps < 65535 ? steps : 65535) : 0), high = low;
    while (low > 0 && grid_position(grid, axis, low) > double{point[axis]}) --low;
    while (high < 65535 && grid_position(grid, axis, high) < double{point[axis]}) ++high;
    if (low < node.lower[axis]) node.lower[axis] = static_cast<std::uint16_t>(low);
    if (high > node.upper[axis]) node.upper[axis] = static_cast<std::uint16_t>(high);
  }
}

/// Makes a node's box hold another node's.
inline void hold_box(const SearchNode& inner, SearchNode& node) {
  for (int axis = 0; axis < 3; ++axis) {
    if (inner.lower[axis] < node.lower[axis]) node.lower[axis] = inner.lower[axis];
    if (inner.upper[axis] > node.upper[axis]) node.upper[axis] = inner.upper[axis];
  }
}

/// A node whose box holds nothing yet.
inline constexpr SearchNode kEmptyNode{{65535, 65535, 65535}, {0, 0, 0}, 0};

static_assert(sizeof(float) == 4 && sizeof(double) == 8);
static_assert(sizeof(FileHeader) == 64 && offsetof(FileHeader, checksum) == 24 && offsetof(FileHeader, features) == 32);
static_assert(sizeof(SectionEntry) == 32 && offsetof(SectionEntry, offset) == 8);
static_assert(sizeof(Meta) == 128 && offsetof(Meta, site_count) == 16 && offsetof(Meta, coef_bits) == 72);
static_assert(sizeof(Site) == 32 && sizeof(ToolPatch) == 12 && sizeof(Point) == 12);
static_assert(sizeof(ToolRecord) == 64 && sizeof(ToolVertexRecord) == 64);
static_assert(sizeof(ResponseHead) == 8 && sizeof(BondedHead) == 8 && sizeof(BondedTorqueHead) == 4 &&
              sizeof(SearchNode) == 16);
static_assert(sizeof(ComplianceHead) == 64 && sizeof(ComplianceSite) == 8);
static_assert(std::is_trivially_copyable_v<Meta> && std::is_trivially_copyable_v<ToolRecord>);

/// Index of the response of (site, tool vertex); tool vertices are numbered over all tools.
inline constexpr std::uint64_t response_index(const Meta& meta, std::uint32_t site, std::uint32_t tool_vertex) {
  return std::uint64_t{site} * meta.tool_vertex_count + tool_vertex;
}

/// Bytes of an index of a triangle, vertex, patch or site: 2 where that is enough, else 4.
inline constexpr std::uint32_t index_bytes(const Meta& m) {
  const bool small =
      m.site_count <= 65536 && m.vertex_count <= 65536 && m.triangle_count <= 65536 && m.patch_count <= 65536;
  return small ? 2 : 4;
}

/// Bytes of an element of SURFACE_TRIANGLES: Index vertex[3], neighbour[3], patch, then grid.
inline constexpr std::uint32_t triangle_size(std::uint32_t index_bytes) { return 7 * index_bytes + 6; }
/// Bytes of an element of SURFACE_PATCHES: Index site[3].
inline constexpr std::uint32_t patch_size(std::uint32_t index_bytes) { return 3 * index_bytes; }

/// Writes a triangle without its sites. Index: an unsigned integer of index_bytes.
template <class Index>
inline void pack_triangle(const SurfaceTriangle& from, unsigned char* to) {
  Index index[7];
  for (int k = 0; k < 3; ++k) {
    index[k] = static_cast<Index>(from.vertex[k]);
    index[3 + k] = static_cast<Index>(from.neighbour[k]);
  }
  index[6] = static_cast<Index>(from.patch);
  std::memcpy(to, index, sizeof index);
  std::memcpy(to + sizeof index, from.grid, sizeof from.grid);
}

template <class Index>
inline void pack_patch(const std::uint32_t (&site)[3], unsigned char* to) {
  const Index index[3] = {static_cast<Index>(site[0]), static_cast<Index>(site[1]), static_cast<Index>(site[2])};
  std::memcpy(to, index, sizeof index);
}

/// The k-th index from there on. One at a time: the compiler then reads those alone that are used.
template <class Index>
inline std::uint32_t unpack_index(const unsigned char* from, int k) {
  Index index;
  std::memcpy(&index, from + std::size_t{sizeof index} * static_cast<std::size_t>(k), sizeof index);
  return index;
}

template <class Index>
inline void unpack_patch(const unsigned char* from, std::uint32_t (&site)[3]) {
  for (int k = 0; k < 3; ++k) site[k] = unpack_index<Index>(from, k);
}

/// Reads a triangle without its sites.
template <class Index>
inline SurfaceTriangle unpack_triangle(const unsigned char* from) {
  SurfaceTriangle to{};
  for (int k = 0; k < 3; ++k) {
    to.vertex[k] = unpack_index<Index>(from, k);
    to.neighbour[k] = unpack_index<Index>(from, 3 + k);
  }
  to.patch = unpack_index<Index>(from, 6);
  std::memcpy(to.grid, from + 7 * sizeof(Index), sizeof to.grid);
  return to;
}

inline constexpr bool has_friction(const Meta& m) { return m.tangential_scale > 0; }

}  // namespace palpate::layout

namespace palpate::response {

/// Degrees of a file's responses. Values beyond int's range become 100, which broken_degree refuses.
inline constexpr Degrees degrees(const layout::Meta& m) {
  const auto degree = [](std::uint32_t d) { return d < 100 ? static_cast<int>(d) : 100; };
  return {degree(m.normal_degree), degree(m.bias_degree), degree(m.stiffness_degree), degree(m.friction_degree),
          layout::has_friction(m)};
}

}  // namespace palpate::response

namespace palpate::layout {

/// Bytes of a response before its unit.
inline constexpr std::uint32_t response_head_size(const Meta& m) {
  return static_cast<std::uint32_t>(sizeof(ResponseHead)) + 4 * m.softening_count;
}

/// Bytes from the unit to the coefficients of mu, which always have 16 bits.
inline constexpr std::uint32_t friction_offset(const response::Offsets& o, std::uint32_t bits) {
  return 4 + 2 * ((static_cast<std::uint32_t>(o.friction) * bits + 15) / 16);
}

/// Bytes of a unit and its coefficients, a multiple of 4.
inline constexpr std::uint32_t coefficients_size(const response::Degrees& d, std::uint32_t bits) {
  const response::Offsets o = response::offsets(d);
  return (friction_offset(o, bits) + 2 * static_cast<std::uint32_t>(o.end - o.friction) + 3) / 4 * 4;
}
inline constexpr std::uint32_t coefficients_size(const Meta& m) { return coefficients_size(response::degrees(m), m.coef_bits); }

/// Bytes of one element of RESPONSES. All values of a response lie together, in as few cache lines as possible.
inline constexpr std::uint32_t response_size(const Meta& m) { return response_head_size(m) + coefficients_size(m); }

/// Reads all coefficients that follow the unit at `law`.
template <class Number>
inline void unpack_coefficients(const unsigned char* law, const response::Offsets& o, std::uint32_t bits, Number* to) {
  response::unpack(law + 4, bits, o.friction, to);
  response::unpack(law + friction_offset(o, bits), 16, o.end - o.friction, to + o.friction);
}

/// Bytes of one element of COMPLIANCE_SITES.
inline constexpr std::uint32_t compliance_site_size(std::uint32_t modes) { return 8 + 6 * modes; }

/// BONDED: curves Fx, Fy, Fn, kxx, kxy, kyy of as many coefficients each, over (z / (kBondedRange Z) + 1) / 2.
inline constexpr std::uint32_t kBondedCurves = 6;
inline constexpr double kBondedRange = 1.25;
inline constexpr std::uint32_t bonded_size(std::uint32_t coefs) { return 8 + 4 * kBondedCurves * coefs; }

/// BONDED_TORQUE: curves tx, ty, tn (N m), kxx, kxy, kyy, kxn, kyn, knn (N m), cxx, cxy, cxn, cyx, cyy, cyn (N), each
/// of as many coefficients, over the abscissa of BONDED.
inline constexpr std::uint32_t kTorqueCurves = 15;
inline constexpr double kMaxRotation = 1.0;  ///< rad, largest angle by which a file may have rotated a tool
inline constexpr std::uint32_t torque_size(std::uint32_t coefs) { return 4 + 4 * kTorqueCurves * coefs; }

}  // namespace palpate::layout
