// SPDX-License-Identifier: MIT
// Contact with a body whose shape a host changes while it is felt: a heart that beats.
#pragma once

#include "palpate/latest.hpp"
#include "palpate/moving.hpp"
#include "palpate/shape.hpp"

#include <cmath>
#include <cstddef>
#include <new>

namespace palpate::runtime {

/// A body whose sites are where a host's thread puts them, at a rate of its own (60 Hz), while one force loop follows
/// at its own: neither ever waits. Between two shapes the surface moves evenly, so it lags the newest by that shape's
/// seconds. A shape that comes early waits for the one before, and the newest of several is taken; while none comes the
/// surface stands. Over memory of the caller, which must outlive it, as must the view. Not copied.
class AnimatedSurface {
public:
  /// Of memory that it needs, aligned as by new.
  static std::size_t bytes(const View& view) { return Layout(view).end; }

  AnimatedSurface(const View& view, void* memory)
      : view_(&view),
        memory_(static_cast<unsigned char*>(memory)),
        maker_(view, place<std::uint32_t>(Layout(view).owners, view.meta->vertex_count),
               place<ShapeMaker::Work>(Layout(view).work, view.meta->site_count)) {
    const Layout at(view);
    for (int i = 0; i < kSlots; ++i) {
      const std::size_t slot = at.slots + static_cast<std::size_t>(i) * at.slot;
      arrays_[i].turns = place<Quaternion>(slot, view.meta->site_count);
      arrays_[i].nodes = place<layout::SearchNode>(slot + at.nodes, view.meta->search_nodes);
      arrays_[i].vertices = place<layout::Point>(slot + at.vertices, view.meta->vertex_count);
      shapes_[i].view = view;  // as baked until it is written
      shapes_[i].turns = arrays_[i].turns;
      shapes_[i].seconds = 1;
    }
  }
  AnimatedSurface(const View&&, void*) = delete;
  AnimatedSurface(const AnimatedSurface&) = delete;
  AnimatedSurface& operator=(const AnimatedSurface&) = delete;

  /// By the host's thread alone: the sites' positions (m, the body's frame), in the order of the file, to be reached
  /// `seconds` ((0, 10]) after the shape before. They may be anywhere and turned in any way, but every patch must be
  /// between half as long and 1.75 times as long in every direction as it was baked, and the body not inside out; what
  /// crosses itself is not noticed. One that is refused changes nothing: the last good shape stays.
  ShapeResult set(const Vec3* positions, std::uint32_t count, double seconds) {
    ShapeResult result;
    detail::Fault fault(result.error, sizeof result.error);
    if (count != view_->meta->site_count) {
      fault.say("% positions for % sites", count, view_->meta->site_count);
      return result;
    }
    if (!(seconds > 0 && seconds <= 10)) {
      fault.say("seconds are not in (0, 10]");
      return result;
    }
    const std::uint8_t slot = exchange_.writing();
    const Shape& before = shapes_[newest_];
    const Arrays& arrays = arrays_[slot];
    result = maker_.make(positions, before.turns, arrays.turns, arrays.vertices, arrays.nodes);
    if (!result) return result;
    double most = 0;
    for (std::uint32_t i = 0; i < view_->meta->vertex_count; ++i) {
      const Vec3 way = to_vec(arrays.vertices[i].xyz) - vertex(before.view, i);
      most = std::fmax(most, dot(way, way));
    }
    shapes_[slot].view.vertices = arrays.vertices;
    if (view_->search != nullptr) shapes_[slot].view.search = arrays.nodes;
    shapes_[slot].seconds = seconds;
    shapes_[slot].travel = before.travel + std::sqrt(most);
    newest_ = slot;
    exchange_.publish();
    return result;
  }

  /// By the force loop alone, once before the ticks of its contacts: `seconds` have gone by.
  void advance(double seconds) {
    if (!(seconds > 0)) return;
    const double left = (1 - share_) * to().seconds;
    if (seconds < left) {
      share_ += seconds / to().seconds;
      return;
    }
    share_ = 1;
    std::uint8_t slot = from_;
    if (!exchange_.take(slot)) return;
    from_ = to_;
    to_ = slot;
    ++number_;
    share_ = std::fmin(1, (seconds - left) / to().seconds);
  }

  /// For the force loop: the two shapes between which the surface is, what share of the way it has gone, and how many
  /// shapes it has taken.
  [[nodiscard]] const Shape& from() const { return shapes_[from_]; }
  [[nodiscard]] const Shape& to() const { return shapes_[to_]; }
  [[nodiscard]] double share() const { return share_; }
  [[nodiscard]] std::uint64_t number() const { return number_; }
  /// m, that no point can have gone beyond since it was baked.
  [[nodiscard]] double travel() const { return from().travel + share_ * (to().travel - from().travel); }
  /// The body as it was baked.
  [[nodiscard]] const View& baked() const { return *view_; }

private:
  static constexpr int kSlots = 4;  // the host's, one between, and the two that the force loop is between

  struct Arrays {
    Quaternion* turns;
    layout::SearchNode* nodes;
    layout::Point* vertices;
  };

  /// Bytes from the start of the memory, and of a slot from its own; what needs most alignment comes first.
  struct Layout {
    std::size_t work = 0, slots, slot, nodes, vertices, owners, end;
    explicit Layout(const View& view) {
      const std::size_t sites = view.meta->site_count, points = view.meta->vertex_count;
      slots = sites * sizeof(ShapeMaker::Work);
      nodes = sites * sizeof(Quaternion);
      vertices = nodes + view.meta->search_nodes * sizeof(layout::SearchNode);
      slot = (vertices + points * sizeof(layout::Point) + 7) / 8 * 8;
      owners = slots + kSlots * slot;
      end = owners + points * sizeof(std::uint32_t);
    }
  };

  template <class T>
  T* place(std::size_t offset, std::uint32_t count) {
    T* first = reinterpret_cast<T*>(memory_ + offset);
    for (std::uint32_t i = 0; i < count; ++i) new (first + i) T{};
    return first;
  }

  const View* view_;
  unsigned char* memory_;
  ShapeMaker maker_;
  Arrays arrays_[kSlots];
  Shape shapes_[kSlots];
  std::uint8_t newest_ = 1;  // of the host's thread
  Exchange exchange_{0, 1};
  std::uint8_t from_ = 2, to_ = 3;  // of the force loop's
  double share_ = 1;
  std::uint64_t number_ = 0;
};

/// How the surface near one of its points has moved since it was baked: as a rigid body, to first order, in both shapes
/// between which it is.
class LocalMotion {
public:
  LocalMotion() = default;
  LocalMotion(const AnimatedSurface& surface, const BodyPoint& at)
      : baked_(position(surface.baked(), at)),
        from_(position(surface.from().view, at)),
        to_(position(surface.to().view, at)),
        turned_from_(turn(surface.from(), at)),
        turned_to_(turn(surface.to(), at)) {}

  /// From the body's frame as baked to where the surface is after a share of the way.
  [[nodiscard]] Pose at(double share) const {
    Pose body = to_pose(mixed(turned_from_, turned_to_, share), {});
    body.translation = (1 - share) * from_ + share * to_ - body.rotate(baked_);
    return body;
  }

private:
  Vec3 baked_, from_, to_;  ///< m
  Quaternion turned_from_, turned_to_;
};

/// A Contact with a body that is animated. The contact is one with the body as it was baked, moved rigidly to where the
/// surface now is at c: so distance, normal and frame are those of the present surface, and the force is as continuous
/// as the motions of tool and surface are. As the tool slides, c goes on to its foot on the present surface.
/// Responses are those that were baked for the place on the body: what stretching, a changed wall or the animation's
/// own muscle does to stiffness is not felt, nor inertia. The energy account is that of the motion of the tool against
/// the surface, so a surface that presses itself on a tool at rest does the work.
/// It searches for itself, the present surface, once tool and surface have moved by what was free. There is no tick
/// with a Search of another thread's: that thread would have to keep a shape from being written anew while it looks, so
/// every shape would need another slot, and say how far the surface has come since. kFeatures as those of BasicContact.
/// The surface must outlive it.
template <std::uint32_t kFeatures = layout::feature_all>
class BasicAnimatedContact {
public:
  BasicAnimatedContact(const AnimatedSurface& surface, std::uint32_t tool)
      : surface_(&surface),
        tool_(tool),
        reach_(skeleton_radius<kFeatures>(surface.baked(), tool)),
        motion_(surface, {}),
        contact_(surface.baked(), tool) {}
  BasicAnimatedContact(const AnimatedSurface&&, std::uint32_t) = delete;

  void reset() {
    contact_.reset();
    touches_ = false;
    safe_ = -1;
  }

  /// After the surface was advanced, at a pose of the tool in the frame of the surface's positions; so are all vectors
  /// of the tick.
  Tick tick(const Pose& tool) {
    if (!tool.valid()) {
      reset();
      return contact_.tick(tool);
    }
    follow_surface();
    if (!touches_) look(tool);
    share_ = surface_->share();
    const Pose body = frame();
    search_.pose = inverse(body) * tool;
    Tick tick = contact_.tick_found(search_.pose, search_);
    const bool touched = touches_;
    touches_ = tick.touches();
    if (touched && !touches_) safe_ = -1;
    if (!touches_) return tick;
    const Vec3 c = tick.body_point;
    tick = carried(body, tick);
    go_to(tick.at);
    tick.body_point = frame().apply(c);
    // Should the tool be put elsewhere, there is no search yet that says what is there.
    search_.touch.body.at = tick.at;
    search_.touch.clearance = HUGE_VAL;
    search_.touch.safe = 0;
    return tick;
  }

  /// Where the body as baked would lie if all of it had moved as the surface at c has.
  [[nodiscard]] Pose frame() const { return motion_.at(share_); }
  /// How the surface at c has moved since the last tick, before the next one: a virtual coupling goes along.
  [[nodiscard]] Pose moved() const {
    const bool same = number_ == surface_->number();
    return (same ? motion_ : LocalMotion(*surface_, at_)).at(surface_->share()) * inverse(frame());
  }
  /// m, BasicContact::size().
  [[nodiscard]] double size() const { return contact_.size(); }
  /// Its tool is that of the last tick in frame().
  [[nodiscard]] const BasicContact<kFeatures>& contact() const { return contact_; }

private:
  void follow_surface() {
    if (number_ == surface_->number()) return;
    number_ = surface_->number();
    motion_ = LocalMotion(*surface_, at_);
    share_ = 0;
  }

  /// The motion is that of another point from now on: what the tool did before is told anew.
  void go_to(const BodyPoint& at) {
    if (at.triangle == at_.triangle && at.bary[0] == at_.bary[0] && at.bary[1] == at_.bary[1] &&
        at.bary[2] == at_.bary[2]) {
      return;
    }
    const Pose before = frame();
    at_ = at;
    motion_ = LocalMotion(*surface_, at);
    contact_.rebase(inverse(frame()) * before);
  }

  /// Searches the present surface, where the tool and the surface have moved by what was known to be free.
  void look(const Pose& tool) {
    const double moved = skeleton_motion(looked_, tool, reach_) + surface_->travel() - travelled_;
    if (!(moved < safe_)) {
      looked_ = tool;
      travelled_ = surface_->travel();
      const double share = surface_->share();
      const Shape& to = surface_->to();
      search_.touch = find_touch<kFeatures>(to.view, tool_, tool, at_);
      // The surface is on its way to that shape, nowhere further from it than the rest of the way.
      safe_ = search_.touch.safe - (1 - share) * (to.travel - surface_->from().travel);
      go_to(search_.touch.body.at);
      if (!(safe_ > 0) && share < 1) {
        search_.touch = find_touch<kFeatures>(to.view, tool_, motion_.at(1) * inverse(motion_.at(share)) * tool, at_);
        go_to(search_.touch.body.at);
      }
      search_.touch.body.point = position(surface_->baked(), at_);
      // A contact will begin at the foot, so that is whose motion counts.
      for (int i = 0; i < kSettles && search_.touch.clearance < 0; ++i) {
        const Vec3 q = (inverse(motion_.at(share)) * tool).apply(search_.touch.anchor);
        const Projection foot = project(surface_->baked(), at_, q);
        if (!foot.converged) break;
        go_to(foot.at);
      }
      search_.touch.safe = search_.touch.clearance < 0 ? 0 : HUGE_VAL;
    }
  }

  static constexpr int kSettles = 4;  // of a foot on a surface whose motion is that at the foot

  const AnimatedSurface* surface_;
  std::uint32_t tool_;
  double reach_;  ///< m

  std::uint64_t number_ = 0;
  BodyPoint at_;        ///< whose motion the body has: c, or where a contact is looked for
  LocalMotion motion_;  ///< of it
  double share_ = 1;    ///< of the last tick
  Pose looked_;
  double safe_ = -1, travelled_ = 0;  ///< m, free since looked_; the surface's travel then
  bool touches_ = false;
  Search search_;
  BasicContact<kFeatures> contact_;
};

using AnimatedContact = BasicAnimatedContact<>;

}  // namespace palpate::runtime
