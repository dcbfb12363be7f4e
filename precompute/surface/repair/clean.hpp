// SPDX-License-Identifier: GPL-3.0-or-later
// From any soup to a clean closed surface by the least invasive way: as it is, repaired, wrapped.
#pragma once

#include "precompute/common/body.hpp"

#include <memory>
#include <string>

namespace palpate::surface {

struct CleanOptions {
  RepairMode mode = RepairMode::automatic;
  double wrap_alpha = 0.0;   ///< m; 0 chooses 1/50 of the diagonal
  double wrap_offset = 0.0;  ///< m; 0 chooses wrap_alpha / 30
  int smooth = 0;            ///< rounds of interpolating subdivision afterwards
};

struct CleanSurface {
  /// The clean surface: closed, outward, every part kept as a label.
  std::shared_ptr<const geometry::SurfaceQuery> query;
  SurfaceReport report;
};

/// Throws Error(bad_input) naming `name` and what is wrong, when the mode does not lead to a clean surface or smoothing
/// spoils it.
CleanSurface clean_surface(const Surface& input, const CleanOptions& options, const std::string& name);

}  // namespace palpate::surface
