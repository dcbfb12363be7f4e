// SPDX-License-Identifier: GPL-3.0-or-later
// Octree cells, refined until they follow the size field.
#include "precompute/mesh/volume/interior_points.hpp"

#include "formats/io/error.hpp"
#include "precompute/geometry/query.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

namespace palpate::mesh {
namespace {

using Eigen::Vector3d;

constexpr double kWidest = 1.25;  // cells over the size in their middle: between this and half of it
constexpr double kClear = 0.67;   // from a surface, over the size
constexpr double kJitter = 0.12;  // of a cell: lattice points lie on common spheres, which give flat tetrahedra
constexpr int kMostCells = 500'000;

struct Cell {
  Vector3d middle;
  double edge;
  std::uint64_t path;  // digits of the octants, for the jitter
};

double jitter(std::uint64_t& state) {
  // splitmix64 (Steele, Lea and Flood 2014)
  std::uint64_t z = state += 0x9e3779b97f4a7c15U;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-52 - 1.0;
}

}  // namespace

std::vector<Vector3d> interior_points(const std::vector<const Surface*>& surfaces, const SizeField& size) {
  std::vector<geometry::SurfaceQuery> queries;
  for (const Surface* s : surfaces) queries.emplace_back(*s);
  Eigen::AlignedBox3d box;
  for (const Vector3d& v : surfaces.front()->vertices) box.extend(v);

  std::vector<Vector3d> points;
  std::vector<Cell> stack{{box.center(), box.sizes().maxCoeff(), 1}};
  for (int cells = 0; !stack.empty(); ++cells) {
    if (cells > kMostCells) {
      throw Error(ExitCode::numerical, "the size field needs more than " + std::to_string(kMostCells) +
                                           " octree cells: elements of " + std::to_string(1e3 * size(box.center())) +
                                           " mm in the middle of the body");
    }
    Cell cell = stack.back();
    stack.pop_back();
    const double there = size(cell.middle);
    if (cell.edge > kWidest * there) {
      for (int octant = 0; octant < 8; ++octant) {
        const Vector3d corner((octant & 1) ? 0.25 : -0.25, (octant & 2) ? 0.25 : -0.25, (octant & 4) ? 0.25 : -0.25);
        stack.push_back({cell.middle + cell.edge * corner, cell.edge / 2, cell.path * 8 + octant});
      }
      continue;
    }
    for (int k = 0; k < 3; ++k) cell.middle[k] += kJitter * cell.edge * jitter(cell.path);
    const double clear = kClear * there;
    const bool inside = queries.front().signed_distance(cell.middle) < -clear;
    const bool apart = std::all_of(queries.begin() + 1, queries.end(), [&](const geometry::SurfaceQuery& q) {
      return q.closest(cell.middle).distance > clear;
    });
    if (inside && apart) points.push_back(cell.middle);
  }
  return points;
}

}  // namespace palpate::mesh
