// SPDX-License-Identifier: MIT
// Two instruments at once, each with a Contact of its own: one presses, one presses and strokes: two_tools FILE.palp
#include <cstdio>

#include "palpate/mapped_file.hpp"
#include "palpate/runtime.hpp"

int main(int argc, char** argv) {
  using namespace palpate::runtime;
  if (argc != 2) return std::fprintf(stderr, "usage: two_tools FILE.palp\n"), 1;
  const MappedFile file(argv[1]);
  if (!file.ok()) return std::fprintf(stderr, "%s: %s\n", argv[1], file.error()), 4;
  const OpenResult opened = View::open(file.data(), file.size());
  if (!opened) return std::fprintf(stderr, "%s: %s\n", argv[1], opened.error), 2;

  const View& view = opened.view;
  const std::uint32_t tools[2] = {0, view.meta->tool_count - 1}, sites[2] = {0, view.meta->site_count - 1};
  Contact contacts[2] = {{view, tools[0]}, {view, tools[1]}};
  for (int tick = 0; tick <= 1000; ++tick) {  // 1 kHz: one second
    for (int hand = 0; hand < 2; ++hand) {
      const Vec3 up = to_vec(view.sites[sites[hand]].normal), c = to_vec(view.sites[sites[hand]].position);
      Pose pose = Pose::from_quaternion(1.000001 + up.z, -up.y, up.x, 0, c);  // the tool's z axis along the normal
      const double depth = 1e-6 * tick, aside = hand == 1 && tick > 500 ? 1e-5 * (tick - 500) : 0;  // m
      pose.translation = c + (view.tools[tools[hand]].probe_radius - depth) * up + aside * any_orthogonal(up);
      const Tick t = contacts[hand].tick(pose);
      if (tick % 200 == 0) std::printf("%s%4d ms: %.3f N", hand == 1 ? ", right " : "left ", tick, length(t.force));
      if (tick % 200 == 0 && hand == 1) std::printf(" (%s)\n", t.state == State::slide ? "slides" : "sticks");
    }
  }
}
