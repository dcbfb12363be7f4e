// SPDX-License-Identifier: MIT
// How a tool is turned about the normal of its contact: which of the sampled spins answer, and how they lie.
#pragma once

#include "palpate/surface.hpp"

#include <cmath>

namespace palpate::runtime {

/// The spin of a tool at a contact: that of a pose, or one that was sampled (below that vertex' count of spins), which
/// lies as it was baked.
struct Spin {
  const Pose* pose = nullptr;
  std::uint32_t sample = 0;
  /// Of a point on a profile's tip that lies further from the pole than the pose says: times the sine of the tool's
  /// tilt it is how sure the direction is in which it lies, at most wholly.
  double sure_per_sine = HUGE_VAL;
};

/// From one of so many spins, evenly round, to the next: remembered, for all vertices of a tool mostly have as many.
class SpinStep {
public:
  const Across& of(std::uint32_t spins) {
    if (spins != spins_) {
      spins_ = spins;
      step_ = {std::cos(kFullTurn / spins), std::sin(kFullTurn / spins)};
    }
    return step_;
  }

private:
  std::uint32_t spins_ = 1;
  Across step_;
};

/// What the vertices of a tool answer at the sites of a contact's patch: the samples on either side of the spin, by
/// hats, each turned on until its tangent lies where the tool's does: what the tool brings along turns with it. What is
/// not sure is left to the first sample as it was baked, and so is all of a view without spins.
class SpunSites {
public:
  /// `x` and `y` span what lies across n(c); `axis`: in it, the x axes of the sites' frames, carried to c.
  SpunSites(const View& view, const layout::ToolRecord& tool, const Spin& spin, const Vec3& n, const Vec3& x,
            const Vec3& y, const Across (&axis)[3], SpinStep& step)
      : view_(view), tool_(tool), spin_(spin), n_(n), x_(x), y_(y), step_(step) {
    for (int k = 0; k < 3; ++k) axis_[k] = axis[k];
    if (spin.pose == nullptr || view.spins == nullptr) return;
    for (int k = 0; k < 3; ++k) angle_[k] = std::atan2(axis[k].sine, axis[k].cosine);
  }

  /// Calls use(k, sample, share, x) for all that answers of a vertex: by layers, of one sample at each of the sites k,
  /// up to kMostLayers; `x` is the axis of what the sample answers. Samples next to each other change places in their
  /// layers as the tool turns, and none else.
  template <class Use>
  void for_each(std::uint32_t vertex, const Use& use) const {
    const std::uint32_t spins = view_.spins != nullptr ? view_.spins[vertex] : 1;
    if (spins == 1 || spin_.pose == nullptr) {
      const std::uint32_t sample = spin_.sample < spins ? spin_.sample : 0u;
      for (int k = 0; k < 3; ++k) use(k, sample, 1.0, axis_[k]);
      return;
    }
    const Laid laid = lie(vertex);
    const double angle = std::atan2(laid.tangent.sine, laid.tangent.cosine);
    const Across& step = step_.of(spins);
    std::uint32_t below[3];
    double share[3];
    Across turned[3];
    for (int k = 0; k < 3; ++k) {
      double from = angle - angle_[k];
      if (from < 0) from += kFullTurn;
      const double at = from * (spins / kFullTurn);
      below[k] = static_cast<std::uint32_t>(at);  // `spins` where it was rounded up
      share[k] = at - below[k];
      turned[k] = k > 0 && below[k] == below[k - 1] ? turned[k - 1] : turned_back(laid.tangent, step, below[k]);
    }
    for (std::uint32_t layer = 0; layer < 2; ++layer) {
      for (int k = 0; k < 3; ++k) {
        const bool next = (below[k] + layer) % 2 != 0;
        const double weight = laid.sure * (next ? share[k] : 1 - share[k]);
        use(k, (below[k] + next) % spins, weight, next ? back_by(turned[k], step) : turned[k]);
      }
    }
    if (!(laid.sure < 1)) return;
    for (int k = 0; k < 3; ++k) use(k, 0u, 1 - laid.sure, axis_[k]);
  }

private:
  /// How a vertex lies at the contact.
  struct Laid {
    Across tangent;   ///< that of its first spin
    double sure = 1;  ///< [0, 1], falls to 0 where that direction is lost
  };

  [[nodiscard]] static Across back_by(const Across& a, const Across& by) {
    return {a.cosine * by.cosine + a.sine * by.sine, a.sine * by.cosine - a.cosine * by.sine};
  }
  /// By so many steps: squares of a step, one for each of the number's bits.
  [[nodiscard]] static Across turned_back(Across a, Across by, std::uint32_t steps) {
    for (; steps > 0; steps /= 2) {
      if (steps % 2 != 0) a = back_by(a, by);
      by = {by.cosine * by.cosine - by.sine * by.sine, 2 * by.cosine * by.sine};
    }
    return a;
  }

  /// Of a profile the tangent runs up the tool's axis, whichever side of it touches; it is lost where the tool points
  /// into the body, and where the stem that is to lie on the body stands upright, or a tip that lags behind. Of a mesh
  /// it is carried from the vertex' own normal to the contact's by the smallest rotation; it is lost where these are
  /// opposed.
  [[nodiscard]] Laid lie(std::uint32_t vertex) const {
    const layout::ToolVertexRecord& record = view_.tool_vertices[vertex];
    const Pose& pose = *spin_.pose;
    Vec3 along = pose.rotate({0, 0, 1});
    double cosine = dot(along, n_);
    double per_sine = record.tangent[2] > 0.9f ? 2 : spin_.sure_per_sine;
    if (tool_.kind != static_cast<std::uint32_t>(layout::ToolKind::profile)) {
      const Vec3 own = pose.rotate(to_vec(record.normal));
      cosine = -dot(own, n_);
      along = pose.rotate(to_vec(record.tangent));
      if (1 + cosine > 1e-9) along = along + (dot(along, n_) / (1 + cosine)) * (own - n_);
      per_sine = HUGE_VAL;
    }
    Laid laid;
    const double a = dot(along, x_), b = dot(along, y_), size = std::sqrt(a * a + b * b);
    if (!(size > 0)) return {{}, 0};
    laid.tangent = {a / size, b / size};
    if (cosine < 0) per_sine = 2;
    if (per_sine < HUGE_VAL) laid.sure = std::fmin(1, per_sine * std::sqrt(std::fmax(0, 1 - cosine * cosine)));
    return laid;
  }

  const View& view_;
  const layout::ToolRecord& tool_;
  const Spin& spin_;
  Vec3 n_, x_, y_;
  Across axis_[3];
  double angle_[3] = {};  ///< rad, of the axes
  SpinStep& step_;
};

}  // namespace palpate::runtime
