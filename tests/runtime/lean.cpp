// SPDX-License-Identifier: GPL-3.0-or-later
// Opens a file and ticks with the features FEATURES alone, without a virtual coupling. Compiled with all features and with
// none, for lean_symbols_test.cmake.
#include "palpate/contact/contact.hpp"
#include "palpate/format/open.hpp"
#include "palpate/output/virtual_coupling.hpp"

using namespace palpate::runtime;

// The same code twice: a rigid coupling costs nothing.
Tick directly(BasicContact<FEATURES>& contact, const Pose& pose, double) { return contact.tick(pose); }
Tick rigidly(BasicContact<FEATURES>& contact, const Pose& pose, double seconds) {
  return Rigid().tick(contact, pose, seconds);
}

double lean(const void* bytes, std::size_t size, const Pose* poses, int count) {
  const OpenResult opened = View::open<FEATURES>(bytes, size);
  if (!opened) return -1;
  BasicContact<FEATURES> contact(opened.view, 0);
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += length(contact.tick(poses[i]).force);
  return sum;
}
