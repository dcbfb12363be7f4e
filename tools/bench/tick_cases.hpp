// SPDX-License-Identifier: GPL-3.0-or-later
// Random contacts of a response file: what the benchmarks of ticks are made on.
#pragma once

#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "palpate/palpate.hpp"

namespace palpate::cli {

/// A contact that was made, and poses that keep it in a state, a power of two of them.
struct TickCase {
  std::unique_ptr<runtime::Contact> contact;
  std::vector<runtime::Pose> poses;
};

/// The same place pressed, dragged along and left.
struct TickCases {
  TickCase press;  ///< in and out where it touched
  TickCase slide;  ///< sideways, 2 % of the depth scale a tick
  TickCase free;   ///< far from the body
};

/// Points uniform over the area of the sampled part of the contact surface: patches of three sampled sites, or where
/// there are none of one.
class RandomPoints {
public:
  explicit RandomPoints(const runtime::View& view);
  [[nodiscard]] bool empty() const { return !(sums_.back() > 0); }
  [[nodiscard]] runtime::BodyPoint draw(std::mt19937& random) const;

private:
  void sum_areas(int least);

  const runtime::View& view_;
  std::vector<double> sums_;
};

/// Up to `count` of them, the tool pressed in along n(c) to a random depth. Throws Error(bad_input) when no contact can
/// be made.
std::vector<TickCases> random_contacts(const runtime::View& view, std::uint32_t tool, int count, std::uint32_t seed);

}  // namespace palpate::cli
