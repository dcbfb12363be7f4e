// SPDX-License-Identifier: MIT
// Checks of a response file's content; the runtime repeats the ones that a damaged file could break.
#include "formats/response_check.hpp"

#include "formats/error.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

namespace palpate::detail {
namespace {

[[noreturn]] void fail(const std::string& where, const std::string& what) {
  throw Error(ExitCode::bad_input, "response file: " + where + ": " + what);
}

void require(bool good, const std::string& where, const std::string& what) {
  if (!good) fail(where, what);
}

std::string at(const char* what, std::size_t index) { return std::string(what) + " " + std::to_string(index); }

double dot(const Triple& a, const Triple& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

bool finite(const Triple& v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }

void check_frame(const Triple& normal, const Triple& tangent, const std::string& where) {
  require(finite(normal) && std::abs(dot(normal, normal) - 1) < 1e-4, where, "normal is not a unit vector");
  require(finite(tangent) && std::abs(dot(tangent, tangent) - 1) < 1e-4, where, "tangent is not a unit vector");
  require(std::abs(dot(normal, tangent)) < 1e-4, where, "tangent is not orthogonal to the normal");
}

void check_count(std::uint32_t count, bool may_be_absent, const char* name) {
  require((may_be_absent && count == 0) || (count >= layout::kMinCoefs && count <= layout::kMaxCoefs), name,
          "is " + std::to_string(count) + ", allowed " + (may_be_absent ? "0 or " : "") + "4 to 32");
}

void check_scales(const ResponseFileContent& c) {
  require(std::isfinite(c.depth_scale) && c.depth_scale > 0, "depth scale", "must be finite and above 0");
  check_count(c.normal_coefs, false, "normal coefficient count");
  check_count(c.lateral_coefs, true, "lateral coefficient count");
  check_count(c.growth_coefs, true, "growth coefficient count");
  check_count(c.sideways_coefs, true, "sideways coefficient count");
  check_count(c.friction_coefs, true, "friction coefficient count");
  const bool friction = c.growth_coefs > 0;
  require(friction == (c.sideways_coefs > 0) && friction == (c.friction_coefs > 0), "coefficient counts",
          "growth, sideways and friction are all 0 or none is");
  require(std::isfinite(c.sideways_scale) && (friction ? c.sideways_scale > 0 : c.sideways_scale == 0),
          "sideways scale", "must be above 0 with friction and 0 without");
}

void check_limit(double limit, double scale, const std::string& where) {
  require(std::isfinite(limit) && limit > 0 && limit <= scale * (1 + 1e-6), where,
          "depth limit " + std::to_string(limit) + " m, allowed above 0 and at most the depth scale " +
              std::to_string(scale) + " m");
}

void check_body(const ResponseFileContent& c) {
  require(!c.sites.empty() && !c.patches.empty(), "haptic mesh", "is empty");
  for (std::size_t i = 0; i < c.sites.size(); ++i) {
    require(finite(c.sites[i].position), at("site", i), "position is not finite");
    check_frame(c.sites[i].normal, c.sites[i].tangent, at("site", i));
    check_limit(c.sites[i].depth_limit, c.depth_scale, at("site", i));
    require((c.sites[i].flags & ~layout::site_all) == 0, at("site", i), "unknown flag");
  }
  for (std::size_t i = 0; i < c.patches.size(); ++i) {
    const auto& [a, b, d] = c.patches[i];
    require(std::max({a, b, d}) < c.sites.size() && a != b && b != d && d != a, at("patch", i),
            "corners must be three different sites");
  }
  require(c.subdivision >= 1 && c.subdivision <= layout::kMaxSubdivision, "subdivision", "allowed 1 to 1024");
  require(!c.surface_triangles.empty(), "contact surface", "is empty");
  for (std::size_t i = 0; i < c.surface_vertices.size(); ++i) {
    require(finite(c.surface_vertices[i]), at("contact surface vertex", i), "is not finite");
  }
  for (std::size_t i = 0; i < c.surface_triangles.size(); ++i) {
    const ResponseTriangle& t = c.surface_triangles[i];
    const auto& [a, b, d] = t.vertices;
    require(std::max({a, b, d}) < c.surface_vertices.size() && a != b && b != d && d != a,
            at("contact surface triangle", i), "corners must be three different vertices");
    require(t.patch < c.patches.size(), at("contact surface triangle", i), "no such patch");
    for (const auto& g : t.grid) {
      require(g[0] + g[1] <= static_cast<int>(c.subdivision), at("contact surface triangle", i),
              "grid coordinates lie outside the patch");
    }
  }
}

void check_tools(const ResponseFileContent& c) {
  require(!c.tools.empty(), "tools", "there is none");
  std::set<std::string> names;
  for (std::size_t i = 0; i < c.tools.size(); ++i) {
    const ResponseTool& t = c.tools[i];
    require(!t.name.empty() && t.name.size() < sizeof(layout::ToolRecord::name), at("tool", i),
            "name must have 1 to 31 bytes");
    require(names.insert(t.name).second, at("tool", i), "name '" + t.name + "' is taken");
    for (const double length : {t.radius, t.probe_radius, t.axis_length}) {
      require(std::isfinite(length) && length >= 0, at("tool", i), "lengths must be finite and not negative");
    }
    require(!t.vertices.empty(), at("tool", i), "has no vertex");
    require(t.vertices.size() == 1 || !t.patches.empty(), at("tool", i), "has no patch");
    for (const ResponseToolVertex& v : t.vertices) {
      require(v.name.size() < sizeof(layout::ToolVertexRecord::name), at("tool", i),
              "vertex name '" + v.name + "' is longer than 23 bytes");
      require(finite(v.point) && std::isfinite(v.meridian), at("tool", i), "vertex '" + v.name + "' is not finite");
      check_frame(v.normal, v.tangent, "tool '" + t.name + "' vertex '" + v.name + "'");
    }
    double reached = -HUGE_VAL;  // meridian at the end of the segments so far
    for (const auto& p : t.patches) {
      require(std::max({p[0], p[1], p[2]}) < t.vertices.size(), at("tool", i), "a patch names a vertex it has not");
      if (t.kind != layout::ToolKind::profile) continue;
      const double low = t.vertices[p[0]].meridian, high = t.vertices[p[1]].meridian;
      require(low <= high && low >= reached, at("tool", i), "a profile's segments must ascend");
      reached = high;
    }
  }
}

void check_family(const std::vector<float>& coefs, std::uint32_t count, int zeros, const char* name,
                  std::size_t index) {
  const std::string where = at("response", index) + ", " + name;
  require(coefs.size() == count, where,
          "has " + std::to_string(coefs.size()) + " coefficients, the file " + std::to_string(count));
  for (const float v : coefs) require(std::isfinite(v), where, "is not finite");
  for (int k = 0; k < zeros && count > 0; ++k) require(coefs[k] == 0, where, "must start at zero");
}

void check_phi(const std::vector<float>& phi, const char* name, std::size_t index) {
  const std::string where = at("response", index) + ", " + name;
  require(std::is_sorted(phi.rbegin(), phi.rend()), where, "must not increase");
  const double size = std::max(std::abs(phi.front()), std::abs(phi.back()));
  require(std::abs(spline::value(phi.data(), static_cast<int>(phi.size()), 0.5)) <= 1e-5 * size, where,
          "must vanish at zero deflection");
}

void check_responses(const ResponseFileContent& c) {
  const std::size_t expected = c.sites.size() * c.tool_vertex_count();
  require(c.responses.size() == expected, "responses",
          "there are " + std::to_string(c.responses.size()) + ", sites times tool vertices are " +
              std::to_string(expected));
  for (std::size_t i = 0; i < c.responses.size(); ++i) {
    const Response& r = c.responses[i];
    check_limit(r.depth_limit, c.depth_scale, at("response", i));
    require(r.flags == layout::response_solved || r.flags == layout::response_covered, at("response", i),
            "must be either solved or covered");
    check_family(r.normal, c.normal_coefs, 2, "normal force", i);
    require(std::is_sorted(r.normal.begin(), r.normal.end()), at("response", i), "normal force must not decrease");
    check_family(r.lateral_x, c.lateral_coefs, 2, "lateral x", i);
    check_family(r.lateral_y, c.lateral_coefs, 2, "lateral y", i);
    check_family(r.growth_x, c.growth_coefs, 1, "growth x", i);
    check_family(r.growth_y, c.growth_coefs, 1, "growth y", i);
    check_family(r.sideways_x, c.sideways_coefs, 0, "sideways x", i);
    check_family(r.sideways_y, c.sideways_coefs, 0, "sideways y", i);
    check_family(r.friction, c.friction_coefs, 0, "friction", i);
    if (c.growth_coefs == 0) continue;
    check_phi(r.sideways_x, "sideways x", i);
    check_phi(r.sideways_y, "sideways y", i);
    for (const auto* g : {&r.growth_x, &r.growth_y}) {
      require(*std::min_element(g->begin(), g->end()) >= 0, at("response", i), "growth must not be negative");
    }
    const auto [low, high] = std::minmax_element(r.friction.begin(), r.friction.end());
    require(*low >= 0 && *high <= 10, at("response", i), "friction limit, allowed 0 to 10");
  }
}

}  // namespace

void check_content(const ResponseFileContent& c) {
  check_scales(c);
  check_body(c);
  check_tools(c);
  check_responses(c);
  require(c.provenance.size() >= 2 && c.provenance.front() == '{' && c.provenance.back() == '}', "provenance",
          "must be a JSON object");
}

std::vector<std::array<std::uint32_t, 3>> neighbours(const ResponseFileContent& c) {
  struct Edge {
    std::uint32_t from, to, triangle, corner;
  };
  std::vector<Edge> edges;
  edges.reserve(3 * c.surface_triangles.size());
  for (std::uint32_t t = 0; t < c.surface_triangles.size(); ++t) {
    const auto& v = c.surface_triangles[t].vertices;
    for (std::uint32_t k = 0; k < 3; ++k) edges.push_back({v[(k + 1) % 3], v[(k + 2) % 3], t, k});
  }
  const auto key = [](const Edge& e) { return std::pair(std::min(e.from, e.to), std::max(e.from, e.to)); };
  std::sort(edges.begin(), edges.end(),
            [&](const Edge& a, const Edge& b) { return key(a) != key(b) ? key(a) < key(b) : a.triangle < b.triangle; });
  std::vector<std::array<std::uint32_t, 3>> result(c.surface_triangles.size());
  for (std::size_t i = 0; i < edges.size(); i += 2) {
    const bool pair = i + 1 < edges.size() && key(edges[i]) == key(edges[i + 1]) &&
                      (i + 2 == edges.size() || key(edges[i + 2]) != key(edges[i]));
    require(pair && edges[i].from == edges[i + 1].to, at("contact surface triangle", edges[i].triangle),
            "the surface is not closed, manifold and consistently oriented at the edge between vertices " +
                std::to_string(edges[i].from) + " and " + std::to_string(edges[i].to));
    result[edges[i].triangle][edges[i].corner] = edges[i + 1].triangle;
    result[edges[i + 1].triangle][edges[i + 1].corner] = edges[i].triangle;
  }
  return result;
}

}  // namespace palpate::detail
