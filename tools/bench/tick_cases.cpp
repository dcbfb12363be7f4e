// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/tick_cases.hpp"

#include <algorithm>
#include <cmath>

#include "formats/io/error.hpp"

namespace palpate::cli {
namespace {

using runtime::BodyPoint;
using runtime::Contact;
using runtime::Pose;
using runtime::Tick;
using runtime::Vec3;

// Rotation that takes the tool's direction `from` to `to` (unit): turns about the line between them.
Pose turned(const Vec3& from, const Vec3& to) {
  const Vec3 half = unit(from + to, runtime::any_orthogonal(from));
  return Pose::from_quaternion(0, half.x, half.y, half.z, {});
}

// A tool point that can touch and the outward direction there: the tip's rounding, or a vertex of the tool.
struct Feeler {
  Vec3 anchor, outward;
};

Feeler draw_feeler(const runtime::View& view, std::uint32_t tool, std::mt19937& random) {
  const layout::ToolRecord& record = view.tools[tool];
  if (record.vertex_count == 1 || view.tool_vertices == nullptr) return {{0, 0, 0}, {0, 0, -1}};
  const std::uint32_t vertex = record.first_vertex + static_cast<std::uint32_t>(random() % record.vertex_count);
  const layout::ToolVertexRecord& v = view.tool_vertices[vertex];
  const Vec3 outward = unit(runtime::to_vec(v.normal), {0, 0, -1});
  return {runtime::to_vec(v.point) - static_cast<double>(record.probe_radius) * outward, outward};
}

// Presses in at a random place; nothing where something else touches first.
TickCases make(const runtime::View& view, std::uint32_t tool, const RandomPoints& points, std::mt19937& random) {
  const BodyPoint at = points.draw(random);
  const Vec3 c = position(view, at), n = smooth_normal(view, at);
  const Feeler feeler = draw_feeler(view, tool, random);
  Pose pose = turned(feeler.outward, -n);
  const double probe = view.tools[tool].probe_radius, scale = view.meta->depth_scale;
  const double depth = std::uniform_real_distribution<double>(0.2, 0.9)(random) * scale;
  const auto at_height = [&](double height, const Vec3& aside) {
    pose.translation = c + (probe + height) * n + aside - pose.rotate(feeler.anchor);
    return pose;
  };
  auto contact = std::make_unique<Contact>(view, tool);
  Tick tick;
  for (double height = 0.5 * scale; height > -depth; height -= 0.01 * scale)
    tick = contact->tick(at_height(height, {}));
  TickCases made;
  if (tick.depth < 0.5 * depth || length(tick.body_point - c) > 0.5 * scale) return made;
  const Vec3 aside = runtime::any_orthogonal(n);
  for (int i = 0; i < 16; ++i) made.press.poses.push_back(at_height(-depth + 1e-3 * scale * std::abs(i - 8), {}));
  for (int i = 0; i < 256; ++i) {
    made.slide.poses.push_back(at_height(-depth, 0.02 * scale * (i < 128 ? i : 256 - i) * aside));
  }
  for (int i = 0; i < 16; ++i) made.free.poses.push_back(at_height(4 * scale, 1e-3 * scale * i * aside));
  made.slide.contact = std::make_unique<Contact>(*contact);
  made.free.contact = std::make_unique<Contact>(view, tool);
  made.press.contact = std::move(contact);
  return made;
}

}  // namespace

RandomPoints::RandomPoints(const runtime::View& view) : view_(view) {
  sum_areas(3);
  if (empty()) sum_areas(1);
}

BodyPoint RandomPoints::draw(std::mt19937& random) const {
  std::uniform_real_distribution<double> unit(0, 1);
  const auto at = std::upper_bound(sums_.begin(), sums_.end(), unit(random) * sums_.back());
  const auto index = std::min<std::ptrdiff_t>(at - sums_.begin(), static_cast<std::ptrdiff_t>(sums_.size()) - 1);
  double a = unit(random), b = unit(random);
  if (a + b > 1) {
    a = 1 - a;
    b = 1 - b;
  }
  return {static_cast<std::uint32_t>(index), {a, b, 1 - a - b}};
}

void RandomPoints::sum_areas(int least) {
  sums_.clear();
  double sum = 0;
  for (std::uint32_t t = 0; t < view_.meta->triangle_count; ++t) {
    int sampled = 0;
    for (const std::uint32_t site : view_.triangle(t).site) {
      sampled += (view_.sites[site].flags & layout::site_outside) == 0 ? 1 : 0;
    }
    if (sampled >= least) sum += length(runtime::face_normal(view_, t));
    sums_.push_back(sum);
  }
}

std::vector<TickCases> random_contacts(const runtime::View& view, std::uint32_t tool, int count, std::uint32_t seed) {
  const RandomPoints points(view);
  if (points.empty()) throw Error(ExitCode::bad_input, "the response file has no sampled patch to press on");
  std::mt19937 random(seed);
  std::vector<TickCases> made;
  for (int tries = 0; tries < 20 * count && static_cast<int>(made.size()) < count; ++tries) {
    TickCases next = make(view, tool, points, random);
    if (next.press.contact) made.push_back(std::move(next));
  }
  if (made.empty()) throw Error(ExitCode::bad_input, "the tool makes no contact with the sampled part of the body");
  return made;
}

}  // namespace palpate::cli
