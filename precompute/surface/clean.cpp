// SPDX-License-Identifier: GPL-3.0-or-later
// The ladder as it is -> repair -> wrap, the part labels and the moves.
#include "precompute/surface/clean.hpp"

#include "formats/error.hpp"
#include "precompute/surface/examine.hpp"
#include "precompute/surface/kernel.hpp"
#include "precompute/surface/report.hpp"
#include "precompute/surface/smooth.hpp"
#include "precompute/surface/weld.hpp"

#include <fmt/format.h>

namespace palpate {
namespace {

constexpr double weld_share = 1e-6;       // of the diagonal: rounding of single-precision files
constexpr double join_share = 2e-3;       // of the diagonal: rims of meshes that were drawn to match
constexpr double hole_share = 0.01;       // of the area: largest hole that is closed without asking for a wrap
constexpr double small_component = 1e-3;  // of the area: debris

std::optional<Surface> repair(const Surface& input) {
  const double size = diagonal(input);
  auto surface = drop_duplicates(weld(input, weld_share * size));
  if (topology(surface).boundary_edges > 0) surface = join_borders(surface, join_share * size);
  surface = drop_small_components(drop_fins(drop_duplicates(surface)), small_component);
  auto mended = mend(surface, {hole_share * area(surface)});
  // Where sheets crossed, stitching may leave debris of its own.
  if (mended && topology(*mended).components > 1) mended = mend(drop_small_components(*mended, small_component), {});
  return mended;
}

// Triangles that a point query can take.
Surface solid_triangles(const Surface& surface) {
  std::vector<bool> keep(surface.triangles.size());
  for (std::size_t t = 0; t < keep.size(); ++t) keep[t] = !is_degenerate(surface, t);
  return keep_triangles(surface, keep);
}

// Gives every triangle without a label (all of them when asked) the part of the closest input triangle.
void label_parts(Surface& surface, const SurfaceQuery& input, bool all) {
  surface.part_names = input.surface().part_names;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (!all && surface.parts[t] >= 0) continue;
    const auto& c = surface.triangles[t];
    const Eigen::Vector3d centre = (surface.vertices[std::size_t(c[0])] + surface.vertices[std::size_t(c[1])] +
                                    surface.vertices[std::size_t(c[2])]) /
                                   3.0;
    surface.parts[t] = input.surface().parts[std::size_t(input.closest(centre).triangle)];
  }
}

// A closed input of several components is used as it is only when every one faces the right way already.
bool faces_right(const Surface& input, const SurfaceFaults& faults) {
  if (faults.topology.components < 2) return true;
  const auto oriented = mend(input, {});
  return oriented && std::abs(signed_volume(*oriented) - faults.volume) <= 1e-9 * std::abs(faults.volume);
}

}  // namespace

CleanSurface clean_surface(const Surface& input, const CleanOptions& options, const std::string& name) {
  require_usable(input, name);
  const auto fail = [&](const std::string& cause) { throw Error(ExitCode::bad_input, name + ": " + cause); };
  const auto solid = solid_triangles(input);
  if (solid.empty()) fail("no triangle has an area");
  const auto faults = examine(input);
  CleanSurface result;
  auto& report = result.report;
  report.findings = faults.lines();

  Surface surface;
  const bool usable = faults.clean() && faces_right(input, faults);
  if (options.mode == RepairMode::none && !usable) {
    fail("the surface is not clean and repair is \"none\": " +
         (faults.clean() ? std::string("a component faces the wrong way") : joined(report.findings)));
  }
  if (usable && options.mode != RepairMode::wrap) {
    surface = keep_triangles(input, std::vector<bool>(input.triangles.size(), true));
    report.action = "used as it is";
  }
  std::string remaining = "there is nothing left of it";
  if (report.action.empty() && options.mode != RepairMode::wrap) {
    if (auto repaired = repair(input)) {
      const auto left = examine(*repaired);
      remaining = joined(left.lines());
      if (left.clean()) {
        surface = std::move(*repaired);
        report.action = "repaired";
      }
    }
    if (report.action.empty() && options.mode == RepairMode::repair) {
      fail("repair does not lead to a closed surface (found: " + joined(report.findings) +
           "; after repair: " + remaining + "); repair = \"wrap\" makes one of anything");
    }
  }
  const SurfaceQuery original(solid);
  if (report.action.empty()) {
    const double alpha = options.wrap_alpha > 0 ? options.wrap_alpha : diagonal(input) / 50.0;
    const double offset = options.wrap_offset > 0 ? options.wrap_offset : alpha / 30.0;
    surface = drop_small_components(alpha_wrap(input, alpha, offset), small_component);
    const auto left = examine(surface);
    if (surface.empty() || !left.clean()) {
      fail("wrapping failed: " + (surface.empty() ? std::string("nothing is left") : joined(left.lines())));
    }
    report.action = "wrapped";
    label_parts(surface, original, true);
  } else {
    label_parts(surface, original, false);
  }
  if (options.smooth > 0) {
    const SurfaceQuery facets(surface);
    const Smoothed smoothed = smooth(surface, options.smooth);
    surface = smoothed.surface;
    const auto left = examine(surface);
    if (!left.clean())
      fail("smooth = " + std::to_string(options.smooth) + " spoils the surface: " + joined(left.lines()));
    label_parts(surface, facets, true);
    report.action += ", smoothed";
    if (smoothed.kept_edges > 0) {
      report.findings.push_back(
          fmt::format("{} edges kept straight: rounded, the surface would cross itself there", smoothed.kept_edges));
    }
  }
  if (report.action != "used as it is") std::tie(report.largest_move, report.mean_move) = distances(surface, original);
  result.query = std::make_shared<const SurfaceQuery>(surface);
  if (report.action != "used as it is") {
    const auto [largest, mean] = distances(input, *result.query);
    if (largest > 1.5 * report.largest_move + weld_share * diagonal(input)) {
      report.findings.push_back(
          fmt::format("input left aside up to {:.3g} mm from the result (mean {:.3g} mm)", largest * 1e3, mean * 1e3));
    }
  }
  measure(*result.query, report);
  return result;
}

}  // namespace palpate
