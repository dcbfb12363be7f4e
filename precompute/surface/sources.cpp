// SPDX-License-Identifier: GPL-3.0-or-later
// Reading, turning and naming of a scene's surfaces.
#include "precompute/surface/sources.hpp"

#include "formats/io/error.hpp"
#include "formats/surface/surface_io.hpp"
#include "precompute/geometry/label_surface.hpp"
#include "precompute/geometry/solids.hpp"
#include "precompute/surface/repair/weld.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace palpate::surface {
namespace {

constexpr double region_edges = 12.0;  // of a region given by its measures, along its smallest extent

[[noreturn]] void refuse_source(const std::string& message) { throw Error(ExitCode::bad_input, message); }

const char* name_of(Frame frame) { return frame == Frame::lps ? "LPS" : "RAS"; }

std::string described(const LabelSource& labels) {
  std::vector<std::string> parts;
  for (const int value : labels.values) parts.push_back(std::to_string(value));
  for (const std::string& segment : labels.segments) parts.push_back("'" + segment + "'");
  return fmt::format("{}: label {}", labels.file.string(), fmt::join(parts, ", "));
}

void rename(Surface& surface, const std::string& name) {
  surface.part_names = {name};
  surface.parts.assign(surface.triangles.size(), 0);
}

}  // namespace

const LabelImage& SceneSurfaces::image(const LabelSource& labels) {
  auto& entry = images_[labels.file.string()];
  if (!entry) entry = std::make_shared<const LabelImage>(read_label_image(labels.file, labels.unit));
  return *entry;
}

Surface SceneSurfaces::labelled(const LabelSource& labels, MaskUse use, const std::vector<LabelMask>& also) {
  const LabelImage& from = image(labels);
  const LabelMask mask = label_mask(from, labels, use, also);
  Surface surface = geometry::label_surface(mask, described(labels));
  surface.frame = from.frame;
  surface.notes = mask.notes;
  return surface;
}

void SceneSurfaces::turn(Surface& surface, const std::string& file) {
  if (surface.frame == Frame::unstated || surface.frame == frame_) return;
  if (frame_ == Frame::unstated) {
    refuse_source(
        fmt::format("{} is in {}, and {} states no frame; add frame = \"{}\" at the top of the scene if their "
                    "coordinates agree, or frame = \"{}\" if x and y have opposite signs",
                    file, name_of(surface.frame), unstated_, name_of(surface.frame),
                    name_of(surface.frame == Frame::lps ? Frame::ras : Frame::lps)));
  }
  for (auto& v : surface.vertices) v = {-v.x(), -v.y(), v.z()};  // half a turn about z: nothing is mirrored
  surface.notes.push_back(fmt::format("turned from {} to {}", name_of(surface.frame), name_of(frame_)));
  surface.frame = frame_;
}

Surface SceneSurfaces::body() {
  const BodyScene& body = scene_.body;
  frame_ = scene_.frame;
  if (!body.labels.file.empty()) {
    // A tumour's voxels have a value of their own: without them the organ would have a hole.
    LabelSource labels = body.labels;
    std::vector<LabelMask> also;
    const auto add = [&](const LabelSource& inner) {
      if (inner.file.empty()) return;
      if (inner.file != labels.file) {
        also.push_back(label_mask(image(inner), inner, MaskUse::region));
        return;
      }
      labels.values.insert(labels.values.end(), inner.values.begin(), inner.values.end());
      labels.segments.insert(labels.segments.end(), inner.segments.begin(), inner.segments.end());
    };
    for (const RegionScene& region : scene_.regions) add(region.labels);
    for (const CavityScene& cavity : scene_.cavities) add(cavity.labels);
    Surface surface = labelled(labels, MaskUse::body, also);
    rename(surface, "body");  // no path: it is hashed into the plan
    if (frame_ == Frame::unstated) frame_ = surface.frame;
    if (surface.frame == Frame::unstated) unstated_ = labels.file.string();
    turn(surface, labels.file.string());
    return surface;
  }
  if (body.surfaces.empty()) refuse_source(scene_.file.string() + ": the body has no surface");
  std::vector<Surface> surfaces;
  for (const SurfaceSource& source : body.surfaces) {
    surfaces.push_back(read_surface(source));
    if (frame_ == Frame::unstated) frame_ = surfaces.back().frame;
    if (surfaces.back().frame == Frame::unstated) unstated_ = source.file.string();
  }
  if (!unstated_.empty() && scene_.frame == Frame::unstated) frame_ = Frame::unstated;
  for (std::size_t k = 0; k < surfaces.size(); ++k) turn(surfaces[k], body.surfaces[k].file.string());
  return join(surfaces);
}

Surface SceneSurfaces::region(const RegionScene& region) {
  switch (region.shape) {
    case RegionScene::Shape::surface:
      break;
    case RegionScene::Shape::ellipsoid:
      return geometry::ellipsoid(region.centre, region.radii, 2 * region.radii.minCoeff() / region_edges, region.name);
    case RegionScene::Shape::box:
      return geometry::box_solid(region.box_min, region.box_max,
                                 (region.box_max - region.box_min).minCoeff() / region_edges, region.name);
    case RegionScene::Shape::labels: {
      Surface surface = labelled(region.labels, MaskUse::region);
      turn(surface, region.labels.file.string());
      return surface;
    }
  }
  return other(region.surface);
}

Surface SceneSurfaces::cavity(const CavityScene& cavity) {
  Surface surface;
  if (cavity.labels.file.empty()) {
    surface = other(cavity.surface);
  } else {
    surface = labelled(cavity.labels, MaskUse::region);
    turn(surface, cavity.labels.file.string());
  }
  rename(surface, cavity.name);
  return surface;
}

Surface SceneSurfaces::other(const SurfaceSource& source) {
  Surface surface = read_surface(source);
  turn(surface, source.file.string());
  return surface;
}

}  // namespace palpate::surface
