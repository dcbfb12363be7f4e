// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled without exceptions and RTTI, and looked into: what it leaves to the linker is what a tick needs.
#include "tests/runtime/every_tick.hpp"

#include "palpate/palpate.hpp"
#include "tests/runtime/wandering.hpp"

namespace palpate::test {
namespace {

using namespace runtime;

template <class Held>
void hold_on(const View& view, std::uint32_t tool, const Pose& pose, const Tick& tick, EveryTick& sum) {
  Held grasp(view, tool, pose, tick);
  Pose turning = pose;
  for (int i = 0; i < 4; ++i) {
    turning = Pose::from_quaternion(1, 0.01, 0.02, 0.01 * i, {1e-4, 0, 1e-4 * i}) * turning;
    const Tick held = grasp.tick(turning);
    sum.held += length(held.force) > 0;
    sum.finite = sum.finite && std::isfinite(length(held.force) + length(held.torque));
  }
}

}  // namespace

EveryTick every_tick(const void* bytes, std::size_t size, int ticks, void (*halfway)()) {
  static char error[200];
  constexpr std::uint32_t kMostSites = 64;
  SiteScales::Scale factors[kMostSites];
  Vec3 sites[kMostSites];
  static double memory[1 << 14];
  EveryTick sum;
  const OpenResult opened = View::open(bytes, size);
  const View& view = opened.view;
  if (!opened || view.meta->site_count > kMostSites || AnimatedSurface::bytes(view) > sizeof memory) {
    for (std::size_t i = 0; i < sizeof error; ++i) error[i] = opened.error[i];
    sum.error = opened ? "too many sites for this test" : error;
    return sum;
  }
  SiteScales scales(view, factors);
  for (std::uint32_t tool = 0; tool < view.meta->tool_count; ++tool) {
    Wandering wandering(tool + 7);
    Contact alone(view, tool), served(view, tool);
    SeveralContacts<> several(view, tool);
    SeveralTools<2> tools(view, {tool, tool});
    MovingContact moving(view, tool);
    AnimatedSurface surface(view, memory);
    AnimatedContact animated(surface, tool);
    Contact tied(view, tool);
    VirtualCoupling tie(CouplingOptions{300, 0.1}), tie_of_several(tie);
    ContactsAsOne<3> tied_several(view, tool);
    AdjustedContact adjusted(view, tool, scales), tied_adjusted(view, tool, scales);
    AnimatedContact tied_animated(surface, tool);
    VirtualCoupling tie_of_adjusted(tie), tie_of_animated(tie);
    MovingContact served_moving(view, tool);
    AdjustedContact served_adjusted(view, tool, scales);
    SeveralContacts<> served_several(view, tool);
    SeveralTools<2> served_tools(view, {tool, tool});
    Latest<Search> searches;
    Search latest;
    SeveralSearch<2> seen;
    Places<2> places;
    Output<output::LowPass, output::RateLimit, output::Limit> out({200}, {500}, {3});
    Output<output::TwoAxes, output::Passivity> across({{0, 1, 0}}, output::Passivity({2e-3, 0.5, 0.1, 500, 5e-5}));
    Output<output::OneAxis> cable({{0, 0, 1}, true});
    const DeviceFrame device{Pose::from_quaternion(1, 0.1, 0.2, 0.3, {0.1, 0.2, 0.3}), 2, 0.5};
    for (int i = 0; i < ticks; ++i) {
      if (i == ticks / 2 && tool == 0) halfway();
      const Pose pose = wandering.next();
      if (i % 20 == 0) searches.write(search(view, tool, pose));
      searches.read(latest);
      places.pose = pose;
      if (i % 20 == 0) seen = search(view, tool, places);
      const SeveralTick<2> at_several = served_several.tick(pose, seen);
      places = Places<2>::of(pose, at_several);
      if (i % 100 == 0) scales.set(static_cast<std::uint32_t>(i / 100) % view.meta->site_count, 0.5f);
      for (std::uint32_t k = 0; k < view.meta->site_count && i % 16 == 0; ++k) {
        sites[k] = (1 + 0.1 * std::sin(0.006 * i)) * to_vec(view.sites[k].position);
      }
      if (i % 16 == 0) sum.finite = surface.set(sites, view.meta->site_count, 0.016) && sum.finite;
      surface.advance(1e-3);
      const Pose breathing = Pose::from_quaternion(1, 0, 0, 1e-6 * i, {0, 0, 1e-7 * i});
      const Tick answers[] = {alone.tick(pose),
                              served.tick(pose, latest),
                              moving.tick(breathing, breathing * pose),
                              adjusted.tick(pose, 1e-3),
                              several.tick(pose).each[0],
                              tools.tick({pose, pose})[1],
                              tie.tick(tied, pose, 1e-3),
                              tie_of_several.tick(tied_several, pose, 1e-3),
                              tie_of_adjusted.tick(tied_adjusted, pose, 1e-3, 1e-3),
                              tie_of_animated.tick(tied_animated, pose, 1e-3),
                              animated.tick(pose),
                              at_several.each[0],
                              served_moving.tick(breathing, breathing * pose, latest),
                              served_adjusted.tick(pose, 1e-3, latest),
                              served_tools.tick({pose, pose}, {latest, latest})[1]};
      for (const Tick& tick : answers) {
        sum.touching += tick.touches();
        const Vec3 sent = device.to_device(out(tick.force, 1e-3));
        const Vec3 pulled = across(sent, 1e-3, pose.translation) + cable(sent, 1e-3);
        sum.finite = sum.finite && std::isfinite(length(sent) + length(pulled));
      }
      if (i % 50 != 0 || !answers[0].touches()) continue;
      hold_on<Grasp>(view, tool, pose, answers[0], sum);
      hold_on<TurningGrasp>(view, tool, pose, answers[0], sum);
    }
  }
  return sum;
}

}  // namespace palpate::test
