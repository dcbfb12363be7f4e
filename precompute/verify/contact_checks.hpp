// SPDX-License-Identifier: GPL-3.0-or-later
// Solves beyond what a bake solves, at a few contacts: gross sliding, strokes, and two tips beside each other.
#pragma once

#include "precompute/solve/reference/slide.hpp"
#include "precompute/solve/reference/two_tips.hpp"
#include "precompute/verify/solver_bench.hpp"
#include "precompute/verify/strokes.hpp"

#include <functional>
#include <vector>

namespace palpate {

struct ContactCheckOptions {
  double radii = 3.5;                        ///< length of a slide in contact radii
  std::vector<double> spacings{1, 2, 4, 8};  ///< of two tips, in contact radii
  double stroke_depth = 0.9;                 ///< of a contact's own, (0, 1]
  double stroke_refine = 0.7;                ///< elements of a stroke's mesh, of the scene's
  unsigned threads = 1;
  std::function<bool()> stop;  ///< polled between steps of a slide and between pairs of tips; fewer results then
  std::function<void(std::size_t done, std::size_t total)> progress;
};

/// One slide, in the first of four directions that stays on free surface.
struct CheckedSlide {
  double angle = 0.0;    ///< rad, in the contact's frame
  double seconds = 0.0;  ///< meshing included, on one thread
  SlideResult result;
};

/// One stroke, its main way in the first of four directions in which all of it stays on free surface.
struct CheckedStroke {
  std::size_t contact = 0;  ///< index
  std::string name;
  double angle = 0.0;    ///< rad, in the contact's frame
  double seconds = 0.0;  ///< meshing included, on one thread
  StrokeResult result;
};

struct CheckedTips {
  std::size_t contact = 0;  ///< index
  double spacing = 0.0;     ///< contact radii
  double seconds = 0.0;
  TwoTipsResult result;
};

/// A slide of the tool's first vertex at every contact and its depth, with the scene's friction (> 0).
std::vector<CheckedSlide> check_slides(const Scene& scene, const Body& body, const Tool& tool,
                                       const std::vector<BenchContact>& contacts, const ContactCheckOptions& options);

/// The standard strokes of the tool's first vertex at every contact, with the scene's friction (> 0): by contact, then
/// by stroke.
std::vector<CheckedStroke> check_strokes(const Scene& scene, const Body& body, const Tool& tool,
                                         const std::vector<BenchContact>& contacts, const ContactCheckOptions& options);

/// Two tips at every contact, at every spacing: by contact, then by spacing. The same four directions.
std::vector<CheckedTips> check_two_tips(const Scene& scene, const Body& body, const Tool& tool,
                                        const std::vector<BenchContact>& contacts, const ContactCheckOptions& options);

}  // namespace palpate
