// SPDX-License-Identifier: MIT
// One tool against the body: free, sticking, sliding, released; one force a tick.
#pragma once

#include "palpate/first_touch.hpp"
#include "palpate/hold.hpp"
#include "palpate/way_between.hpp"

#include <cmath>

namespace palpate::runtime {

/// Follows one tool. Every tick takes bounded time, allocates nothing and throws nothing. Not for several
/// threads at once; any number of contacts may share a view, which must outlive them and stay where it is (they keep
/// its address, as all that is made of a view does).
/// kFeatures (layout::Feature bits): what it can do; of what is left out it has neither code nor memory, and with a
/// file that holds it every tick is a fault. View::open<kFeatures> says so beforehand.
template <std::uint32_t kFeatures = layout::feature_all>
class BasicContact {
public:
  /// `tool`: an index below view.meta->tool_count; with any other every tick is a fault.
  BasicContact(const View& view, std::uint32_t tool)
      : view_(&view),
        tool_(tool),
        reach_(skeleton_radius<kFeatures>(view, tool)),
        probe_(view.tool(tool).probe_radius),
        hold_(view, tool) {}
  BasicContact(const View&&, std::uint32_t) = delete;  ///< of a temporary nothing would be left

  /// Forgets the contact. The next tick must be outside the body, else the contact starts at zero force, and what it is
  /// deep then is subtracted for as long as it lasts.
  void reset() {
    hold_.end();
    was_free_ = false;
    search_.touch.safe = -1;
  }

  /// Force at `pose`. Ticks are meant to follow a motion. From a free one to the next the tool counts as having gone
  /// straight: the contact begins where it first touched on that way (first_touch.hpp), also where it is beyond
  /// something thin by now. Where the searches at both ends leave a stretch of the way unseen, up to seven more look
  /// there, and four for the place where it came in: what overlaps the tool for an eighth of the way is found, as far
  /// as a search sees it. Missed may be what does so for less beside other stretches that are unseen, what the tool has
  /// left over an edge by the end, and the first of two. No stretch is looked at that is shorter than 0.1 % of the
  /// depth scale, or than 2 % before a body that the tool overlaps at the end. A tool that goes farther than size() was
  /// put elsewhere, and looks nowhere; nor does one that touches, or that let go or overlapped the body unfelt, as by
  /// an edge, a tick ago.
  Tick tick(const Pose& pose) {
    if (!fits() || !pose.valid()) return fault();
    if (const Vec3 q = hold_.rest().point(pose); keeps(q)) return keep(pose, q);
    return exists() ? seek(pose) : fault();
  }

  /// The same in a force loop whose searches are made elsewhere, at a lower rate: `latest` is the last that arrived.
  /// Beyond what that search knew to be free, the surface near its nearest point is looked at; a body met elsewhere is
  /// felt from the first search that sees it on, without force at first. No tick searches, so its bound has nothing to
  /// do with how large the body is: where c cannot follow the tool, it goes to where the search saw the body if p has
  /// not gone half a contact's size since. Nor does it look between ticks: what the tool passes in one is not felt.
  /// The search must be of the same view and tool: of one that is not (of the file before, perhaps) all that is noticed
  /// is a place which the file does not have, and that is a fault.
  Tick tick(const Pose& pose, const Search& latest) { return tick_found(pose, latest, &latest); }

  /// As tick(pose), with `found` instead of the search for a contact that it would make: for hosts that search within
  /// their ticks. `served`, if not null, is asked where c may go, else that is searched for.
  Tick tick_found(const Pose& pose, const Search& found, const Search* served = nullptr) {
    if (!fits() || !pose.valid() || !found.pose.valid()) return fault();
    if (const Vec3 q = hold_.rest().point(pose); keeps(q)) {
      return served && !has_triangle(*served) ? fault() : keep(pose, q, served);
    }
    if (!exists() || !knows(found)) return fault();
    search_ = found;
    return motion_since_search(pose) < search_.touch.safe ? free(pose) : meet(pose, false);
  }

  /// Whether the file has the place that a search names: on the body and, of a tool with patches, on the tool.
  [[nodiscard]] bool knows(const Search& search) const {
    return has_triangle(search) && (!detail::has_probes<kFeatures>(*view_, tool_) ||
                                    search.touch.tool_point.patch < view_->meta->tool_patch_count);
  }

  [[nodiscard]] const BasicField<kFeatures>& field() const { return hold_.rest().field(); }
  /// m, body frame, of a contact: what rests on the body sideways. Friction works where it goes on, while c may lag
  /// behind.
  [[nodiscard]] Vec3 anchor() const { return hold_.rest().anchor(); }
  /// m, of a contact: a tool that leaps farther in a tick was put elsewhere, and begins anew without force.
  [[nodiscard]] double size() const { return hold_.rest().size(); }

  /// J that the contact holds, and how much of it the hand did not give (energy.hpp): negative where it gave more.
  [[nodiscard]] double stored() const { return hold_.lasts() ? hold_.stored() : 0; }
  [[nodiscard]] double owed() const { return hold_.lasts() ? hold_.owed() : 0; }
  /// J that were kept from the hand for what was owed, since this contact (or the last) began. A tick that changes it
  /// is one in which the account acts.
  [[nodiscard]] double lost() const { return hold_.lost(); }

  /// For a host that multiplies forces: from now on by `ratio` (>= 0, infinite where the factor was 0) times what it
  /// was in the last tick. What is stored more by that is no work of the hand. With a factor of 0 stored() and owed()
  /// mean nothing. Where depth is lost for it, `tick`, which was the last, with this pose, becomes what is felt then.
  void rescaled(double ratio, const Pose& pose, Tick& tick) {
    if (hold_.lasts() && ratio > 0) hold_.rescaled(ratio, pose, tick);
  }

  /// For a host whose body changes its shape: what the tool did up to here was, in the body's frame, done at `by` times
  /// the poses that were told. The contact stays where it is on the body.
  void rebase(const Pose& by) {
    free_at_ = by * free_at_;
    if (hold_.lasts()) hold_.rebase(by);
  }

private:
  /// The file holds nothing that was left out; grasps are no matter of a contact.
  [[nodiscard]] bool fits() const {
    constexpr std::uint32_t kOfContacts = layout::feature_all & ~(layout::feature_grasp | layout::feature_turn);
    return (view_->features & kOfContacts & ~kFeatures) == 0;
  }
  /// Of a tool that the file does not have no contact begins, so one that lasts need not ask.
  [[nodiscard]] bool exists() const { return tool_ < view_->meta->tool_count; }

  /// All that a contact that lasts reads of a search.
  [[nodiscard]] bool has_triangle(const Search& search) const {
    return search.touch.body.at.triangle < view_->meta->triangle_count;
  }

  [[nodiscard]] bool keeps(const Vec3& q) {
    if (hold_.lasts() && hold_.jumped(q)) reset();
    return hold_.lasts();
  }

  Tick fault() {
    reset();
    Tick tick;
    tick.state = State::fault;
    return tick;
  }

  /// Out of line, for it is called in many places and copies a pose.
  [[gnu::noinline]] Tick free(const Pose& pose) {
    was_free_ = true;
    free_at_ = pose;
    return {};
  }

  Tick keep(const Pose& pose, const Vec3& q, const Search* served = nullptr) {
    Tick tick = hold_.tick(pose, q, served);
    if (!hold_.lasts()) let_go(pose);
    return tick;
  }

  void let_go(const Pose& pose) {
    was_free_ = hold_.left();
    free_at_ = pose;
    search_.touch.safe = -1;
  }

  Tick seek(const Pose& pose) {
    if (search_.touch.safe > 0 && motion_since_search(pose) < search_.touch.safe) return free(pose);
    const double clear = search_.touch.clearance - motion_since_search(free_at_);
    search_ = {pose, touch_at(pose)};
    if (was_free_ && clear >= 0 && touched_between(pose, clear)) return meet(pose, false);
    return search_.touch.clearance >= 0 ? free(pose) : meet(pose, was_free_);
  }

  [[nodiscard]] ToolTouch touch_at(const Pose& pose) const {
    constexpr double kStretched = 1.002;  // a rotation is taken that is orthonormal to 1e-3 only
    const ToolTouch& last = search_.touch;
    // No point of the skeleton has moved as far as the body was from it.
    const bool outside = last.safe > 0 && motion_since_search(pose) < probe_ + last.clearance;
    return outside ? find_touch_ahead<kFeatures>(*view_, tool_, pose, last.body.at, probe_ + kStretched * reach_)
                   : find_touch<kFeatures>(*view_, tool_, pose, last.body.at);
  }

  /// Begins a contact where the last search saw the body, if the tool overlaps it there. `clear`: a tick ago it did so
  /// nowhere.
  Tick meet(const Pose& pose, bool clear) {
    const Vec3 q = pose.apply(search_.touch.anchor);
    const double size = hold_.rest().size();
    const bool seen = search_.touch.clearance < 0 && motion_since_search(pose) < 0.5 * size;
    const Projection found = seen ? first_point(search_.touch, q) : project(*view_, search_.touch.body.at, q);
    const double depth = depth_under(found, q);
    // Of what has not been seen the surface near an old point says something as far as it reaches.
    if (!seen && (!found.converged || depth > 0.5 * size)) {
      was_free_ = false;
      return {};
    }
    if (!(depth > 0)) return free(pose);
    FirstTouch first{found, q, depth};
    // Farther it did not move, it was put elsewhere.
    if (const Vec3 from = free_at_.apply(search_.touch.anchor); was_free_ && length(q - from) <= size) {
      first = first_touch(*view_, found, depth, probe_, from, q);
      // The tool was clear of all, yet not of the surface that is nearest now: it came in by another, past the middle
      // of something thin.
      if (first.late && clear) {
        look_between(pose, skeleton_motion(free_at_, pose, reach_), {0, 0, 1, 1});
        return meet(pose, false);
      }
    }
    Tick tick = hold_.begin(search_.touch, first, pose);
    if (!hold_.lasts()) let_go(pose);
    return tick;
  }

  /// The tool was free a tick ago, with nothing of the body within `clear` (m). Sets the search to where it first
  /// touched on the way from there, if that is a place which neither end knows of and where it still pushes.
  [[gnu::noinline]] bool touched_between(const Pose& pose, double clear) {
    // A tool that overlaps the body at its pose has done so for as long a way as it is deep. Seen askew a stretch is
    // left, with nothing on it mostly; of one that leaves the body askew ever shorter ones where it began.
    constexpr double kShallow = 0.02, kThin = 1e-3;  // of the depth scale
    const double way = skeleton_motion(free_at_, pose, reach_), known = std::fabs(search_.touch.clearance);
    const double least = (search_.touch.clearance < 0 ? kShallow : kThin) * view_->meta->depth_scale;
    // Farther it did not move, it was put elsewhere.
    if (!(way - clear - known > least) || way > hold_.rest().size()) return false;
    Unseen<kLooks> unseen(clear / way, known / way);
    for (int i = 0; i < kLooks; ++i) {
      Stretch stretch = unseen.longest();
      if (!((stretch.high - stretch.low) * way > least)) break;
      const double middle = 0.5 * (stretch.low + stretch.high);
      const ToolTouch touch = touch_between(pose, middle);
      if (touch.clearance >= 0) {
        unseen.add(stretch, middle, touch.clearance / way);
        continue;
      }
      const ToolTouch there = search_.touch;
      const Pose before = free_at_;
      search_.touch = touch;
      stretch.high = middle;
      look_between(pose, way, stretch);
      if (still_in(pose.apply(search_.touch.anchor))) return true;
      search_.touch = there;
      free_at_ = before;
      return false;
    }
    return false;
  }

  /// Looks for the place where the tool came in on its way (m): in a stretch at whose end it overlaps the body.
  [[gnu::noinline]] void look_between(const Pose& pose, double way, Stretch stretch) {
    constexpr int kNarrower = 4;
    for (int i = 0; i < kNarrower; ++i) {
      const double middle = 0.5 * (std::fmin(stretch.low, stretch.high) + stretch.high);
      const ToolTouch touch = touch_between(pose, middle);
      if (touch.clearance < 0) {
        search_.touch = touch;
        stretch.high = middle;
      } else {
        stretch.free = middle;
        stretch.low = middle + (way > 0 ? touch.clearance / way : 0);
      }
    }
    free_at_ = between(free_at_, pose, stretch.free);
  }

  [[nodiscard]] ToolTouch touch_between(const Pose& pose, double share) const {
    return find_touch<kFeatures>(*view_, tool_, between(free_at_, pose, share), search_.touch.body.at);
  }

  /// Most that any skeleton point can have moved since the last search.
  [[nodiscard]] double motion_since_search(const Pose& pose) const {
    return skeleton_motion(search_.pose, pose, reach_);
  }

  /// Where the search saw the body a tool pushes that is at q by now. Where c may have followed it over an edge it has
  /// left the body, though not the plane of that place.
  [[nodiscard]] bool still_in(const Vec3& q) const {
    const Projection foot = project(*view_, search_.touch.body.at, q);
    return depth_under(first_point(search_.touch, q), q) > 0 && !(foot.converged && depth_under(foot, q) <= 0);
  }

  /// m, of the skin about q under the plane of a point of the surface.
  [[nodiscard]] double depth_under(const Projection& found, const Vec3& q) const {
    return probe_ - dot(q - found.point, found.normal);
  }

  /// Where the smooth normals meet the tool: there the first deflection is purely along n(c). The nearest
  /// point where they do not meet it close by.
  [[nodiscard]] Projection first_point(const ToolTouch& touch, const Vec3& q) const {
    Projection found = project(*view_, touch.body.at, q);
    const double reach = std::fabs(touch.body.signed_distance);
    const bool near = std::fabs(found.height) <= 1.5 * reach + 0.1 * probe_;
    if (found.converged && near) return found;
    found.at = touch.body.at;
    found.point = touch.body.point;
    found.normal = normal(*view_, found.at);
    return found;
  }

  static constexpr int kLooks = 7;  // no stretch of an eighth of the way stays unseen

  const View* view_;
  std::uint32_t tool_;
  double reach_, probe_;  ///< m

  bool was_free_ = false;  ///< the last tick saw no overlap
  Pose free_at_;           ///< the tool then
  Search search_;          ///< the last one; free until the tool has moved by touch.safe from its pose
  BasicHold<kFeatures> hold_;
};

using Contact = BasicContact<>;

}  // namespace palpate::runtime
