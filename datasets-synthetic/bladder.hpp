// SPDX-License-Identifier: GPL-3.0-or-later
// A bladder-like organ: a closed ellipsoidal shell, 70 x 64 x 80 mm outside, with a wall of 4 mm, held at its neck.
#pragma once

#include "formats/surface/surface.hpp"

namespace palpate::synth {

class BladderShape {
public:
  /// `scale` 1 is adult size, half full.
  explicit BladderShape(double scale) : scale_(scale) {}

  /// Outside and wall of the cavity, both of one part ("bladder", "lumen"), with edges of about `edge` (m).
  [[nodiscard]] Surface surface(double edge) const;
  /// The surface below this height belongs to the neck (m).
  [[nodiscard]] double neck() const;
  /// How far about the top rises under a pressure (Pa): that of a thin neo-Hookean sphere of the mean radius.
  /// Throws Error(usage) at pressures that no radius of such a sphere holds.
  [[nodiscard]] double rise(double young, double pressure) const;

private:
  double scale_;
};

}  // namespace palpate::synth
