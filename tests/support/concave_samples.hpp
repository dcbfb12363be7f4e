// SPDX-License-Identifier: GPL-3.0-or-later
// Small response files of concave and sharp bodies, from a table: hollows, grooves, fissures, a sheet, ridges, a
// saddle.
#pragma once

#include <functional>

#include "tests/support/response_samples.hpp"

namespace palpate::test {

/// A closed surface with its vertices for sites.
struct ConcaveShape {
  std::string name;
  std::vector<Triple> points;  ///< m
  std::vector<std::array<std::uint32_t, 3>> triangles;
  double reach;  ///< m, along x from the middle: as far a ball may be drawn that is to stay off the ends
};

namespace concave_detail {

using Profile = std::vector<std::array<double, 2>>;  // mm: x (or the distance from the axis) and z

/// A block whose top is lifted to `top` (mm of x, y in mm) over a grid of lines; its bottom is the same grid at `low`.
inline ConcaveShape block(const std::string& name, const std::vector<double>& x, const std::vector<double>& y,
                          double low, double reach, const std::function<double(double, double)>& top) {
  ConcaveShape shape{name, {}, {}, 1e-3 * reach};
  const auto nx = static_cast<std::uint32_t>(x.size()), ny = static_cast<std::uint32_t>(y.size());
  for (const bool upper : {true, false}) {
    for (const double yj : y) {
      for (const double xi : x) shape.points.push_back({1e-3 * xi, 1e-3 * yj, 1e-3 * (upper ? top(xi, yj) : low)});
    }
  }
  const auto at = [&](std::uint32_t i, std::uint32_t j, bool upper) { return (upper ? 0 : nx * ny) + j * nx + i; };
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    shape.triangles.push_back({a, b, c});
    shape.triangles.push_back({a, c, d});
  };
  for (std::uint32_t j = 0; j + 1 < ny; ++j) {
    for (std::uint32_t i = 0; i + 1 < nx; ++i) {
      quad(at(i, j, true), at(i + 1, j, true), at(i + 1, j + 1, true), at(i, j + 1, true));
      quad(at(i, j, false), at(i, j + 1, false), at(i + 1, j + 1, false), at(i + 1, j, false));
    }
    quad(at(0, j, true), at(0, j + 1, true), at(0, j + 1, false), at(0, j, false));
    quad(at(nx - 1, j + 1, true), at(nx - 1, j, true), at(nx - 1, j, false), at(nx - 1, j + 1, false));
  }
  for (std::uint32_t i = 0; i + 1 < nx; ++i) {
    quad(at(i + 1, 0, true), at(i, 0, true), at(i, 0, false), at(i + 1, 0, false));
    quad(at(i, ny - 1, true), at(i + 1, ny - 1, true), at(i + 1, ny - 1, false), at(i, ny - 1, false));
  }
  return shape;
}

/// The same with one profile all along y, given for x >= 0 and mirrored.
inline ConcaveShape beam(const std::string& name, const Profile& half, double low, double reach) {
  std::vector<double> x;
  for (auto p = half.rbegin(); p != half.rend(); ++p) {
    if ((*p)[0] > 0) x.push_back(-(*p)[0]);
  }
  for (const auto& p : half) x.push_back(p[0]);
  return block(name, x, {-20, -10, 0, 10, 20}, low, reach, [&](double at, double) {
    for (const auto& p : half) {
      if (p[0] == std::abs(at)) return p[1];
    }
    return 0.0;
  });
}

/// A profile from one point of the axis to another, turned about z.
inline ConcaveShape turned(const std::string& name, const Profile& profile, int sectors, double reach) {
  ConcaveShape shape{name, {}, {}, 1e-3 * reach};
  const auto count = static_cast<std::uint32_t>(sectors), rings = static_cast<std::uint32_t>(profile.size() - 2);
  const auto on_axis = [&](double z) { shape.points.push_back({0, 0, 1e-3 * z}); };
  on_axis(profile.front()[1]);
  for (std::uint32_t r = 1; r <= rings; ++r) {
    for (std::uint32_t k = 0; k < count; ++k) {
      const double angle = 2 * std::numbers::pi * k / count, out = 1e-3 * profile[r][0];
      shape.points.push_back({out * std::cos(angle), out * std::sin(angle), 1e-3 * profile[r][1]});
    }
  }
  on_axis(profile.back()[1]);
  const auto at = [&](std::uint32_t ring, std::uint32_t k) { return 1 + ring * count + k % count; };
  const std::uint32_t last = 1 + rings * count;
  for (std::uint32_t k = 0; k < count; ++k) {
    shape.triangles.push_back({0, at(0, k), at(0, k + 1)});
    for (std::uint32_t r = 0; r + 1 < rings; ++r) {
      shape.triangles.push_back({at(r, k), at(r + 1, k), at(r + 1, k + 1)});
      shape.triangles.push_back({at(r, k), at(r + 1, k + 1), at(r, k + 1)});
    }
    shape.triangles.push_back({at(rings - 1, k), last, at(rings - 1, k + 1)});
  }
  return shape;
}

}  // namespace concave_detail

/// All of them; upright, their tops round the origin.
inline std::vector<ConcaveShape> concave_shapes() {
  using namespace concave_detail;
  std::vector<ConcaveShape> shapes;
  // Creases lie between patches half a millimetre wide: sharp for a ball, whose normals turn over those alone.
  Profile dent{{0, -10}};
  for (const double degrees : {15, 30, 45, 60, 75, 87, 90}) {
    const double angle = degrees * std::numbers::pi / 180;
    dent.push_back({10 * std::sin(angle), -10 * std::cos(angle)});
  }
  dent.insert(dent.end(), {{10.5, 0}, {18, 0}, {30, 0}, {30, -25}, {15, -25}, {0, -25}});
  shapes.push_back(turned("dent", dent, 16, 20));
  shapes.push_back(
      beam("groove_90", {{0, -10}, {0.4, -9.6}, {5, -5}, {9.6, -0.4}, {10, 0}, {10.5, 0}, {20, 0}, {30, 0}}, -25, 20));
  // Sites as far apart as the ball is wide: its bottom is a crease to the eye and a trough to the normals.
  shapes.push_back(beam("trough", {{0, -10}, {3, -7}, {7, -3}, {10, 0}, {13, 0}, {20, 0}, {30, 0}}, -25, 20));
  shapes.push_back(beam("groove_40",
                        {{0, -25}, {0.182, -24.5}, {4.55, -12.5}, {8.918, -0.5}, {9.1, 0}, {9.6, 0}, {20, 0}, {30, 0}},
                        -35, 20));
  shapes.push_back(
      beam("slit", {{0, -8}, {0.3, -7.9}, {0.6, -0.5}, {0.61, 0}, {1.1, 0}, {10, 0}, {20, 0}, {30, 0}}, -25, 20));
  shapes.push_back(
      beam("fissure", {{0, -8}, {2, -7.9}, {2.5, -0.5}, {2.52, 0}, {3, 0}, {10, 0}, {20, 0}, {30, 0}}, -25, 20));
  shapes.push_back(beam("sheet", {{0, 0}, {10, 0}, {20, 0}, {30, 0}}, -1, 20));
  shapes.push_back(
      beam("wall", {{0.3, 0}, {0.5, -0.2}, {0.6, -14.5}, {0.61, -15}, {1.1, -15}, {10, -15}, {30, -15}}, -25, 12));
  shapes.push_back(beam(
      "ridge_30", {{0, 0}, {0.134, -0.5}, {2.68, -10}, {5.226, -19.5}, {5.36, -20}, {5.86, -20}, {12, -20}, {30, -20}},
      -25, 12));
  shapes.push_back(beam(
      "ridge_15", {{0, 0}, {0.066, -0.5}, {1.315, -10}, {2.567, -19.5}, {2.63, -20}, {3.13, -20}, {12, -20}, {30, -20}},
      -25, 12));
  const std::vector<double> lines{-30, -20, -10, 0, 10, 20, 30};
  shapes.push_back(block("saddle", lines, lines, -30, 20, [](double x, double y) { return (x * x - y * y) / 60; }));
  return shapes;
}

inline ResponseFileContent concave_content(const ConcaveShape& shape, const ResponseSampleOptions& options = {}) {
  using namespace sample_detail;
  ResponseFileContent content;
  content.patches = shape.triangles;
  std::vector<Triple> normals(shape.points.size(), Triple{0, 0, 0});
  for (const auto& t : shape.triangles) {
    // Each face by its angle.
    for (int k = 0; k < 3; ++k) {
      const Triple &o = shape.points[t[k]], &a = shape.points[t[(k + 1) % 3]], &b = shape.points[t[(k + 2) % 3]];
      const Triple u = normalised({a[0] - o[0], a[1] - o[1], a[2] - o[2]});
      const Triple v = normalised({b[0] - o[0], b[1] - o[1], b[2] - o[2]});
      const Triple n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
      const double sine = std::hypot(n[0], n[1], n[2]), cosine = u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
      for (int i = 0; i < 3; ++i) normals[t[k]][i] += std::atan2(sine, cosine) * n[i] / sine;
    }
  }
  for (std::size_t i = 0; i < shape.points.size(); ++i) {
    ResponseSite s;
    content.surface_vertices.push_back(shape.points[i]);
    s.normal = normalised(normals[i]);
    s.tangent = tangent_of(s.normal, options.uniform ? 0 : 0.5 * static_cast<double>(i));
    s.depth_limit = kDepthScale;
    content.sites.push_back(s);
  }
  subdivide_surface(content, options.subdivision);
  add_rest(content, options);
  return content;
}

/// The same friction coefficient at every place.
inline void set_friction(ResponseFileContent& content, double mu) {
  const response::Offsets o = response::offsets(content.degrees);
  for (Response& r : content.responses) {
    std::fill(r.coefficients.begin() + o.friction, r.coefficients.end(),
              static_cast<std::int16_t>(std::lround(mu / layout::kFrictionUnit)));
  }
}

}  // namespace palpate::test
