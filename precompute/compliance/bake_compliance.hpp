// SPDX-License-Identifier: GPL-3.0-or-later
// The compliance between the sites of a body: a half-space in closed form, and modes of the rest.
#pragma once

#include "formats/response/response.hpp"
#include "precompute/compliance/linear_body.hpp"
#include "precompute/compliance/report.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpate::compliance {

/// The sites of a bake. Arrays have one entry a site.
struct ComplianceSites {
  std::vector<LoadSite> places;
  std::vector<char> touchable;  ///< a tool may touch here: columns are solved of such sites alone
  std::vector<std::array<std::int32_t, 3>> triangles;  ///< patches; neighbours share one
};

struct ComplianceOptions {
  double contact_radius = 0.0;  ///< m, > 0: of the smallest tool at half of its depth
  double tolerance = 0.03;      ///< (0, 1): see ComplianceScene
  int modes = 0;                ///< [0, 128], a multiple of 8; 0: chosen by the tolerance
  solve::PairOptions solver;

  /// Throws Error(usage) that names an option, its value and its range.
  void validate() const;
};

struct BakedCompliance {
  ResponseCompliance file;
  ComplianceReport report;
};

/// Solves the columns of some sites, spread evenly, and finds the modes from them. Columns left out measure the error;
/// they join the others while it is above the tolerance and each time loses a tenth. The half-space has the
/// small-strain moduli of the body's material. Deterministic. Throws as LinearBody does, Error(bad_input) where no site
/// can be touched.
BakedCompliance bake_compliance(const Body& body, const ComplianceSites& sites, const ComplianceOptions& options);

}  // namespace palpate::compliance
