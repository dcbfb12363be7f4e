// SPDX-License-Identifier: GPL-3.0-or-later
// The ladder as it is -> repair -> wrap, the part labels and the moves.
#include "precompute/surface/repair/clean.hpp"

#include "formats/io/error.hpp"
#include "precompute/surface/repair/caps.hpp"
#include "precompute/surface/repair/examine.hpp"
#include "precompute/surface/repair/kernel.hpp"
#include "precompute/surface/repair/report.hpp"
#include "precompute/surface/repair/smooth.hpp"
#include "precompute/surface/repair/weld.hpp"

#include <fmt/format.h>

namespace palpate::surface {
namespace {

constexpr double weld_share = 1e-6;       // of the diagonal: rounding of single-precision files
constexpr double join_share = 2e-3;       // of the diagonal: rims of meshes that were drawn to match
constexpr double hole_share = 0.01;       // of the area: largest hole that is closed without a wrap
constexpr double small_component = 1e-3;  // of the area: debris
constexpr double hanging_share = 0.05;    // of the volume: largest block that hung by an edge or corner and is dropped

// Blocks that hung by an edge or a corner are parts of their own once they are split off.
std::optional<Surface> take_apart(const Surface& surface, std::vector<std::string>& notes) {
  const Split split = split_touching(surface);
  if (split.edges + split.vertices == 0 || !geometry::topology(split.surface).closed_manifold()) return std::nullopt;
  const auto labels = geometry::triangle_components(split.surface, true);
  const auto count = std::size_t(*std::max_element(labels.begin(), labels.end())) + 1;
  std::vector<double> volumes(count);
  std::vector<bool> keep(labels.size(), true);
  double whole = 0;
  for (std::size_t k = 0; k < count; ++k) {
    std::vector<bool> in(labels.size());
    for (std::size_t t = 0; t < in.size(); ++t) in[t] = labels[t] == std::int32_t(k);
    volumes[k] = geometry::signed_volume(keep_triangles(split.surface, in));
    whole += volumes[k];
  }
  notes.push_back(fmt::format("split where blocks touch in {} edges and {} vertices", split.edges, split.vertices));
  for (std::size_t k = 0; k < count; ++k) {
    if (volumes[k] < 0 || volumes[k] >= hanging_share * whole) continue;
    notes.push_back(fmt::format("dropped a block of {:.3g} mL that hung by an edge or a corner", volumes[k] * 1e6));
    for (std::size_t t = 0; t < keep.size(); ++t) keep[t] = keep[t] && labels[t] != std::int32_t(k);
  }
  Surface result = keep_triangles(split.surface, keep);
  if (!examine(result).clean()) return std::nullopt;
  return result;
}

std::optional<Surface> repair(const Surface& input, std::vector<std::string>& notes) {
  const double size = geometry::diagonal(input);
  auto surface = drop_duplicates(weld(input, weld_share * size));
  if (const auto found = geometry::topology(surface);
      found.nonmanifold_edges + found.nonmanifold_vertices > 0 &&
      found.boundary_edges + found.flipped_edges + found.degenerate == 0) {
    if (auto apart = take_apart(surface, notes)) return apart;
  }
  if (geometry::topology(surface).boundary_edges > 0) surface = join_borders(surface, join_share * size);
  surface = drop_small_components(drop_fins(drop_duplicates(surface)), small_component);
  if (geometry::topology(surface).boundary_edges > 0) surface = cap_flat_rims(surface, notes);
  auto mended = mend(surface, {hole_share * geometry::area(surface)});
  // Stitching of sheets that crossed may leave debris of its own.
  if (mended && geometry::topology(*mended).components > 1)
    mended = mend(drop_small_components(*mended, small_component), {});
  return mended;
}

// Triangles that a point query can take.
Surface solid_triangles(const Surface& surface) {
  std::vector<bool> keep(surface.triangles.size());
  for (std::size_t t = 0; t < keep.size(); ++t) keep[t] = !geometry::is_degenerate(surface, t);
  return keep_triangles(surface, keep);
}

// Gives every triangle without a label (or with `all` every one) the part of the closest input triangle.
void label_parts(Surface& surface, const geometry::SurfaceQuery& input, bool all) {
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

// A closed part inside another that faces outward, as a solid does: neither a cavity (which faces inward) nor a part of
// the body. Empty: there is none.
std::string nested_solid(const Surface& surface) {
  const auto labels = geometry::triangle_components(surface, true);
  const auto count = labels.empty() ? 0 : std::size_t(*std::max_element(labels.begin(), labels.end())) + 1;
  constexpr std::size_t kMostComponents = 64;  // more are debris
  if (count < 2 || count > kMostComponents) return {};
  std::vector<std::unique_ptr<const geometry::SurfaceQuery>> parts;
  std::vector<double> volumes;
  for (std::size_t k = 0; k < count; ++k) {
    std::vector<bool> in(labels.size());
    for (std::size_t t = 0; t < in.size(); ++t) in[t] = labels[t] == std::int32_t(k);
    parts.push_back(std::make_unique<const geometry::SurfaceQuery>(keep_triangles(surface, in)));
    volumes.push_back(geometry::signed_volume(parts.back()->surface()));
  }
  for (std::size_t k = 0; k < count; ++k) {
    int depth = 0;
    std::size_t around = k;
    const Eigen::Vector3d& point = parts[k]->surface().vertices.front();
    for (std::size_t o = 0; o < count; ++o) {
      if (o == k || std::abs(volumes[o]) <= std::abs(volumes[k])) continue;
      const bool in = (parts[o]->signed_distance(point) < 0) == (volumes[o] > 0);
      if (!in) continue;
      ++depth;
      if (around == k || std::abs(volumes[o]) < std::abs(volumes[around])) around = o;
    }
    if (depth % 2 == 0 || (volumes[k] > 0) != (volumes[around] > 0)) continue;
    const Surface& part = parts[k]->surface();
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const auto& v : part.vertices) middle += v / double(part.vertices.size());
    return fmt::format(
        "component {} of {} ({:.4g} mL round ({:.4g}, {:.4g}, {:.4g}) m, mesh '{}') lies inside another and faces "
        "outward, as a solid does; make it a [[region]] with a material or a [[cavity]] by its mesh or file, or leave "
        "it "
        "out (meshes = [...])",
        k + 1, count, std::abs(volumes[k]) * 1e6, middle.x(), middle.y(), middle.z(),
        part.part_names[std::size_t(part.parts.front())]);
  }
  return {};
}

// A closed input of several components is used as it is only when every one faces the right way already.
bool faces_right(const Surface& input, const SurfaceFaults& faults) {
  if (faults.topology.components < 2) return true;
  const auto oriented = mend(input, {});
  return oriented && std::abs(geometry::signed_volume(*oriented) - faults.volume) <= 1e-9 * std::abs(faults.volume);
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

  if (options.mode != RepairMode::wrap && faults.topology.closed_manifold() && faults.crossings == 0 &&
      faults.topology.components > 1) {
    if (const auto inside = nested_solid(input); !inside.empty()) fail(inside);
  }
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
    std::vector<std::string> notes;
    if (auto repaired = repair(input, notes)) {
      const auto left = examine(*repaired);
      remaining = joined(left.lines());
      if (left.clean()) {
        surface = std::move(*repaired);
        report.action = "repaired";
        report.findings.insert(report.findings.end(), notes.begin(), notes.end());
      }
    }
    if (report.action.empty() && options.mode == RepairMode::repair) {
      fail("repair does not lead to a closed surface (found: " + joined(report.findings) +
           "; after repair: " + remaining + "); repair = \"wrap\" makes one of anything");
    }
  }
  const geometry::SurfaceQuery original(solid);
  const bool wrapped = report.action.empty();
  if (report.action.empty()) {
    const double alpha = options.wrap_alpha > 0 ? options.wrap_alpha : geometry::diagonal(input) / 50.0;
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
    const geometry::SurfaceQuery facets(surface);
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
  result.query = std::make_shared<const geometry::SurfaceQuery>(surface);
  if (report.action != "used as it is") {
    const auto [largest, mean] = distances(input, *result.query);
    if (largest > 1.5 * report.largest_move + weld_share * geometry::diagonal(input)) {
      report.findings.push_back(
          fmt::format("input left aside up to {:.3g} mm from the result (mean {:.3g} mm)", largest * 1e3, mean * 1e3));
    }
  }
  measure(*result.query, report);
  if (wrapped && faults.topology.boundary_edges > 0 && report.thin_bag) {
    fail(
        fmt::format("open: {} boundary edges in {} loops, and no rim is flat enough to be capped; a wrap would make a "
                    "bag of {:.2g} mm of it, {:.3g} mL, not a solid. Close its holes in the file, or name the meshes "
                    "that close it",
                    faults.topology.boundary_edges, faults.topology.boundary_loops, report.thickness_median * 1e3,
                    report.volume * 1e6));
  }
  return result;
}

}  // namespace palpate::surface
