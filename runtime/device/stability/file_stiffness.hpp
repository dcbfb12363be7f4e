// SPDX-License-Identifier: MIT
// How stiff the responses of a file are: the largest slope of force over deflection that a stuck contact has.
#pragma once

#include "palpate/math/pose.hpp"
#include "palpate/format/response_view.hpp"

namespace palpate::device {

using runtime::Vec3;

/// d force / d deflection of a contact field (N/m), and what of it matters to a force loop.
struct Slope {
  double norm = 0;  ///< N/m, spectral: largest change of force per motion, in any direction
  Vec3 direction;   ///< unit, the motion that it belongs to
};

/// Largest stiffness of a force at a whole deflection (m), by central differences of `step` (m).
template <class Response>
Slope slope(const Response& response, const Vec3& deflection, double step);

/// Slope of a 3x3 matrix given by columns.
Slope slope_of(const Vec3 (&columns)[3]);

/// The site, depth and direction at which a file is stiffest.
struct FileStiffness {
  Slope slope;
  std::uint32_t tool = 0, site = 0, tool_vertex = 0;
  double depth = 0;     ///< m
  double tangential = 0;  ///< m, deflection across the normal
};

/// Every response of the file at 24 depths down to where it was sampled, straight and deflected tangentially in eight
/// ways within its friction limit. Stiffness that blending of responses or rotation of the normal adds is not counted.
FileStiffness file_stiffness(const runtime::View& view);

template <class Response>
Slope slope(const Response& response, const Vec3& deflection, double step) {
  const Vec3 axes[3] = {{step, 0, 0}, {0, step, 0}, {0, 0, step}};
  Vec3 columns[3];
  for (int k = 0; k < 3; ++k) {
    columns[k] = (0.5 / step) * (response.force(deflection + axes[k]) - response.force(deflection - axes[k]));
  }
  return slope_of(columns);
}

}  // namespace palpate::device
