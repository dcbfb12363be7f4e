// SPDX-License-Identifier: GPL-3.0-or-later
// Plays a motion against a response file: one force a row.
#pragma once

#include <string>
#include <vector>

#include "palpate/palpate.hpp"
#include "tools/play/motion_file.hpp"

namespace palpate::cli {

struct PlayedRow {
  double time = 0;  ///< s
  runtime::Tick tick;
  int finger = 0;  ///< of a glove, from 1, the thumb: each has a row of its own; 0: of another device
};

/// Over all ticks, those between two rows included.
struct PlaySummary {
  std::size_t ticks = 0;
  bool starts_inside = false;               ///< the first pose overlaps the body: its contact starts at zero force
  double peak_force = 0;                    ///< N
  double peak_torque = 0;                   ///< N m
  double peak_depth = 0;                    ///< m
  double contact_time = 0, slide_time = 0;  ///< s
  std::size_t contacts = 0;                 ///< times that a contact began
  bool touching = false;                    ///< in the last tick
  std::size_t rows_extrapolated = 0;        ///< deeper than the pair was sampled, there or on the way
  std::size_t rows_filled = 0;              ///< more than half taken from neighbours, there or on the way
  std::size_t rows_other_contacts = 0;      ///< where the tool touches at another place, too, that is not felt
  std::size_t rows_near = 0;                ///< where places lie so near each other that their sum is too large
};

/// Adds a tick that lasted so long (s); rows are for whoever has them.
void account(PlaySummary& summary, const runtime::Tick& tick, double seconds);

/// Adds to `summary` the summary of another tool in the same ticks: times and contacts of all, the peaks of any.
void add(PlaySummary& summary, const PlaySummary& other);

/// Ticks through the motion, with as many ticks between two rows as keep each below 1 % of the depth scale
/// (at most 10 000): a recorded motion is not an occasion for late detection. A row has the sums of up to three walls and
/// the deepest depth; with `single` the nearest wall alone.
std::vector<PlayedRow> play(const runtime::View& view, std::uint32_t tool, const std::vector<MotionRow>& motion,
                            PlaySummary& summary, bool single = false);

/// t,fx,fy,fz,tx,ty,tz,state,depth,cx,cy,cz (s, N, N m about the tool frame's origin, m; body frame); of a glove
/// t,finger,fx and so on.
std::string forces_csv(const std::vector<PlayedRow>& rows);

/// Force components and depth over time; of a glove each finger's force and depth.
std::string forces_svg(const std::vector<PlayedRow>& rows, const std::string& title);

}  // namespace palpate::cli
