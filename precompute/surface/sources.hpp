// SPDX-License-Identifier: GPL-3.0-or-later
// The surfaces of a scene from its files, all in one frame.
#pragma once

#include "formats/image/label_image.hpp"
#include "formats/surface/surface.hpp"

#include <map>
#include <memory>
#include <string>

namespace palpate::surface {

/// Reads the surfaces and labels of one scene. An image that several of them name is read once. Coordinates that a file
/// states in LPS or RAS are turned into the scene's frame: the one that `scene.frame` says, else the one that the
/// body's files state. Each function throws Error(bad_input) where one file states a frame and the scene does not have
/// one because the body's files state none.
class SceneSurfaces {
public:
  explicit SceneSurfaces(const Scene& scene) : scene_(scene) {}

  /// The body's surfaces, joined, or the surface round its labels. To be called first.
  Surface body();
  Surface region(const RegionScene& region);
  Surface cavity(const CavityScene& cavity);
  /// A surface that stands beside the body: of a support.
  Surface other(const SurfaceSource& source);

private:
  const LabelImage& image(const LabelSource& labels);
  Surface labelled(const LabelSource& labels, MaskUse use, const std::vector<LabelMask>& also = {});
  void turn(Surface& surface, const std::string& file);

  const Scene& scene_;
  std::map<std::string, std::shared_ptr<const LabelImage>> images_;
  Frame frame_ = Frame::unstated;
  std::string unstated_;  ///< the body's file that states no frame
};

}  // namespace palpate::surface
