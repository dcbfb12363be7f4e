// SPDX-License-Identifier: GPL-3.0-or-later
// What the battery ticks: one contact of each driver behind one call, and what friction does to it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "palpate/contact/contact_set.hpp"
#include "tests/runtime/battery_hand.hpp"

namespace palpate::test::battery {

using runtime::State;
using runtime::Tick;

/// A body whose shape goes on swelling, shearing, bending and turning, and the contact with it.
struct Animation {
  Animation(const View& view, const BatteryCase& c)
      : memory(runtime::AnimatedSurface::bytes(view) / sizeof(double) + 1),
        surface(view, memory.data()),
        contact(surface, c.tool),
        sites(view.meta->site_count),
        lively(c.motion == Motion::fast ? 1.0 : 0.2),
        tick_time(c.motion == Motion::fast ? 1e-3 : 2e-4 * c.fine),
        random(c.seed + 99) {}

  [[nodiscard]] Pose at(const BodyPoint& point) const { return at(point, surface.share()); }
  [[nodiscard]] Pose at(const BodyPoint& point, double share) const {
    return runtime::LocalMotion(surface, point).at(share);
  }

  Tick tick(const Pose& pose) {
    next -= tick_time;
    if (next < 0) {
      give();
      next += (random.one_in(10) ? 1.5 : 1.0) / 60;
    }
    const Pose before = contact.frame();
    const double share = surface.share();
    surface.advance(tick_time);
    moved = at(last) * inverse(before);
    const Tick tick = contact.tick(pose);
    if (tick.touches() && !touched) moved = at(tick.at) * inverse(at(tick.at, share));  // where it begins
    last = tick.at;
    touched = tick.touches();
    return tick;
  }

  /// The next shape: 60 a second, a beat of a second.
  void give() {
    const View& view = surface.baked();
    const double phase = 6.283185307179586 / 60 * ++given, a = 0.2 * lively;
    const Pose turned = rotation_of({0.5 * lively * std::sin(phase), 0.3 * lively * std::sin(0.7 * phase), 0});
    for (std::uint32_t i = 0; i < view.meta->site_count; ++i) {
      const Vec3 x = runtime::to_vec(view.sites[i].position);
      const double beat = a * std::sin(phase + 20 * x.x);
      sites[i] = turned.apply({(1 + beat) * x.x + 0.5 * a * std::sin(phase) * x.y, (1 - beat) * x.y,
                               (1 + a * std::sin(1.3 * phase)) * x.z + 2 * a * x.x * x.y});
    }
    refused += !surface.set(sites.data(), view.meta->site_count, 1.0 / 60);
  }

  std::vector<double> memory;
  runtime::AnimatedSurface surface;
  runtime::AnimatedContact contact;
  std::vector<Vec3> sites;
  double lively, tick_time, next = 0;  ///< s, until the next shape
  Random random;
  BodyPoint last;
  bool touched = false;
  Pose moved;
  std::uint32_t given = 0, refused = 0;
};

/// Three contacts as if they were one, whose c goes as far in a tick as the one that goes farthest.
class Together {
public:
  static constexpr std::size_t kPlaces = 3;

  Together(const View& view, std::uint32_t tool) : contacts_(view, tool) {}

  Tick tick(const Pose& pose) {
    const runtime::SeveralTick<kPlaces> now = contacts_.tick(pose);
    Tick sum;
    sum.force = now.force;
    sum.torque = now.torque;
    sum.friction_limit = HUGE_VAL;  // that of none
    deepest_ = 0;
    std::array<double, kPlaces> crept = {};
    for (std::size_t k = 0; k < now.each.size(); ++k) {
      const Tick& each = now.each[k];
      if (each.state == State::fault) return each;
      if (!each.touches()) continue;
      if (sum.state != State::slide) sum.state = each.state;
      sum.depth += each.depth;  // so much force may be theirs
      deepest_ = std::max(deepest_, each.depth);
      double least = HUGE_VAL;
      for (const Tick& before : last_.each) {
        if (before.touches()) least = std::min(least, length(each.body_point - before.body_point));
      }
      if (std::isfinite(least)) crept[k] = least;
    }
    // One that begins is far from all.
    std::sort(crept.begin(), crept.end());
    along_ += crept[crept.size() - 1 - static_cast<std::size_t>(std::max(0, now.touching - last_.touching))];
    sum.body_point = {along_, 0, 0};
    last_ = now;
    return sum;
  }
  void reset() { contacts_.reset(); }
  [[nodiscard]] const runtime::Contact& first() const { return contacts_.contact(0); }
  template <class Add>
  void each(const Add& add) const {
    for (std::size_t i = 0; i < kPlaces; ++i) {
      const runtime::Contact& one = contacts_.contact(static_cast<int>(i));
      add(i, last_.each[i], one.anchor(), one.field().normal());
    }
  }
  [[nodiscard]] double deepest() const { return deepest_; }  ///< m, of them in the last tick

private:
  runtime::SeveralContacts<kPlaces> contacts_;
  runtime::SeveralTick<kPlaces> last_;
  double along_ = 0, deepest_ = 0;
};

inline bool same_place(const runtime::ToolPoint& a, const runtime::ToolPoint& b) {
  return a.patch == b.patch && std::equal(a.weights, a.weights + 3, b.weights);
}

/// What friction took from one contact that slides, and gave (J). Where p runs over the tool c goes with it without
/// slipping: such ticks do not count.
struct Friction {
  /// Of a tick whose anchor is there (m); the surface went so, and the tool, of that probe radius (m), by `turn` (rad)
  /// against it.
  void add(const Tick& tick, const Vec3& anchor, const Vec3& normal, const Pose& surface, const Vec3& turn,
           double probe) {
    if (tick.state == State::slide && last.state == State::slide && same_place(tick.on_tool, last.on_tool) &&
        std::isfinite(tick.friction_limit)) {
      // What slips are both c and the anchor: c alone takes over what the anchor went ahead while the tool went
      // deeper; the anchor alone goes on where c cannot follow, as at a corner. The skin goes there as the tool turns
      // and as the normal does, about p.
      const double height = probe + dot(tick.tool_point - tick.body_point, normal);
      const Vec3 turned = probe * cross(normal, turn) + height * (normal - surface.rotate(normal_before));
      const Vec3 bears = tangential(0.5 * (last.force + tick.force), normal);
      const double loss = std::max(-dot(bears, tick.body_point - surface.apply(last.body_point) + turned),
                                   -dot(bears, anchor - surface.apply(before) + turned));
      (loss > 0 ? taken : given) += std::fabs(loss);
    }
    last = tick;
    before = anchor;
    normal_before = normal;
  }

  /// The hand was put elsewhere.
  void begin() { last = {}; }

  double taken = 0, given = 0;

private:
  Tick last;
  Vec3 before;  ///< m, the anchor
  Vec3 normal_before;
};

/// One contact loop behind one call.
class Loop {
public:
  Loop(const View& view, const BatteryCase& c)
      : view_(view), case_(c), random_(c.seed + 77), contact_(view, c.tool), memory_(view.meta->site_count) {
    if (c.driver == Driver::several) together_ = std::make_unique<Together>(view, c.tool);
    if (c.driver == Driver::animated) animation_ = std::make_unique<Animation>(view, c);
    if (c.driver != Driver::online) return;
    scales_ = std::make_unique<runtime::SiteScales>(view, memory_.data());
    adjusted_ = std::make_unique<runtime::AdjustedContact>(view, c.tool, *scales_, 5);
  }

  /// Where a hand that is put somewhere is put in the world: by the motion of the surface there.
  void put(const Pose& pose) {
    if (animation_) place_ = animation_->at(locate(view_, pose.translation).at);
  }
  [[nodiscard]] Pose in_world(const Pose& pose) const { return place_ * pose; }

  Tick tick(const Pose& pose) {
    if (case_.driver == Driver::alone) return contact_.tick(pose);
    if (animation_) return animation_->tick(pose);
    if (together_) return together_->tick(pose);
    if (case_.driver == Driver::online) {
      if (ticks_++ % 50 == 0) {
        const double about = random_.between(0.2, 2);
        for (std::uint32_t i = 0; i < view_.meta->site_count; ++i) {
          scales_->set(i, static_cast<float>(about * random_.between(0.5, 1.5)));
        }
      }
      return adjusted_->tick(pose, 1e-3);
    }
    if (count_ == 0) latest_ = coming_ = runtime::search(view_, case_.tool, pose);
    if (count_++ % every_ == 0) {  // what was searched for one period ago arrives
      latest_ = coming_;
      coming_ = runtime::search(view_, case_.tool, pose);
      every_ = 5 + random_.below(36);
    }
    return contact_.tick(pose, latest_);
  }

  void reset() {
    contact_.reset();
    if (adjusted_) adjusted_->reset();
    if (together_) together_->reset();
    if (animation_) animation_->contact.reset();
    count_ = 0;
  }
  /// Calls add(which, its tick, its anchor, its n(c)) for each contact, in the world.
  template <class Add>
  void each(const Tick& tick, const Add& add) const {
    if (together_) return together_->each(add);
    const Pose frame = animation_ ? animation_->contact.frame() : Pose{};
    const runtime::Contact& one = animation_ ? animation_->contact.contact() : contact();
    add(0, tick, frame.apply(one.anchor()), frame.rotate(one.field().normal()));
  }
  /// m, of the last tick's deepest contact.
  [[nodiscard]] double deepest(const Tick& tick) const { return together_ ? together_->deepest() : tick.depth; }
  /// J that the account of the contact took so far.
  [[nodiscard]] double lost() const { return animation_ ? animation_->contact.contact().lost() : contact().lost(); }
  /// How the surface at the last tick's c moved in this tick.
  [[nodiscard]] Pose surface_motion() const { return animation_ ? animation_->moved : Pose{}; }

private:
  [[nodiscard]] const runtime::Contact& contact() const {
    return adjusted_ ? adjusted_->contact() : together_ ? together_->first() : contact_;
  }

  const View& view_;
  BatteryCase case_;
  Random random_;
  runtime::Contact contact_;
  std::vector<runtime::SiteScales::Scale> memory_;
  std::unique_ptr<runtime::SiteScales> scales_;
  std::unique_ptr<runtime::AdjustedContact> adjusted_;
  std::unique_ptr<Animation> animation_;
  std::unique_ptr<Together> together_;
  Pose place_;
  std::uint64_t ticks_ = 0, count_ = 0, every_ = 5;
  runtime::Search latest_, coming_;
};

}  // namespace palpate::test::battery
