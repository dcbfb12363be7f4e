// SPDX-License-Identifier: GPL-3.0-or-later
// Curves and surface fields of a response file, evaluated by the runtime's response law.
#include "tools/inspect/export.hpp"

#include <cstdio>
#include <limits>
#include <optional>
#include <vector>

#include "formats/io/error.hpp"
#include "palpate/response/interpolation.hpp"
#include "tools/inspect/one_response.hpp"

namespace palpate::cli {
namespace {

using runtime::BodyPoint;
using runtime::ToolPoint;
using runtime::Vec3;

/// The point of a tool that is a vertex alone, at its first spin. Empty where no patch has it.
std::optional<ToolPoint> vertex_point(const runtime::View& view, std::uint32_t tool, std::uint32_t vertex) {
  const layout::ToolRecord& record = view.tools[tool];
  if (record.vertex_count == 1) return ToolPoint{record.first_patch, {1, 0, 0}};
  for (std::uint32_t p = record.first_patch; p < record.first_patch + record.patch_count; ++p) {
    for (int corner = 0; corner < 3; ++corner) {
      if (view.tool_patches[p].vertex[corner] != record.first_vertex + vertex) continue;
      ToolPoint at{p, {0, 0, 0}};
      at.weights[corner] = 1;
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

  void begin(const std::string& columns) { columns_ = columns; }

  void row(const runtime::ResponseLaw& law, const char* kind, double depth, double x, double y) {
    double normal = 0, limit = 0;
    runtime::Vec2 across;
    if (depth > 0) {
      const runtime::ResponseAtDepth r = law.at(depth);
      const runtime::Vec2 e{x, y};
      normal = r.normal_force + dot(r.bias_slope, e) + 0.5 * quadratic(r.normal_coupling, e);
      across = -1 * (r.bias + r.stiffness * e);
      limit = r.friction_coefficient * r.normal_force;
    }
    char line[300];
    // + 0.0 turns a negative zero into zero.
    const int used = std::snprintf(line, sizeof line, ",%s,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,", kind, depth, x, y,
                                   across.x + 0.0, across.y + 0.0, normal + 0.0);
    table_.csv += columns_;
    table_.csv.append(line, static_cast<std::size_t>(used));
    if (view_.has(layout::feature_friction)) {
      std::snprintf(line, sizeof line, "%.9g", limit);
      table_.csv += line;
    }
    table_.csv += '\n';
    ++table_.rows;
  }

private:
  const runtime::View& view_;
  CurveTable& table_;
  std::string columns_;
};

}  // namespace

CurveTable response_curves(const runtime::View& view, double depth, int points) {
  CurveTable table;
  CurveWriter writer(view, table);
  const double last = points - 1, tangential = view.meta->tangential_scale;
  for (std::uint32_t site = 0; site < view.meta->site_count; ++site) {
    for (std::uint32_t tool = 0; tool < view.meta->tool_count; ++tool) {
      const layout::ToolRecord& record = view.tools[tool];
      for (std::uint32_t vertex = 0; vertex < record.vertex_count; ++vertex) {
        ++table.responses;
        const std::uint64_t index = layout::response_index(*view.meta, site, record.first_vertex + vertex);
        const layout::ResponseHead& head = view.response_head(index);
        writer.begin(std::to_string(site) + "," + quoted(record.name) + "," + std::to_string(vertex) + "," +
                     layout::source_name(head.flags));
        const runtime::ResponseLaw law = response_law(view, index);
        const double limit = head.depth_limit, beside = std::min(depth, limit);
        for (int i = 0; i < points; ++i) writer.row(law, "normal", limit * (i / last) * (i / last), 0, 0);
        for (int i = 0; tangential > 0 && i < points; ++i) {
          writer.row(law, "tangential_x", beside, tangential * (2 * i / last - 1), 0);
        }
        for (int i = 0; tangential > 0 && i < points; ++i) {
          writer.row(law, "tangential_y", beside, 0, tangential * (2 * i / last - 1));
        }
      }
    }
  }
  return table;
}

SurfaceFields body_fields(const runtime::View& view, const BodyFieldOptions& options) {
  const std::optional<ToolPoint> pressing = vertex_point(view, options.tool, options.tool_vertex);
  if (!pressing) throw Error(ExitCode::bad_input, "the tool's vertex is in no patch of it: it never touches alone");
  constexpr auto kNew = std::numeric_limits<std::uint32_t>::max();
  const bool friction = view.has(layout::feature_friction);
  SurfaceField stiffness{"stiffness", "N/m", {}}, force{"force", "N", {}}, limit{"friction", "N", {}},
      filled{"filled", "", {}};
  SurfaceFields surface;
  surface.numbers = {{"depth_m", options.depth}};
  std::vector<std::uint32_t> numbers(view.meta->vertex_count, kNew);
  const auto array = [](const Vec3& v) {
    return std::array<float, 3>{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  };
  const auto add = [&](std::uint32_t triangle, int corner) {
    BodyPoint at{triangle, {0, 0, 0}};
    at.bary[corner] = 1;
    runtime::BlendedResponse<> response;
    response.blend(view, options.tool, at, *pressing, {1, 0, 0}, nullptr);
    const runtime::ResponseAtDepth terms = response.law().at(options.depth);
    surface.points.push_back(array(position(view, at)));
    surface.normals.push_back(array(response.normal()));
    stiffness.values.push_back(static_cast<float>(terms.normal_slope));
    force.values.push_back(static_cast<float>(terms.normal_force));
    if (friction) limit.values.push_back(static_cast<float>(terms.friction_coefficient * terms.normal_force));
    filled.values.push_back(static_cast<float>(response.filled_share()));
  };
  for (std::uint32_t t = 0; t < view.meta->triangle_count; ++t) {
    std::array<std::uint32_t, 3> corners{};
    for (int k = 0; k < 3; ++k) {
      std::uint32_t& number = numbers[view.triangle(t).vertex[k]];
      if (number == kNew) {
        number = static_cast<std::uint32_t>(surface.points.size());
        add(t, k);
      }
      corners[static_cast<std::size_t>(k)] = number;
    }
    surface.triangles.push_back(corners);
  }
  surface.fields = {stiffness, force, filled};
  if (friction) surface.fields.push_back(limit);
  return surface;
}

}  // namespace palpate::cli
