// SPDX-License-Identifier: MIT
#include "device/stability/safety.hpp"

#include <cmath>

namespace palpate::device {

std::optional<std::string> SafetyOptions::validate() const {
  if (const auto wrong = timing.validate()) return wrong;
  if (!(scale > 0 && scale < 1e9)) return "scale is above 0 and below 1e9";
  if (!(amplitude > 0 && amplitude < 1)) return "amplitude is above 0 and below 1 m";
  if (!(damping >= 0 && damping < 1e6)) return "damping is at least 0 and below 1e6 N s/m";
  return std::nullopt;
}

Safety safety(const runtime::View& view, const PlantOptions& plant, const SafetyOptions& options) {
  Safety s;
  s.file = file_stiffness(view);
  s.stiffness = options.scale * s.file.slope.norm;
  s.passive = passive_stiffness(plant, options.timing);
  s.onset = onset_of_oscillation(plant, options.timing, options.amplitude);
  const double bound = s.passive.least();
  s.largest_scale = s.file.slope.norm > 0 ? bound / s.file.slope.norm : HUGE_VAL;
  const double coupled = passive_stiffness(plant, options.timing, 3, options.damping).least();
  s.largest_coupling = s.stiffness > bound ? s.stiffness * coupled / (s.stiffness - coupled) : HUGE_VAL;
  return s;
}

}  // namespace palpate::device
