// SPDX-License-Identifier: GPL-3.0-or-later
// The law of a single response of a file, without any blend.
#pragma once

#include "palpate/format/response_view.hpp"
#include "palpate/response/response_law.hpp"

#include <cstdint>

namespace palpate::cli {

/// The law of response `index` (layout::response_index), in the frame of its site.
inline runtime::ResponseLaw response_law(const runtime::View& view, std::uint64_t index) {
  const response::Degrees degrees = response::degrees(*view.meta);
  std::int16_t coefs[response::kMostCoefs];
  view.coefficients(index, coefs);
  double values[response::kMostCoefs];
  const response::Offsets o = response::offsets(degrees);
  for (int k = 0; k < o.end; ++k) {
    values[k] = coefs[k] * (k < o.friction ? static_cast<double>(view.coefficient_unit(index)) : layout::kFrictionUnit);
  }
  runtime::ResponseLaw law;
  law.set(degrees, values, view.meta->depth_scale, view.meta->tangential_scale);
  return law;
}

}  // namespace palpate::cli
