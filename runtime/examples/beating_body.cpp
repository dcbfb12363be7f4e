// SPDX-License-Identifier: MIT
// A body that beats against a tool at rest, its shapes given 60 times a second: beating_body FILE.palp
#include <cmath>
#include <cstdio>
#include <vector>

#include "palpate/format/mapped_file.hpp"
#include "palpate/palpate.hpp"

int main(int argc, char** argv) {
  using namespace palpate::runtime;
  if (argc != 2) return std::fprintf(stderr, "usage: beating_body FILE.palp\n"), 1;
  const MappedFile file(argv[1]);
  if (!file.ok()) return std::fprintf(stderr, "%s: %s\n", argv[1], file.error()), 4;
  const OpenResult opened = View::open(file.data(), file.size());
  if (!opened) return std::fprintf(stderr, "%s: %s\n", argv[1], opened.error), 2;

  const View& view = opened.view;
  std::vector<double> memory(DeformingSurface::bytes(view) / sizeof(double) + 1);
  DeformingSurface surface(view, memory.data());
  Contact contact(view, 0);
  const Vec3 up = to_vec(view.sites[0].normal), c = vertex(view, 0);
  const Pose tool{{1, 0, 0, 0, 1, 0, 0, 0, 1}, c + (view.tools[0].probe_radius + 1e-3) * up};  // 1 mm above it at rest
  std::vector<Vec3> sites(view.meta->site_count);
  for (int tick = 0; tick <= 1000; ++tick, surface.advance(1e-3)) {  // 1 kHz: a beat of a second
    const double size = 1 + 0.05 * (1 - std::cos(6.283185307179586e-3 * tick));
    for (std::uint32_t i = 0; i < sites.size(); ++i) sites[i] = size * vertex(view, i);
    const auto count = static_cast<std::uint32_t>(sites.size());
    if (tick % 16 == 0) {  // a host's own thread may do this
      if (const ShapeResult set = surface.set(sites.data(), count, 0.016); !set) return std::puts(set.error), 3;
    }
    const double force = length(contact.tick(tool, DeformingBody{&surface}).force);
    if (tick % 125 == 0) std::printf("%4d ms: %.3f times its size, %.3f N\n", tick, size, force);
  }
}
