// SPDX-License-Identifier: GPL-3.0-or-later
// Random motions against a response file, and what they hold the contact to: the property battery.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "palpate/palpate.hpp"

namespace palpate::test {

/// How the hand moves. All but `fast` in steps far below the depth scale, so that a sum over trapezoids is the work.
enum class Motion : std::uint8_t {
  press,   ///< in, aside, deeper, back, out, anywhere on the body; the tool keeps its direction
  graze,   ///< along the surface, a hundredth of the depth scale deep
  corner,  ///< as press, about the sharpest edges and corners
  turn,    ///< as press, and the tool turns
  fast,    ///< up to the depth scale in one tick, with leaps and spins now and then
};

/// Who finds the contact, and what is done to the file meanwhile.
enum class Driver : std::uint8_t {
  alone,     ///< Contact::tick(pose)
  late,      ///< searches that are 5 to 40 ticks old
  online,    ///< AdjustedContact, all sites' factors redrawn every 50 ticks
  animated,  ///< AnimatedContact: the body swells, shears and turns, shapes come at 60 Hz and now and then late
  several    ///< SeveralContacts<3>: what they give together
};

struct BatteryCase {
  Motion motion = Motion::press;
  Driver driver = Driver::alone;
  std::uint32_t tool = 0;
  std::uint64_t ticks = 10000;
  unsigned seed = 1;
  double fine = 1;  ///< steps so many times as long: the error of the sums over trapezoids falls with its square
};

/// What was found; shares are of the file's own scales, so that they compare from file to file.
struct BatteryResult {
  std::uint64_t ticks = 0, touching = 0, sliding = 0, contacts = 0;
  std::uint64_t broken = 0;  ///< ticks that are not finite, push without depth, or call a good pose a fault
  double force = 0;          ///< largest force, as a share of stiffness * max(depth, depth scale)
  double step = 0;           ///< largest change of the force over stiffness * the way of the tool's skin and of c
  double leap = 0;           ///< the same over that of the skin alone, of a slow tool that keeps its direction
  double begin = 0;          ///< largest force with which a contact began or ended on a fast motion or an old search
  double gain = 0;           ///< most that any contact had given back beyond what it took, over what went through it or
                             ///< a thousandth (in fast motions a fiftieth) of stiffness * depth scale squared
  double gained = 0;         ///< J, sum of that over the contacts
  double gross = 0;          ///< J that hand and surface gave or got
  std::uint64_t acting = 0;  ///< touching ticks, and their ends, in which the energy account took something
  double lost = 0;           ///< J that it took
  double drag = 0;           ///< J that sideways forces gave to a sliding contact, over what they took from it
  std::uint64_t hash = 0;    ///< of every force and torque

  void add(const BatteryResult& other);
};

/// The bounds that every result is held to; empty, or which of them does not hold. Per metre that the tool's skin
/// (against the surface) and c move (where the body is animated, in the tick before, too), the force changes by at most
/// twice the stiffness (Stiffest, of the contact's depth), two and a half times in fast motions. Of a slow tool that
/// keeps its direction c may go where it will: per metre that the skin moves, by at most five times the stiffness. A
/// contact begins and ends with less than 0.5 % of stiffness * depth scale. A contact gives back at most a thousandth
/// of what went through it more than it took: the error of the sum. In fast motions at most a fiftieth, beyond what the
/// hand may have given otherwise than the sum over trapezoids says: half of each tick's change of the force times its
/// way.
std::string broken_promise(const BatteryCase& c, const BatteryResult& result);

/// Newtons a metre that no push of the tool, straight or sideways, exceeds; a tenth of margin. Deeper than the depth
/// scale the sideways stiffness goes on growing with the depth.
struct Stiffest {
  double within = 0;       ///< N/m, within the depth scale
  double further = 0;      ///< N/m, more with each depth scale beyond
  double depth_scale = 0;  ///< m

  [[nodiscard]] double at(double depth) const;  ///< N/m, down to there (m)
};
Stiffest stiffest(const runtime::View& view, std::uint32_t tool);

BatteryResult run_battery(const runtime::View& view, const BatteryCase& c);

const char* name(Motion motion);
const char* name(Driver driver);

}  // namespace palpate::test
