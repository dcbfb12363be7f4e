// SPDX-License-Identifier: GPL-3.0-or-later
// Two balls side by side, between which a tool touches both.
#pragma once

#include <cmath>

#include "tests/runtime/support.hpp"

namespace palpate::test {

inline constexpr double kApart = 0.032;  // m, of the middle from each lobe's

/// Two balls side by side along x, each `apart` (m) from the middle.
inline ResponseFileContent two_lobes(Options options, double apart = kApart) {
  options.search = false;
  ResponseFileContent content = ball_content(options);
  const ResponseFileContent one = content;
  const auto sites = static_cast<std::uint32_t>(one.sites.size());
  const auto vertices = static_cast<std::uint32_t>(one.surface_vertices.size());
  const auto patches = static_cast<std::uint32_t>(one.patches.size());
  // The vertices of both lobes' sites come first.
  const auto number = [&](std::uint32_t v, std::uint32_t lobe) {
    return v < sites ? lobe * sites + v : sites + lobe * (vertices - sites) + v;
  };
  content.sites.insert(content.sites.end(), one.sites.begin(), one.sites.end());
  content.surface_vertices.resize(2 * std::size_t{vertices});
  content.surface_triangles.clear();
  for (std::uint32_t lobe = 0; lobe < 2; ++lobe) {
    const double aside = lobe == 0 ? -apart : apart;
    for (std::uint32_t v = 0; v < vertices; ++v) {
      const Triple& from = one.surface_vertices[v];
      content.surface_vertices[number(v, lobe)] = {from[0] + aside, from[1], from[2]};
    }
    for (ResponseTriangle t : one.surface_triangles) {
      t.patch += lobe * patches;
      for (std::uint32_t& v : t.vertices) v = number(v, lobe);
      content.surface_triangles.push_back(t);
    }
  }
  for (auto p : one.patches) content.patches.push_back({p[0] + sites, p[1] + sites, p[2] + sites});
  content.responses.insert(content.responses.end(), one.responses.begin(), one.responses.end());
  add_search(content);
  return content;
}

inline Options smooth(bool friction, Options::Tools tools = Options::Tools::sphere) {
  Options options = uniform();
  options.friction = friction;
  options.bias = false;
  options.subdivision = 3;
  options.search = true;
  options.tools = tools;
  return options;
}

/// Height of a tip over the lobes' middles (m) at which it touches both.
inline double between(double apart = kApart) {
  return std::sqrt(std::pow(kBallRadius + kTipRadius, 2) - apart * apart);
}

}  // namespace palpate::test
