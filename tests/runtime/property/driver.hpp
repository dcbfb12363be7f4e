// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts of the property test: each kind behind one call, and the work of its friction.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "palpate/body/deforming_body.hpp"
#include "palpate/body/stiffness_scale.hpp"
#include "palpate/contact/contact_set.hpp"
#include "tests/runtime/property/hand.hpp"

namespace palpate::test::property {

using runtime::State;
using runtime::Tick;

/// A body whose shape goes on swelling, shearing, bending and turning.
struct Animation {
  Animation(const View& view, const PropertyCase& c)
      : memory(runtime::DeformingSurface::bytes(view) / sizeof(double) + 1),
        surface(view, memory.data()),
        sites(view.meta->site_count),
        lively(c.motion == Motion::fast ? 1.0 : 0.2),
        tick_time(c.motion == Motion::fast ? 1e-3 : 2e-4 * c.fine),
        random(c.seed + 99) {}

  [[nodiscard]] Pose at(const BodyPoint& point) const {
    return runtime::LocalMotion(surface, point).at(surface.share());
  }
  void advance() {
    next -= tick_time;
    if (next < 0) {
      give();
      next += (random.one_in(10) ? 1.5 : 1.0) / 60;
    }
    surface.advance(tick_time);
  }
  /// The next shape: 60 a second, a beat of a second.
  void give() {
    const View& view = surface.baked();
    const double phase = 6.283185307179586 / 60 * ++given, a = 0.2 * lively;
    const Pose turned = rotation_of({0.5 * lively * std::sin(phase), 0.3 * lively * std::sin(0.7 * phase), 0});
    for (std::uint32_t i = 0; i < view.meta->site_count; ++i) {
      const Vec3 x = runtime::vertex(view, i);
      const double beat = a * std::sin(phase + 20 * x.x);
      sites[i] = turned.apply({(1 + beat) * x.x + 0.5 * a * std::sin(phase) * x.y, (1 - beat) * x.y,
                               (1 + a * std::sin(1.3 * phase)) * x.z + 2 * a * x.x * x.y});
    }
    refused += !surface.set(sites.data(), view.meta->site_count, 1.0 / 60);
  }

  std::vector<double> memory;
  runtime::DeformingSurface surface;
  std::vector<Vec3> sites;
  double lively, tick_time, next = 0;  ///< s, until the next shape
  Random random;
  std::uint32_t given = 0, refused = 0;
};

/// Work of the friction of one contact from its first tick on: sticking stores, slipping dissipates, and the sum is never
/// below zero.
struct FrictionWork {
  /// `bias` (N, world): tangential bias, which is no friction. `way` (m, world): of the tool's skin over the body.
  void add(const Tick& tick, const Vec3& bias, const Vec3& way) {
    const Vec3 friction = tangential(tick.force, tick.normal) + bias;  // the bias is the hand's push
    const double loss = -0.5 * dot(friction + last, way);
    net += loss;
    gross += std::fabs(loss);
    least = std::min(least, net);
    last = friction;
  }
  /// Ends the contact; `least_gross` (J): of a contact that is worth a share.
  void close(double least_gross) {
    if (gross > 0) worst = std::max(worst, -least / std::max(gross, least_gross));
    net = gross = least = 0;
    last = {};
  }
  double worst = 0;  ///< largest share given back beyond what was taken

private:
  double net = 0, gross = 0, least = 0;  ///< J
  Vec3 last;
};

/// One contact of a case.
class Loop {
public:
  Loop(const View& view, const PropertyCase& c)
      : view_(view), case_(c), random_(c.seed + 77), contact_(view, c.tool), set_(view, c.tool),
        memory_(view.meta->site_count) {
    if (c.driver == Driver::deforming) animation_ = std::make_unique<Animation>(view, c);
    if (c.driver == Driver::scaled) scales_ = std::make_unique<runtime::SiteScales>(view, memory_.data());
  }

  /// Puts the hand at a pose in the world, moved by the motion of the surface there.
  void put(const Pose& pose) {
    if (animation_) place_ = animation_->at(closest_point(view_, pose.translation).at);
  }
  [[nodiscard]] Pose in_world(const Pose& pose) const { return place_ * pose; }

  Tick tick(const Pose& pose) {
    switch (case_.driver) {
      case Driver::alone:
        return contact_.tick(pose);
      case Driver::set:
        return set_.tick(pose);
      case Driver::deforming: {
        const Pose before = animation_->at(last_at_);
        const double share = animation_->surface.share();
        animation_->advance();
        surface_motion_ = animation_->at(last_at_) * inverse(before);
        const bool touched = contact_.state().touching;
        const Tick tick = contact_.tick(pose, runtime::DeformingBody{&animation_->surface});
        if (!tick.touches()) return tick;
        last_at_ = tick.at;
        if (!touched) {  // where it begins
          const runtime::LocalMotion there(animation_->surface, tick.at);
          surface_motion_ = there.at(animation_->surface.share()) * inverse(there.at(share));
        }
        return tick;
      }
      case Driver::scaled:
        if (ticks_++ % 50 == 0) {
          const double about = random_.between(0.2, 2);
          for (std::uint32_t i = 0; i < view_.meta->site_count; ++i) {
            scales_->set(i, static_cast<float>(about * random_.between(0.5, 1.5)));
          }
        }
        return contact_.tick(pose, runtime::StiffnessScale<runtime::StillBody>{{&view_}, scales_.get(), &view_, 5e-3});
      default:
        break;
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
    set_.reset();
    count_ = 0;
  }

  /// m, travel of the responses over the body in this tick, the largest of all contacts. If c jumps, the response lags
  /// behind it.
  [[nodiscard]] double point_motion() const {
    double most = 0;
    for (int k = 0; k < 3; ++k) {
      const runtime::ContactState& now = contact(k).state();
      if (now.touching && was_[k].touching) most = std::max(most, response_way(was_[k].place, now.place));
    }
    return most;
  }
  void remember() {
    for (int k = 0; k < 3; ++k) was_[k] = contact(k).state();
  }
  /// m, sum of the indentations.
  [[nodiscard]] double depth(const Tick& tick) const {
    if (case_.driver != Driver::set) return tick.depth;
    double sum = 0;
    for (const Tick& each : set_.each()) sum += each.touches() ? each.depth : 0;
    return sum;
  }
  /// N, world: the hand's push against the tangential bias of the contact (the first of a set).
  [[nodiscard]] Vec3 bias(const Tick& tick) const {
    const runtime::Contact& one = contact(0);
    const runtime::ContactState& s = one.state();
    if (!s.touching || !(s.counted_depth > 0)) return {};
    const runtime::Vec2 g = one.response().law().at(s.counted_depth).bias;
    const Vec3 y = cross(s.place.normal, s.place.axis), local = s.factor * (g.x * s.place.axis + g.y * y);
    return animation_ ? animation_->at(tick.at).rotate(local) : local;
  }
  /// How the surface at the last tick's c moved in this tick.
  [[nodiscard]] Pose surface_motion() const { return surface_motion_; }

private:
  [[nodiscard]] const runtime::Contact& contact(int k) const {
    return case_.driver == Driver::set ? set_.contact(k) : contact_;
  }

  const View& view_;
  PropertyCase case_;
  Random random_;
  runtime::Contact contact_;
  runtime::ContactSet<3> set_;
  std::vector<runtime::SiteScales::Scale> memory_;
  std::unique_ptr<runtime::SiteScales> scales_;
  std::unique_ptr<Animation> animation_;
  Pose place_, surface_motion_;
  BodyPoint last_at_;
  std::uint64_t ticks_ = 0, count_ = 0, every_ = 5;
  runtime::Search latest_, coming_;
  runtime::ContactState was_[3];
};

}  // namespace palpate::test::property
