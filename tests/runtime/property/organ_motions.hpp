// SPDX-License-Identifier: GPL-3.0-or-later
// Presses at every site of a body and slides round it, by a ball: promises 8 and 9 of a contact.
#pragma once

#include <cstdint>
#include <string>

#include "palpate/contact/contact.hpp"

namespace palpate::test {

struct PressOptions {
  double depth = 0.6;     ///< of the depth scale
  double aside = 0;       ///< m, there and back at full depth; promise 8 is for 0
  int repeats = 4;        ///< presses a site; without `aside` all but the first repeat it
  unsigned seed = 3;
};

struct SlideOptions {
  double overlap = 0.3;   ///< of the depth scale, of the ball and the body
  int runs = 24;
  int ticks = 6000;       ///< of a run
  double stride = 4e-5;   ///< m a tick
  unsigned seed = 5;
};

/// Results of presses and slides. A press goes in along the site's normal and out again.
struct OrganResult {
  std::uint32_t presses = 0;
  std::uint32_t stepped = 0;     ///< presses with a tick that changes the force by more than 10 % of the peak
  std::uint32_t lifts_off = 0;   ///< presses whose lift differs from the way in by more than 10 % of the peak
  std::uint32_t lost_early = 0;  ///< presses that lose all force with more than a tenth of the depth left
  double step = 0;               ///< largest change of the force in a tick, of the peak
  double lift = 0;               ///< largest difference of a lift, of the peak

  std::uint32_t slides = 0;
  double travel = 0;                ///< m, of all slides
  double weak_travel = 0;           ///< m, with a force below a tenth of the place's own
  double longest_weak = 0;          ///< overlaps, longest such travel in one piece
  std::uint32_t touch_changes = 0;  ///< contacts that begin or end on a slide
  double contact_size = 0;          ///< m
  double slide_step = 0;            ///< largest change of the force in a tick, of its 90th percentile in the slide

  double gain = 0;  ///< most that a motion gave back beyond what it took, over what went through it

  void add(const OrganResult& other);
  /// Contacts that begin or end on a slide, for a contact's size of travel.
  [[nodiscard]] double touch_changes_per_size() const;
};

/// Presses the ball `tool` into every site with a response of its own from which it is free 1 mm above.
OrganResult press_sites(const runtime::View& view, std::uint32_t tool, const PressOptions& options = {});

/// Slides the ball `tool` round the body at constant overlap. A run ends where the ball's centre would enter the body.
OrganResult slide_round(const runtime::View& view, std::uint32_t tool, const SlideOptions& options = {});

/// Whether a tool is a ball, for which these motions are made.
bool is_ball(const runtime::View& view, std::uint32_t tool);

/// Empty, or which promise does not hold:
///
///     8 lift                                        within 10 % of the peak of the press
///       press                                       keeps its force to the last tenth of the depth
///       step in a tick                              at most 10 % of the peak
///     9 travel below a tenth of the place's force   at most 5 overlaps in one piece
///       touch and release                           at most once per contact's size of travel
std::string broken_promise(const OrganResult& result);

}  // namespace palpate::test
