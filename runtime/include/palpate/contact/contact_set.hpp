// SPDX-License-Identifier: MIT
// One tool that touches at several places: a contact for each wall, begun when it was first touched.
#pragma once

#include "palpate/contact/contact.hpp"

#include <array>
#include <cmath>
#include <utility>

namespace palpate::runtime {

/// Constants of the contacts of one tool. `gap`: a contact's size, from which on two feet lie on two walls.
struct ContactSetConstants {
  /// Times gap: two feet nearer than this are on one wall, and the later contact's share of the force is 0. The share
  /// grows evenly to 1 at gap.
  static constexpr double kMerged = 0.5;
  /// Times the tool's travel over gap: most that a share changes by in a tick. Two feet that each go as far as the tool
  /// change it by this.
  static constexpr double kFade = 2 / (1 - kMerged);
  /// Times gap: distance from the skin within which another wall is looked for. The tool goes this far before the next
  /// search where none is nearer.
  static constexpr double kReach = 0.25;
  /// Steps of the tool's point down to a local minimum of the distance.
  static constexpr int kSteps = 8;
  /// Times the tool's extent: a shorter step ends the way to the minimum.
  static constexpr double kRest = 1e-3;
};

/// Places of the contacts of a tool, for a search for another wall.
template <int Most>
struct WallSearchRequest {
  Pose pose;  ///< of the tool, body frame
  int count = 0;
  std::array<Vec3, Most> feet;  ///< m
  double gap = 0;               ///< m, a point that is this far from all feet lies on another wall
  double reach = 0;             ///< m, from the skin, within which another wall is looked for

  /// Whether a point of the body (m) lies on another wall than the feet.
  [[nodiscard]] bool apart(const Vec3& point) const {
    for (int k = 0; k < count; ++k) {
      if (length(point - feet[static_cast<std::size_t>(k)]) < gap) return false;
    }
    return true;
  }
};

/// Result of a search thread for a tool that may touch several walls.
template <int Most>
struct SetSearch {
  Search first;  ///< as for one contact
  Search more{{}, {{}, {}, HUGE_VAL, 0}};  ///< another wall; infinite clearance where there is none
};

namespace detail {

/// The wall nearest to a tool among those that no foot lies on: a local minimum of the distance that is at least
/// request.gap away from all feet. Its clearance is infinite where none is nearer than request.reach to the skin.
template <std::uint32_t kFeatures, int Most>
PALPATE_NOINLINE inline ToolTouch find_wall(const View& surface, const ToolShape<kFeatures>& shape,
                                            const WallSearchRequest<Most>& request) {
  const auto apart = [&](const Vec3& point) { return request.apart(point); };
  ToolTouch best;
  best.clearance = HUGE_VAL;
  shape.for_each_sample([&](const CorePoint& core) {
    const Vec3 q = request.pose.apply(core.point);
    Location found;
    // The best clearance so far bounds nothing: a core point inside the body is the better the farther the surface is.
    if (!closest_point_where<kFeatures>(surface, q, apart, shape.skin() + request.reach, found)) return;
    // This is a foot's wall if the distance falls on towards that foot, over the body or over the tool.
    CorePoint at = core;
    found = local_closest_point(surface, found.at, q);
    for (int step = 0; step < ContactSetConstants::kSteps && found.signed_distance > 0; ++step) {
      const CorePoint next = shape.advance(at, request.pose, found, smooth_normal(surface, found.at), shape.extent());
      if (!(length(next.point - at.point) > ContactSetConstants::kRest * shape.extent())) break;
      at = next;
      found = local_closest_point(surface, found.at, request.pose.apply(at.point));
    }
    if (!apart(found.point) || !(found.signed_distance - shape.skin() < best.clearance)) return;
    best.core = at;
    best.body = found;
    best.clearance = found.signed_distance - shape.skin();
  });
  return best;
}

}  // namespace detail

/// A body of which one contact feels a share: a factor more on the stiffness.
template <class Body>
struct SharedBody {
  const Body* body;
  double share;  ///< [0, 1]
  double step;   ///< most that the share may change by in a tick

  [[nodiscard]] bool valid() const { return body->valid(); }
  [[nodiscard]] auto frame(const BodyPoint& at) const { return body->frame(at); }
  [[nodiscard]] const View& surface() const { return body->surface(); }
  [[nodiscard]] auto surface_frame() const { return body->surface_frame(); }
  [[nodiscard]] double travel() const { return body->travel(); }
  [[nodiscard]] double factor(const BodyPoint& at) const { return share * body->factor(at); }
  [[nodiscard]] double factor_step() const { return smaller(step, body->factor_step()); }
};

/// One tool that may touch up to `Most` walls: between two lobes, in a fold, by tip and stem. Ticks as a contact does;
/// force and torque are the sums. The first contact follows the nearest wall; every other wall that the skin overlaps
/// gets a contact of its own, begun when it was first touched. Contacts whose feet come nearer than a contact's size
/// fade into the earlier one, the later one's share falling to nothing at half of that distance.
template <int Most = 3, std::uint32_t kFeatures = layout::feature_all>
class ContactSet {
  static_assert(Most >= 2, "one wall is what BasicContact follows");

public:
  /// As BasicContact: the view must outlive the set; a tool that the file does not have makes every tick a fault.
  ContactSet(const View& view, std::uint32_t tool) : ContactSet(view, tool, std::make_index_sequence<Most>()) {}
  ContactSet(const View&&, std::uint32_t) = delete;

  void reset() {
    for (BasicContact<kFeatures>& contact : contacts_) contact.reset();
    for (Tick& tick : ticks_) tick = Tick{};
    clear_ = -1;
  }

  Tick tick(const Pose& tool) { return tick(tool, StillBody{&contacts_[0].view()}); }
  Tick tick(const Pose& tool, const SetSearch<Most>& latest) {
    return tick(tool, StillBody{&contacts_[0].view()}, &latest);
  }

  /// Returns the sums of all contacts: force, torque and friction limit are added; depth, counted depth and filled
  /// share are the largest; `extrapolated` holds where any contact's does. State, normal and points are those of the
  /// first contact. A fault of one contact is a fault of the set, and all contacts are forgotten. `body`, `latest`: as
  /// for BasicContact::tick.
  template <class Body>
  Tick tick(const Pose& tool, const Body& body, const SetSearch<Most>* latest = nullptr) {
    const Pose here = in_body(tool, body.frame(ticks_[0].at));
    const double moved = travel(last_, here, contacts_[0].shape().extent());
    const Search* const first = latest != nullptr ? &latest->first : nullptr;
    const double fade = ContactSetConstants::kFade * moved / gap();
    // One contact alone follows the nearest wall; each of several keeps to its own.
    int touching = 0;
    for (const Tick& tick : ticks_) touching += tick.touches();
    for (BasicContact<kFeatures>& contact : contacts_) contact.keep_to_wall(touching > 1);
    ticks_[0] = contacts_[0].tick(tool, SharedBody<Body>{&body, 1, fade}, first);
    if (ticks_[0].state == State::fault) return fail(ticks_[0].fault);
    if (latest != nullptr && !contacts_[0].valid(latest->more)) return fail(Fault::bad_search);
    for (std::size_t k = 1; k < Most; ++k) {
      if (!ticks_[k].touches()) continue;
      const double share = larger(0, share_of(k));
      if (share == 0 && contacts_[k].state().factor == 0) {
        contacts_[k].reset();
        ticks_[k] = Tick{};
        continue;
      }
      const SharedBody<Body> shared{&body, share, fade};
      ticks_[k] = contacts_[k].tick(tool, shared, latest != nullptr ? &latest->more : nullptr);
      if (ticks_[k].state == State::fault) return fail(ticks_[k].fault);
    }
    lead();
    if (ticks_[0].touches()) look(tool, body, latest);
    last_ = here;
    return sum();
  }

  /// Each contact's own tick; without contact where it does not touch.
  [[nodiscard]] const std::array<Tick, Most>& each() const { return ticks_; }
  [[nodiscard]] const BasicContact<kFeatures>& contact(int k) const { return contacts_[static_cast<std::size_t>(k)]; }
  /// m, BasicContact::size().
  [[nodiscard]] double size(double depth) const { return contacts_[0].size(depth); }
  [[nodiscard]] const View& view() const { return contacts_[0].view(); }

  /// Returns the places of the contacts, for a search in another thread. `tool_in_body`: pose of the tool in the frame
  /// of the body as baked.
  [[nodiscard]] WallSearchRequest<Most> request(const Pose& tool_in_body) const {
    WallSearchRequest<Most> request;
    request.pose = tool_in_body;
    request.gap = gap();
    request.reach = ContactSetConstants::kReach * request.gap;
    for (std::size_t k = 0; k < Most; ++k) {
      if (ticks_[k].touches()) {
        request.feet[static_cast<std::size_t>(request.count++)] = contacts_[k].state().place.foot.point;
      }
    }
    return request;
  }

private:
  template <std::size_t... K>
  ContactSet(const View& view, std::uint32_t tool, std::index_sequence<K...>)
      : contacts_{((void)K, BasicContact<kFeatures>(view, tool))...} {}

  Tick fail(Fault fault) {
    reset();
    Tick tick;
    tick.state = State::fault;
    tick.fault = fault;
    return tick;
  }

  /// m, from which on two feet lie on two walls.
  [[nodiscard]] double gap() const { return contacts_[0].size(contacts_[0].state().indentation); }

  [[nodiscard]] double share_of(std::size_t k) const {
    double share = 1;
    for (std::size_t j = 0; j < k; ++j) {
      if (!ticks_[j].touches()) continue;
      const double apart =
          length(contacts_[k].state().place.foot.point - contacts_[j].state().place.foot.point) / gap();
      share = smaller(share, (apart - ContactSetConstants::kMerged) / (1 - ContactSetConstants::kMerged));
    }
    return share;
  }

  /// The first contact searches. Another takes its place where it ended, and where both lie on one wall and the other
  /// holds more energy.
  void lead() {
    for (std::size_t k = 1; k < Most; ++k) {
      if (!ticks_[k].touches()) continue;
      const bool ended = !ticks_[0].touches();
      const ContactState &first = contacts_[0].state(), &other = contacts_[k].state();
      const bool merged =
          length(first.place.foot.point - other.place.foot.point) < ContactSetConstants::kMerged * gap();
      if (!ended && !(merged && other.energy.energy() > first.energy.energy())) continue;
      std::swap(contacts_[0], contacts_[k]);
      std::swap(ticks_[0], ticks_[k]);
      if (ended) return;
    }
  }

  /// Begins a contact on another wall that the skin overlaps.
  template <class Body>
  void look(const Pose& tool, const Body& body, const SetSearch<Most>* latest) {
    std::size_t spare = 1;
    while (spare < Most && ticks_[spare].touches()) ++spare;
    if (spare == Most) return;
    const Pose in_frame = in_body(tool, body.frame(ticks_[0].at));
    const View& view = contacts_[0].view();
    const ToolShape<kFeatures>& shape = contacts_[0].shape();
    ToolTouch wall;
    if (latest != nullptr) {
      if (!(latest->more.touch.clearance < HUGE_VAL)) return;
      // Tool and contacts have moved since the search.
      wall = local_touch(view, shape, latest->more, in_frame, latest->more.touch.body.at);
      if (!request(in_frame).apart(wall.body.point)) return;
    } else {
      if (travel(looked_, in_frame, shape.extent()) < clear_) return;
      looked_ = in_frame;
      const WallSearchRequest<Most> known = request(in_frame);
      wall = detail::find_wall(view, shape, known);
      clear_ = smaller(known.reach, larger(0, wall.clearance));
    }
    if (!(wall.clearance <= 0)) return;
    contacts_[spare].keep_to_wall(true);
    contacts_[spare].begin(wall, body.frame(ticks_[0].at) * last_, body);
    const SharedBody<Body> whole{&body, 1, 0};
    ticks_[spare] = contacts_[spare].tick(tool, whole, latest != nullptr ? &latest->more : nullptr);
  }

  [[nodiscard]] Tick sum() const {
    Tick all = ticks_[0];
    for (std::size_t k = 1; k < Most; ++k) {
      const Tick& tick = ticks_[k];
      if (!tick.touches()) continue;
      all.force = all.force + tick.force;
      all.torque = all.torque + tick.torque;
      all.friction_limit += tick.friction_limit;
      all.depth = larger(all.depth, tick.depth);
      all.counted_depth = larger(all.counted_depth, tick.counted_depth);
      all.filled_share = larger(all.filled_share, tick.filled_share);
      all.extrapolated = all.extrapolated || tick.extrapolated;
    }
    return all;
  }

  std::array<BasicContact<kFeatures>, Most> contacts_;
  std::array<Tick, Most> ticks_;
  Pose last_, looked_;  ///< of the tool, in the frame of the body near the first contact
  double clear_ = -1;   ///< m, the tool may go from looked_ before another wall can overlap
};

/// Returns the place nearest to the body, as search() for one contact does, and the nearest wall within request.reach
/// of the skin that no foot of the request lies on. `view`: the body as baked. `tool`: an index below
/// view.meta->tool_count. `request`: of ContactSet::request(). Without contacts the other wall is one beside the
/// nearest place. For any thread: it reads the view alone.
template <std::uint32_t kFeatures = layout::feature_all, int Most>
inline SetSearch<Most> search(const View& view, std::uint32_t tool, const WallSearchRequest<Most>& request) {
  SetSearch<Most> result;
  result.first = search<kFeatures>(view, tool, request.pose);
  result.more.pose = request.pose;
  WallSearchRequest<Most> known = request;
  if (known.count == 0) known.feet[static_cast<std::size_t>(known.count++)] = result.first.touch.body.point;
  result.more.touch = detail::find_wall(view, ToolShape<kFeatures>(view, tool), known);
  return result;
}

}  // namespace palpate::runtime
