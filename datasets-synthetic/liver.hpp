// SPDX-License-Identifier: GPL-3.0-or-later
// A liver-like organ: three lobes, a flat underside, a thin margin; about 160 mm wide.
#pragma once

#include "formats/surface/surface.hpp"

#include <array>
#include <cstdint>

namespace palpate::synth {

/// The organ as a star-shaped solid about the origin: its surface is one radius for every direction, and so
/// closed and free of self-intersections whatever the seed.
class LiverShape {
public:
  /// `scale` 1 is adult size.
  LiverShape(std::uint64_t seed, double scale);

  /// Distance from the origin to the surface along a unit direction (m).
  [[nodiscard]] double radius(const Eigen::Vector3d& direction) const;
  /// Height of the flat underside below the middle (m, negative).
  [[nodiscard]] double underside() const { return -depth_; }

private:
  struct Lobe {
    Eigen::Vector3d centre, semi_axes;  ///< m; the origin lies inside
  };
  struct Wave {
    Eigen::Vector3d direction;
    double phase, height;
  };
  std::array<Lobe, 3> lobes_;
  std::array<Wave, 6> waves_;
  double depth_;
};

/// Triangulates the shape with edges of about `edge` (m).
Surface liver_surface(const LiverShape& shape, double edge);

}  // namespace palpate::synth
