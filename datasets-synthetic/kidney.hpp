// SPDX-License-Identifier: GPL-3.0-or-later
// A kidney-like organ: an ellipsoid of 110 x 40 x 55 mm bent into a bean that lies on its hollow side, with six
// pyramids in a row under its convex border.
#pragma once

#include "formats/surface/surface.hpp"

#include <vector>

namespace palpate::synth {

class KidneyShape {
public:
  /// `scale` 1 is adult size.
  explicit KidneyShape(double scale) : scale_(scale) {}

  /// With edges of about `edge` (m).
  [[nodiscard]] Surface surface(double edge) const;
  /// The surface below this height is held (m): both poles and the hilum.
  [[nodiscard]] double underside() const;

  /// An ellipsoid along the axes (m).
  struct Pyramid {
    Eigen::Vector3d centre{0, 0, 0}, radii{0, 0, 0};
  };
  [[nodiscard]] std::vector<Pyramid> pyramids() const;

private:
  double scale_;
};

}  // namespace palpate::synth
