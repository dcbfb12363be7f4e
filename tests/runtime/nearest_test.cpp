// SPDX-License-Identifier: GPL-3.0-or-later
// What a search of the surface leaves out is nowhere nearer than what it finds.
#include <cmath>

#include "palpate/geometry/closest_point.hpp"
#include "tests/runtime/support.hpp"

namespace palpate {
namespace {

using namespace test;
using runtime::detail::nearest_on_triangle;

struct Triangle {
  Vec3 corner[3];
};

// Of any size between a tenth of a millimetre and 0.1 m, and down to `flat` times as high as long.
Triangle draw(std::mt19937& random, double flat) {
  const auto exponent = [&](double low) { return std::uniform_real_distribution<double>(low, 0)(random); };
  const double size = 0.1 * std::pow(10, exponent(-3)), height = size * std::pow(10, exponent(std::log10(flat)));
  const Vec3 along = random_direction(random), across = runtime::any_orthogonal(along);
  const Vec3 at = 0.05 * random_direction(random);
  const double share = std::uniform_real_distribution<double>(-0.5, 1.5)(random);
  return {{at, at + size * along, at + share * size * along + height * across}};
}

TEST(Nearest, WhatIsOutOfReachHasNoNearerPoint) {
  std::mt19937 random(7);
  int out = 0, plump = 0;
  for (int i = 0; i < 200000; ++i) {
    const bool slivers = i % 2 == 0;
    const Triangle two[2] = {draw(random, slivers ? 1e-9 : 0.1), draw(random, slivers ? 1e-9 : 0.1)};
    const Vec3 p = two[i % 2].corner[0] + std::pow(10, -1 - i % 6) * random_direction(random);
    double squared[2];
    runtime::detail::Vec3Two corners[3];
    for (int k = 0; k < 3; ++k) corners[k] = runtime::detail::beside(two[0].corner[k], two[1].corner[k]);
    for (int j = 0; j < 2; ++j) {
      squared[j] = nearest_on_triangle(p, two[j].corner[0], two[j].corner[1], two[j].corner[2]).squared;
    }
    for (int j = 0; j < 2; ++j) {
      const auto far = [&](double most) {
        return runtime::detail::out_of_reach(runtime::detail::beside(p, p), corners[0], corners[1], corners[2],
                                             most)[j];
      };
      ASSERT_FALSE(far(HUGE_VAL) > 0) << i;
      ASSERT_FALSE(far((1 + 1e-6) * squared[j]) > 0) << i << ": " << std::sqrt(squared[j]);
      if (slivers) continue;
      ++plump;
      out += far(0.25 * squared[j]) > 0;
    }
  }
  EXPECT_GT(out, 0.9 * plump);  // of those twice as far as what is known: else the test is of no use
}

// Triangles that are crowded more and more: the least sum of widths is where a few of them are parted from the rest.
TEST(Nearest, ACrowdedSurfaceHasATreeThatIsNotTooDeep) {
  Options options;
  options.subdivision = 16;
  ResponseFileContent content = ball_content(options);
  for (std::size_t i = 0; i < content.surface_vertices.size(); ++i) {
    for (double& x : content.surface_vertices[i]) x *= std::pow(0.98, static_cast<double>(i));
  }
  const Opened looked(ResponseFileContent{content});
  add_search(content);
  const Opened searched(std::move(content));  // refuses a tree that is too deep or does not hold its triangles
  std::mt19937 random(8);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = std::pow(0.1, i % 5) * 0.05 * random_direction(random);
    const auto distance = [&](const Opened& body) { return std::fabs(locate(body.view, p).signed_distance); };
    ASSERT_EQ(distance(searched), distance(looked)) << i;
  }
}

}  // namespace
}  // namespace palpate
