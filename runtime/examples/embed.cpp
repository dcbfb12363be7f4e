// SPDX-License-Identifier: MIT
// Presses the first tool straight down on a solved site, to its depth limit: embed FILE.palp
#include <cstdio>

#include "palpate/format/mapped_file.hpp"
#include "palpate/palpate.hpp"

int main(int argc, char** argv) {
  using namespace palpate::runtime;
  if (argc != 2) return std::fprintf(stderr, "usage: embed FILE.palp\n"), 1;
  const MappedFile file(argv[1]);
  if (!file.ok()) return std::fprintf(stderr, "%s: %s\n", argv[1], file.error()), 4;
  const OpenResult opened = View::open(file.data(), file.size());  // validated once, here
  if (!opened) return std::fprintf(stderr, "%s: %s\n", argv[1], opened.error), 2;

  const View& view = opened.view;
  std::uint32_t site = 0;  // the first that was solved: others were filled from neighbours
  const auto head = [&] { return view.response_head(response_index(*view.meta, site, 0)); };
  while (head().flags == palpate::layout::response_filled && site + 1 < view.meta->site_count) ++site;
  const Vec3 up = to_vec(view.sites[site].normal), c = vertex(view, site);
  Pose pose = Pose::from_axis(c, up);  // the tool's handle points along the normal
  pose.translation = c - search(view, 0, pose).touch.clearance * up;  // the tool just touches
  Contact contact(view, 0);
  for (int tick = 0; tick <= 1000; ++tick, pose.translation = pose.translation - 0.001 * head().depth_limit * up) {
    const Tick t = contact.tick(pose);  // 1 kHz: one second
    if (tick % 100 == 0)
      std::printf("%4d ms: depth %.2f mm, force %.3f N%s\n", tick, 1e3 * t.depth, length(t.force),
                  t.extrapolated ? ", beyond what was sampled" : "");
  }
}
