// SPDX-License-Identifier: GPL-3.0-or-later
// Opens a file and ticks with the features FEATURES alone: compiled with all and with none, and looked into.
#include "palpate/runtime.hpp"

using namespace palpate::runtime;

double lean(const void* bytes, std::size_t size, const Pose* poses, int count) {
  const OpenResult opened = View::open<FEATURES>(bytes, size);
  if (!opened) return -1;
  BasicContact<FEATURES> contact(opened.view, 0);
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += length(contact.tick(poses[i]).force);
  return sum;
}
