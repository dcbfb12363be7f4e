// SPDX-License-Identifier: MIT
// A body whose shape a host changes while it is felt: a heart that beats.
#pragma once

#include "palpate/body/body.hpp"
#include "palpate/body/skinned_pose.hpp"
#include "palpate/threading/triple_buffer.hpp"

#include <cmath>
#include <cstddef>
#include <new>

namespace palpate::runtime {

/// A surface whose sites a host's thread places at a rate of its own (60 Hz), while one force loop follows at its own;
/// neither waits. Between two shapes the surface moves evenly, so it is one shape late. A shape that comes early waits
/// for the one before; of several the newest is used; without a new one the surface rests. Memory and view are the
/// caller's and must outlive it. Not copyable.
class DeformingSurface {
public:
  /// Bytes of memory that it needs, aligned as by new.
  static std::size_t bytes(const View& view) { return Layout(view).end; }

  DeformingSurface(const View& view, void* memory)
      : view_(&view),
        memory_(static_cast<unsigned char*>(memory)),
        maker_(view, place<std::uint32_t>(Layout(view).owners, view.meta->vertex_count),
               place<SkinnedPoseMaker::Work>(Layout(view).work, view.meta->site_count)) {
    const Layout at(view);
    for (int i = 0; i < kSlots; ++i) {
      const std::size_t slot = at.slots + static_cast<std::size_t>(i) * at.slot;
      arrays_[i].rotations = place<Quaternion>(slot, view.meta->site_count);
      arrays_[i].nodes = place<layout::SearchNode>(slot + at.nodes, view.meta->search_nodes);
      arrays_[i].vertices = place<layout::Point>(slot + at.vertices, view.meta->vertex_count);
      shapes_[i].view = view;  // as baked until the first shape
      shapes_[i].rotations = arrays_[i].rotations;
      shapes_[i].seconds = 1;
    }
  }
  DeformingSurface(const View&&, void*) = delete;
  DeformingSurface(const DeformingSurface&) = delete;
  DeformingSurface& operator=(const DeformingSurface&) = delete;

  /// Sets the sites' positions (m, the body's frame, in the file's order), to be reached `seconds` ((0, 10]) after the
  /// shape before. Every patch must be stretched between 0.5 and 1.75 times in every direction, and the body must not
  /// be inside out; a surface that crosses itself is not detected. A shape that is refused changes nothing. For the
  /// host's thread alone.
  ShapeResult set(const Vec3* positions, std::uint32_t count, double seconds) {
    ShapeResult result;
    detail::Fault fault(result.error, sizeof result.error);
    if (count != view_->meta->site_count) {
      fault.fail("% positions for % sites", count, view_->meta->site_count);
      return result;
    }
    if (!(seconds > 0 && seconds <= 10)) {
      fault.fail("seconds are not in (0, 10]");
      return result;
    }
    const std::uint8_t slot = exchange_.writing();
    const SkinnedPose& before = shapes_[newest_];
    const Arrays& arrays = arrays_[slot];
    result = maker_.make(positions, before.rotations, arrays.rotations, arrays.vertices, arrays.nodes,
                         shapes_[slot].view.search_grid);
    if (!result) return result;
    double most = 0;
    for (std::uint32_t i = 0; i < view_->meta->vertex_count; ++i) {
      const Vec3 way = to_vec(arrays.vertices[i].xyz) - vertex(before.view, i);
      most = std::fmax(most, dot(way, way));
    }
    shapes_[slot].view.vertices = arrays.vertices;
    if (view_->search != nullptr) shapes_[slot].view.search = arrays.nodes;
    shapes_[slot].seconds = seconds;
    shapes_[slot].displacement_bound = before.displacement_bound + std::sqrt(most);
    newest_ = slot;
    exchange_.publish();
    return result;
  }

  /// Moves the surface on by `seconds`, once before the ticks of its contacts. Without effect where `seconds` is not
  /// above 0.
  /// For the force loop's thread alone.
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

  /// Return the two shapes between which the surface is, the share of the way between them, and the number of shapes so
  /// far. For the force loop's thread alone.
  [[nodiscard]] const SkinnedPose& from() const { return shapes_[from_]; }
  [[nodiscard]] const SkinnedPose& to() const { return shapes_[to_]; }
  [[nodiscard]] double share() const { return share_; }
  [[nodiscard]] std::uint64_t number() const { return number_; }
  /// m: no point has moved farther since it was baked.
  [[nodiscard]] double displacement_bound() const {
    return from().displacement_bound + share_ * (to().displacement_bound - from().displacement_bound);
  }
  /// The body as it was baked.
  [[nodiscard]] const View& baked() const { return *view_; }

private:
  static constexpr int kSlots = 4;  // the host's, one in exchange, and the two of the force loop

  struct Arrays {
    Quaternion* rotations;
    layout::SearchNode* nodes;
    layout::Point* vertices;
  };

  /// Offsets (bytes) of the arrays, those of the largest alignment first.
  struct Layout {
    std::size_t work = 0, slots, slot, nodes, vertices, owners, end;
    explicit Layout(const View& view) {
      const std::size_t sites = view.meta->site_count, points = view.meta->vertex_count;
      slots = sites * sizeof(SkinnedPoseMaker::Work);
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
  SkinnedPoseMaker maker_;
  Arrays arrays_[kSlots];
  SkinnedPose shapes_[kSlots];
  std::uint8_t newest_ = 1;  // of the host's thread
  SlotExchange exchange_{0, 1};
  std::uint8_t from_ = 2, to_ = 3;  // of the force loop's
  double share_ = 1;
  std::uint64_t number_ = 0;
};

/// The motion of the surface near one of its points since it was baked: rigid to first order, in both shapes between
/// which the surface is.
class LocalMotion {
public:
  LocalMotion() = default;
  LocalMotion(const DeformingSurface& surface, const BodyPoint& at)
      : baked_(position(surface.baked(), at)),
        from_(position(surface.from().view, at)),
        to_(position(surface.to().view, at)),
        turned_from_(rotation_at(surface.from(), at)),
        turned_to_(rotation_at(surface.to(), at)) {}

  /// From where the body was baked to where the surface is after a share of the way.
  [[nodiscard]] Pose at(double share) const {
    Pose body = to_pose(mixed(turned_from_, turned_to_, share), {});
    body.translation = (1 - share) * from_ + share * to_ - body.rotate(baked_);
    return body;
  }

private:
  Vec3 baked_, from_, to_;  ///< m
  Quaternion turned_from_, turned_to_;
};

/// A deforming surface as the body of a tick (see StillBody for the members). Near c the surface has moved rigidly, to
/// first order, so a contact is one with the body as baked against that motion. Stretching changes no response, and
/// there is no inertia. A free tool is searched for on the shape that the surface moves to.
struct DeformingBody {
  const DeformingSurface* deforming;

  [[nodiscard]] bool valid() const { return true; }
  [[nodiscard]] Pose frame(const BodyPoint& at) const { return LocalMotion(*deforming, at).at(deforming->share()); }
  [[nodiscard]] const View& surface() const { return deforming->to().view; }
  [[nodiscard]] StillFrame surface_frame() const { return {}; }
  [[nodiscard]] double travel() const { return deforming->to().displacement_bound; }
  [[nodiscard]] double factor(const BodyPoint& /*at*/) const { return 1; }
  [[nodiscard]] double factor_step() const { return HUGE_VAL; }
};

}  // namespace palpate::runtime
