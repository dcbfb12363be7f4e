// SPDX-License-Identifier: GPL-3.0-or-later
// What a program may name beside a contact: a function for each, of which a linker keeps one. Compiled without
// inlining, so that whatever it calls has a symbol.
#include "palpate/palpate.hpp"

using namespace palpate::runtime;

namespace {

template <class Step>
Vec3 through(const Step& step, const Vec3& force) {
  return Output<Step>(step)(force, 1e-3, force);
}

template <class Held>
Tick hold(const View& view, const Pose& pose) {
  Contact contact(view, 0);
  Held held(view, 0, pose, contact.tick(pose));
  Tick tick;
  tick.force = held.tick(pose).force;
  return tick;
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
Vec3 use_Passivity(const Vec3& force) { return through(output::Passivity({}), force); }
Vec3 use_DeviceFrame(const Vec3& force, const Pose& pose) {
  const DeviceFrame frame{pose, 2, 0.5};
  return frame.to_device(force + frame.to_scene(pose).translation);
}

Tick use_VirtualCoupling(const View& view, const Pose& pose) {
  Contact contact(view, 0);
  return VirtualCoupling(CouplingOptions()).tick(contact, pose, 1e-3);
}
Tick use_SeveralContacts(const View& view, const Pose& pose) { return SeveralContacts<>(view, 0).tick(pose).each[0]; }
Tick use_ContactsAsOne(const View& view, const Pose& pose) { return ContactsAsOne<>(view, 0).tick(pose); }
Tick use_SeveralTools(const View& view, const Pose& pose) { return SeveralTools<1>(view, {0}).tick({pose})[0]; }
Tick use_AdjustedContact(const View& view, const Pose& pose, SiteScales::Scale* memory) {
  SiteScales scales(view, memory);
  return AdjustedContact(view, 0, scales).tick(pose, 1e-3);
}
Tick use_Grasp(const View& view, const Pose& pose) { return hold<Grasp>(view, pose); }
Tick use_TurningGrasp(const View& view, const Pose& pose) { return hold<TurningGrasp>(view, pose); }
Tick use_AnimatedContact(const View& view, const Pose& pose, void* memory) {
  AnimatedSurface surface(view, memory);
  return AnimatedContact(surface, 0).tick(pose);
}
Tick use_MovingContact(const View& view, const Pose& pose) { return MovingContact(view, 0).tick(pose, pose); }
bool use_Latest(Latest<Search>& latest, Search& found) {
  latest.write(found);
  return latest.read(found);
}
double use_EnergyMeter(const Pose& pose, const Tick& tick) {
  EnergyMeter meter;
  meter.add(pose, tick);
  return meter.given();
}

}  // extern "C"
