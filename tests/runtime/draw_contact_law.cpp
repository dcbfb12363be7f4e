// SPDX-License-Identifier: GPL-3.0-or-later
// draw_contact_law > contact-law.svg: the figure of the contact law, of a ball that is pressed into a block beside a
// groove, drawn across the groove at constant height, and lifted.
#include <cstdio>

#include "tests/runtime/support.hpp"
#include "tests/support/concave_samples.hpp"
#include "tools/play/plot.hpp"

namespace palpate::test {
namespace {

ConcaveShape groove() {
  for (const ConcaveShape& shape : concave_shapes()) {
    if (shape.name == "fissure") return shape;
  }
  return {};
}

std::string figure() {
  const Opened file(concave_content(groove()));
  runtime::Contact contact(file.view, 0);
  std::vector<double> travel;
  cli::PlotSeries normal{"along n", {}}, tangential{"across n", {}};
  cli::PlotSeries z{"indentation z", {}}, d{"counted depth d", {}};
  cli::PlotSeries q{"tool q", {}}, f{"closest point f", {}}, c{"body point c", {}};
  std::vector<cli::PlotSeries> layers;
  const int shown[] = {0, 4, 8, 11};
  for (const int k : shown) layers.push_back({"layer " + std::to_string(k + 1), {}});
  double gone = 0;
  Vec3 last{-0.016, 0, kTipRadius + 5e-4};
  const auto see = [&](const Pose& pose, const Tick& tick) {
    gone += length(pose.translation - last);
    last = pose.translation;
    travel.push_back(1e3 * gone);
    const double push = dot(tick.force, tick.normal);
    normal.values.push_back(push);
    tangential.values.push_back(length(tick.force - push * tick.normal));
    z.values.push_back(1e3 * tick.depth);
    d.values.push_back(1e3 * tick.counted_depth);
    const runtime::ContactState& state = contact.state();
    const double nowhere = std::nan("");
    q.values.push_back(1e3 * pose.translation.x);
    f.values.push_back(state.touching ? 1e3 * state.place.foot.point.x : nowhere);
    c.values.push_back(state.touching ? 1e3 * state.place.body_point.point.x : nowhere);
    for (std::size_t k = 0; k < layers.size(); ++k) {
      const runtime::Vec2 e = state.springs.layer[shown[k]].deflection;
      layers[k].values.push_back(state.touching ? 1e3 * std::hypot(e.x, e.y) : nowhere);
    }
  };
  const double deep = kTipRadius - 2e-3, free = kTipRadius + 5e-4, step = 1e-5;
  move(contact, last, {-0.016, 0, deep}, step, see);
  move(contact, {-0.016, 0, deep}, {0.016, 0, deep}, step, see);
  move(contact, {0.016, 0, deep}, {0.016, 0, free}, step, see);
  return cli::line_plot_svg("A press, a slide across a groove, a lift", "travel of the tool (mm)", travel,
                            {{"force (N)", {normal, tangential}},
                             {"depth (mm)", {z, d}},
                             {"x (mm)", {q, f, c}},
                             {"deflection (mm)", layers}});
}

}  // namespace
}  // namespace palpate::test

int main() { return std::fputs(palpate::test::figure().c_str(), stdout) < 0 ? 4 : 0; }
