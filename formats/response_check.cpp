// SPDX-License-Identifier: MIT
// Checks of a response file before it is given out; what the bytes can tell is left to the reader.
#include "formats/response_check.hpp"

#include "formats/error.hpp"
#include "palpate/open.hpp"

#include <algorithm>
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

void check_tools(const ResponseFileContent& c) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < c.tools.size(); ++i) {
    const ResponseTool& t = c.tools[i];
    require(!t.name.empty() && t.name.size() < sizeof(layout::ToolRecord::name), at("tool", i),
            "name must have 1 to 31 bytes");
    require(names.insert(t.name).second, at("tool", i), "name '" + t.name + "' is taken");
    require(!t.vertices.empty(), at("tool", i), "has no vertex");
    require(t.vertices.size() == 1 || !t.patches.empty(), at("tool", i), "has no patch");
    for (const ResponseToolVertex& v : t.vertices) {
      require(v.name.size() < sizeof(layout::ToolVertexRecord::name), at("tool", i),
              "vertex name '" + v.name + "' is longer than 23 bytes");
    }
    for (const auto& p : t.patches) {
      require(std::max({p[0], p[1], p[2]}) < t.vertices.size(), at("tool", i), "a patch names a vertex it has not");
    }
  }
}

template <class Coefs>
void check_family(const Coefs& coefs, std::uint32_t count, const char* name, std::size_t index) {
  require(coefs.size() == count, at("response", index) + ", " + name,
          "has " + std::to_string(coefs.size()) + " coefficients, the file " + std::to_string(count));
}

void check_responses(const ResponseFileContent& c) {
  const std::size_t expected = c.sites.size() * c.tool_vertex_count();
  require(c.responses.size() == expected, "responses",
          "there are " + std::to_string(c.responses.size()) + ", sites times tool vertices are " +
              std::to_string(expected));
  for (std::size_t i = 0; i < c.responses.size(); ++i) {
    const Response& r = c.responses[i];
    check_family(r.normal, c.normal_coefs, "normal force", i);
    check_family(r.lateral_x, c.lateral_coefs, "lateral x", i);
    check_family(r.lateral_y, c.lateral_coefs, "lateral y", i);
    check_family(r.growth_x, c.growth_coefs, "growth x", i);
    check_family(r.growth_y, c.growth_coefs, "growth y", i);
    check_family(r.sideways_x, c.sideways_coefs, "sideways x", i);
    check_family(r.sideways_y, c.sideways_coefs, "sideways y", i);
    check_family(r.friction, c.friction_coefs, "friction", i);
    for (int k = 0; c.coupled && k < std::min(coupled::places(*c.coupled).limit, static_cast<int>(r.coupled.size()));
         ++k) {
      const int most = (1 << (c.coupled_bits - 1)) - 1;
      require(std::abs(int{r.coupled[static_cast<std::size_t>(k)]}) <= most, "response " + std::to_string(i),
              "a coefficient of the coupled model takes more bits than the file gives it");
    }
    check_family(r.coupled, c.coupled ? static_cast<std::uint32_t>(coupled::count(*c.coupled)) : 0, "coupled", i);
    check_family(r.grasp, layout::kGraspCurves * c.grasp_coefs, "grasp", i);
    check_family(r.turn, c.turns ? layout::kTurnCurves * c.grasp_coefs : 0, "turn", i);
  }
}

}  // namespace

void check_content(const ResponseFileContent& c) {
  const bool friction = c.growth_coefs > 0;
  require(friction == (c.sideways_coefs > 0) && friction == (c.friction_coefs > 0), "coefficient counts",
          "growth, sideways and friction are all 0 or none is");
  require(!c.coupled || coupled::in_range(*c.coupled), "coupled model", "its degrees are out of range");
  require(c.coupled_bits == 16 || (c.coupled && (c.coupled_bits == 8 || c.coupled_bits == 12)), "coupled model",
          "its coefficients have 8, 12 or 16 bits");
  require(!c.turns || c.grasp_coefs > 0, "turns", "there are none without grasps");
  for (std::size_t i = 0; i < c.surface_triangles.size(); ++i) {
    const std::uint32_t patch = c.surface_triangles[i].patch;
    require(patch < c.patches.size(), at("contact surface triangle", i), "no patch " + std::to_string(patch));
  }
  check_tools(c);
  check_responses(c);
}

void check_bytes(const std::vector<std::byte>& bytes) {
  const runtime::OpenResult opened = runtime::View::open(bytes.data(), bytes.size());
  if (opened) return;
  const std::string fault = opened.error;
  // Curves come from the fit, all the rest from the scene and its surfaces.
  bool curves = false;
  for (const char* section : {"RESPONSES: ", "GRASP: ", "TURN: "}) curves = curves || fault.rfind(section, 0) == 0;
  throw Error(curves ? ExitCode::numerical : ExitCode::bad_input, "response file: " + fault);
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
