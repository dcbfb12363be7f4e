// SPDX-License-Identifier: GPL-3.0-or-later
// Classes that a program may use beside a contact: a function for each, of which a linker keeps one. Compiled without
// inlining, so that every function that is called has a symbol.
#include "palpate/palpate.hpp"

using namespace palpate::runtime;

namespace {

template <class Step>
Vec3 through(const Step& step, const Vec3& force) {
  return OutputChain<Step>(step)(force, 1e-3, force);
}

template <class Bonded>
Tick tick_bonded(const View& view, const Pose& pose) {
  Contact contact(view, 0);
  Bonded bonded(view, 0, pose, contact.tick(pose));
  return bonded.tick(pose);
}

}  // namespace

extern "C" {

Tick use_nothing(const void* bytes, std::size_t size, const Pose& pose) {
  const OpenResult opened = View::open(bytes, size);
  Contact contact(opened.view, 0);
  return contact.tick(pose, search(opened.view, 0, pose));
}

Vec3 use_LowPass(const Vec3& force) { return through(output::LowPass{80}, force); }
Vec3 use_RateLimit(const Vec3& force) { return through(output::RateLimit{80}, force); }
Vec3 use_Limit(const Vec3& force) { return through(output::Limit{3}, force); }
Vec3 use_OneAxis(const Vec3& force) { return through(output::OneAxis{{0, 0, 1}}, force); }
Vec3 use_TwoAxes(const Vec3& force) { return through(output::TwoAxes{{0, 0, 1}}, force); }
Vec3 use_PassivityController(const Vec3& force) {
  return through(output::PassivityController(output::PassivityOptions{}), force);
}
Vec3 use_DeviceFrame(const Vec3& force, const Pose& pose) {
  const DeviceFrame frame{pose, 2, 0.5};
  return frame.to_device(force + frame.to_scene(pose).translation);
}

Tick use_VirtualCoupling(const View& view, const Pose& pose) {
  Contact contact(view, 0);
  return VirtualCoupling(CouplingOptions()).tick(contact, pose, 1e-3);
}
Tick use_ContactSet(const View& view, const Pose& pose) { return ContactSet<3>(view, 0).tick(pose); }
Tick use_StiffnessScale(const View& view, const Pose& pose, SiteScales::Scale* memory) {
  SiteScales scales(view, memory);
  return Contact(view, 0).tick(pose, StiffnessScale<StillBody>{{&view}, &scales, &view});
}
Tick use_BondedContact(const View& view, const Pose& pose) { return tick_bonded<BondedContact>(view, pose); }
Tick use_BondedContact6D(const View& view, const Pose& pose) { return tick_bonded<BondedContact6D>(view, pose); }
Tick use_DeformingBody(const View& view, const Pose& pose, const Vec3* sites, void* memory) {
  DeformingSurface surface(view, memory);
  surface.set(sites, view.meta->site_count, 0.016);
  surface.advance(1e-3);
  return Contact(view, 0).tick(pose, DeformingBody{&surface});
}
Tick use_RigidMotion(const View& view, const Pose& pose) { return Contact(view, 0).tick(pose, RigidMotion{&view, pose}); }
double use_Mechanism(const Pose& pose) {
  Mechanism<1, 8> mechanism({HandleSpring{}});
  mechanism.add(trocar(0, Pose(), Side::ground({0, 0, 0.1})));
  return length(mechanism.tick({pose})[0].force);
}
bool use_TripleBuffer(TripleBuffer<Search>& latest, Search& found) {
  latest.write(found);
  return latest.read(found);
}
double use_EnergyMeter(const Pose& pose, const Tick& tick) {
  EnergyMeter meter;
  meter.add(pose, tick);
  return meter.given();
}
bool use_SuperpositionError(const View& view, const Tick& tick) {
  SuperpositionError error;
  error.add(tick, ContactRadius(view, 0), tick, ContactRadius(view, 0));
  return error.notable();
}

}  // extern "C"
