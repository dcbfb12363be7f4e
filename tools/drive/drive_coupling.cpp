// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/drive/drive_coupling.hpp"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "device/stability/safety.hpp"
#include "formats/io/error.hpp"
#include "tools/cli/output.hpp"

namespace palpate::cli {
namespace {

/// Infinite where none is needed.
double largest_coupling(const CouplingArguments& asked, const runtime::View& view, const runtime::DeviceFrame& frame,
                        const device::SimKind& stand_in) {
  device::SafetyOptions options;
  options.timing.period = 1 / asked.rate;
  options.scale = asked.places * frame.scale * frame.force_scale;
  options.damping = asked.damping;
  return safety(view, stand_in.plant, options).largest_coupling;
}

std::string newtons_per_metre(double stiffness) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4g N/m", stiffness);
  return text;
}

// The result of verify --device for this scale, before the hand does.
void check_scale(const CouplingArguments& asked, const runtime::View& view, const runtime::DeviceFrame& frame,
                 const device::DeviceKind& kind) {
  if (!asked.scaled || !(frame.force_scale > 0)) return;
  const device::SimKind* stand_in = device::find_stand_in(kind);
  if (stand_in == nullptr) return;
  device::SafetyOptions options;
  options.timing.period = 1 / asked.rate;
  options.scale = asked.places * frame.scale * frame.force_scale;
  const device::Safety s = safety(view, stand_in->plant, options);
  char text[300];
  std::snprintf(text, sizeof text,
                "--force-scale %g: %.0f N/m in the hand oscillate in a usual grip on %s (from %.0f N/m on)",
                frame.force_scale, s.stiffness, kind.name, s.onset.stiffness);
  if (s.settles()) return;
  if (asked.unsafe_scale) return warn(text);
  std::snprintf(text + std::strlen(text), sizeof text - std::strlen(text),
                "; safe in any hand: %.3g at most. --unsafe-force-scale drives it all the same",
                frame.force_scale * s.largest_scale);
  throw Error(ExitCode::tolerance, text);
}

}  // namespace

std::optional<runtime::CouplingOptions> choose_coupling(const CouplingArguments& asked, const runtime::View& view,
                                                        const runtime::DeviceFrame& frame,
                                                        const device::DeviceKind& kind, const Globals& globals) {
  if (asked.stiffness.empty()) {
    check_scale(asked, view, frame, kind);
    return std::nullopt;
  }
  if (!(frame.force_scale > 0)) throw Error(ExitCode::usage, "--coupling needs a --force-scale above 0");
  const bool automatic = asked.stiffness == "auto";
  runtime::CouplingOptions options;
  options.damping = asked.damping;
  if (!automatic) {
    const char* end = asked.stiffness.data() + asked.stiffness.size();
    const auto [rest, error] = std::from_chars(asked.stiffness.data(), end, options.stiffness);
    if (error != std::errc() || rest != end || options.validate() != nullptr) {
      throw Error(ExitCode::usage,
                  "--coupling: got '" + asked.stiffness + "'; expected auto, or N/m above 0 and up to 1e12");
    }
  }
  const device::SimKind* stand_in = device::find_stand_in(kind);
  if (stand_in == nullptr) {
    if (!automatic) return options;
    throw Error(ExitCode::usage, std::string("--coupling auto: the mechanics of '") + kind.name +
                                     "' are not known; give a stiffness in N/m");
  }
  const double largest = largest_coupling(asked, view, frame, *stand_in);
  if (!automatic) {
    if (options.stiffness > largest) {
      warn("--coupling " + asked.stiffness + ": safe in any hand on " + kind.name + " are " +
           newtons_per_metre(largest) + " at most");
    }
    return options;
  }
  if (std::isinf(largest)) {
    note(globals, "no virtual coupling: the file is safe in any hand without one");
    return std::nullopt;
  }
  if (!(largest > 0)) {
    throw Error(ExitCode::tolerance, std::string("--coupling auto: the damping and friction of ") + kind.name +
                                         " leave nothing for a coupling; choose less --coupling-damping, or give a "
                                         "stiffness");
  }
  note(globals, "virtual coupling: " + newtons_per_metre(largest));
  options.stiffness = largest;
  return options;
}

}  // namespace palpate::cli
