// SPDX-License-Identifier: GPL-3.0-or-later
// Curves and surface fields of a response file, by the runtime's own evaluation.
#include "tools/export.hpp"

#include <cstdio>
#include <limits>
#include <optional>
#include <vector>

#include "formats/error.hpp"

namespace palpate::cli {
namespace {

using runtime::BodyPoint;
using runtime::Field;
using runtime::FieldForce;
using runtime::ToolPoint;
using runtime::Vec3;

/// For every site a corner of the contact surface that is the site alone.
std::vector<std::optional<BodyPoint>> site_points(const runtime::View& view) {
  std::vector<std::optional<BodyPoint>> points(view.meta->site_count);
  const std::uint32_t k = view.meta->subdivision;
  for (std::uint32_t t = 0; t < view.meta->triangle_count; ++t) {
    const layout::SurfaceTriangle& triangle = view.triangles[t];
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t a = triangle.grid[corner][0], b = triangle.grid[corner][1];
      if (a != k && b != k && a + b != 0) continue;
      BodyPoint at{t, {0, 0, 0}};
      at.bary[corner] = 1;
      points[triangle.site[a == k ? 0 : b == k ? 1 : 2]] = at;
    }
  }
  return points;
}

/// One vertex of a tool, at one spin.
struct VertexPoint {
  ToolPoint on_tool;
  runtime::Spin spin;
};

/// The vertex alone; none where no patch has it.
std::optional<VertexPoint> vertex_point(const runtime::View& view, std::uint32_t tool, std::uint32_t vertex) {
  const layout::ToolRecord& record = view.tools[tool];
  if (record.vertex_count == 1) return VertexPoint{{record.first_patch, {1, 0, 0}}, {}};
  runtime::Spin spin;
  for (; view.spins != nullptr && view.spins[record.first_vertex + vertex] == 0; --vertex) ++spin.sample;
  for (std::uint32_t p = record.first_patch; p < record.first_patch + record.patch_count; ++p) {
    for (int corner = 0; corner < 3; ++corner) {
      if (view.tool_patches[p].vertex[corner] != record.first_vertex + vertex) continue;
      VertexPoint at{{p, {0, 0, 0}}, spin};
      at.on_tool.weights[corner] = 1;
      return at;
    }
  }
  return {};
}

/// A CSV field in quotes: names may hold commas and quotes (RFC 4180).
std::string quoted(const char* name) {
  std::string text = "\"";
  for (; *name != 0; ++name) text += *name == '"' ? std::string("\"\"") : std::string(1, *name);
  return text + "\"";
}

class CurveWriter {
public:
  CurveWriter(const runtime::View& view, CurveTable& table) : view_(view), table_(table) {
    table.csv =
        "site,tool,tool_vertex,status,kind,depth_m,x_m,y_m,force_x_N,force_y_N,force_normal_N,friction_limit_N\n";
  }

  void begin(std::uint32_t site, const std::string& columns) {
    const layout::Site& s = view_.sites[site];
    n_ = unit(runtime::to_vec(s.normal), {0, 0, 1});
    x_ = unit(tangential(runtime::to_vec(s.tangent), n_), {});
    y_ = cross(n_, x_);
    columns_ = columns;
  }

  void row(const Field& field, const char* kind, double depth, double x, double y) {
    const FieldForce f = field.force(x * x_ + y * y_ - depth * n_);
    char line[300];
    // Zeros of either sign are zero.
    const int used = std::snprintf(line, sizeof line, ",%s,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,", kind, depth, x, y,
                                   dot(f.force, x_) + 0.0, dot(f.force, y_) + 0.0, dot(f.force, n_) + 0.0);
    table_.csv += columns_;
    table_.csv.append(line, static_cast<std::size_t>(used));
    if (view_.has(layout::feature_friction)) {
      std::snprintf(line, sizeof line, "%.9g", f.limit);
      table_.csv += line;
    }
    table_.csv += '\n';
    ++table_.rows;
  }

private:
  const runtime::View& view_;
  CurveTable& table_;
  Vec3 x_, y_, n_;
  std::string columns_;
};

}  // namespace

CurveTable response_curves(const runtime::View& view, double depth, int points) {
  CurveTable table;
  CurveWriter writer(view, table);
  const std::vector<std::optional<BodyPoint>> sites = site_points(view);
  const double last = points - 1, sideways = view.meta->sideways_scale;
  for (std::uint32_t site = 0; site < view.meta->site_count; ++site) {
    for (std::uint32_t tool = 0; tool < view.meta->tool_count; ++tool) {
      const layout::ToolRecord& record = view.tools[tool];
      for (std::uint32_t vertex = 0; vertex < record.vertex_count; ++vertex) {
        const std::optional<VertexPoint> at = vertex_point(view, tool, vertex);
        if (!sites[site] || !at) {
          ++table.left_out;
          continue;
        }
        ++table.responses;
        const layout::ResponseHead& head =
            view.response_head(layout::response_index(*view.meta, site, record.first_vertex + vertex));
        writer.begin(site, std::to_string(site) + "," + quoted(record.name) + "," + std::to_string(vertex) + "," +
                               layout::source_name(head.flags));
        const Field field(view, tool, *sites[site], at->on_tool, at->spin);
        const double limit = head.depth_limit, beside = std::min(depth, limit);
        for (int i = 0; i < points; ++i) writer.row(field, "push", limit * (i / last) * (i / last), 0, 0);
        for (int i = 0; sideways > 0 && i < points; ++i) {
          writer.row(field, "sideways_x", beside, sideways * (2 * i / last - 1), 0);
        }
        for (int i = 0; sideways > 0 && i < points; ++i) {
          writer.row(field, "sideways_y", beside, 0, sideways * (2 * i / last - 1));
        }
      }
    }
  }
  return table;
}

SurfaceFields body_fields(const runtime::View& view, const BodyFieldOptions& options) {
  const std::optional<VertexPoint> pressing = vertex_point(view, options.tool, options.tool_vertex);
  if (!pressing) throw Error(ExitCode::bad_input, "the tool's vertex is in no patch of it: it never touches alone");
  constexpr double kStep = 1e-3;  // of the depth, of the central difference: its error is some 1e-7 of the slope
  constexpr auto kNew = std::numeric_limits<std::uint32_t>::max();
  const bool friction = view.has(layout::feature_friction);
  SurfaceField stiffness{"stiffness", "N/m", {}}, force{"force", "N", {}}, limit{"friction", "N", {}},
      covered{"covered", "", {}};
  SurfaceFields surface;
  surface.numbers = {{"depth_m", options.depth}};
  std::vector<std::uint32_t> numbers(view.meta->vertex_count, kNew);
  const auto array = [](const Vec3& v) {
    return std::array<float, 3>{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  };
  const auto add = [&](std::uint32_t triangle, int corner) {
    BodyPoint at{triangle, {0, 0, 0}};
    at.bary[corner] = 1;
    const Field field(view, options.tool, at, pressing->on_tool, pressing->spin);
    const double z = options.depth, step = kStep * z;
    const auto terms = field.at_depth(z);
    const double rise = field.at_depth(z + step).normal_force - field.at_depth(z - step).normal_force;
    surface.points.push_back(array(position(view, at)));
    surface.normals.push_back(array(field.normal()));
    stiffness.values.push_back(static_cast<float>(rise / (2 * step)));
    force.values.push_back(static_cast<float>(terms.normal_force));
    if (friction) limit.values.push_back(static_cast<float>(terms.limit));
    covered.values.push_back(static_cast<float>(field.covered()));
  };
  for (std::uint32_t t = 0; t < view.meta->triangle_count; ++t) {
    std::array<std::uint32_t, 3> corners{};
    for (int k = 0; k < 3; ++k) {
      std::uint32_t& number = numbers[view.triangles[t].vertex[k]];
      if (number == kNew) {
        number = static_cast<std::uint32_t>(surface.points.size());
        add(t, k);
      }
      corners[static_cast<std::size_t>(k)] = number;
    }
    surface.triangles.push_back(corners);
  }
  surface.fields = {stiffness, force, covered};
  if (friction) surface.fields.push_back(limit);
  return surface;
}

}  // namespace palpate::cli
