// SPDX-License-Identifier: MIT
#include "device/stability/file_stiffness.hpp"

#include "device/device.hpp"
#include "palpate/response/interpolation.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate::device {
namespace {

using runtime::BodyPoint;
using runtime::BlendedResponse;
using runtime::ToolPoint;
using runtime::View;

/// A point of the surface that is the site itself, for every site of a patch.
std::vector<std::pair<std::uint32_t, BodyPoint>> site_points(const View& view) {
  std::vector<bool> seen(view.meta->site_count);
  std::vector<std::pair<std::uint32_t, BodyPoint>> points;
  for (std::uint32_t t = 0; t < view.meta->triangle_count; ++t) {
    for (int k = 0; k < 3; ++k) {
      BodyPoint at{t, {0, 0, 0}};
      at.bary[k] = 1;
      double weights[3];
      site_weights(view, at, weights);
      for (int j = 0; j < 3; ++j) {
        const std::uint32_t site = view.triangle(t).site[j];
        if (weights[j] < 1 - 1e-9 || seen[site]) continue;
        seen[site] = true;
        points.emplace_back(site, at);
      }
    }
  }
  return points;
}

/// The same of a tool's vertices.
std::vector<std::pair<std::uint32_t, ToolPoint>> tool_points(const View& view, std::uint32_t tool) {
  const auto& record = view.tools[tool];
  if (view.tool_patches == nullptr || record.vertex_count == 1) return {{record.first_vertex, ToolPoint{}}};
  std::vector<std::pair<std::uint32_t, ToolPoint>> points;
  for (std::uint32_t p = record.first_patch; p < record.first_patch + record.patch_count; ++p) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t vertex = view.tool_patches[p].vertex[k];
      const auto known = [&](const auto& point) { return point.first == vertex; };
      if (std::any_of(points.begin(), points.end(), known)) continue;
      ToolPoint at{p, {0, 0, 0}};
      at.weights[k] = 1;
      points.emplace_back(vertex, at);
    }
  }
  return points;
}

/// Replaces the best so far by the largest slope of one response.
void search(const BlendedResponse<>& response, const View& view, FileStiffness& best, std::uint32_t tool, std::uint32_t site,
            std::uint32_t vertex) {
  constexpr int kDepths = 24, kWays = 8;
  const Vec3 &n = response.normal(), &x = response.basis_x(), &y = response.basis_y();
  const double step = 1e-5 * view.meta->depth_scale;
  for (int i = 1; i <= kDepths; ++i) {
    const double depth = response.depth_limit() * i / kDepths;
    const runtime::ResponseAtDepth at = response.law().at(depth);
    const double limit = at.friction_coefficient * at.normal_force;  // N, of the friction springs
    for (int way = 0; way <= kWays; ++way) {
      const double angle = 2 * kPi * way / kWays;
      const double far = way == 0 ? 0 : 0.5 * view.meta->tangential_scale;
      if (way > 0 && !(far > 0)) break;
      const runtime::Vec2 aside{far * std::cos(angle), far * std::sin(angle)};
      if (way > 0 && length(at.stiffness * aside) > limit) continue;
      const Slope here = slope(response, aside.x * x + aside.y * y - depth * n, step);
      if (here.norm > best.slope.norm) best = {here, tool, site, vertex, depth, far};
    }
  }
}

}  // namespace

Slope slope_of(const Vec3 (&columns)[3]) {
  // Powers of J^T J, squared again and again: what is left of the largest column is the direction.
  double a[9];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) a[3 * i + j] = dot(columns[i], columns[j]);
  }
  for (int round = 0; round < 30; ++round) {
    const double trace = a[0] + a[4] + a[8];
    if (!(trace > 0 && std::isfinite(trace))) return {std::isfinite(trace) ? 0 : HUGE_VAL, {}};
    double b[9] = {};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        for (int k = 0; k < 3; ++k) b[3 * i + j] += a[3 * i + k] / trace * (a[3 * k + j] / trace);
      }
    }
    std::copy(b, b + 9, a);
  }
  int best = 0;
  for (int k = 1; k < 3; ++k) {
    if (a[4 * k] > a[4 * best]) best = k;
  }
  Slope result;
  result.direction = unit(Vec3{a[best], a[3 + best], a[6 + best]}, {});
  const Vec3& d = result.direction;
  result.norm = length(d.x * columns[0] + d.y * columns[1] + d.z * columns[2]);
  return result;
}

FileStiffness file_stiffness(const View& view) {
  FileStiffness best;
  const auto sites = site_points(view);
  for (std::uint32_t tool = 0; tool < view.meta->tool_count; ++tool) {
    const auto vertices = tool_points(view, tool);
    for (const auto& [site, at] : sites) {
      for (const auto& [vertex, on_tool] : vertices) {
        for (std::uint32_t spin = 0; spin < (view.spins != nullptr ? view.spins[vertex] : 1); ++spin) {
          BlendedResponse<> response;
          response.blend(view, tool, at, on_tool, {1, 0, 0}, runtime::Orientation(spin));
          search(response, view, best, tool, site, vertex + spin);
        }
      }
    }
  }
  return best;
}

}  // namespace palpate::device
