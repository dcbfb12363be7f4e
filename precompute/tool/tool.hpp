// SPDX-License-Identifier: GPL-3.0-or-later
// Rigid tools: a signed distance function in the tool's frame, and the points by which they may touch first.
#pragma once

#include "formats/journal/samples.hpp"
#include "formats/scene/scene.hpp"

#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <string>
#include <vector>

namespace palpate::tool {

struct DistanceSample {
  double value = 0.0;                                 ///< m, negative inside the tool
  Eigen::Vector3d gradient{0, 0, 1};                  ///< outward; unit but at the rounded edges of a mesh
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();  ///< 1/m

  [[nodiscard]] Eigen::Vector3d normal() const { return gradient.normalized(); }
};

/// Signed distance to the tool in its own frame (m). Thread-safe.
class ToolShape {
public:
  virtual ~ToolShape() = default;
  [[nodiscard]] virtual DistanceSample distance(const Eigen::Vector3d& point) const = 0;
  /// Cheap, and not above the distance (m): excludes places where no contact can be.
  [[nodiscard]] virtual double lower_bound(const Eigen::Vector3d& point) const { return distance(point).value; }
  /// Cheaper than the distance: true where it is surely above `gap` (m), false says nothing.
  [[nodiscard]] virtual bool surely_beyond(const Eigen::Vector3d& /*point*/, double /*gap*/) const { return false; }
  /// Axis-aligned bounds in the tool's frame.
  [[nodiscard]] virtual Eigen::AlignedBox3d bounds() const = 0;
};

/// A vertex of the tool's patches, in the tool's frame.
struct ToolVertex {
  std::string name;
  Eigen::Vector3d point{0, 0, 0};
  Eigen::Vector3d normal{0, 0, -1};  ///< outward unit normal
  Eigen::Vector3d tangent{1, 0, 0};  ///< unit, orthogonal to normal; laid along the contact frame's x
  double curvature_radius = 0.0;     ///< m, the smaller principal radius of the tool's surface here; 0: unknown
  double flat_radius = 0.0;          ///< m, radius of a flat face; 0 where the tool is curved
  double cone_slope = 0.0;           ///< tangent of the half angle of a cone behind the tip; 0: none
  double meridian = 0.0;             ///< m, arc length from the tip's pole (profile tools)
  /// At how many angles about its normal the point is sampled: as many vertices that follow each other, all but the
  /// first with 0 here, the k-th with the tangent turned by k / spins of a circle.
  int spins = 1;
  /// Half the tool's least width at a height over the plane that touches it here (m).
  struct Width {
    double half = 0.0, height = 0.0;
  };
  std::vector<Width> profile;  ///< meshes: at growing heights; empty: as the radii say
  double edge_radius = 0.0;    ///< m, meshes: of what is sharp
};

/// A point of a sharp edge (tool frame): meshes that it touches want elements of about `size` there.
struct ToolEdgePoint {
  Eigen::Vector3d point{0, 0, 0};
  double size = 0.0;  ///< m
};

/// How the runtime finds the tool's contact point; see formats/response/response-file.md.
enum class ToolKind : std::uint32_t { point_sphere = 0, profile = 1, mesh = 2 };

/// A tool as scene, shape and contact vertices. Tool frame: the tip points along -z, the handle along +z.
/// sphere: centre at the origin. punch: end face in the plane z = 0. capsule: tip cap's centre at the
/// origin, the axis along +z to (0, 0, length). cone, needle: the rounded tip's centre at the origin.
struct Tool {
  std::string name;
  ToolKind kind = ToolKind::point_sphere;
  ToolScene scene;
  std::shared_ptr<const ToolShape> shape;
  std::vector<ToolVertex> vertices;
  /// Patches (of first spins): one vertex (sphere: {v, v, v}), a segment of a meridian (profile: {a, b, b}) or a
  /// triangle.
  std::vector<std::array<std::int32_t, 3>> patches;
  std::vector<ToolEdgePoint> edges;
};

/// Radius of the contact that `vertex` makes at `depth` (m): sqrt(R depth) up to R (Hertz), the flat face's, or of a
/// cone 2/pi tan(half angle) depth; of a mesh that of a body of revolution with its profile (Sneddon 1965).
double contact_radius(const ToolVertex& vertex, double depth);

/// Builds a tool. Throws Error(bad_input) for a mesh that is not closed or faces inward, Error(io) where it cannot be
/// read.
Tool make_tool(const ToolScene& scene);

/// The vertex with its tangent turned about its normal (rad): the contact frame's x comes to lie there, so that
/// touching_pose turns the tool by as much about the frame's n, by the right hand.
ToolVertex spun(ToolVertex vertex, double angle);

/// A point inside a tool patch, interpolated (weights sum to 1), on the tool's surface; at its first spin.
ToolVertex interpolate(const Tool& tool, std::int32_t patch, const Eigen::Vector3d& weights);

/// Pose (tool frame to body frame) at which `vertex` touches frame.origin with opposite normals and the
/// tangent along frame.x.
Eigen::Isometry3d touching_pose(const ToolVertex& vertex, const ContactFrame& frame);

}  // namespace palpate::tool
