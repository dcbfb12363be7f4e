// SPDX-License-Identifier: GPL-3.0-or-later
// Pseudo-normals, and the closest point of a triangle by its Voronoi regions.
#include "precompute/geometry/feature_normals.hpp"

#include "formats/io/error.hpp"
#include "precompute/geometry/coincident.hpp"
#include "precompute/geometry/topology.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

void check(const Surface& s) {
  if (s.empty()) throw Error(ExitCode::bad_input, "surface without triangles: a query needs at least one");
  for (std::size_t i = 0; i < s.vertices.size(); ++i) {
    if (!s.vertices[i].allFinite()) {
      throw Error(ExitCode::bad_input, "surface vertex " + std::to_string(i) + ": coordinate is not finite");
    }
  }
  const auto count = static_cast<std::int32_t>(s.vertices.size());
  for (std::size_t i = 0; i < s.triangles.size(); ++i) {
    for (const std::int32_t v : s.triangles[i]) {
      if (v < 0 || v >= count) {
        throw Error(ExitCode::bad_input, "surface triangle " + std::to_string(i) + ": vertex " + std::to_string(v) +
                                             " outside [0, " + std::to_string(count) + ")");
      }
    }
  }
}

}  // namespace

TrianglePoint closest_on_triangle(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {a, {1, 0, 0}};
  const Vector3d bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {b, {0, 1, 0}};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double t = d1 - d3 > 0 ? d1 / (d1 - d3) : 0.0;
    return {a + t * ab, {1 - t, t, 0}};
  }
  const Vector3d cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {c, {0, 0, 1}};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double t = d2 - d6 > 0 ? d2 / (d2 - d6) : 0.0;
    return {a + t * ac, {1 - t, 0, t}};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double length = (d4 - d3) + (d5 - d6);
    const double t = length > 0 ? (d4 - d3) / length : 0.0;
    return {b + t * (c - b), {0, 1 - t, t}};
  }
  const double sum = va + vb + vc;
  const double v = vb / sum, w = vc / sum;
  return {a + v * ab + w * ac, {1 - v - w, v, w}};
}

FeatureNormals::FeatureNormals(const Surface& surface) {
  check(surface);
  const std::vector<std::int32_t> welded = coincident(surface.vertices, 0.0);
  const std::size_t count = surface.triangles.size();
  face_.assign(count, Vector3d::Zero());
  edge_.assign(count, {Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()});
  vertex_.assign(surface.vertices.size(), Vector3d::Zero());
  corners_.resize(count);
  std::map<std::pair<std::int32_t, std::int32_t>, Vector3d> edges;
  const auto key = [](std::int32_t a, std::int32_t b) { return std::pair{std::min(a, b), std::max(a, b)}; };

  for (std::size_t i = 0; i < count; ++i) {
    std::array<Vector3d, 3> p;
    for (int k = 0; k < 3; ++k) {
      corners_[i][k] = welded[surface.triangles[i][k]];
      p[k] = surface.vertices[surface.triangles[i][k]];
    }
    const Vector3d cross = (p[1] - p[0]).cross(p[2] - p[0]);
    const double area = cross.norm();
    if (!(area > 0)) continue;
    face_[i] = cross / area;
    for (int k = 0; k < 3; ++k) {
      const Vector3d u = p[(k + 1) % 3] - p[k], v = p[(k + 2) % 3] - p[k];
      vertex_[corners_[i][k]] += std::atan2(area, u.dot(v)) * face_[i];
      edges.try_emplace(key(corners_[i][(k + 1) % 3], corners_[i][(k + 2) % 3]), Vector3d::Zero()).first->second +=
          face_[i];
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    for (int k = 0; k < 3; ++k) {
      const auto found = edges.find(key(corners_[i][(k + 1) % 3], corners_[i][(k + 2) % 3]));
      if (found != edges.end()) edge_[i][k] = found->second;
    }
  }
}

std::vector<std::array<std::int32_t, 2>> FeatureNormals::sharp_lines(const Surface& surface, double degrees,
                                                                     double shortest) const {
  // The sum of two unit normals that turn by t is 2 cos(t / 2) long.
  const double longest = 2 * std::cos(0.5 * degrees * std::numbers::pi / 180);
  std::vector<std::array<std::int32_t, 2>> sharp;
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = corners_[i][(k + 1) % 3], b = corners_[i][(k + 2) % 3];
      // On a closed, oriented surface either triangle of an edge sees it the other way round.
      if (a < b && edge_[i][k].norm() < longest) sharp.push_back({a, b});
    }
  }
  // The length of a line sits at its set's representative.
  Sets lines(surface.vertices.size());
  for (const auto& [a, b] : sharp) lines.join(a, b);
  std::vector<double> length(surface.vertices.size(), 0.0);
  for (const auto& [a, b] : sharp) length[lines.find(a)] += (surface.vertices[a] - surface.vertices[b]).norm();
  std::erase_if(sharp, [&](const auto& e) { return length[lines.find(e[0])] < shortest; });
  return sharp;
}

const Vector3d& FeatureNormals::at(std::int32_t triangle, const Vector3d& weights) const {
  for (int k = 0; k < 3; ++k) {
    if (weights[(k + 1) % 3] == 0 && weights[(k + 2) % 3] == 0) return vertex_[corners_[triangle][k]];
  }
  for (int k = 0; k < 3; ++k) {
    if (weights[k] == 0) return edge_[triangle][k];
  }
  return face_[triangle];
}

}  // namespace palpate::geometry
