// SPDX-License-Identifier: GPL-3.0-or-later
// The virtual coupling that `palpate drive` puts between a device and its tool.
#pragma once

#include <optional>
#include <string>

#include "device/loop/contact_source.hpp"
#include "tools/cli/commands.hpp"

namespace palpate::cli {

struct CouplingArguments {
  std::string stiffness;  ///< N/m in the hand, or "auto": the stiffest that is safe in any hand; empty: no coupling
  double damping = 0;     ///< N s/m in the hand, at least 0
  double rate = 1000;     ///< Hz of the force loop
  bool scaled = false;    ///< --force-scale is given
  bool unsafe_scale = false;  ///< one that verify --device calls unsafe is wanted on purpose
  int places = 1;         ///< at which the tool is felt at most: all may push one way, and their stiffnesses add
};

/// Returns the coupling in the hand; empty without --coupling, or where "auto" finds (and prints) that none is needed.
/// Warns of a coupling that is stiffer than is safe, as far as the device's mechanics are known. Throws Error(usage)
/// for a text that is neither number nor "auto", a frame that gives no force, and "auto" on a device of unknown
/// mechanics; Error(tolerance) where no coupling is soft enough. Without a coupling, a --force-scale whose forces
/// oscillate in a usual grip is Error(tolerance), too, unless `unsafe_scale` allows it.
std::optional<runtime::CouplingOptions> choose_coupling(const CouplingArguments& asked, const runtime::View& view,
                                                        const runtime::DeviceFrame& frame,
                                                        const device::DeviceKind& kind, const Globals& globals);

}  // namespace palpate::cli
