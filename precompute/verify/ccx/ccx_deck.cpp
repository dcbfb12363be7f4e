// SPDX-License-Identifier: GPL-3.0-or-later
// Nodes and ten-node tetrahedra of body and tool, the contact pair, a step a depth.
#include "precompute/verify/ccx/ccx_deck.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>
#include <stdexcept>

namespace palpate::verify {
namespace {

using Eigen::Vector3d;

constexpr double kMillimetres = 1e3, kKilopascals = 1e-3;

// Corners of the faces S1 to S4 of a C3D10, whose nodes are numbered as ours.
constexpr int kFaces[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};

using Text = std::back_insert_iterator<std::string>;

void node(Text out, std::size_t number, const Vector3d& point) {
  fmt::format_to(out, "{},{:.12g},{:.12g},{:.12g}\n", number, kMillimetres * point.x(), kMillimetres * point.y(),
                 kMillimetres * point.z());
}

// `first`: the deck's number of node 0.
void element(Text out, std::size_t number, const std::array<std::int32_t, 10>& nodes, std::size_t first) {
  fmt::format_to(out, "{}", number);
  for (const std::int32_t n : nodes) fmt::format_to(out, ",{}", first + std::size_t(n));
  fmt::format_to(out, "\n");
}

std::string held_along(int k) { return fmt::format("{}{}", kCcxHeld, k + 1); }

void body(Text out, const CcxPush& push) {
  const mesh::TetMesh& mesh = push.mesh;
  fmt::format_to(out, "*NODE\n");
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) node(out, n + 1, mesh.nodes[n]);
  fmt::format_to(out, "*ELEMENT,TYPE=C3D10,ELSET=BODY\n");
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) element(out, t + 1, mesh.tets[t], 1);
  // All that are held somehow, then those held along x, y and z.
  for (int k = -1; k < 3; ++k) {
    const int mask = k < 0 ? 7 : 1 << k;
    fmt::format_to(out, "*NSET,NSET={}\n", k < 0 ? kCcxHeld : held_along(k));
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
      if ((push.held[n] & mask) != 0) fmt::format_to(out, "{}\n", n + 1);
    }
  }
  // Boundary faces near the site, by element and face number.
  std::map<std::array<std::int32_t, 3>, int> skin;
  for (const auto& face : mesh.faces) {
    double nearest = std::numeric_limits<double>::infinity();
    std::array<std::int32_t, 3> key{face[0], face[1], face[2]};
    for (const std::int32_t n : key) nearest = std::min(nearest, (mesh.nodes[n] - push.frame.origin).norm());
    std::sort(key.begin(), key.end());
    if (nearest <= push.contact.reach) skin[key] = 1;
  }
  if (skin.empty()) throw std::invalid_argument("no face of the body lies within the contact's reach");
  fmt::format_to(out, "*SURFACE,NAME=SKIN,TYPE=ELEMENT\n");
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    for (int f = 0; f < 4; ++f) {
      std::array<std::int32_t, 3> key{};
      for (int k = 0; k < 3; ++k) key[k] = mesh.tets[t][kFaces[f][k]];
      std::sort(key.begin(), key.end());
      if (skin.count(key) != 0) fmt::format_to(out, "{},S{}\n", t + 1, f + 1);
    }
  }
}

// Every facet is the face S1 of a tetrahedron with its fourth corner inside; the tool moves as one, so they never
// strain.
void tool(Text out, const CcxPush& push) {
  const ToolFacets& facets = push.tool;
  const std::size_t first = push.mesh.nodes.size() + 1;
  const auto count = static_cast<std::int32_t>(facets.nodes.size());
  const auto spoke = [&](std::int32_t corner) { return count + 1 + corner; };
  fmt::format_to(out, "*NODE,NSET={}\n", kCcxTool);
  for (std::int32_t n = 0; n < count; ++n) node(out, first + std::size_t(n), push.pose * facets.nodes[n]);
  node(out, first + std::size_t(count), push.pose * facets.inside);
  for (std::int32_t n = 0; n < facets.corner_count; ++n) {
    node(out, first + std::size_t(spoke(n)), push.pose * Vector3d((facets.nodes[n] + facets.inside) / 2));
  }
  fmt::format_to(out, "*ELEMENT,TYPE=C3D10,ELSET=TIP\n");
  for (std::size_t f = 0; f < facets.faces.size(); ++f) {
    const auto [a, b, c, ab, bc, ca] = facets.faces[f];
    element(out, push.mesh.tets.size() + f + 1, {a, c, b, count, ca, bc, ab, spoke(a), spoke(c), spoke(b)}, first);
  }
  fmt::format_to(out, "*SURFACE,NAME=FACETS,TYPE=ELEMENT\nTIP,S1\n");
}

void material(Text out, const CcxMaterial& m) {
  const double d1 = 2 / (kKilopascals * m.bulk);
  fmt::format_to(out, "*MATERIAL,NAME=TISSUE\n");
  if (m.c01 == 0) {
    fmt::format_to(out, "*HYPERELASTIC,NEO HOOKE\n{:.12g},{:.12g}\n", kKilopascals * m.c10, d1);
  } else {
    fmt::format_to(out, "*HYPERELASTIC,MOONEY-RIVLIN\n{:.12g},{:.12g},{:.12g}\n", kKilopascals * m.c10,
                   kKilopascals * m.c01, d1);
  }
  fmt::format_to(out, "*SOLID SECTION,ELSET=BODY,MATERIAL=TISSUE\n*SOLID SECTION,ELSET=TIP,MATERIAL=TISSUE\n");
}

void steps(Text out, const CcxPush& push) {
  const double increment = 1.0 / push.contact.increments;
  for (const double depth : push.depths) {
    const Vector3d move = -kMillimetres * depth * push.frame.n;
    fmt::format_to(out, "*STEP,NLGEOM,INC=1000\n*STATIC\n{:.12g},1.,1e-4,{:.12g}\n*BOUNDARY\n", increment, increment);
    for (int k = 0; k < 3; ++k) fmt::format_to(out, "{},{},{},{:.12g}\n", kCcxTool, k + 1, k + 1, move[k]);
    for (const char* set : {kCcxTool, kCcxHeld}) {
      fmt::format_to(out, "*NODE PRINT,NSET={},TOTALS=ONLY,FREQUENCY=1000\nRF\n", set);
    }
    fmt::format_to(out, "*END STEP\n");
  }
}

}  // namespace

std::string ccx_deck(const CcxPush& push) {
  std::string text;
  const Text out(text);
  body(out, push);
  tool(out, push);
  material(out, push.material);
  fmt::format_to(out,
                 "*SURFACE INTERACTION,NAME=PRESS\n*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR\n{:.12g}\n"
                 "*CONTACT PAIR,INTERACTION=PRESS,TYPE=SURFACE TO SURFACE\nSKIN,FACETS\n"
                 "*BOUNDARY\n",
                 kKilopascals / kMillimetres * push.contact.stiffness);
  for (int k = 0; k < 3; ++k) fmt::format_to(out, "{},{},{}\n", held_along(k), k + 1, k + 1);
  steps(out, push);
  return text;
}

}  // namespace palpate::verify
