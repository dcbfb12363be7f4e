// SPDX-License-Identifier: GPL-3.0-or-later
// Solves beyond what a bake solves, at a few contacts: gross sliding, strokes, and several tools at once.
#pragma once

#include "precompute/solve/reference/slide.hpp"
#include "precompute/solve/reference/together.hpp"
#include "precompute/verify/layouts.hpp"
#include "precompute/verify/solver_bench.hpp"
#include "precompute/verify/strokes.hpp"

#include <functional>
#include <vector>

namespace palpate::verify {

struct ContactCheckOptions {
  double radii = 3.5;                        ///< length of a slide in contact radii
  std::vector<double> spacings{1, 2, 4, 8};  ///< of tools together, in contact radii
  Layout layout = Layout::line;              ///< of tools together
  int count = 2;                             ///< tools together, [1, 5]
  std::size_t draws = 8;                     ///< random layouts at each contact, within the range of `spacings`
  bool sticking = false;                     ///< the contacts of tools together stick
  double aside = 0.0;                        ///< of the first of them once all are down, in depths; they stick then
  double alone_depth = 0.0;                  ///< m, solve::TogetherPath
  double stroke_depth = 0.9;                 ///< of a contact's own, (0, 1]
  double stroke_refine = 0.7;                ///< elements of a stroke's mesh, of the scene's
  std::function<bool(const solve::ContactCase&, double depth)> touchable;  ///< for tools together; empty: everywhere
  unsigned threads = 1;
  std::function<void(std::size_t done, std::size_t total)> progress;
};

/// One slide, in the first of four directions that stays on free surface.
struct CheckedSlide {
  double angle = 0.0;    ///< rad, in the contact's frame
  double seconds = 0.0;  ///< meshing included, on one thread
  solve::SlideResult result;
};

/// One stroke, its main way in the first of four directions in which all of it stays on free surface.
struct CheckedStroke {
  std::size_t contact = 0;  ///< index
  std::string name;
  double angle = 0.0;    ///< rad, in the contact's frame
  double seconds = 0.0;  ///< meshing included, on one thread
  solve::StrokeResult result;
};

struct CheckedTogether {
  std::size_t contact = 0;  ///< index
  double spacing = 0.0;     ///< contact radii, the least between two tools; 0 for one tool
  double seconds = 0.0;
  std::vector<ContactFrame> places;
  solve::TogetherResult result;
};

/// A slide of the tool's first vertex at every contact and its depth, with the scene's friction (> 0).
std::vector<CheckedSlide> check_slides(const Scene& scene, const Body& body, const tool::Tool& tool,
                                       const std::vector<BenchContact>& contacts, const ContactCheckOptions& options);

/// The standard strokes of the tool's first vertex at every contact, with the scene's friction (> 0): by contact, then
/// by stroke.
std::vector<CheckedStroke> check_strokes(const Scene& scene, const Body& body, const tool::Tool& tool,
                                         const std::vector<BenchContact>& contacts, const ContactCheckOptions& options);

/// Tools of the first vertex at every contact and its depth, at every spacing: by contact, then by spacing. A line or
/// ring takes the first of four directions that has surface for it; random places differ from spacing to spacing, and a
/// pinch has only the first. A place for which the scene bakes nothing is refused: outside sampling.within_box, where
/// the contact's depth is more than its own, and where it is not touchable.
std::vector<CheckedTogether> check_together(const Scene& scene, const Body& body, const tool::Tool& tool,
                                            const std::vector<BenchContact>& contacts,
                                            const ContactCheckOptions& options);

}  // namespace palpate::verify
