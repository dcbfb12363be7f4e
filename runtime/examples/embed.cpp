// SPDX-License-Identifier: MIT
// Pushes the file's first tool straight down on the body from above and prints the force: embed FILE.palp
#include <cstdio>

#include "palpate/mapped_file.hpp"
#include "palpate/runtime.hpp"

int main(int argc, char** argv) {
  using namespace palpate::runtime;
  if (argc != 2) return std::fprintf(stderr, "usage: embed FILE.palp\n"), 1;
  const MappedFile file(argv[1]);
  if (!file.ok()) return std::fprintf(stderr, "%s: %s\n", argv[1], file.error()), 4;
  const OpenResult opened = View::open(file.data(), file.size());  // validated once, here
  if (!opened) return std::fprintf(stderr, "%s: %s\n", argv[1], opened.error), 2;

  Contact contact(opened.view, 0);
  const Vec3 top = to_vec(opened.view.sites[0].position), up = to_vec(opened.view.sites[0].normal);
  for (int tick = 0; tick < 1000; ++tick) {  // 1 kHz: 15 mm to the body in one second
    const Pose pose{{1, 0, 0, 0, 1, 0, 0, 0, 1}, top + (0.010 - 15e-6 * tick) * up};
    const Tick t = contact.tick(pose);
    if (tick % 100 == 0) std::printf("%3d ms: depth %.2f mm, force %.3f N\n", tick, 1e3 * t.depth, length(t.force));
  }
}
