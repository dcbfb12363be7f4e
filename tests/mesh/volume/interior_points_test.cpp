// SPDX-License-Identifier: GPL-3.0-or-later
// Places of interior points: inside, clear of every surface, spaced by the size field.
#include "precompute/mesh/volume/interior_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "formats/io/error.hpp"
#include "precompute/geometry/query.hpp"
#include "tests/support/shapes.hpp"

namespace palpate::test {
namespace {

using Eigen::Vector3d;

TEST(InteriorPoints, FollowTheSizeFieldClearOfTheSurfaces) {
  const Surface block = box_surface({-0.04, -0.04, -0.04}, {0.04, 0.04, 0});
  const Surface hole = box_surface({-0.004, -0.004, -0.012}, {0.004, 0.004, -0.006});
  const mesh::SizeField size = [](const Vector3d& p) { return 0.001 + 0.3 * p.norm(); };
  const std::vector<Vector3d> points = mesh::interior_points({&block, &hole}, size);
  ASSERT_GT(points.size(), 50U);
  const geometry::SurfaceQuery outer(block), inner(hole);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vector3d& p = points[k];
    // They are shifted by up to 0.12 of a cell along each axis after their size was taken.
    EXPECT_LT(outer.signed_distance(p), -0.55 * size(p));
    EXPECT_GT(inner.closest(p).distance, 0.55 * size(p));
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < points.size(); ++j) {
      if (j != k) nearest = std::min(nearest, (points[j] - p).norm());
    }
    EXPECT_GT(nearest, 0.3 * size(p));
    EXPECT_LT(nearest, 2.0 * size(p));
  }
  EXPECT_EQ(mesh::interior_points({&block, &hole}, size), points);
}

TEST(InteriorPoints, NoneWhereTheBodyIsThinnerThanItsElements) {
  const Surface sheet = box_surface({-0.04, -0.04, -0.001}, {0.04, 0.04, 0});
  EXPECT_TRUE(mesh::interior_points({&sheet}, [](const Vector3d&) { return 0.002; }).empty());
}

TEST(InteriorPoints, TooManyAreAnErrorAndNotAFullMemory) {
  const Surface block = box_surface({-0.04, -0.04, -0.04}, {0.04, 0.04, 0});
  try {
    mesh::interior_points({&block}, [](const Vector3d&) { return 1e-5; });
    FAIL() << "five hundred million points";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::numerical);
    EXPECT_NE(std::string(error.what()).find("octree cells"), std::string::npos);
  }
}

}  // namespace
}  // namespace palpate::test
