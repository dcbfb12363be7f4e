// SPDX-License-Identifier: MIT
// Several contacts at once: of one tool that touches at two places, and of several tools on one body.
#pragma once

#include "palpate/contact.hpp"

#include <array>
#include <cmath>
#include <utility>

namespace palpate::runtime {

/// By what share the sum of two equal tips' forces is too large, for each sinks into the other's dent: `spacing` and
/// their contact radius in m. Measured by solving both at once on a block 30 contact radii wide and deep, 1, 2, 4 and 8
/// radii apart (`palpate verify --two-tips`): 0.33, 0.22, 0.11, 0.04. Straight in between; beyond, falling as the dent
/// does.
inline double superposition_error(double spacing, double contact_radius) {
  constexpr double kError[] = {0.33, 0.22, 0.11, 0.04};
  if (!(contact_radius > 0)) return 0;
  double apart = spacing / contact_radius;
  if (apart >= 8) return kError[3] * 8 / apart;
  if (!(apart > 1)) return apart > 0 ? 0.5 - (0.5 - kError[0]) * apart : 0.5;  // at one place the second counts twice
  int below = 0;
  for (; apart >= 2; apart *= 0.5) ++below;
  return kError[below] + (apart - 1) * (kError[below + 1] - kError[below]);
}

/// How large the contact of a tool is. A round tip's grows with the depth, a punch has its own from the first touch; a
/// mesh tool counts as round with the reach of its skeleton, so rather as too large.
class Tip {
public:
  Tip() = default;
  Tip(const View& view, std::uint32_t tool) {
    const layout::ToolRecord& record = view.tools[tool];
    if (record.kind == static_cast<std::uint32_t>(layout::ToolKind::mesh)) {
      round_ = std::fmax(skeleton_radius(view, tool), record.probe_radius);
    } else {
      (record.probe_radius > 0 ? round_ : flat_) = std::fmax(record.radius, record.probe_radius);
    }
  }

  /// Radius (m) at a depth (m).
  [[nodiscard]] double contact(double depth) const { return flat_ > 0 ? flat_ : std::sqrt(round_ * depth); }

private:
  double round_ = 0, flat_ = 0;  ///< m, radius of curvature, or of the flat end
};

/// Where two contacts add, and whether their sum can be trusted.
struct Overlap {
  double spacing = HUGE_VAL;  ///< m, least between two points c that push
  double error = 0;           ///< largest superposition_error of such two
  /// People notice 7 to 10 %: what is less than this is not worth a warning.
  static constexpr double kNotable = 0.07;
  [[nodiscard]] bool near() const { return error > kNotable; }

  /// Takes in two contacts, of which it counts those that push.
  void add(const Tick& a, const Tip& tip_a, const Tick& b, const Tip& tip_b) {
    if (!(a.depth > 0) || !(b.depth > 0)) return;
    const double gap = length(a.body_point - b.body_point);
    spacing = std::fmin(spacing, gap);
    error = std::fmax(error, superposition_error(gap, std::fmax(tip_a.contact(a.depth), tip_b.contact(b.depth))));
  }
};

/// What one tool gets from all its contacts.
template <int Most>
struct SeveralTick {
  Vec3 force, torque;  ///< N, N m about the origin of the tool's frame, body frame: the sums
  int touching = 0;
  std::array<Tick, Most> each;  ///< each contact's own, with the share that it has in the sums
  Overlap overlap;
};

/// Where a tool is and touches, for a look for another place.
template <int Most>
struct Places {
  Pose pose;
  int count = 0;
  std::array<Vec3, Most> at;  ///< m, the points c

  /// Of a tick at this pose.
  static Places of(const Pose& pose, const SeveralTick<Most>& tick) {
    Places places;
    places.pose = pose;
    for (const Tick& each : tick.each) {
      if (each.touches()) places.at[static_cast<std::size_t>(places.count++)] = each.body_point;
    }
    return places;
  }
  /// Whether a point is farther than `gap` (m) from all of them.
  [[nodiscard]] bool apart(const Vec3& point, double gap) const {
    for (int k = 0; k < count; ++k) {
      if (length(point - at[static_cast<std::size_t>(k)]) < gap) return false;
    }
    return true;
  }
};

/// Looks for another place where a tool touches.
template <std::uint32_t kFeatures = layout::feature_all>
class PlaceFinder {
public:
  PlaceFinder(const View& view, std::uint32_t tool) : view_(&view), tool_(tool), probe_(view.tools[tool].probe_radius) {
    const double contact = Tip(view, tool).contact(view.meta->depth_scale);
    gap_ = contact > 0 ? contact : view.meta->depth_scale;
  }

  /// m, between the points c of two contacts.
  [[nodiscard]] double gap() const { return gap_; }

  /// What is nearest of all that is apart from the places. Of what is nearer than `reach` (m, 0: overlaps) only what is
  /// another place counts: with a foot of its own, and beyond a hollow. Infinite clearance where there is nothing. Its
  /// `safe` is how far the tool may move before it may touch any of it, whether that counts or not.
  template <int Most>
  [[nodiscard]] Search look(const Places<Most>& places, double reach) const {
    Search search;
    search.pose = places.pose;
    search.touch.clearance = search.touch.safe = HUGE_VAL;
    const layout::ToolRecord& record = view_->tools[tool_];
    const bool mesh =
        record.kind == static_cast<std::uint32_t>(layout::ToolKind::mesh) && view_->tool_patches != nullptr;
    if ((kFeatures & layout::feature_tool_patches) != 0 && mesh) {
      for (std::uint32_t p = record.first_patch; p < record.first_patch + record.patch_count; ++p) {
        const auto& corner = view_->tool_patches[p].vertex;
        for (int i = 0; i < 3; ++i) {
          ToolPoint on_tool{p, {0, 0, 0}};
          on_tool.weights[i] = 1;
          try_anchor(places, reach, to_vec(view_->tool_vertices[corner[i]].point), on_tool, search.touch);
        }
      }
    } else {
      constexpr int kSamples = 9;
      const int samples = record.axis_length > 0 ? kSamples : 1;
      const double axis = record.axis_length, spacing = samples > 1 ? axis / (samples - 1) : 0;
      for (int i = 0; i < samples; ++i) try_anchor(places, reach, {0, 0, i * spacing}, {}, search.touch);
    }
    return search;
  }

private:
  /// Keeps an anchor's touch if it is nearer to the body than the one kept so far, and apart from all places.
  template <int Most>
  void try_anchor(const Places<Most>& places, double reach, const Vec3& anchor, const ToolPoint& on_tool,
                  ToolTouch& best) const {
    const Vec3 q = places.pose.apply(anchor);
    const auto apart = [&](const Vec3& point) { return places.apart(point, gap_); };
    Location found;
    if (!locate_where<kFeatures>(*view_, q, apart, found)) return;
    const double clearance = found.signed_distance - probe_;
    best.safe = std::fmin(best.safe, std::fmax(0, clearance));
    if (clearance >= best.clearance) return;
    if (clearance < reach) {
      // Its own foot close by, not the rim of a contact that is there nor the far side of a ridge; and a hollow
      // between.
      const Projection foot = project(*view_, found.at, q);
      const bool near = std::fabs(foot.height) <= 1.5 * std::fabs(found.signed_distance) + 0.1 * probe_;
      if (!foot.converged || !near || !apart(foot.point) || foot.height > probe_ + reach) return;
      for (int k = 0; k < places.count; ++k) {
        const Vec3 middle = 0.5 * (places.at[static_cast<std::size_t>(k)] + foot.point);
        if (locate<kFeatures>(*view_, middle).signed_distance < 0.05 * gap_) return;
      }
      found.at = foot.at;
      found.point = foot.point;
      found.signed_distance = foot.height;
    }
    best.anchor = anchor;
    best.tool_point = on_tool;
    best.body = found;
    best.clearance = clearance;
  }

  const View* view_;
  std::uint32_t tool_;
  double probe_, gap_;  ///< m
};

/// What a thread of its own saw of a tool that may touch at several places.
template <int Most>
struct SeveralSearch {
  Places<Most> asked;  ///< of which it looked for another
  Search first;        ///< what is nearest, as for a Contact
  Search more;         ///< another place; infinite clearance where there is none
};

/// For a thread that searches while another one makes forces (SeveralContacts::tick with a SeveralSearch). Of a tool
/// that is about to touch it says beforehand what it touches besides.
template <std::uint32_t kFeatures = layout::feature_all, int Most>
inline SeveralSearch<Most> search(const View& view, std::uint32_t tool, const Places<Most>& places) {
  const double reach = 0.5 * (view.tools[tool].probe_radius + view.meta->depth_scale);
  SeveralSearch<Most> result{places, search<kFeatures>(view, tool, places.pose), {}};
  const ToolTouch& nearest = result.first.touch;
  if (places.count == 0 && nearest.clearance < reach) result.asked.at[result.asked.count++] = nearest.body.point;
  result.more.pose = places.pose;
  result.more.touch.clearance = HUGE_VAL;
  if (result.asked.count == 0) return result;
  const Search found = PlaceFinder<kFeatures>(view, tool).look(result.asked, reach);
  if (found.touch.clearance < reach) result.more = found;
  return result;
}

/// One tool that may touch at up to `Most` places: tip and stem, or between two lobes. The first contact is Contact's.
/// Another begins, at zero force, where the tool overlaps the body beyond a hollow: the straight line from a contact
/// point to it is outside the body half way. As two points c come closer than `gap` the later one's share falls, to
/// nothing at half the gap, so that contacts merge without a step; what is stored falls and rises with it
/// (Contact::rescaled). Every tick takes bounded time and allocates nothing; a look for another place is nine searches
/// more (for a mesh tool three for every patch) and is made once the tool or c has moved by what is known to be free.
/// kFeatures as those of BasicContact.
template <int Most = 2, std::uint32_t kFeatures = layout::feature_all>
class SeveralContacts {
  static_assert(Most >= 2);

public:
  SeveralContacts(const View& view, std::uint32_t tool)
      : SeveralContacts(view, tool, std::make_index_sequence<Most>()) {}

  void reset() {
    for (BasicContact<kFeatures>& contact : contacts_) contact.reset();
    share_.fill(1);
    free_ = -1;
  }

  SeveralTick<Most> tick(const Pose& pose) { return tick(pose, nullptr); }

  /// The same with searches that are made elsewhere: search() of Places::of(pose, tick), which the force loop tells.
  /// No tick searches or looks. Another contact begins only while all that touch are where they were told, by half the
  /// gap at most.
  SeveralTick<Most> tick(const Pose& pose, const SeveralSearch<Most>& latest) { return tick(pose, &latest); }

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
    sum.each[0] = latest ? contacts_[0].tick(pose, latest->first) : contacts_[0].tick(pose);
    for (int k = 1; k < Most; ++k) {
      if (last_[k].touches()) sum.each[k] = contacts_[k].tick_found(pose, none(pose), latest ? &latest->more : nullptr);
    }
    if (sum.each[0].state == State::fault) {
      reset();
      last_ = sum.each;
      return sum;
    }
    // The first contact is the one that searches: where it was let go, another takes its place.
    for (int k = 1; k < Most && !sum.each[0].touches(); ++k) {
      if (!sum.each[k].touches()) continue;
      std::swap(contacts_[0], contacts_[k]);
      std::swap(sum.each[0], sum.each[k]);
      std::swap(share_[0], share_[k]);
      // It did not move there.
      looked_c_ = sum.each[0].body_point;
      before_ = motion(pose, sum.each[0]);
    }
    if (!sum.each[0].touches()) {
      share_.fill(1);
    } else if (latest) {
      take(pose, *latest, sum);
    } else {
      look(pose, sum);
    }
    for (int k = 0; k < Most; ++k) {
      if (sum.each[k].touches()) weigh(k, sum);
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

  /// Adds contact k with the share that its distance from those before it leaves.
  void weigh(int k, SeveralTick<Most>& sum) {
    const auto at = static_cast<std::size_t>(k);
    Tick& tick = sum.each[at];
    double share = 1;
    for (std::size_t j = 0; j < at; ++j) {
      if (!sum.each[j].touches()) continue;
      const double apart = length(tick.body_point - sum.each[j].body_point) / finder_.gap();
      share = std::fmin(share, std::fmax(0, 2 * apart - 1));
    }
    // The first keeps what it has when it was another before: its share comes back as the tool moves.
    share = std::fmin(share, share_[at] + grow_);
    if (k > 0 && !(share > 0)) {
      contacts_[at].reset();
      tick = {};
      return;
    }
    if (share != share_[at]) contacts_[at].rescaled(share_[at] > 0 ? share / share_[at] : HUGE_VAL);
    share_[at] = share;
    tick.force = share * tick.force;
    tick.torque = share * tick.torque;
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
  double grow_ = 0;                ///< most that a share rises in this tick
};

/// Several tools on one body (two instruments, five fingertips): each keeps its own contact and its own handle, and the
/// overlap says how far their forces can be trusted, which are those of each alone.
template <int Count, std::uint32_t kFeatures = layout::feature_all>
class SeveralTools {
public:
  /// `tools`: indices into the file's tools, which may repeat.
  SeveralTools(const View& view, const std::array<std::uint32_t, Count>& tools)
      : SeveralTools(view, tools, std::make_index_sequence<Count>()) {}

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
