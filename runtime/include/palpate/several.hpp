// SPDX-License-Identifier: MIT
// Several contacts at once: of one tool that touches at two places, and of several tools on one body.
#pragma once

#include "palpate/contact.hpp"
#include "palpate/places.hpp"

#include <array>
#include <cmath>
#include <utility>

namespace palpate::runtime {

/// One tool that may touch at up to `Most` places: tip and stem, or between two lobes. The first contact is Contact's.
/// Another begins, at zero force, where the tool overlaps the body beyond a hollow: the straight line from a contact
/// point to it is outside the body half way. As two points c come closer than `gap` the later one's share falls, to
/// nothing at half the gap, so that contacts merge without a step, as the tool moves where one leapt to another's
/// place; what is stored falls and rises with it (Contact::rescaled). Every tick takes bounded time and allocates
/// nothing; a look for another place is nine searches more (for a mesh tool three for every patch) and is made once the
/// tool or c has moved by what is known to be free. kFeatures as those of BasicContact.
template <int Most = 2, std::uint32_t kFeatures = layout::feature_all>
class SeveralContacts {
  static_assert(Most >= 2);

public:
  SeveralContacts(const View& view, std::uint32_t tool)
      : SeveralContacts(view, tool, std::make_index_sequence<Most>()) {}
  SeveralContacts(const View&&, std::uint32_t) = delete;

  void reset() {
    for (BasicContact<kFeatures>& contact : contacts_) contact.reset();
    share_.fill(1);
    last_ = {};
    free_ = -1;
  }

  SeveralTick<Most> tick(const Pose& pose) { return tick(pose, nullptr); }

  /// The same with searches that are made elsewhere: search() of Places::of(pose, tick), which the force loop tells.
  /// No tick searches or looks. Another contact begins only while all that touch are where they were told, by half the
  /// gap at most. Searches of another view or tool are as in Contact::tick, a fault of all.
  SeveralTick<Most> tick(const Pose& pose, const SeveralSearch<Most>& latest) { return tick(pose, &latest); }

  /// `k`: 0 to Most - 1.
  [[nodiscard]] const BasicContact<kFeatures>& contact(int k) const { return contacts_[static_cast<std::size_t>(k)]; }

private:
  template <std::size_t... K>
  SeveralContacts(const View& view, std::uint32_t tool, std::index_sequence<K...>)
      : view_(&view),
        reach_(skeleton_radius<kFeatures>(view, tool)),
        tip_(view, tool),
        finder_(view, tool),
        contacts_{((void)K, BasicContact<kFeatures>(view, tool))...} {
    share_.fill(1);
  }

  SeveralTick<Most> tick(const Pose& pose, const SeveralSearch<Most>* latest) {
    SeveralTick<Most> sum;
    if (latest && !contacts_[0].knows(latest->more)) {
      reset();
      sum.each[0].state = State::fault;
      return sum;
    }
    sum.each[0] = latest ? contacts_[0].tick(pose, latest->first) : contacts_[0].tick(pose);
    for (int k = 1; k < Most; ++k) {
      if (last_[k].touches()) sum.each[k] = contacts_[k].tick_found(pose, none(pose), latest ? &latest->more : nullptr);
    }
    if (sum.each[0].state == State::fault) {
      for (std::size_t k = 1; k < Most; ++k) sum.each[k] = {};
      reset();
      return sum;
    }
    for (int k = 1; k < Most; ++k) {
      if (takes_over(k, sum)) lead(k, pose, sum);
    }
    if (!sum.each[0].touches()) {
      share_.fill(1);
    } else if (latest) {
      take(pose, *latest, sum);
    } else {
      look(pose, sum);
    }
    for (int k = 0; k < Most; ++k) {
      if (sum.each[k].touches()) weigh(k, pose, sum);
    }
    last_ = sum.each;
    return sum;
  }

  /// A search that sees nothing: contacts beyond the first begin only where a look found them.
  static Search none(const Pose& pose) {
    Search search;
    search.pose = pose;
    search.touch.clearance = search.touch.safe = HUGE_VAL;
    return search;
  }

  /// The first contact is the one that searches: where it was let go, another takes its place, and so does one to which
  /// it came too near and that pushes more.
  [[nodiscard]] bool takes_over(int k, const SeveralTick<Most>& sum) const {
    const Tick &first = sum.each[0], &other = sum.each[k];
    if (!other.touches()) return false;
    if (!first.touches()) return true;
    return length(other.body_point - first.body_point) < 0.5 * finder_.gap() &&
           share_[k] * length(other.force) > share_[0] * length(first.force);
  }
  void lead(int k, const Pose& pose, SeveralTick<Most>& sum) {
    std::swap(contacts_[0], contacts_[k]);
    std::swap(sum.each[0], sum.each[k]);
    std::swap(share_[0], share_[k]);
    // It did not move there.
    looked_c_ = sum.each[0].body_point;
    before_ = motion(pose, sum.each[0]);
  }

  /// Adds contact k with the share that its distance from those before it leaves.
  void weigh(int k, const Pose& pose, SeveralTick<Most>& sum) {
    const auto at = static_cast<std::size_t>(k);
    Tick& tick = sum.each[at];
    double share = 1;
    for (std::size_t j = 0; j < at; ++j) {
      if (!sum.each[j].touches()) continue;
      const double apart = length(tick.body_point - sum.each[j].body_point) / finder_.gap();
      share = std::fmin(share, std::fmax(0, 2 * apart - 1));
    }
    // A share changes as the tool moves: where a point c leapt to another's, or the first was another before.
    share = std::fmax(std::fmin(share, share_[at] + grow_), share_[at] - fade_);
    if (k > 0 && !(share > 0)) {
      contacts_[at].reset();
      tick = {};
      return;
    }
    if (share != share_[at]) contacts_[at].rescaled(share_[at] > 0 ? share / share_[at] : HUGE_VAL, pose, tick);
    share_[at] = share;
    tick.force = share * tick.force;
    tick.torque = share * tick.torque;
    tick.friction_limit *= share;
    sum.force = sum.force + tick.force;
    sum.torque = sum.torque + tick.torque;
    ++sum.touching;
    for (std::size_t j = 0; j < at; ++j) {
      if (sum.each[j].touches()) sum.overlap.add(sum.each[j], tip_, tick, tip_);
    }
  }

  /// Begins a contact more where there is one and a place for it.
  void look(const Pose& pose, SeveralTick<Most>& sum) {
    if (grow(pose, sum.each[0]) < free_) return;
    const std::size_t k = spare(sum);
    if (k == Most) return;
    looked_from(pose, sum.each[0]);
    const Search found = finder_.look(Places<Most>::of(pose, sum), 0);
    // A look is at samples: between them as much may be missed as a contact begins late, at zero force.
    free_ = std::fmax(0.02 * view_->meta->depth_scale, std::fmin(found.touch.safe, 0.25 * finder_.gap()));
    if (found.touch.clearance < 0) begin(k, pose, found, nullptr, sum);
  }

  /// The same where another thread looked.
  void take(const Pose& pose, const SeveralSearch<Most>& latest, SeveralTick<Most>& sum) {
    grow(pose, sum.each[0]);
    looked_from(pose, sum.each[0]);
    free_ = -1;
    const std::size_t k = spare(sum);
    if (k == Most || !(latest.more.touch.clearance < HUGE_VAL)) return;
    for (const Tick& tick : sum.each) {
      if (tick.touches() && latest.asked.apart(tick.body_point, 0.5 * finder_.gap())) return;
    }
    begin(k, pose, latest.more, &latest.more, sum);
  }

  void begin(std::size_t k, const Pose& pose, const Search& found, const Search* served, SeveralTick<Most>& sum) {
    const Places<Most> others = Places<Most>::of(pose, sum);
    contacts_[k].reset();
    share_[k] = 1;
    const Tick tick = contacts_[k].tick_found(pose, found, served);
    if (tick.touches() && others.apart(tick.body_point, finder_.gap())) {
      sum.each[k] = tick;
    } else {
      contacts_[k].reset();
    }
  }

  /// The first that does not touch.
  static std::size_t spare(const SeveralTick<Most>& sum) {
    std::size_t k = 1;
    while (k < Most && sum.each[k].touches()) ++k;
    return k;
  }

  /// How far skin and c may have come since the last look (m). What this tick brought of it lets shares rise.
  double grow(const Pose& pose, const Tick& first) {
    const double moved = motion(pose, first), more = moved - before_;
    grow_ = std::fmin(1, more > 0 ? more / finder_.gap() : 0);
    fade_ = 2 * std::fabs(more) / finder_.gap();
    before_ = moved;
    return moved;
  }
  [[nodiscard]] double motion(const Pose& pose, const Tick& first) const {
    return skeleton_motion(looked_, pose, reach_) + length(first.body_point - looked_c_);
  }
  void looked_from(const Pose& pose, const Tick& first) {
    looked_ = pose;
    looked_c_ = first.body_point;
    before_ = 0;
  }

  const View* view_;
  double reach_;  ///< m
  Tip tip_;
  PlaceFinder<kFeatures> finder_;
  std::array<BasicContact<kFeatures>, Most> contacts_;
  std::array<double, Most> share_;
  std::array<Tick, Most> last_;
  Pose looked_;
  Vec3 looked_c_;
  double free_ = -1, before_ = 0;  ///< m since the last look: needs none yet; was in the last tick
  double grow_ = 0, fade_ = 0;     ///< most that a share rises and falls in this tick
};

/// Several tools on one body (two instruments, five fingertips): each keeps its own contact and its own handle, and the
/// overlap says how far their forces can be trusted, which are those of each alone.
template <int Count, std::uint32_t kFeatures = layout::feature_all>
class SeveralTools {
public:
  /// `tools`: indices into the file's tools, which may repeat.
  SeveralTools(const View& view, const std::array<std::uint32_t, Count>& tools)
      : SeveralTools(view, tools, std::make_index_sequence<Count>()) {}
  SeveralTools(const View&&, const std::array<std::uint32_t, Count>&) = delete;

  void reset() {
    for (BasicContact<kFeatures>& contact : contacts_) contact.reset();
    overlap_ = {};
  }

  /// One tick of each, in order.
  std::array<Tick, Count> tick(const std::array<Pose, Count>& poses) {
    return together([&](std::size_t k) { return contacts_[k].tick(poses[k]); });
  }
  /// The same with searches that are made elsewhere, one of each.
  std::array<Tick, Count> tick(const std::array<Pose, Count>& poses, const std::array<Search, Count>& latest) {
    return together([&](std::size_t k) { return contacts_[k].tick(poses[k], latest[k]); });
  }

  /// Of the last tick.
  [[nodiscard]] const Overlap& overlap() const { return overlap_; }
  /// `k`: 0 to Count - 1.
  [[nodiscard]] const BasicContact<kFeatures>& contact(int k) const { return contacts_[static_cast<std::size_t>(k)]; }

private:
  template <std::size_t... K>
  SeveralTools(const View& view, const std::array<std::uint32_t, Count>& tools, std::index_sequence<K...>)
      : contacts_{BasicContact<kFeatures>(view, tools[K])...}, tips_{Tip(view, tools[K])...} {}

  template <class TickOf>
  std::array<Tick, Count> together(const TickOf& tick_of) {
    std::array<Tick, Count> ticks;
    overlap_ = {};
    for (std::size_t k = 0; k < Count; ++k) {
      ticks[k] = tick_of(k);
      for (std::size_t j = 0; j < k; ++j) {
        overlap_.add(ticks[j], tips_[j], ticks[k], tips_[k]);
      }
    }
    return ticks;
  }

  std::array<BasicContact<kFeatures>, Count> contacts_;
  std::array<Tip, Count> tips_;
  Overlap overlap_;
};

}  // namespace palpate::runtime
