// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled without exceptions and RTTI; what it leaves to the linker is what opening and ticking need.
#include "tests/runtime/every_tick.hpp"

#include "palpate/palpate.hpp"
#include "tests/runtime/wandering.hpp"

namespace palpate::test {
namespace {

using namespace runtime;

template <class Bonded>
void tick_bonded(const View& view, std::uint32_t tool, const Pose& pose, const Tick& tick, EveryTick& sum) {
  Bonded bonded(view, tool, pose, tick);
  Pose turning = pose;
  for (int i = 0; i < 4; ++i) {
    turning = Pose::from_quaternion(1, 0.01, 0.02, 0.01 * i, {1e-4, 0, 1e-4 * i}) * turning;
    const Tick held = bonded.tick(turning);
    sum.bonded += length(held.force) > 0;
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
  if (!opened || view.meta->site_count > kMostSites || DeformingSurface::bytes(view) > sizeof memory) {
    for (std::size_t i = 0; i < sizeof error; ++i) error[i] = opened.error[i];
    sum.error = opened ? "too many sites for this test" : error;
    return sum;
  }
  SiteScales scales(view, factors);
  const StiffnessScale<StillBody> scaled{{&view}, &scales, &view};
  for (std::uint32_t tool = 0; tool < view.meta->tool_count; ++tool) {
    Wandering wandering(tool + 7);
    DeformingSurface surface(view, memory);
    const DeformingBody deforming{&surface};
    Contact alone(view, tool), searched(view, tool), moving(view, tool), moving_searched(view, tool);
    Contact bent(view, tool), adjusted(view, tool), adjusted_searched(view, tool), coupled(view, tool);
    Contact coupled_bent(view, tool), coupled_adjusted(view, tool);
    ContactSet<3> set(view, tool), set_searched(view, tool), coupled_set(view, tool);
    VirtualCoupling coupling(CouplingOptions{300, 0.1}), coupling_bent(coupling), coupling_adjusted(coupling);
    VirtualCoupling coupling_set(coupling);
    TripleBuffer<Search> searches;
    Search latest;
    SetSearch<3> walls;
    EnergyMeter meter;
    OutputChain<output::LowPass, output::RateLimit, output::Limit> out({200}, {500}, {3});
    OutputChain<output::TwoAxes, output::PassivityController> across(
        {{0, 1, 0}}, output::PassivityController(output::PassivityOptions{}));
    OutputChain<output::OneAxis> cable({{0, 0, 1}, true});
    const DeviceFrame device{Pose::from_quaternion(1, 0.1, 0.2, 0.3, {0.1, 0.2, 0.3}), 2, 0.5};
    for (int i = 0; i < ticks; ++i) {
      if (i == ticks / 2 && tool == 0) halfway();
      const Pose pose = wandering.next();
      if (i % 20 == 0) {
        searches.write(search(view, tool, pose));
        walls = search(view, tool, set_searched.request(pose));
      }
      searches.read(latest);
      if (i % 100 == 0) scales.set(static_cast<std::uint32_t>(i / 100) % view.meta->site_count, 0.5f);
      for (std::uint32_t k = 0; k < view.meta->site_count && i % 16 == 0; ++k) {
        sites[k] = (1 + 0.1 * std::sin(0.006 * i)) * vertex(view, k);
      }
      if (i % 16 == 0) sum.finite = surface.set(sites, view.meta->site_count, 0.016) && sum.finite;
      surface.advance(1e-3);
      const RigidMotion breathing{&view, Pose::from_quaternion(1, 0, 0, 1e-6 * i, {0, 0, 1e-7 * i})};
      const Pose carried = breathing.pose * pose;
      const Tick answers[] = {alone.tick(pose),
                              searched.tick(pose, latest),
                              moving.tick(carried, breathing),
                              moving_searched.tick(carried, breathing, &latest),
                              bent.tick(pose, deforming),
                              adjusted.tick(pose, scaled),
                              adjusted_searched.tick(pose, scaled, &latest),
                              set.tick(pose),
                              set_searched.tick(pose, walls),
                              coupling.tick(coupled, pose, 1e-3),
                              coupling_bent.tick(coupled_bent, pose, 1e-3, deforming),
                              coupling_adjusted.tick(coupled_adjusted, pose, 1e-3, scaled),
                              coupling_set.tick(coupled_set, pose, 1e-3)};
      meter.add(pose, answers[0]);
      SuperpositionError superposition;
      const ContactRadius radius(view, tool);
      for (int k = 0; k < 3; ++k) superposition.add(set.each()[0], radius, set.each()[k == 0 ? 1 : 2], radius);
      sum.finite = sum.finite && superposition.error >= 0;
      for (const Tick& tick : answers) {
        sum.touching += tick.touches();
        const Vec3 sent = device.to_device(out(tick.force, 1e-3));
        const Vec3 pulled = across(sent, 1e-3, pose.translation) + cable(sent, 1e-3);
        sum.finite = sum.finite && std::isfinite(length(sent) + length(pulled));
      }
      if (i % 50 != 0 || !answers[0].touches()) continue;
      tick_bonded<BondedContact>(view, tool, pose, answers[0], sum);
      tick_bonded<BondedContact6D>(view, tool, pose, answers[0], sum);
    }
    sum.finite = sum.finite && std::isfinite(meter.given() + meter.returned());
  }
  return sum;
}

}  // namespace palpate::test
