// SPDX-License-Identifier: MIT
// A quadratic tetrahedral mesh with a solution, written for viewers as VTK's XML unstructured grid.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// In m and Pa. Lists of points and of cells are each of one length; everything is finite.
struct VolumeFields {
  std::vector<Eigen::Vector3d> points;                  ///< at rest
  std::vector<std::array<std::int32_t, 10>> tets;       ///< corners, then middles of edges 01, 12, 20, 03, 13, 23
  std::vector<std::int32_t> regions;                    ///< per cell
  std::vector<Eigen::Vector3d> displacement;            ///< per point
  std::vector<Eigen::Matrix3d> stress;                  ///< per cell, Cauchy, symmetric
  std::vector<double> jacobian;                         ///< per cell, volume over volume at rest
  std::vector<std::pair<std::string, double>> numbers;  ///< what holds for the whole: lower-case names
};

/// Von Mises stress (Pa).
double von_mises(const Eigen::Matrix3d& stress);

/// Point data: displacement. Cell data: region, stress (XX, YY, ZZ, XY, YZ, XZ), von_mises, pressure, jacobian. Throws
/// Error(bad_input) where lists are of different lengths, Error(io) when the file cannot be written whole.
void write_volume_vtu(const VolumeFields& volume, const std::filesystem::path& path);

}  // namespace palpate
