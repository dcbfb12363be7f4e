// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/runtime/property/organ_motions.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/runtime/property/hand.hpp"

namespace palpate::test {

using property::Random;
using runtime::Contact;
using runtime::Location;
using runtime::Tick;
using runtime::Vec3;
using runtime::View;

namespace {

constexpr double kNotable = 0.1;   // share of a peak or of a place's own force
constexpr double kMostWeak = 5;    // overlaps
constexpr double kAbove = 1e-3;    // m, where a press begins
constexpr int kPressTicks = 700;   // of a way in, and of a lift
constexpr int kAsideTicks = 500;   // of a way aside, and back
constexpr int kInTicks = 300;      // of a slide's way in

/// Work of the hand on one contact (trapezoid), of a tool that does not turn.
class Work {
public:
  void add(const Vec3& force, const Vec3& at) {
    if (started_) {
      const double work = -0.5 * dot(force_ + force, at - at_);
      net_ += work;
      gross_ += std::fabs(work);
      least_ = std::min(least_, net_);
    }
    force_ = force;
    at_ = at;
    started_ = true;
  }
  [[nodiscard]] double gain() const { return gross_ > 0 ? -least_ / gross_ : 0; }

private:
  bool started_ = false;
  Vec3 force_, at_;
  double net_ = 0, gross_ = 0, least_ = 0;  // J
};

/// Smooth from 0 to 1 with no speed and no acceleration at both ends.
double ease(double x) { return x * x * x * (10 - 15 * x + 6 * x * x); }

/// A direction across the unit vector n.
Vec3 across(Random& random, const Vec3& n) {
  for (;;) {
    const Vec3 t = tangential(random.direction(), n);
    if (length(t) > 0.1) return unit(t, t);
  }
}

bool own_response(const View& view, std::uint32_t tool, std::uint32_t site) {
  const std::uint64_t index = layout::response_index(*view.meta, site, view.tools[tool].first_vertex);
  return view.response_head(index).flags != layout::response_filled;
}

/// One press along a normal, with what it found.
class Press {
public:
  Press(const View& view, std::uint32_t tool, const Vec3& touch, const Vec3& up, const Vec3& way)
      : view_(view), radius_(view.tools[tool].probe_radius), contact_(view, tool), touch_(touch), up_(up), way_(way) {}

  void run(double depth, double aside, OrganResult& result) {
    std::vector<double> down(kPressTicks + 1), lift(kPressTicks + 1);
    const auto height = [&](int k) { return -kAbove + (depth + kAbove) * ease(k / double{kPressTicks}); };
    for (int k = 0; k <= kPressTicks; ++k) down[static_cast<std::size_t>(k)] = go(height(k), 0);
    for (int k = 0; aside > 0 && k <= kAsideTicks; ++k) go(depth, aside * ease(k / double{kAsideTicks}));
    for (int k = kAsideTicks; aside > 0 && k >= 0; --k) go(depth, aside * ease(k / double{kAsideTicks}));
    for (int k = kPressTicks; k >= 0; --k) {
      const double force = lift[static_cast<std::size_t>(k)] = go(height(k), 0);
      if (force < 1e-9) left_ = std::max(left_, radius_ - closest_point(view_, at_).signed_distance);
    }
    double off = 0;
    for (std::size_t k = 0; k < down.size(); ++k) off = std::max(off, std::fabs(lift[k] - down[k]));
    if (!(peak_ > 0)) return;
    ++result.presses;
    result.stepped += step_ > kNotable * peak_;
    result.lifts_off += aside == 0 && off > kNotable * peak_;
    result.lost_early += left_ > kNotable * depth;
    result.step = std::max(result.step, step_ / peak_);
    if (aside == 0) result.lift = std::max(result.lift, off / peak_);
    result.gain = std::max(result.gain, work_.gain());
  }

private:
  /// Returns the size of the force.
  double go(double depth, double aside) {
    at_ = touch_ - depth * up_ + aside * way_;
    const Vec3 force = contact_.tick(runtime::Pose::from_axis(at_, up_)).force;
    peak_ = std::max(peak_, length(force));
    step_ = std::max(step_, length(force - last_));
    last_ = force;
    work_.add(force, at_);
    return length(force);
  }

  const View& view_;
  double radius_;
  Contact contact_;
  Vec3 touch_, up_, way_;
  Vec3 at_, last_;
  double peak_ = 0, step_ = 0, left_ = 0;  // N, N, m
  Work work_;
};

/// The centre of a ball that goes round a body at constant overlap, tick by tick; it begins free.
std::vector<Vec3> way_round(const View& view, double radius, std::uint32_t site, const SlideOptions& options,
                            Random& random) {
  constexpr double kFree = 2e-3;  // m
  const double overlap = options.overlap * view.meta->depth_scale;
  const Vec3 up = runtime::to_vec(view.sites[site].normal);
  Vec3 heading = across(random, up), p = runtime::vertex(view, site) + (radius + kFree) * up;
  std::vector<Vec3> way;
  Location on = closest_point(view, p);
  for (int k = 0; k < kInTicks; ++k) {
    const double s = k / double{kInTicks}, share = s * s * (3 - 2 * s);
    p = on.point + (radius + kFree - (kFree + overlap) * share) * unit(p - on.point, up);
    way.push_back(p);
    on = closest_point(view, p, on.at);
  }
  for (int k = 0; k < options.ticks; ++k) {
    heading = unit(tangential(heading, unit(p - on.point, up)), heading);
    const Vec3 wanted = p + options.stride * heading;
    on = closest_point(view, wanted, on.at);
    if (!(on.signed_distance > 0)) break;
    p = on.point + (radius - overlap) * unit(wanted - on.point, up);
    way.push_back(p);
    on = closest_point(view, p, on.at);
  }
  return way;
}

/// N, of a normal indentation to the present overlap at the closest point.
double own_force(const View& view, std::uint32_t tool, const Vec3& at, runtime::BodyPoint& near) {
  const Location closest = closest_point(view, at, near);
  near = closest.at;
  runtime::ToolPoint on_tool;
  on_tool.patch = view.tools[tool].first_patch;
  runtime::BlendedResponse<> response;
  response.blend(view, tool, closest.at, on_tool, {1, 0, 0}, nullptr);
  const double depth = double{view.tools[tool].probe_radius} - closest.signed_distance;
  return depth > 0 ? response.law().at(depth).normal_force : 0;
}

}  // namespace

void OrganResult::add(const OrganResult& o) {
  presses += o.presses;
  stepped += o.stepped;
  lifts_off += o.lifts_off;
  lost_early += o.lost_early;
  step = std::max(step, o.step);
  lift = std::max(lift, o.lift);
  slides += o.slides;
  travel += o.travel;
  weak_travel += o.weak_travel;
  longest_weak = std::max(longest_weak, o.longest_weak);
  touch_changes += o.touch_changes;
  contact_size = std::max(contact_size, o.contact_size);
  slide_step = std::max(slide_step, o.slide_step);
  gain = std::max(gain, o.gain);
}

double OrganResult::touch_changes_per_size() const {
  return travel > 0 ? touch_changes * contact_size / travel : 0;
}

bool is_ball(const View& view, std::uint32_t tool) {
  const layout::ToolRecord& record = view.tools[tool];
  return record.kind == static_cast<std::uint32_t>(layout::ToolKind::point_sphere) && record.probe_radius > 0;
}

OrganResult press_sites(const View& view, std::uint32_t tool, const PressOptions& options) {
  Random random(options.seed);
  OrganResult result;
  const double radius = view.tools[tool].probe_radius;
  for (std::uint32_t site = 0; site < view.meta->site_count; ++site) {
    if (!own_response(view, tool, site)) continue;
    const Vec3 up = runtime::to_vec(view.sites[site].normal), c = runtime::vertex(view, site);
    const Vec3 touch = c + (2 * radius - closest_point(view, c + radius * up).signed_distance) * up;
    if (closest_point(view, touch + kAbove * up).signed_distance - radius < 0.5 * kAbove) continue;
    for (int k = 0; k < (options.aside > 0 ? options.repeats : 1); ++k) {
      Press(view, tool, touch, up, across(random, up))
          .run(options.depth * view.meta->depth_scale, options.aside, result);
    }
  }
  return result;
}

OrganResult slide_round(const View& view, std::uint32_t tool, const SlideOptions& options) {
  Random random(options.seed);
  OrganResult result;
  std::vector<std::uint32_t> sites;
  for (std::uint32_t site = 0; site < view.meta->site_count; ++site) {
    if (own_response(view, tool, site)) sites.push_back(site);
  }
  const double radius = view.tools[tool].probe_radius, overlap = options.overlap * view.meta->depth_scale;
  for (int run = 0; run < options.runs && !sites.empty(); ++run) {
    const std::uint32_t site = sites[random.below(static_cast<std::uint32_t>(sites.size()))];
    const Vec3 up = runtime::to_vec(view.sites[site].normal);
    const std::vector<Vec3> way = way_round(view, radius, site, options, random);
    Contact contact(view, tool);
    result.contact_size = contact.size(overlap);
    Work work;
    std::vector<double> sizes;
    Vec3 last;
    bool touched = false;
    double weak = 0, step = 0;
    runtime::BodyPoint near;
    for (std::size_t k = 0; k < way.size(); ++k) {
      const Tick tick = contact.tick(runtime::Pose::from_axis(way[k], up));
      work.add(tick.force, way[k]);
      if (k >= kInTicks) {
        const double moved = length(way[k] - way[k - 1]), size = length(tick.force);
        result.travel += moved;
        result.touch_changes += tick.touches() != touched;
        const bool is_weak = size < kNotable * own_force(view, tool, way[k], near);
        weak = is_weak ? weak + moved : 0;
        result.weak_travel += is_weak ? moved : 0;
        result.longest_weak = std::max(result.longest_weak, weak / overlap);
        step = std::max(step, length(tick.force - last));
        sizes.push_back(size);
      }
      touched = tick.touches();
      last = tick.force;
    }
    result.gain = std::max(result.gain, work.gain());
    ++result.slides;
    if (sizes.empty()) continue;
    const auto high = sizes.begin() + static_cast<std::ptrdiff_t>(0.9 * static_cast<double>(sizes.size()));
    std::nth_element(sizes.begin(), high, sizes.end());
    if (*high > 0) result.slide_step = std::max(result.slide_step, step / *high);
  }
  return result;
}

std::string broken_promise(const OrganResult& r) {
  if (r.lost_early > 0) return "8: a press that loses all force early";
  if (r.lifts_off > 0) return "8: a lift that does not follow the press";
  if (r.stepped > 0) return "8: a step of the force in a press";
  if (r.longest_weak > kMostWeak) return "9: a slide with no force over what it overlaps";
  if (r.touch_changes_per_size() > 1) return "9: a slide that touches and releases again and again";
  if (r.gain > 1e-3) return "6: a press or slide that gives back more than it took";
  return {};
}

}  // namespace palpate::test
