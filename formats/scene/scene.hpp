// SPDX-License-Identifier: MIT
// The content of a scene file, with every default in one place. Read by read_scene (scene.cpp, toml++).
#pragma once

#include "formats/scene/frame.hpp"

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// How a surface that is not a clean closed manifold is made into one.
enum class RepairMode { automatic, none, repair, wrap };

/// One surface file and the named meshes to take from it.
struct SurfaceSource {
  std::filesystem::path file;       ///< absolute, or relative to the working directory after reading
  std::vector<std::string> meshes;  ///< names of meshes or nodes to take; empty takes all
  double unit = 1.0;                ///< metres per file unit (scene: units = "m" | "cm" | "mm" | "in")
};

/// Which separate pieces of a label are kept: those that matter (see label_mask), the largest, or all.
enum class Islands { automatic, largest, all };

/// Voxels of a label image that belong together: all that have one of the values, or are in one of the segments.
struct LabelSource {
  std::filesystem::path file;         ///< the image; empty: none
  double unit = 0.0;                  ///< metres per file unit; 0: what the file states, else 1 mm
  std::vector<int> values;            ///< of the voxels
  std::vector<std::string> segments;  ///< names, where the file has them
  Islands islands = Islands::automatic;
};

struct BodyScene {
  std::vector<SurfaceSource> surfaces;  ///< joined into one body
  LabelSource labels;                   ///< in place of surfaces
  RepairMode repair = RepairMode::automatic;
  double wrap_alpha = 0.0;         ///< m; 0 chooses the smallest tool's radius, within 1/50 to 1/20 of the diagonal
  double wrap_offset = 0.0;        ///< m; 0 chooses wrap_alpha / 30
  int smooth = 0;                  ///< rounds of interpolating subdivision of the clean surface, [0, 3]
  double capsule_thickness = 0.0;  ///< m, of a thin sheet on the outside; 0: none
  double capsule_young = 0.0;      ///< Pa, of that sheet; > 0 where there is one
};

/// A hyperelastic material. Laws with moduli of their own set `young` from them when they are read.
struct MaterialScene {
  enum class Law { neo_hookean, mooney_rivlin, ogden, veronda_westmann, holzapfel, st_venant, linear };
  struct OgdenTerm {
    double mu = 0.0;     ///< Pa
    double alpha = 0.0;  ///< not 0
  };
  enum class Volumetric { coupled, isochoric };
  Law law = Law::neo_hookean;
  Volumetric volumetric = Volumetric::coupled;  ///< isochoric: the law sees J^(-1/3) F; not linear, not st_venant
  std::string tissue;              ///< neo_hookean: what young was taken from; empty: the scene says it
  double young = 5e3;              ///< Pa at small strain (of the matrix, where there are fibres), > 0
  double poisson = 0.49;           ///< at small strain, [0, 0.4999]; linear and St. Venant: [0, 0.45]
  double c10 = 0.0, c01 = 0.0;     ///< Pa; mooney_rivlin
  std::vector<OgdenTerm> terms;    ///< ogden
  double c1 = 0.0, beta = 0.0;     ///< Pa, 1; veronda_westmann
  std::optional<double> c2;        ///< Pa; veronda_westmann; none: -c1 beta / 2
  double k1 = 0.0, k2 = 1.0;       ///< Pa, 1; holzapfel
  double dispersion = 0.0;         ///< holzapfel: [0, 1/3], from aligned fibres to none
  Eigen::Vector3d fibre{0, 0, 0};  ///< holzapfel: unit direction, where there is no centreline
  SurfaceSource centreline;        ///< holzapfel: curves that the fibres run along; without a file: none
};

/// Young's modulus at small strain (Pa): of the law's own moduli, or `young` where it has none.
double small_strain_young(const MaterialScene& material);

/// An inclusion with its own material: a closed inner surface, a shape given by its measures, or a label of an image.
struct RegionScene {
  enum class Shape { surface, ellipsoid, box, labels };
  std::string name;
  Shape shape = Shape::surface;
  SurfaceSource surface;                               ///< surface
  LabelSource labels;                                  ///< labels
  Eigen::Vector3d centre{0, 0, 0}, radii{0, 0, 0};     ///< m; ellipsoid (a sphere is one with equal radii)
  Eigen::Vector3d box_min{0, 0, 0}, box_max{0, 0, 0};  ///< m; box
  MaterialScene material;
};

/// A hollow inside the body: a closed surface, or a label of an image.
struct CavityScene {
  std::string name;
  SurfaceSource surface;
  LabelSource labels;  ///< in place of the surface
};

struct SupportScene {
  enum class Kind { mesh, box, half_space, distance };
  enum class Type { fixed, spring, slider };
  Kind kind = Kind::half_space;
  Type type = Type::fixed;
  double stiffness = 0.0;                              ///< N/m^3; spring: of the bed, > 0
  std::string mesh;                                    ///< mesh: the part name that is held
  Eigen::Vector3d box_min{0, 0, 0}, box_max{0, 0, 0};  ///< box (m)
  Eigen::Vector3d point{0, 0, 0}, normal{0, 0, 1};     ///< half_space: held where (x - point) . normal <= 0 (m)
  SurfaceSource other;                                 ///< distance: held within `within` of this surface
  double within = 0.0;                                 ///< m
};

/// Loads on the body before any tool touches it.
struct PrestressScene {
  Eigen::Vector3d gravity{0, 0, 0};  ///< m/s^2, [-1000, 1000]
  double density = 1060.0;           ///< kg/m^3 of body and regions, stress-free, (0, 1e5]; gravity acts on it
  double pressure = 0.0;             ///< Pa inside cavities over that outside, [0, 1e9]; 0: none
  std::string cavity;                ///< only in the cavity whose wall came from this mesh; empty: in every one
  Eigen::Vector3d stretch{1, 1, 1};  ///< along the axes, of where supports hold the body, [0.2, 5]

  [[nodiscard]] bool any() const { return !gravity.isZero(0) || pressure > 0 || !stretch.isOnes(0); }
};

struct ToolScene {
  enum class Shape { sphere, punch, capsule, mesh, cone, needle };
  std::string name = "tool";
  Shape shape = Shape::sphere;
  double radius = 0.005;      ///< m; sphere, punch (outer radius), capsule; cone, needle: of the rounded tip
  double edge_radius = 0.0;   ///< m; punch: rounding of its rim; 0 chooses radius / 10; mesh: scale on which its facets
                              ///< and edges are rounded; 0 chooses 1/20 of its smallest extent
  double length = 0.03;       ///< m; capsule: distance between the two cap centres; punch, cone, needle: height
  double half_angle = 0.5;    ///< rad; cone, needle: between axis and side, [0.02, 1.5]
  double shaft_radius = 0.0;  ///< m; needle: above its point, > radius; 0 chooses 4 radii
  SurfaceSource surface;      ///< mesh: a closed surface, its frame is the tool frame
  bool whole = true;          ///< capsule: contacts = "all" (every patch of the tool) or "tip" (one tool vertex)
  double spacing = 0.0;       ///< m; mesh: edge length of the tool patches; 0 chooses a third of its size
  int spins = 1;              ///< capsule as a whole, mesh: angles about the normal at which it is sampled, [1, 64]
  double grasp_depth = 0.0;   ///< m, at most sampling.depth; > 0: the contact that forms there can be bonded and pulled
  double grasp_turn = 0.0;    ///< rad, [0, 0.5], with grasp_depth; > 0: the bonded tool is turned by as much, too
};

struct SamplingScene {
  enum class FrictionLimit { estimated, solved };
  double spacing = 0.0;  ///< m; edge length of the body patches; 0: sites are added until response.tolerance holds
  double margin_spacing = 0.0;    ///< m; edge length at sharp margins; 0 chooses spacing / 2; = spacing: uniform
  std::vector<Eigen::Vector3d> sites;  ///< m; places that are sampled beside those of the spacing, all of `depth` deep
  double depth = 0.005;           ///< m; deepest push, > 0
  double depth_fraction = 0.6;    ///< of the local thickness, (0, 0.8]
  int normal_points = 12;         ///< points of a normal curve, [4, 64]
  int tangential_depths = 3;      ///< [2, 8], at most normal_points
  int tangential_directions = 4;  ///< [4, 16], even
  int tangential_points = 3;      ///< points of one tangential push, [2, 16]
  /// mu(depth): predicted from the slopes of the contact, or solved by drawing the tool aside until all of it slips.
  FrictionLimit friction_limit = FrictionLimit::estimated;
  int most_sites = 2000;      ///< where sites are added: beyond it no more are, [8, 1000000]
  double max_refused = 0.03;  ///< share of refused pairs beyond which build and fit exit with 5, [0, 0.5]
  /// Region of the body's surface whose sites are baked: everything, or only inside this box (m).
  std::optional<std::pair<Eigen::Vector3d, Eigen::Vector3d>> within_box;
};

struct ResponseScene {
  enum class Search { automatic, none, bvh };
  double path_share = 0.1;  ///< with friction: of the pairs that are also solved along paths which only test, [0, 1]
  Search search = Search::automatic;
  double tolerance = 0.05;  ///< requested relative force error, (0, 1); the responses' degrees meet half of it
  double floor = 0.0;       ///< N, >= 0: errors of smaller forces are relative to this one
  double max_residual = 1;  ///< relative error beyond which a pair's fit is refused, [0.01, 1000]
  /// m; largest distance between the contact surface and the body's; 0 chooses 1/40 of the smallest tool radius
  double surface_tolerance = 0.0;
};

struct SolverScene {
  double mesh_size = 0.35;  ///< element edge at the contact over the contact radius at full depth, [0.05, 1]
  double growth = 0.65;     ///< growth of the edge length per distance from the contact, (0, 1]
  double max_size = 0.0;    ///< m; longest edge far away; 0: 1/8 of the box's diagonal, or twice the median wall
  double rim_size = 0.0;    ///< element edge at the rim of the deepest contact, in contact radii, [0, 1]; 0: no ring
  double time_limit = 30;   ///< s of processor time for one pair; what was solved until then is kept
  double memory_limit = 1000;  ///< MB of a pair's Cholesky factor; a mesh that needs more is refused
  /// Share of the pairs, at least one, whose normal indentation is also solved on a finer mesh, [0, 1]; 0: none.
  double check_share = 0.01;
  int check_seed = 1;  ///< of the draw of these pairs
};

/// Compliance of the body, by which contacts that lie near each other feel each other.
struct ComplianceScene {
  enum class Between { none, contacts };
  Between between = Between::none;
  double tolerance = 0.03;  ///< error between sites over a site's own compliance, (0, 1): it chooses the modes
  int modes = 0;            ///< [0, 128], a multiple of 8; 0: chosen
};

/// A whole scene. Every member has its documented default; read_scene checks ranges.
struct Scene {
  std::filesystem::path file;
  std::string name;  ///< default: the file's stem
  /// Frame of the scene's coordinates; files that state another frame are turned into it. Unstated: the body's.
  Frame frame = Frame::unstated;
  BodyScene body;
  MaterialScene material;
  std::vector<RegionScene> regions;
  std::vector<CavityScene> cavities;
  std::vector<SupportScene> supports;  ///< none given: the lowest tenth of the body along z is held
  PrestressScene prestress;            ///< none given: the body starts free of stress
  std::vector<ToolScene> tools;        ///< none given: one sphere tip of radius 5 mm
  double friction = 0.0;               ///< Coulomb coefficient, [0, 2]; 0: a frictionless scene
  SamplingScene sampling;
  ResponseScene response;
  SolverScene solver;
  ComplianceScene compliance;  ///< none given: contacts are added
};

/// Reads and checks a scene. Throws Error(bad_input) "file:line: key: what, allowed range" on unknown
/// keys, wrong types and out-of-range values; Error(io) when the file cannot be read.
Scene read_scene(const std::filesystem::path& file);

/// Every file that a scene names but the recordings (SceneSources), there or not.
std::vector<std::filesystem::path> files_of(const Scene& scene);

/// Scope of a canonical text: everything that changes a result, or only what changes a solve. The latter leaves out the
/// keys of the fit, such as the refusal limit, because a new fit needs no new solves.
enum class CanonicalScope { everything, solves };

/// Canonical text of everything in the scene that changes a result (for content hashes; no paths, no names:
/// the contents of surface files are to be hashed beside it).
std::string canonical_text(const Scene& scene, CanonicalScope scope = CanonicalScope::everything);

/// Texts that earlier programs gave the same scene with CanonicalScope::solves, for work folders that they baked.
/// They had 2 tangential depths by default, and paths only in scenes that requested them.
std::vector<std::string> earlier_canonical_texts(const Scene& scene);

/// Reference of every key with its help, default and allowed range: TOML that reads back as the defaults.
std::string scene_reference();

}  // namespace palpate
