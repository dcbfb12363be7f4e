// SPDX-License-Identifier: GPL-3.0-or-later
// Small response files with known answers: a box and a ball with Hertz-like responses.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "formats/response/response.hpp"
#include "palpate/format/spline.hpp"

namespace palpate::test {

/// Contents of a sample file.
struct ResponseSampleOptions {
  bool friction = true;
  bool bias = true;            ///< normal indentations have a tangential force; none where `uniform`
  bool uniform = false;        ///< all sites have the same response
  bool search = false;
  bool spring = false;         ///< the linear spring, response::kSpring
  std::uint32_t bits = 16;     ///< of a coefficient: 8, 12 or 16
  bool softening = false;      ///< contacts that slip have less normal force
  bool bonded = false;         ///< the first tool bonds to the body
  bool bonded_torque = false;  ///< and it was rotated
  int spins = 1;               ///< of every point of capsule and mesh but the capsule's pole
  std::uint32_t subdivision = 1;
  int cells = 4;  ///< box: cells along an edge
  int modes = -1;  ///< of the compliance, beside a half-space; -1: no compliance
  double stiffening = 0;  ///< of the compliance
  enum class Tools { sphere, capsule, mesh, all } tools = Tools::sphere;
};

inline constexpr double kDepthScale = 0.005, kTangentialScale = 0.002, kTipRadius = 0.005, kStemLength = 0.03;
inline constexpr double kBoxSize = 0.06, kBallRadius = 0.03;
inline constexpr double kHertzForce = 2.0;  ///< N at the depth scale
/// N/m, of a bonded contact along the normal and across it, at depth 0.
inline constexpr double kBondedStiffness = 500.0, kBondedTangential = 300.0;
/// N m, of a twist and of a roll; N, force of a roll; rad, angle of rotation.
inline constexpr double kTwistStiffness = 6e-3, kRollStiffness = 4e-3, kRollForce = 0.4, kRotated = 0.2;
inline constexpr double kSampleShear = 15e3;  ///< Pa; Hertz' law with it is nearly that of the uniform samples
inline constexpr double kSoftening = 0.04;  ///< share of F, as over a thin layer

namespace sample_detail {

inline Triple scaled(const Triple& v, double s) { return {v[0] * s, v[1] * s, v[2] * s}; }
inline Triple normalised(const Triple& v) { return scaled(v, 1 / std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])); }
inline Triple tangent_of(const Triple& n, double turn) {
  const Triple a = std::abs(n[0]) < 0.6 ? Triple{1, 0, 0} : Triple{0, 1, 0};
  const double d = a[0] * n[0] + a[1] * n[1] + a[2] * n[2];
  const Triple t = normalised({a[0] - d * n[0], a[1] - d * n[1], a[2] - d * n[2]});
  const Triple b{n[1] * t[2] - n[2] * t[1], n[2] * t[0] - n[0] * t[2], n[0] * t[1] - n[1] * t[0]};
  const double c = std::cos(turn), s = std::sin(turn);
  return {c * t[0] + s * b[0], c * t[1] + s * b[1], c * t[2] + s * b[2]};
}

inline void add_tools(ResponseFileContent& content, ResponseSampleOptions::Tools which) {
  using Tools = ResponseSampleOptions::Tools;
  if (which == Tools::sphere || which == Tools::all) {
    ResponseTool tool{"ball", layout::ToolKind::point_sphere, kTipRadius, kTipRadius, 0, {}, {{0, 0, 0}}};
    tool.vertices.push_back({"tip", {0, 0, -kTipRadius}, {0, 0, -1}, {1, 0, 0}, 0});
    content.tools.push_back(tool);
  }
  if (which == Tools::capsule || which == Tools::all) {
    ResponseTool tool{"rod", layout::ToolKind::profile, kTipRadius, kTipRadius, kStemLength, {}, {}};
    for (const double angle : {0.0, 45.0, 90.0}) {
      const double a = angle * std::numbers::pi / 180;
      std::string name = "tip";
      name += std::to_string(static_cast<int>(angle));
      tool.vertices.push_back({name,
                               {kTipRadius * std::sin(a), 0, -kTipRadius * std::cos(a)},
                               {std::sin(a), 0, -std::cos(a)},
                               {std::cos(a), 0, std::sin(a)},
                               kTipRadius * a});
    }
    const double quarter = kTipRadius * std::numbers::pi / 2;
    tool.vertices.push_back({"stem", {kTipRadius, 0, kStemLength}, {1, 0, 0}, {0, 0, 1}, quarter + kStemLength});
    tool.patches = {{0, 1, 1}, {1, 2, 2}, {2, 3, 3}};
    content.tools.push_back(tool);
  }
  if (which == Tools::mesh || which == Tools::all) {
    // An octahedron: a closed mesh with six corners.
    ResponseTool tool{"gem", layout::ToolKind::mesh, 0.004, 0, 0, {}, {}};
    const Triple axes[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    for (const Triple& n : axes) {
      std::string name = "v";
      name += std::to_string(tool.vertices.size());
      tool.vertices.push_back({name, scaled(n, 0.004), n, tangent_of(n, 0), 0});
    }
    tool.patches = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    content.tools.push_back(tool);
  }
}

/// Every point of capsule and mesh but a pole as many times, turned about its normal.
inline void add_spins(ResponseFileContent& content, int spins) {
  for (ResponseTool& tool : content.tools) {
    if (spins < 2 || tool.vertices.size() == 1) continue;
    std::vector<ResponseToolVertex> all;
    std::vector<std::uint32_t> first;
    for (const ResponseToolVertex& v : tool.vertices) {
      const int count = tool.kind == layout::ToolKind::profile && v.meridian == 0 ? 1 : spins;
      first.push_back(static_cast<std::uint32_t>(all.size()));
      const Triple &n = v.normal, &t = v.tangent;
      const Triple b{n[1] * t[2] - n[2] * t[1], n[2] * t[0] - n[0] * t[2], n[0] * t[1] - n[1] * t[0]};
      for (int k = 0; k < count; ++k) {
        const double c = std::cos(2 * std::numbers::pi * k / count), s = std::sin(2 * std::numbers::pi * k / count);
        all.push_back(v);
        all.back().tangent = {c * t[0] + s * b[0], c * t[1] + s * b[1], c * t[2] + s * b[2]};
        all.back().spins = k == 0 ? static_cast<std::uint32_t>(count) : 0;
      }
    }
    tool.vertices = all;
    for (auto& patch : tool.patches) {
      for (std::uint32_t& corner : patch) corner = first[corner];
    }
  }
}

/// F is 0.9 s^3 + 0.1 s^2 times kHertzForce, K grows like s, mu is 0.3. Each response differs a little from the others
/// unless the file is uniform.
inline void add_responses(ResponseFileContent& content, const ResponseSampleOptions& options) {
  const int bias = options.bias ? 4 : 0;
  const response::Degrees d = options.spring     ? response::kSpring
                              : options.friction ? response::Degrees{5, bias, 3, 2, true}
                                                 : response::Degrees{5, bias, 0, 0, false};
  const response::Offsets o = response::offsets(d);
  content.depth_scale = kDepthScale;
  content.tangential_scale = d.friction_families ? kTangentialScale : 0;
  content.degrees = d;
  content.coef_bits = options.bits;
  content.slip_softening = options.softening;
  const double units = options.bits == 16 ? 1e4 : options.bits == 12 ? 1500 : 100;  // kHertzForce
  const std::size_t count = content.sites.size() * content.tool_vertex_count();
  for (std::size_t i = 0; i < count; ++i) {
    const double vary = options.uniform ? 0 : 0.2 * std::sin(1.7 * static_cast<double>(i));
    Response r;
    r.depth_limit = kDepthScale * (options.uniform ? 1 : 0.9 + 0.1 * std::cos(static_cast<double>(i)));
    r.flags = i % 7 == 3 && !options.uniform ? layout::response_filled : layout::response_solved;
    r.unit = static_cast<float>(kHertzForce / units);
    std::vector<double> c(static_cast<std::size_t>(o.end));
    for (int k = 2; k <= d.normal; ++k) {
      c[k - 2] = (0.9 * response::binomial(k, 3) / response::binomial(5, 3) +
                  0.1 * response::binomial(k, 2) / response::binomial(std::min(d.normal, 5), 2)) *
                 (1 + vary);
    }
    for (int k = o.bias; k < o.stiffness; ++k) c[k] = options.uniform ? 0 : 0.1 * vary * (k % 2 == 0 ? 1 : -0.5);
    for (int k = 0; d.friction_families && k <= d.stiffness; ++k) {
      c[o.stiffness + 3 * k] = 0.75 * (1 - vary);
      c[o.stiffness + 3 * k + 1] = 0.05;
      c[o.stiffness + 3 * k + 2] = -0.04;
    }
    for (int k = 2; d.friction_families && k <= d.stiffness; ++k) c[o.coupling + 3 * (k - 2)] = -0.2;
    for (int k = 0; k < o.end; ++k) {
      const double whole = k < o.friction ? units * c[static_cast<std::size_t>(k)] : 0.3 / layout::kFrictionUnit;
      r.coefficients.push_back(static_cast<std::int16_t>(std::lround(whole)));
    }
    if (options.softening) {
      const double change = options.uniform ? 0 : 0.5 * std::sin(2.3 * static_cast<double>(i));
      r.softening = static_cast<float>(kSoftening * (1 + change));
    }
    content.responses.push_back(r);
  }
  content.provenance = R"({"generator": "test"})";
}

/// The normal force is linear in the depth, and the tangential stiffness grows with the depth. It is isotropic in
/// uniform files.
inline void add_bonded(ResponseFileContent& content, const ResponseSampleOptions& options) {
  constexpr int n = 6;
  content.bonded_coefs = n;
  const double range = layout::kBondedRange * kDepthScale;
  const std::size_t vertices = content.tool_vertex_count();
  for (std::size_t i = 0; i < content.responses.size(); ++i) {
    Response& r = content.responses[i];
    r.bonded.assign(6 * n, 0.0f);
    if (i % vertices >= content.tools.front().vertices.size()) continue;
    const double vary = options.uniform ? 0 : 0.2 * std::sin(1.3 * static_cast<double>(i));
    r.bonded_depth = r.depth_limit / 2;
    r.bonded_pulled = r.depth_limit;
    const auto set = [&](int curve, int k, double value) { r.bonded[curve * n + k] = static_cast<float>(value); };
    for (int k = 0; k < n; ++k) {
      const double z = range * (2 * spline::greville(n, k) - 1);
      const double grows = kBondedTangential * (1 + 0.1 * std::clamp(k, 1, n - 2));
      set(0, k, 20 * vary * z);
      set(1, k, -10 * vary * z);
      set(2, k, kBondedStiffness * (1 + vary) * z);
      set(3, k, grows * (1 + vary));
      set(4, k, 0.3 * grows * vary);
      set(5, k, grows * (1 - vary));
    }
  }
}

/// As of a round tip: a roll about y has a force along x. Files that are not uniform have every entry.
inline void add_bonded_torque(ResponseFileContent& content, const ResponseSampleOptions& options) {
  const auto n = static_cast<int>(content.bonded_coefs);
  content.has_bonded_torque = true;
  for (std::size_t i = 0; i < content.responses.size(); ++i) {
    Response& r = content.responses[i];
    r.bonded_torque.assign(layout::kTorqueCurves * content.bonded_coefs, 0.0f);
    if (!(r.bonded_depth > 0)) continue;
    const double vary = options.uniform ? 0 : 0.2 * std::sin(1.1 * static_cast<double>(i));
    r.rotated = kRotated;
    const double rotation[12] = {
        kRollStiffness * (1 + vary),  0.3 * vary * kRollStiffness, kRollStiffness * (1 - vary),
        0.2 * vary * kRollStiffness,  -0.1 * vary * kRollStiffness, kTwistStiffness,
        0.2 * vary * kRollForce,      kRollForce * (1 + vary),      0.1 * vary * kRollForce,
        -kRollForce * (1 - vary),     0.1 * vary * kRollForce,      -0.2 * vary * kRollForce};
    for (int k = 0; k < n; ++k) {
      const double z = 2 * spline::greville(n, k) - 1, grows = 1 + 0.1 * std::clamp(k, 1, n - 2);
      const auto set = [&](int curve, double value) { r.bonded_torque[curve * n + k] = static_cast<float>(value); };
      for (int j = 0; j < 3; ++j) set(j, 1e-4 * vary * (1 - 2 * j) * (1 + z));
      for (int j = 0; j < 12; ++j) set(3 + j, grows * rotation[j]);
    }
  }
}

/// Adds tools, responses and the search tree to sites, patches and contact surface.
/// A half-space as stiff as the responses' tip feels, and modes that vary smoothly over the body; a quarter are
/// negative.
inline void add_compliance(ResponseFileContent& content, int modes, double stiffening) {
  ResponseCompliance c;
  c.stiffening = stiffening;
  c.modes = static_cast<std::uint32_t>(modes);
  c.negative = c.modes / 4;
  c.poisson = 0.49;
  c.rounding = 1e-3;
  for (std::size_t site = 0; site < content.sites.size(); ++site) {
    c.shear.push_back(kSampleShear);
    for (int m = 0; m < modes; ++m) {
      for (int k = 0; k < 3; ++k) {
        c.values.push_back(3e-3 / (m + 1) * std::cos(30.0 * (m + 1) * content.surface_vertices[site][(k + m) % 3] + k));
      }
    }
  }
  content.compliance = c;
}

inline void add_rest(ResponseFileContent& content, const ResponseSampleOptions& options) {
  add_tools(content, options.tools);
  add_spins(content, options.spins);
  add_responses(content, options);
  if (options.bonded) add_bonded(content, options);
  if (options.bonded_torque) add_bonded_torque(content, options);
  if (options.search) add_search(content);
  if (options.modes >= 0) add_compliance(content, options.modes, options.stiffening);
}

}  // namespace sample_detail

/// A closed box centred at the origin, kBoxSize x kBoxSize x kBoxSize / 2; its top lies in z = kBoxSize / 4.
inline ResponseFileContent box_content(const ResponseSampleOptions& options = {}) {
  using namespace sample_detail;
  ResponseFileContent content;
  const int n = options.cells;
  std::map<std::array<int, 3>, std::uint32_t> numbers;
  std::vector<Triple> sums;
  const auto site = [&](const std::array<int, 3>& cell, const Triple& face) {
    const auto [at, fresh] = numbers.try_emplace(cell, static_cast<std::uint32_t>(numbers.size()));
    if (fresh) {
      ResponseSite s;
      Triple position;
      for (int k = 0; k < 3; ++k)
        position[k] = kBoxSize * (k == 2 ? 0.5 : 1) * (cell[k] / static_cast<double>(n) - 0.5);
      content.surface_vertices.push_back(position);
      s.depth_limit = kDepthScale;
      content.sites.push_back(s);
      sums.push_back({0, 0, 0});
    }
    for (int k = 0; k < 3; ++k) sums[at->second][k] += face[k];
    return at->second;
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {0, n}) {
      Triple face{0, 0, 0};
      face[axis] = side == 0 ? -1 : 1;
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          const auto corner = [&](int di, int dj) {
            std::array<int, 3> cell{};
            cell[axis] = side;
            cell[(axis + 1) % 3] = i + di;
            cell[(axis + 2) % 3] = j + dj;
            return site(cell, face);
          };
          const std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          if (side == 0) {
            content.patches.push_back({a, c, b});
            content.patches.push_back({a, d, c});
          } else {
            content.patches.push_back({a, b, c});
            content.patches.push_back({a, c, d});
          }
        }
      }
    }
  }
  for (std::size_t i = 0; i < content.sites.size(); ++i) {
    content.sites[i].normal = normalised(sums[i]);
    content.sites[i].tangent = tangent_of(content.sites[i].normal, options.uniform ? 0 : 0.5 * static_cast<double>(i));
  }
  subdivide_surface(content, options.subdivision);
  add_rest(content, options);
  return content;
}

/// An octahedron split twice on a ball of kBallRadius round the origin; contact surface on the ball.
inline ResponseFileContent ball_content(const ResponseSampleOptions& options = {}) {
  using namespace sample_detail;
  ResponseFileContent content;
  std::vector<Triple> points = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  content.patches = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int round = 0; round < 2; ++round) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    std::vector<std::array<std::uint32_t, 3>> finer;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(points.size()));
      if (fresh) {
        points.push_back(
            normalised({points[a][0] + points[b][0], points[a][1] + points[b][1], points[a][2] + points[b][2]}));
      }
      return at->second;
    };
    for (const auto& [a, b, c] : content.patches) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    content.patches = finer;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    ResponseSite s;
    s.normal = points[i];
    content.surface_vertices.push_back(scaled(points[i], kBallRadius));
    s.tangent = tangent_of(s.normal, options.uniform ? 0 : 0.7 * static_cast<double>(i));
    s.depth_limit = kDepthScale;
    content.sites.push_back(s);
  }
  subdivide_surface(content, options.subdivision);
  for (Triple& p : content.surface_vertices) p = scaled(normalised(p), kBallRadius);
  add_rest(content, options);
  return content;
}

}  // namespace palpate::test
