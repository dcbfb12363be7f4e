// SPDX-License-Identifier: MIT
// A body that breathes against a tool at rest: moving_body FILE.palp
#include <cmath>
#include <cstdio>

#include "palpate/format/mapped_file.hpp"
#include "palpate/palpate.hpp"

int main(int argc, char** argv) {
  using namespace palpate::runtime;
  if (argc != 2) return std::fprintf(stderr, "usage: moving_body FILE.palp\n"), 1;
  const MappedFile file(argv[1]);
  if (!file.ok()) return std::fprintf(stderr, "%s: %s\n", argv[1], file.error()), 4;
  const OpenResult opened = View::open(file.data(), file.size());
  if (!opened) return std::fprintf(stderr, "%s: %s\n", argv[1], opened.error), 2;

  const View& view = opened.view;
  const Vec3 up = to_vec(view.sites[0].normal), c = vertex(view, 0);
  const Pose tool = Pose::from_axis(c + (view.tools[0].probe_radius + 1e-3) * up, up);  // 1 mm above the body at rest
  Contact contact(view, 0);
  for (int tick = 0; tick <= 4000; ++tick) {                                    // 1 kHz: one breath of 4 s
    const double lift = 1.5e-3 * (1 - std::cos(1.5707963267948966e-3 * tick));  // 0 to 3 mm
    const Pose body = Pose::from_quaternion(1, 0, 0, 0, lift * up);
    const Tick t = contact.tick(tool, RigidMotion{&view, body});  // in the world's frame
    if (tick % 500 == 0) std::printf("%4d ms: body at %.2f mm, force %.3f N\n", tick, 1e3 * lift, dot(t.force, up));
  }
}
