// SPDX-License-Identifier: GPL-3.0-or-later
// The property test: random motions against a response file, and promises 1 to 7 of a contact.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "palpate/body/stiffness_scale.hpp"
#include "palpate/contact/contact_set.hpp"

namespace palpate::test {

/// How the hand moves.
enum class Motion : std::uint8_t {
  press,   ///< in, aside, deeper, back, out, anywhere on the body; the tool keeps its direction
  graze,   ///< along the surface, a hundredth of the depth scale deep
  corner,  ///< as press, about the sharpest edges and corners
  turn,    ///< as press, and the tool turns
  fast     ///< up to the depth scale in one tick, with leaps and turns now and then
};

/// Which contact ticks.
enum class Driver : std::uint8_t {
  alone,      ///< BasicContact::tick(pose)
  searched,   ///< with searches that are 5 to 40 ticks old
  scaled,     ///< StiffnessScale, all sites' factors redrawn every 50 ticks
  deforming,  ///< DeformingBody that swells, shears and turns, shapes at 60 Hz and now and then late
  set         ///< ContactSet of three
};

struct PropertyCase {
  Motion motion = Motion::press;
  Driver driver = Driver::alone;
  std::uint32_t tool = 0;
  std::uint64_t ticks = 10000;
  unsigned seed = 1;
  double fine = 1;  ///< steps are so many times as long
};

/// Results of the property test. Shares are of the file's own scales, so they compare from file to file.
struct PropertyResult {
  std::uint64_t ticks = 0, touching = 0, sliding = 0, contacts = 0;
  std::uint64_t broken = 0;  ///< ticks that are not finite, push without depth, or are a fault at a good pose
  double force = 0;          ///< largest force over stiffness * max(depth, depth scale)
  double step = 0;           ///< largest change of the force over stiffness * (way of the tool's skin and of c)
  double jump = 0;           ///< the same over the way of the skin alone, of a slow tool that keeps its direction
  double onset = 0;          ///< largest force at a first or last tick beyond its motion, over stiffness * depth scale
  double gain = 0;           ///< most that a contact gave back beyond what it took, over what went through it
  double gross = 0;          ///< J that went through
  double drive = 0;          ///< most that a contact's friction gave back beyond what it took, over what went through it
  double least_counted = 1;  ///< least counted depth over depth (no promise)
  std::uint64_t hash = 0;    ///< of every force and torque

  void add(const PropertyResult& other);
};

/// Empty, or which of the promises 1 to 7 does not hold:
///
///     1 finite; no force without indentation            always
///     2 force                                           1.2 x stiffest place x depth
///     3 change of force per metre of skin and c         2.5 x stiffness
///     4 change of force per metre of a slow skin        5 x stiffness (10 where mu >= 1)
///     5 force of a contact's first and last tick        0.5 % of stiffness x depth scale
///     6 given back beyond what was taken                1e-3 of what went through (2e-2 where steps exceed 1 % of the
///                                                       depth scale)
///     7 given back by friction beyond what it took      1e-3 of what went through it
std::string broken_promise(const PropertyCase& c, const PropertyResult& result, double friction);

/// Stiffness (N/m) that no indentation and no tangential push exceeds, with a tenth of margin. Deeper than the depth
/// scale the tangential stiffness goes on growing with the depth.
struct Stiffest {
  double within = 0;       ///< N/m, within the depth scale
  double further = 0;      ///< N/m, more with each depth scale beyond
  double depth_scale = 0;  ///< m
  double friction = 0;     ///< largest friction coefficient

  [[nodiscard]] double at(double depth) const;  ///< N/m, down to there (m)
};
Stiffest stiffest(const runtime::View& view, std::uint32_t tool);

PropertyResult run_property(const runtime::View& view, const PropertyCase& c);

inline constexpr Motion kMotions[] = {Motion::press, Motion::graze, Motion::corner, Motion::turn, Motion::fast};
inline constexpr Driver kDrivers[] = {Driver::alone, Driver::searched, Driver::scaled, Driver::deforming, Driver::set};

const char* name(Motion motion);
const char* name(Driver driver);

}  // namespace palpate::test
