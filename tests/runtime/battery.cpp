// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/runtime/battery.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>

#include "palpate/checksum.hpp"
#include "palpate/several.hpp"
#include "tests/runtime/battery_hand.hpp"

namespace palpate::test {
namespace {

using namespace battery;
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

bool same_place(const runtime::ToolPoint& a, const runtime::ToolPoint& b) {
  return a.patch == b.patch && std::equal(a.weights, a.weights + 3, b.weights);
}

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

}  // namespace

void BatteryResult::add(const BatteryResult& o) {
  ticks += o.ticks;
  touching += o.touching;
  sliding += o.sliding;
  contacts += o.contacts;
  broken += o.broken;
  force = std::max(force, o.force);
  step = std::max(step, o.step);
  leap = std::max(leap, o.leap);
  begin = std::max(begin, o.begin);
  gain = std::max(gain, o.gain);
  gained += o.gained;
  gross += o.gross;
  acting += o.acting;
  lost += o.lost;
  drag = std::max(drag, o.drag);
  hash = 31 * hash + o.hash;
}

namespace {

// N/m, of small pushes sideways, in two directions across n(c).
double sideways_stiffness(const runtime::Field& field, const runtime::DepthTerms& terms, double aside) {
  if (!(aside > 0)) return 0;
  const Vec3 x = aside * runtime::any_orthogonal(field.normal()), y = cross(field.normal(), x);
  return std::max(length(field.sideways(terms, x)), length(field.sideways(terms, y))) / aside;
}

}  // namespace

double Stiffest::at(double depth) const { return within + further * std::max(0.0, depth / depth_scale - 1); }

Stiffest stiffest(const View& view, std::uint32_t tool) {
  Random random(1);
  const double z = view.meta->depth_scale, aside = 0.02 * view.meta->sideways_scale;
  const layout::ToolRecord& record = view.tools[tool];
  double most = 0, further = 0;
  for (std::uint32_t t = 0; t < view.meta->triangle_count; ++t) {
    for (int k = 0; k < 3; ++k) {
      BodyPoint at{t, {0, 0, 0}};
      at.bary[k] = 1;
      runtime::ToolPoint on_tool{record.first_patch, {1, 0, 0}};
      if (record.patch_count > 0) on_tool.patch += random.below(record.patch_count);
      const runtime::Field field(view, tool, at, on_tool);
      const double slope = (field.at_depth(1.2 * z).normal_force - field.at_depth(1.1 * z).normal_force) / (0.1 * z);
      const runtime::DepthTerms terms = field.at_depth(z);
      const double sideways = sideways_stiffness(field, terms, aside);
      most = std::max({most, slope, terms.normal_force / z, sideways});
      further = std::max(further, sideways_stiffness(field, field.at_depth(2 * z), aside) - sideways);
    }
  }
  return {1.1 * most, 1.1 * further, z};
}

BatteryResult run_battery(const View& view, const BatteryCase& c) {
  const Stiffest stiff = stiffest(view, c.tool);
  const double factor = c.driver == Driver::online ? 3 : 1, k = factor * stiff.within, scale = view.meta->depth_scale;
  const double reach = runtime::skeleton_radius(view, c.tool) + view.tools[c.tool].probe_radius;
  Hand hand(view, c);
  Loop loop(view, c);
  BatteryResult r;
  checksum::Xxh64 hash;
  constexpr double kNothing = 1e-7;  // of the depth scale: half a nanometre, that a contact may begin inside by
  const double drift = c.driver == Driver::online ? 5e-3 * scale : 0;  // factors change by as much in a tick
  Pose asked = hand.next();
  loop.put(asked);
  Pose before = loop.in_world(asked);
  Tick last = loop.tick(before);
  std::array<Friction, Together::kPlaces> friction;
  double deepest = loop.deepest(last);
  double before_that = 0;  // m moved in the tick before: where the body is animated, a part is told a tick late
  double work = 0, gross = 0, worst = 0, lost = 0;
  double hidden = 0;  // J at most, between the sum and what the hand gave on its way from tick to tick
  const auto close = [&] {
    r.contacts += gross > 0;
    r.gross += gross;
    r.gained += worst;
    const double least = c.motion == Motion::fast ? 0.02 : 1e-3;
    if (gross > 0 && worst > 0) r.gain = std::max(r.gain, worst / std::max(gross, least * k * scale * scale));
    work = gross = worst = hidden = 0;
  };
  for (r.ticks = 1; r.ticks < c.ticks; ++r.ticks) {
    const Pose next = hand.next();
    const bool put = length(next.translation - asked.translation) > 0.01 * scale;
    asked = next;
    if (c.motion != Motion::fast && put) {
      // The hand is put to its next place, perhaps inside the body: what it finds there is a start.
      loop.reset();
      loop.put(asked);
      close();
      last = {};
      for (Friction& one : friction) one.begin();
      before = loop.in_world(asked);
    }
    const Pose pose = loop.in_world(asked);
    const Tick tick = loop.tick(pose);
    const double values[] = {tick.force.x, tick.force.y, tick.force.z, tick.torque.x, tick.torque.y, tick.torque.z};
    hash.update(values, sizeof values);
    const double size = length(tick.force);
    if (!std::isfinite(size + length(tick.torque)) || (size > 0 && !(tick.depth > 0)) || tick.state == State::fault) {
      ++r.broken;
      last = {};
      before = pose;
      continue;
    }
    // Of the tool against the surface: so works the hand, and so the surface.
    const Pose surface = loop.surface_motion();
    const Vec3 way = pose.translation - surface.apply(before.translation);
    const Vec3 turned = turn_between({}, surface), turn = turn_between(before, pose) - turned;
    const double moved = length(way) + reach * (length(turn) + length(turned));
    r.touching += tick.touches();
    r.sliding += tick.state == State::slide;
    if (const double paid = loop.lost(); paid != lost) {  // a contact that begins has paid nothing
      r.acting += paid > 0;
      r.lost += paid > lost ? paid - lost : paid;
      lost = paid;
    }
    r.force = std::max(r.force, size / (k * std::max(scale, tick.depth)));
    const bool goes_on = tick.touches() && last.touches();
    const double crept = goes_on ? length(tick.body_point - last.body_point) : 0;
    const double late = c.driver == Driver::animated ? before_that : 0;
    const double change = length(tick.force - last.force),
                 here = factor * stiff.at(std::max(deepest, loop.deepest(tick)));
    const double step = change / (here * (moved + crept + late + drift + kNothing * scale));
    before_that = moved + crept;
    const bool begins = tick.touches() != last.touches() && (c.driver == Driver::late || c.motion == Motion::fast);
    if (begins) {
      r.begin = std::max(r.begin, (change - 2 * k * moved) / (k * scale));
    } else if (c.motion != Motion::fast || moved < 0.5 * scale) {
      r.step = std::max(r.step, step);
      // A tool that turns rolls on by 1e-3 of its size at once; against a body whose vertices move it always turns.
      if (goes_on && c.motion != Motion::fast && c.motion != Motion::turn) {
        const double rolls = c.driver == Driver::animated ? 1e-3 : 2.5e-5;
        const double anyhow = late + drift + rolls * (view.tools[c.tool].probe_radius + scale);
        r.leap = std::max(r.leap, change / (here * (moved + anyhow)));
      }
    }
    const double w = -0.5 * (dot(last.force + tick.force, way) + dot(last.torque + tick.torque, turn));
    work += w;
    gross += std::fabs(w);
    if (c.motion == Motion::fast) {
      hidden += 0.5 * (std::fabs(dot(tick.force - last.force, way)) + std::fabs(dot(tick.torque - last.torque, turn)));
    }
    worst = std::max(worst, -work - hidden);
    if (!tick.touches() && last.touches()) close();
    if (c.motion != Motion::fast) {
      loop.each(tick, [&](std::size_t i, const Tick& one, const Vec3& at, const Vec3& n) {
        friction[i].add(one, at, n, surface, turn, view.tools[c.tool].probe_radius);
      });
    }
    last = tick;
    deepest = loop.deepest(tick);
    before = pose;
  }
  double taken = 0, given = 0;
  for (const Friction& one : friction) {
    taken += one.taken;
    given += one.given;
  }
  r.drag = taken > 0 ? given / taken : 0;
  r.hash = hash.digest();
  return r;
}

std::string broken_promise(const BatteryCase& c, const BatteryResult& r) {
  const bool fast = c.motion == Motion::fast;
  if (r.broken > 0) return "a force that is not finite, or without depth, or a fault at a good pose";
  if (r.force > 1.2) return "a force beyond what the stiffest place answers with";
  if (r.step > (fast ? 2.5 : 2)) return "a force that changed by more than its bound a metre";
  if (r.leap > 5) return "a force that leapt while the tool hardly moved";
  if (r.begin > 5e-3) return "a contact that began or ended with a force";
  if (r.gain > 0.03) return "a contact that gave back more than it took";
  if (r.drag > 1e-3) return "a friction that drove";
  return {};
}

const char* name(Motion motion) {
  static const char* const kNames[] = {"press", "graze", "corner", "turn", "fast"};
  return kNames[static_cast<int>(motion)];
}

const char* name(Driver driver) {
  static const char* const kNames[] = {"alone", "late", "online", "animated", "several"};
  return kNames[static_cast<int>(driver)];
}

}  // namespace palpate::test
