// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces with one known fault each, and sheets bent into bags, rods and plates.
#pragma once

#include "formats/io/error.hpp"
#include "tests/support/shapes.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <numbers>
#include <string>

namespace palpate::test {

inline Surface together(const Surface& a, const Surface& b) {
  Surface all = a;
  const auto vertex = std::int32_t(a.vertices.size()), part = std::int32_t(a.part_names.size());
  all.vertices.insert(all.vertices.end(), b.vertices.begin(), b.vertices.end());
  all.part_names.insert(all.part_names.end(), b.part_names.begin(), b.part_names.end());
  for (const auto& t : b.triangles) all.triangles.push_back({t[0] + vertex, t[1] + vertex, t[2] + vertex});
  for (const auto p : b.parts) all.parts.push_back(p + part);
  return all;
}

inline Surface named(Surface surface, const std::string& name) {
  surface.part_names.assign(1, name);
  return surface;
}

/// 0.2 m cube, 4 x 4 squares a face.
inline Surface cube() { return named(box_surface({0, 0, 0}, {0.2, 0.2, 0.2}, 4), "cube"); }

inline Surface without(Surface surface, const std::function<bool(const Eigen::Vector3d& centre)>& drop) {
  Surface kept = surface;
  kept.triangles.clear();
  kept.parts.clear();
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const auto& t = surface.triangles[i];
    const Eigen::Vector3d centre = (surface.vertices[std::size_t(t[0])] + surface.vertices[std::size_t(t[1])] +
                                    surface.vertices[std::size_t(t[2])]) /
                                   3;
    if (drop(centre)) continue;
    kept.triangles.push_back(t);
    kept.parts.push_back(surface.parts[i]);
  }
  return kept;
}

/// The cube without its lid (z = 0.2), which is a mesh of its own, moved up by `gap` (m).
inline std::pair<Surface, Surface> cube_and_lid(double gap) {
  const auto lid = [](const Eigen::Vector3d& c) { return c.z() > 0.1999; };
  auto top = without(cube(), [&](const Eigen::Vector3d& c) { return !lid(c); });
  for (auto& vertex : top.vertices) vertex.z() += gap;
  return {named(without(cube(), lid), "box"), named(top, "lid")};
}

inline Surface small_hole() {
  Surface s = cube();
  s.triangles.pop_back();
  s.parts.pop_back();
  return s;
}

inline Surface fin() {
  Surface s = cube();
  s.vertices.emplace_back(-0.05, -0.05, 0.05);
  s.triangles.push_back({s.triangles[0][0], s.triangles[0][1], std::int32_t(s.vertices.size()) - 1});
  s.parts.push_back(0);
  return s;
}

inline Surface doubled_face() {
  Surface s = cube();
  s.triangles.push_back(s.triangles[7]);
  s.triangles.push_back({s.triangles[9][1], s.triangles[9][0], s.triangles[9][2]});
  s.parts.resize(s.triangles.size(), 0);
  return s;
}

inline Surface some_flipped() {
  Surface s = cube();
  for (std::size_t t = 0; t < s.triangles.size(); t += 3) std::swap(s.triangles[t][0], s.triangles[t][1]);
  return s;
}

inline Surface inside_out() {
  Surface s = cube();
  for (auto& t : s.triangles) std::swap(t[0], t[1]);
  return s;
}

/// One corner pushed through the opposite wall.
inline Surface pierced() {
  Surface s = cube();
  for (auto& v : s.vertices) {
    if (v.norm() < 1e-9) v = {0.11, 0.12, 0.27};
  }
  return s;
}

inline Surface overlapping() {
  return together(cube(), named(box_surface({0.1, 0.1, 0.1}, {0.3, 0.3, 0.3}, 4), "second"));
}

inline Surface with_degenerate() {
  Surface s = cube();
  // A vertex in the middle of an edge, on one side only: a triangle without area fills the gap.
  const auto t = s.triangles[0];
  s.vertices.push_back((s.vertices[std::size_t(t[0])] + s.vertices[std::size_t(t[1])]) / 2);
  const auto m = std::int32_t(s.vertices.size()) - 1;
  s.triangles[0] = {t[0], m, t[2]};
  s.triangles.push_back({m, t[1], t[2]});
  s.triangles.push_back({t[0], t[1], m});
  s.parts.resize(s.triangles.size(), 0);
  return s;
}

/// Every triangle with its own three vertices.
inline Surface split_vertices(const Surface& source) {
  Surface s = source;
  s.vertices.clear();
  for (auto& t : s.triangles) {
    for (auto& v : t) {
      s.vertices.push_back(source.vertices[std::size_t(v)]);
      v = std::int32_t(s.vertices.size()) - 1;
    }
  }
  return s;
}

/// Two cubes that share one vertex.
inline Surface touching_in_a_point() {
  Surface s = together(cube(), named(box_surface({0.2, 0.2, 0.2}, {0.4, 0.4, 0.4}, 4), "second"));
  std::int32_t first = -1;
  for (std::size_t v = 0; v < s.vertices.size(); ++v) {
    if ((s.vertices[v] - Eigen::Vector3d(0.2, 0.2, 0.2)).norm() > 1e-9) continue;
    if (first < 0) first = std::int32_t(v);
    for (auto& t : s.triangles) std::replace(t.begin(), t.end(), std::int32_t(v), first);
  }
  return s;
}

/// A surface of revolution about z from a closed profile of (radius, height), counter-clockwise; radius 0 at
/// both ends of an open profile closes it on the axis.
inline Surface turned(const std::vector<Eigen::Vector2d>& profile, int around, bool ring) {
  Surface s;
  const auto n = std::int32_t(profile.size());
  for (const auto& p : profile) {
    for (int k = 0; k < around; ++k) {
      const double angle = 2 * std::numbers::pi * k / around;
      s.vertices.emplace_back(p.x() * std::cos(angle), p.x() * std::sin(angle), p.y());
    }
  }
  const auto at = [&](std::int32_t i, int k) { return (i % n) * around + k % around; };
  for (std::int32_t i = 0; i + (ring ? 0 : 1) < n; ++i) {
    for (int k = 0; k < around; ++k) {
      if (profile[std::size_t(i)].x() > 0) s.triangles.push_back({at(i, k), at(i, k + 1), at(i + 1, k)});
      if (profile[std::size_t((i + 1) % n)].x() > 0)
        s.triangles.push_back({at(i, k + 1), at(i + 1, k + 1), at(i + 1, k)});
    }
  }
  // All the vertices of a point on the axis are its first.
  for (auto& t : s.triangles) {
    for (auto& v : t) {
      if (profile[std::size_t(v / around)].x() == 0) v = v / around * around;
    }
  }
  set_one_part(s, "turned");
  return s;
}

/// A bowl: half a spherical shell of outer radius 0.1 m and the given wall, open above.
inline Surface bowl(double wall, int steps = 16) {
  std::vector<Eigen::Vector2d> profile;
  for (int i = 0; i <= steps; ++i) {
    const double a = std::numbers::pi / 2 * i / steps;
    profile.emplace_back(i == 0 ? 0.0 : 0.1 * std::sin(a), -0.1 * std::cos(a));
  }
  for (int i = steps; i >= 0; --i) {
    const double a = std::numbers::pi / 2 * i / steps;
    profile.emplace_back(i == 0 ? 0.0 : (0.1 - wall) * std::sin(a), -(0.1 - wall) * std::cos(a));
  }
  return turned(profile, 48, false);
}

/// A rod of radius 4 mm bent into a ring of radius 0.1 m.
inline Surface bent_rod() {
  std::vector<Eigen::Vector2d> profile;
  for (int i = 0; i < 16; ++i) {
    const double a = 2 * std::numbers::pi * i / 16;
    profile.emplace_back(0.1 + 0.004 * std::cos(a), 0.004 * std::sin(a));
  }
  return turned(profile, 128, true);
}

inline void expect_error(const std::function<void()>& action, ExitCode code, const std::vector<std::string>& pieces) {
  try {
    action();
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    for (const auto& piece : pieces) {
      EXPECT_NE(std::string(error.what()).find(piece), std::string::npos) << "'" << piece << "' in: " << error.what();
    }
  }
}

}  // namespace palpate::test
