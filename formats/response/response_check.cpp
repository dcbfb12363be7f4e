// SPDX-License-Identifier: MIT
// Checks the content of a response file before it is written. The reader checks the rest on the bytes.
#include "formats/response/response_check.hpp"

#include "formats/io/error.hpp"
#include "palpate/format/open.hpp"

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
    check_family(r.coefficients, static_cast<std::uint32_t>(response::count(c.degrees)), "coefficients", i);
    const int most = (1 << (c.coef_bits - 1)) - 1;
    for (int k = 0; k < response::offsets(c.degrees).friction; ++k) {
      const int value = r.coefficients[static_cast<std::size_t>(k)];
      require(std::abs(value) <= most, at("response", i),
              "coefficient " + std::to_string(k) + " is " + std::to_string(value) + ", allowed -" +
                  std::to_string(most) + " to " + std::to_string(most) + " with " + std::to_string(c.coef_bits) +
                  " bits");
    }
    require(c.slip_softening || r.softening == 0, at("response", i), "has a slip softening, the file has none");
    check_family(r.bonded, layout::kBondedCurves * c.bonded_coefs, "curves of a bonded contact", i);
    check_family(r.bonded_torque, c.has_bonded_torque ? layout::kTorqueCurves * c.bonded_coefs : 0,
                 "torque curves of a bonded contact", i);
  }
}

}  // namespace

void check_content(const ResponseFileContent& c) {
  if (const char* broken = response::broken_degree(c.degrees)) fail("degrees", broken);
  require(c.degrees.friction_families == (c.tangential_scale > 0), "tangential scale",
          "must be above 0 with friction and 0 without, got " + std::to_string(c.tangential_scale) + " m");
  require(c.coef_bits == 8 || c.coef_bits == 12 || c.coef_bits == 16, "coefficients",
          "have " + std::to_string(c.coef_bits) + " bits, allowed 8, 12 or 16");
  require(!c.has_bonded_torque || c.bonded_coefs > 0, "torques of bonded contacts",
          "need curves of bonded contacts, the file has none");
  require(c.surface_vertices.size() >= c.sites.size(), "contact surface",
          "has " + std::to_string(c.surface_vertices.size()) + " vertices for " + std::to_string(c.sites.size()) +
              " sites");
  for (std::size_t i = 0; i < c.surface_triangles.size(); ++i) {
    const std::uint32_t patch = c.surface_triangles[i].patch;
    require(patch < c.patches.size(), at("contact surface triangle", i), "no patch " + std::to_string(patch));
  }
  require(
      std::max(c.search.size(), c.search.empty() ? 0 : c.surface_triangles.size()) < layout::SearchNode::kMaxTreeCount,
      "search tree", "has more nodes or triangles than it can count");
  if (c.compliance) {
    const ResponseCompliance& shared = *c.compliance;
    require(shared.shear.size() == c.sites.size() && shared.values.size() == 3 * shared.modes * c.sites.size(),
            "compliance",
            "has " + std::to_string(shared.shear.size()) + " sites and " + std::to_string(shared.values.size()) +
                " values, expected " + std::to_string(c.sites.size()) + " and " +
                std::to_string(3 * shared.modes * c.sites.size()));
  }
  check_tools(c);
  check_responses(c);
}

void check_bytes(const std::vector<std::byte>& bytes) {
  const runtime::OpenResult opened = runtime::View::open(bytes.data(), bytes.size());
  if (opened) return;
  const std::string fault = opened.error;
  // Responses come from the fit, everything else from the scene and its surfaces.
  bool fitted = false;
  for (const char* section : {"RESPONSES: ", "BONDED: ", "BONDED_TORQUE: ", "COMPLIANCE: ", "COMPLIANCE_SITES: "}) {
    fitted = fitted || fault.rfind(section, 0) == 0;
  }
  throw Error(fitted ? ExitCode::numerical : ExitCode::bad_input, "response file: " + fault);
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
