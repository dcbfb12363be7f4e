// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/play/indentation_force.hpp"

#include "palpate/geometry/closest_point.hpp"
#include "palpate/response/interpolation.hpp"

namespace palpate::cli {

double indentation_force(const runtime::View& view, std::uint32_t tool, std::uint32_t site, double depth) {
  const runtime::BodyPoint at = closest_point(view, runtime::vertex(view, site)).at;
  runtime::BlendedResponse<> response;
  response.blend(view, tool, at, {view.tools[tool].first_patch, {1, 0, 0}}, {1, 0, 0}, nullptr);
  return length(response.force(-depth * response.normal()));
}

}  // namespace palpate::cli
