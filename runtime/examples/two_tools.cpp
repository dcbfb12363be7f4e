// SPDX-License-Identifier: MIT
// Two instruments at once: the left one presses, the right one strokes towards it and comes too near: two_tools
// FILE.palp
#include <array>
#include <cstdio>

#include "palpate/format/mapped_file.hpp"
#include "palpate/palpate.hpp"

int main(int argc, char** argv) {
  using namespace palpate::runtime;
  if (argc != 2) return std::fprintf(stderr, "usage: two_tools FILE.palp\n"), 1;
  const MappedFile file(argv[1]);
  if (!file.ok()) return std::fprintf(stderr, "%s: %s\n", argv[1], file.error()), 4;
  const OpenResult opened = View::open(file.data(), file.size());
  if (!opened) return std::fprintf(stderr, "%s: %s\n", argv[1], opened.error), 2;

  const View& view = opened.view;
  const std::array<std::uint32_t, 2> tools{0, view.meta->tool_count - 1};
  ToolSet<2> hands(view, tools);  // each has its own contact
  const Vec3 c = vertex(view, 0), aside = any_orthogonal(to_vec(view.sites[0].normal));
  // 1 kHz: one second.
  for (int ms = 0; ms <= 1000; ++ms) {
    const double scale = view.meta->depth_scale, from_c[2] = {0, (5 - 0.004 * ms) * scale};  // m
    std::array<Pose, 2> poses;
    for (int hand = 0; hand < 2; ++hand) {
      const Location place = closest_point(view, c + from_c[hand] * aside);
      const Vec3 up = smooth_normal(view, place.at);
      poses[hand] = Pose::from_axis(place.point + (view.tools[tools[hand]].probe_radius - 2e-4 * ms * scale) * up, up);
    }
    const std::array<Tick, 2> at = hands.tick(poses);
    if (ms % 200 != 0) continue;
    std::printf("%4d ms:", ms);  // of each handle its force, and the torque about the origin of its frame
    for (int hand = 0; hand < 2; ++hand) {
      const Tick& t = at[hand];
      std::printf(" %s %.3f N %.3f mN m", hand == 0 ? "left" : "right", length(t.force), 1e3 * length(t.torque));
    }
    const SuperpositionError& both = hands.superposition();  // each force is that of its tool alone
    if (both.notable()) std::printf(", near: the sum is up to %.0f %% too large", 100 * both.error);
    std::printf("\n");
  }
}
