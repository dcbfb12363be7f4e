// SPDX-License-Identifier: GPL-3.0-or-later
// A ball as the voxels whose centres lie in it.
#pragma once

#include "formats/image/label_image.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace palpate::test {

/// Edge length `voxel` (m) along every axis; the ball's centre is no voxel's.
inline LabelMask label_ball(const Eigen::Vector3d& centre, double radius, double voxel) {
  LabelMask mask;
  const int n = 2 * static_cast<int>(std::ceil(radius / voxel)) + 2;
  mask.size = {n, n, n};
  mask.axes = voxel * Eigen::Matrix3d::Identity();
  mask.origin = centre - voxel * (n / 2 - 0.3) * Eigen::Vector3d::Ones();
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const bool in = (mask.origin + mask.axes * Eigen::Vector3d(i, j, k) - centre).norm() < radius;
        mask.inside.push_back(in ? 1 : 0);
        mask.count += in ? 1 : 0;
      }
    }
  }
  return mask;
}

/// The same as the text of a .nrrd file in metres: 0, and `label` inside.
inline std::string nrrd(const LabelMask& mask, int label) {
  const auto vector = [](const Eigen::Vector3d& v) {
    char text[96];
    std::snprintf(text, sizeof text, "(%.17g,%.17g,%.17g)", v.x(), v.y(), v.z());
    return std::string(text);
  };
  std::string text =
      "NRRD0004\ntype: int\ndimension: 3\nencoding: ascii\nspace dimension: 3\n"
      "space units: \"m\" \"m\" \"m\"\nsizes: " +
      std::to_string(mask.size[0]) + " " + std::to_string(mask.size[1]) + " " + std::to_string(mask.size[2]) +
      "\nspace directions: " + vector(mask.axes.col(0)) + " " + vector(mask.axes.col(1)) + " " +
      vector(mask.axes.col(2)) + "\nspace origin: " + vector(mask.origin) + "\n\n";
  for (const auto in : mask.inside) text += in != 0 ? std::to_string(label) + " " : "0 ";
  return text;
}

}  // namespace palpate::test
