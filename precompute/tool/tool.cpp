// SPDX-License-Identifier: GPL-3.0-or-later
// From a tool's description to its shape and its contact vertices.
#include "precompute/tool/tool.hpp"

#include "precompute/tool/mesh_tool.hpp"
#include "precompute/tool/shapes.hpp"
#include "precompute/tool/taper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace palpate::tool {
namespace {

using Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;

// A capsule's contact vertex at an arc length along its profile: the tip's quarter circle, then the stem.
ToolVertex capsule_vertex(const ToolScene& scene, double meridian) {
  const double shoulder = scene.radius * kPi / 2;
  ToolVertex v;
  v.curvature_radius = scene.radius;
  v.meridian = meridian;
  const double angle = std::min(meridian, shoulder) / scene.radius;
  v.normal = {std::sin(angle), 0, -std::cos(angle)};
  v.tangent = {std::cos(angle), 0, std::sin(angle)};
  v.point = scene.radius * v.normal + Vector3d(0, 0, std::max(0.0, meridian - shoulder));
  return v;
}

void add_capsule(Tool& tool) {
  // The response changes fastest just before the stem lies flat: the angles crowd towards 90 degrees.
  constexpr double kAngles[] = {0, 35, 58, 70, 78, 84, 87.5, 90};
  const double r = tool.scene.radius;
  for (const double degrees : kAngles) {
    tool.vertices.push_back(capsule_vertex(tool.scene, r * degrees * kPi / 180));
    tool.vertices.back().name = degrees == 0    ? "tip"
                                : degrees == 90 ? "shoulder"
                                                : std::string("tip-").append(std::to_string(std::lround(degrees)));
  }
  for (const double share : {0.5, 1.0}) {
    tool.vertices.push_back(capsule_vertex(tool.scene, r * kPi / 2 + share * tool.scene.length));
    tool.vertices.back().name = share == 1.0 ? "stem-end" : "stem-middle";
  }
  if (!tool.scene.whole) {
    // One vertex that answers for the tip alone: the runtime must not find contacts along the stem.
    tool.vertices.resize(1);
    tool.kind = ToolKind::point_sphere;
  }
  for (std::int32_t k = 0; k + 1 < static_cast<std::int32_t>(tool.vertices.size()); ++k) {
    tool.patches.push_back({k, k + 1, k + 1});
  }
}

// Every point becomes as many vertices as it has spins; a profile's pole is round and has one.
void add_spins(Tool& tool) {
  const int spins = tool.scene.spins;
  if (spins < 2) return;
  std::vector<ToolVertex> all;
  std::vector<std::int32_t> first;
  for (const ToolVertex& v : tool.vertices) {
    first.push_back(static_cast<std::int32_t>(all.size()));
    const bool round = tool.kind == ToolKind::profile && v.meridian == 0;
    for (int k = 0; k < (round ? 1 : spins); ++k) {
      all.push_back(spun(v, 2 * kPi * k / spins));
      all.back().spins = round ? 1 : k == 0 ? spins : 0;
      if (k > 0) all.back().name.append(" ").append(std::to_string(k)).append("/").append(std::to_string(spins));
    }
  }
  tool.vertices = std::move(all);
  for (auto& patch : tool.patches) {
    for (std::int32_t& corner : patch) corner = first[static_cast<std::size_t>(corner)];
  }
}

ToolVertex& add_tip(Tool& tool) {
  ToolVertex v;
  v.name = "tip";
  v.point = {0, 0, -tool.scene.radius};
  v.curvature_radius = tool.scene.radius;
  return tool.vertices.emplace_back(v);
}

void add_punch(Tool& tool) {
  ToolVertex v;
  v.name = "face";
  v.flat_radius = tool.scene.radius;
  v.curvature_radius = tool.scene.radius;
  tool.vertices.push_back(v);
  const double rim = tool.scene.radius - tool.scene.edge_radius;
  for (int k = 0; k < 64; ++k) {
    const double angle = 2 * kPi * k / 64;
    tool.edges.push_back({{rim * std::cos(angle), rim * std::sin(angle), 0}, 0.08 * tool.scene.radius});
  }
}

}  // namespace

Tool make_tool(const ToolScene& scene) {
  Tool tool;
  tool.name = scene.name;
  tool.scene = scene;
  switch (scene.shape) {
    case ToolScene::Shape::sphere:
      tool.shape = make_sphere(scene.radius);
      add_tip(tool);
      break;
    case ToolScene::Shape::punch:
      if (tool.scene.edge_radius <= 0) tool.scene.edge_radius = scene.radius / 10;
      tool.shape = make_punch(scene.radius, tool.scene.edge_radius, scene.length);
      tool.kind = ToolKind::profile;
      add_punch(tool);
      break;
    case ToolScene::Shape::capsule:
      tool.shape = make_capsule(scene.radius, scene.length);
      tool.kind = ToolKind::profile;
      add_capsule(tool);
      break;
    case ToolScene::Shape::cone:
    case ToolScene::Shape::needle: {
      const bool needle = scene.shape == ToolScene::Shape::needle;
      const double widest = needle ? scene.shaft_radius : std::numeric_limits<double>::infinity();
      tool.shape = make_taper(scene.radius, scene.half_angle, widest > 0 ? widest : 4 * scene.radius, scene.length);
      add_tip(tool).cone_slope = std::tan(scene.half_angle);
      break;
    }
    case ToolScene::Shape::mesh:
      tool.kind = ToolKind::mesh;
      add_mesh(tool);
      break;
  }
  if (tool.patches.empty()) tool.patches.push_back({0, 0, 0});
  add_spins(tool);
  return tool;
}

ToolVertex spun(ToolVertex vertex, double angle) {
  vertex.tangent = Eigen::AngleAxisd(angle, vertex.normal) * vertex.tangent;
  return vertex;
}

namespace {

// Ratio of the depth to the profile's height at the contact's rim, for a height that is the power m of the width
// (Sneddon 1965): pi/2 for a cone, 2 for a ball.
double depth_over_height(double m) { return std::sqrt(kPi) * std::tgamma(m / 2 + 1) / std::tgamma(m / 2 + 0.5); }

double contact_radius(const std::vector<ToolVertex::Width>& profile, double depth) {
  double last_depth = 0, last_half = 0;
  for (std::size_t k = 0; k + 1 < profile.size(); ++k) {
    const ToolVertex::Width &here = profile[k], &next = profile[k + 1];
    const double grown = std::log(next.half / here.half);
    const double m = grown > 0 ? std::clamp(std::log(next.height / here.height) / grown, 1.0, 20.0) : 20.0;
    const double reached = std::max(last_depth, here.height * depth_over_height(m));
    if (reached >= depth) {
      if (k == 0) return here.half * std::min(1.0, std::sqrt(depth / reached));
      return last_half + (here.half - last_half) * (depth - last_depth) / (reached - last_depth);
    }
    last_depth = reached;
    last_half = here.half;
  }
  return last_half;
}

}  // namespace

double contact_radius(const ToolVertex& vertex, double depth) {
  if (vertex.flat_radius > 0) return vertex.flat_radius;
  if (!vertex.profile.empty()) {
    return std::max(contact_radius(vertex.profile, depth), std::sqrt(vertex.edge_radius * depth));
  }
  const double ball = std::min(vertex.curvature_radius, std::sqrt(vertex.curvature_radius * depth));
  return std::max(ball, 2 / kPi * vertex.cone_slope * depth);
}

ToolVertex interpolate(const Tool& tool, std::int32_t patch, const Vector3d& weights) {
  const auto& corners = tool.patches[patch];
  const ToolVertex &a = tool.vertices[corners[0]], &b = tool.vertices[corners[1]], &c = tool.vertices[corners[2]];
  if (tool.scene.shape == ToolScene::Shape::capsule) {
    return capsule_vertex(tool.scene, weights[0] * a.meridian + weights[1] * b.meridian + weights[2] * c.meridian);
  }
  if (tool.kind != ToolKind::mesh) return a;  // the only one of its patch
  ToolVertex v = mesh_vertex(tool, weights[0] * a.point + weights[1] * b.point + weights[2] * c.point);
  v.tangent = (a.tangent - a.tangent.dot(v.normal) * v.normal).normalized();
  return v;
}

Eigen::Isometry3d touching_pose(const ToolVertex& vertex, const ContactFrame& frame) {
  Eigen::Matrix3d in_tool, in_body;
  in_tool << vertex.tangent, vertex.normal.cross(vertex.tangent), vertex.normal;
  in_body << frame.x, (-frame.n).cross(frame.x), -frame.n;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = in_body * in_tool.transpose();
  pose.translation() = frame.origin - pose.linear() * vertex.point;
  return pose;
}

}  // namespace palpate::tool
