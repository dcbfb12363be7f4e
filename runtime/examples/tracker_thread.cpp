// SPDX-License-Identifier: MIT
// Forces at 1 kHz in one thread, searches as they come in another; neither waits for the other: tracker_thread
// FILE.palp
#include <atomic>
#include <chrono>
#include <cstdio>
#include <thread>

#include "palpate/format/mapped_file.hpp"
#include "palpate/palpate.hpp"

int main(int argc, char** argv) {
  using namespace palpate::runtime;
  if (argc != 2) return std::fprintf(stderr, "usage: tracker_thread FILE.palp\n"), 1;
  const MappedFile file(argv[1]);
  if (!file.ok()) return std::fprintf(stderr, "%s: %s\n", argv[1], file.error()), 4;
  const OpenResult opened = View::open(file.data(), file.size());
  if (!opened) return std::fprintf(stderr, "%s: %s\n", argv[1], opened.error), 2;

  const View& view = opened.view;
  const Vec3 up = to_vec(view.sites[0].normal), c = vertex(view, 0);
  Pose pose = Pose::from_axis(c, up);  // the tool's handle points along the normal
  TripleBuffer<Pose> poses;            // to the tracker
  TripleBuffer<Search> searches;       // and back
  std::atomic<bool> stop{false};
  std::thread tracker([&] {
    Search last = search(view, 0, {});  // each search begins where the last one saw the body
    for (Pose seen; !stop; std::this_thread::sleep_for(std::chrono::milliseconds(5))) {
      if (poses.read(seen)) searches.write(last = search(view, 0, seen, last.touch.body.at));
    }
  });
  Contact contact(view, 0);
  Search latest = search(view, 0, pose);
  auto next = std::chrono::steady_clock::now();
  for (int tick = 0; tick <= 500; ++tick) {
    pose.translation = c + (view.tools[0].probe_radius + 3e-4 - 4e-6 * tick) * up;
    poses.write(pose);
    searches.read(latest);
    const Tick t = contact.tick(pose, latest);
    if (tick % 100 == 0) std::printf("%3d ms: %.3f N\n", tick, length(t.force));
    std::this_thread::sleep_until(next += std::chrono::milliseconds(1));
  }
  stop = true;
  tracker.join();
}
