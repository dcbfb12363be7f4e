// SPDX-License-Identifier: MIT
// A response file in a microcontroller's flash; neither heap nor files. Compile with -D RESPONSE_FILE='"FILE.palp"'
#include <cstdio>

#include "palpate/palpate.hpp"

__asm__(
    ".pushsection .rodata\n .balign 64\n .global file_begin, file_end\n"
    "file_begin: .incbin \"" RESPONSE_FILE "\"\nfile_end: .popsection");
extern "C" const unsigned char file_begin[], file_end[];

int main() {
  using namespace palpate::runtime;
  static const OpenResult opened = View::open(file_begin, static_cast<std::size_t>(file_end - file_begin));
  if (!opened) return std::printf("%s\n", opened.error), 2;
  const View& view = opened.view;
  static Contact contact(view, 0);
  static Search latest;
  const Vec3 up = to_vec(view.sites[0].normal), aside = any_orthogonal(up), c = vertex(view, 0);
  Pose pose = Pose::from_axis(c, up);  // the tool's handle points along the normal
  for (int tick = 0; tick <= 1000; ++tick) {
    const double depth = tick < 500 ? 4e-6 * tick - 2e-4 : 1.8e-3, way = tick < 500 ? 0 : 4e-6 * (tick - 500);  // m
    pose.translation = c + (view.tools[0].probe_radius - depth) * up + way * aside;  // a position sensor
    if (tick % 50 == 0) latest = search(view, 0, pose);  // the main loop, at 20 Hz, or as fast as it comes round
    const Tick t = contact.tick(pose, latest);           // a timer's interrupt, at 1 kHz; a TripleBuffer goes between
    if (tick % 100 == 0) std::printf("%4d ms: %.4f %.4f %.4f N\n", tick, t.force.x, t.force.y, t.force.z);  // motors
  }
}
