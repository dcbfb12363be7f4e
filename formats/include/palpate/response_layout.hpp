// SPDX-License-Identifier: MIT
// The bytes of a .palp response file, version 2; the prose specification is formats/response-file.md.
#pragma once

#include "palpate/coupled_layout.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

/// C++17 and the standard library alone: shared by the writer (formats/response.cpp) and the runtime.
/// Little-endian, IEEE 754; every section starts at a multiple of kAlignment bytes. Lengths in metres, forces in
/// newtons.
namespace palpate::layout {

inline constexpr unsigned char kMagic[8] = {'P', 'A', 'L', 'P', 'A', 'T', 'E', 0};
inline constexpr std::uint32_t kVersion = 2;
inline constexpr std::uint64_t kAlignment = 64;
inline constexpr std::uint32_t kMinCoefs = 4;   ///< a cubic needs four
inline constexpr std::uint32_t kMaxCoefs = 32;  ///< so that a blended response fits a fixed buffer
inline constexpr std::uint32_t kMaxSections = 32;
inline constexpr std::uint32_t kMaxSearchDepth = 48;
inline constexpr std::uint32_t kMaxSubdivision = 1024;
inline constexpr std::uint32_t kMaxCount = 0x7fffffff;  ///< of anything
inline constexpr std::uint32_t kMaxSpins = 64;          ///< of one point of a tool

enum class Section : std::uint32_t {
  meta = 1,               ///< one Meta
  sites = 2,              ///< Site
  surface_vertices = 3,   ///< Point: contact surface
  surface_triangles = 4,  ///< SurfaceTriangle
  tools = 5,              ///< ToolRecord
  tool_vertices = 6,      ///< ToolVertexRecord; absent when every tool has one vertex
  tool_patches = 7,       ///< ToolPatch; absent with tool_vertices
  spins = 8,              ///< uint32 a tool vertex; absent when every point of a tool has one spin
  responses = 9,          ///< ResponseHead, then the curves or the coupled law of that response
  grasp = 10,             ///< GraspHead, then float[6 * coefs]; absent when no tool holds on
  turn = 11,              ///< TurnHead, then float[15 * coefs]; absent when no tool's turns have a torque
  search = 12,            ///< SearchNode; absent where a scene does without
  provenance = 13         ///< UTF-8 JSON text
};

inline constexpr std::uint32_t kSectionIds = 14;  ///< ids are below this

/// The section's name as the specification spells it; "?" for an unknown id.
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
                                               "GRASP",
                                               "TURN",
                                               "SEARCH",
                                               "PROVENANCE"};
  return id < kSectionIds ? kNames[id] : kNames[0];
}

enum Feature : std::uint32_t {
  feature_lateral = 1u << 0,
  feature_friction = 1u << 1,
  feature_tool_patches = 1u << 2,
  feature_search = 1u << 3,
  feature_coupled = 1u << 4,
  feature_grasp = 1u << 5,
  feature_turn = 1u << 6,
  feature_rim = 1u << 7,
  feature_spin = 1u << 8,
  feature_relief = 1u << 9,
  feature_all = 1023u
};

/// What a person calls it.
inline constexpr const char* feature_name(Feature feature) {
  return feature == feature_lateral        ? "sideways forces of straight pushes"
         : feature == feature_friction     ? "friction"
         : feature == feature_tool_patches ? "tools of several vertices"
         : feature == feature_search       ? "a search tree"
         : feature == feature_coupled      ? "coupled responses"
         : feature == feature_grasp        ? "grasps"
         : feature == feature_turn         ? "turns of grasps"
         : feature == feature_rim          ? "contacts that slip in part"
         : feature == feature_spin         ? "spins of tools"
                                           : "contacts that push less where they slip";
}

enum SiteFlag : std::uint32_t {
  site_held = 1u << 0,     ///< the vertex lies on a support
  site_outside = 1u << 1,  ///< outside the region that was sampled
  site_all = 3u
};

/// Exactly one is set.
enum ResponseFlag : std::uint32_t {
  response_solved = 1u << 0,    ///< fitted to this pair's own solves
  response_covered = 1u << 1,   ///< refused or never planned: taken from neighbours
  response_measured = 1u << 2,  ///< fitted to what a real tool recorded
  response_analytic = 1u << 3   ///< fitted to a closed form
};

/// "solved", "covered", "measured" or "analytic".
inline constexpr const char* source_name(std::uint32_t flags) {
  return flags == response_solved     ? "solved"
         : flags == response_covered  ? "covered"
         : flags == response_measured ? "measured"
                                      : "analytic";
}

enum class ToolKind : std::uint32_t { point_sphere = 0, profile = 1, mesh = 2 };
enum class Model : std::uint32_t { separable = 1, coupled = 2 };
/// Of a straight push's sideways force, times sqrt(depth / Z): what is the tissue's against the tool's flanks, and no
/// shear that a slip takes away.
inline constexpr double kFlanks = 0.75;
inline constexpr float kMostRelief = 0.2f;        ///< of a response
inline constexpr double kLimitUnit = 1.0 / 3200;  ///< of a coupled law's coefficients of the friction limit

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

struct Meta {
  double depth_scale;     ///< Z (m)
  double sideways_scale;  ///< X (m); 0 in a frictionless file
  std::uint32_t model;
  std::uint32_t site_count, vertex_count, triangle_count;
  std::uint32_t tool_count, tool_vertex_count, tool_patch_count;
  std::uint32_t response_count;  ///< site_count * tool_vertex_count
  std::uint32_t subdivision;     ///< k: each patch is k * k triangles of the contact surface
  std::uint32_t normal_coefs, lateral_coefs, growth_coefs, sideways_coefs, friction_coefs;
  std::uint32_t grasp_coefs;  ///< of each curve of GRASP and TURN; 0 when no tool holds on
  std::uint32_t search_nodes;
  /// Degrees of the coupled model; all 0 in a file of another.
  std::uint32_t order, push_degree, straight_degree, stiffness_degree, cubic_degree, quartic_degree, limit_degree;
  /// Share of every contact, (0, 1), that slips before all of it does, and its own share of the friction limit, (0, 1)
  /// (palpate/rim.hpp); both 0 where contacts stick as a whole.
  float rim_share, rim_limit;
  std::uint32_t coef_bits;     ///< of a coupled law's coefficients but those of the friction limit: 8, 12 or 16; else 0
  std::uint32_t relief_count;  ///< floats of a response's relief (palpate/relief.hpp): 1, or 0 where none has one
  std::uint32_t reserved;
};

struct Site {
  float position[3];
  float normal[3];    ///< outward unit
  float tangent[3];   ///< unit, orthogonal to normal: the x axis of the responses; y = normal cross tangent
  float depth_limit;  ///< m, how deep this site was sampled
  std::uint32_t flags;
  std::uint32_t reserved;
};

struct Point {
  float xyz[3];
};

struct SurfaceTriangle {
  std::uint32_t vertex[3];     ///< counter-clockwise seen from outside
  std::uint32_t neighbour[3];  ///< triangle across the edge opposite each corner
  std::uint32_t site[3];       ///< of its patch: the triangle of sites whose responses are blended on it
  std::uint16_t grid[3][2];    ///< per corner: k times its weights of the patch's first two sites
};

struct ToolRecord {
  char name[32];  ///< zero-terminated UTF-8
  std::uint32_t kind;
  std::uint32_t first_vertex, vertex_count;
  std::uint32_t first_patch, patch_count;  ///< both 0 when the file has no tool patches
  float radius;                            ///< m, the scene's (for display)
  float probe_radius;                      ///< m, from the axis to the skin; 0 for a punch and a mesh
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

/// Of one response; both 0 where its tool does not hold on.
struct GraspHead {
  float depth;   ///< m, at which the contact was bonded
  float pulled;  ///< m, how far out of the body it was sampled
};

/// Of one response; 0 where turns of its tool have no torque.
struct TurnHead {
  float turned;  ///< rad, largest angle by which the grasped tool was turned
};

/// Box over the triangles below a node. count 0: children are nodes `first` and `first + 1`.
struct SearchNode {
  float lower[3];
  std::uint32_t first;
  float upper[3];
  std::uint32_t count;  ///< leaf: triangles first .. first + count - 1
};

static_assert(sizeof(float) == 4 && sizeof(double) == 8);
static_assert(sizeof(FileHeader) == 64 && offsetof(FileHeader, checksum) == 24 && offsetof(FileHeader, features) == 32);
static_assert(sizeof(SectionEntry) == 32 && offsetof(SectionEntry, offset) == 8);
static_assert(sizeof(Meta) == 128 && offsetof(Meta, model) == 16);
static_assert(sizeof(Site) == 48 && sizeof(ToolPatch) == 12 && sizeof(Point) == 12);
static_assert(sizeof(SurfaceTriangle) == 48 && sizeof(ToolRecord) == 64 && sizeof(ToolVertexRecord) == 64);
static_assert(sizeof(ResponseHead) == 8 && sizeof(GraspHead) == 8 && sizeof(TurnHead) == 4 && sizeof(SearchNode) == 32);
static_assert(std::is_trivially_copyable_v<Meta> && std::is_trivially_copyable_v<ToolRecord>);

/// Index of the response of (site, tool vertex); tool vertices are numbered over all tools.
inline constexpr std::uint64_t response_index(const Meta& meta, std::uint32_t site, std::uint32_t tool_vertex) {
  return std::uint64_t{site} * meta.tool_vertex_count + tool_vertex;
}

inline constexpr bool is_coupled(const Meta& m) { return m.model == static_cast<std::uint32_t>(Model::coupled); }

/// Degrees beyond int's range are made ones that in_range refuses.
inline constexpr coupled::Degrees coupled_degrees(const Meta& m) {
  const auto degree = [](std::uint32_t d) { return d < 100 ? static_cast<int>(d) : 100; };
  return {degree(m.order),        degree(m.push_degree),    degree(m.straight_degree), degree(m.stiffness_degree),
          degree(m.cubic_degree), degree(m.quartic_degree), degree(m.limit_degree)};
}

/// Bytes from the start of a coupled law (float unit, then its coefficients) to the coefficients of the friction limit,
/// which have 16 bits always.
inline constexpr std::uint32_t coupled_limit_offset(const coupled::Places& p, std::uint32_t bits) {
  return 4 + 2 * ((static_cast<std::uint32_t>(p.limit) * bits + 15) / 16);
}

/// Bytes of a coupled law, a multiple of 4.
inline constexpr std::uint32_t coupled_size(const coupled::Degrees& d, std::uint32_t bits) {
  return (coupled_limit_offset(coupled::places(d), bits) + 2 * (static_cast<std::uint32_t>(d.limit) + 1) + 3) / 4 * 4;
}
inline constexpr std::uint32_t coupled_size(const Meta& m) { return coupled_size(coupled_degrees(m), m.coef_bits); }

/// The coefficients of a coupled law, of so many bits but for those of the friction limit.
template <class Integer>
inline void unpack_coupled(const unsigned char* law, const coupled::Places& p, std::uint32_t bits, Integer* to) {
  coupled::unpack(law + 4, bits, p.limit, to);
  coupled::unpack(law + coupled_limit_offset(p, bits), 16, p.end - p.limit, to + p.limit);
}

/// Bytes of a response before its curves.
inline constexpr std::uint32_t response_head_size(const Meta& m) {
  return static_cast<std::uint32_t>(sizeof(ResponseHead)) + 4 * m.relief_count;
}

/// Bytes of one element of RESPONSES: all that is asked of a response lies together, in as few lines of a cache as can
/// be. After the head come, one after the other, float[relief_count], float[normal_coefs], float[2 lateral_coefs],
/// float[2 growth_coefs + 2 sideways_coefs + friction_coefs]; or a coupled law.
inline constexpr std::uint32_t response_size(const Meta& m) {
  const std::uint32_t curves = m.normal_coefs + 2 * (m.lateral_coefs + m.growth_coefs + m.sideways_coefs);
  return response_head_size(m) + 4 * (curves + m.friction_coefs) + (is_coupled(m) ? coupled_size(m) : 0);
}

/// GRASP: curves Fx, Fy, Fn, kxx, kxy, kyy of as many coefficients each, over (z / (kGraspRange Z) + 1) / 2.
inline constexpr std::uint32_t kGraspCurves = 6;
inline constexpr double kGraspRange = 1.25;
inline constexpr std::uint32_t grasp_size(std::uint32_t coefs) { return 8 + 4 * kGraspCurves * coefs; }

/// TURN: curves tx, ty, tn (N m), kxx, kxy, kyy, kxn, kyn, knn (N m), cxx, cxy, cxn, cyx, cyy, cyn (N), each of as many
/// coefficients, over the same abscissa, as those of GRASP.
inline constexpr std::uint32_t kTurnCurves = 15;
inline constexpr double kLargestTurn = 1.0;  ///< rad, up to which a file may have turned a tool
inline constexpr std::uint32_t turn_size(std::uint32_t coefs) { return 4 + 4 * kTurnCurves * coefs; }

}  // namespace palpate::layout
