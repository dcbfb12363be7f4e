// SPDX-License-Identifier: GPL-3.0-or-later
// Random contacts and their timing.
#include "tools/tick_bench.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <memory>
#include <random>
#include <thread>

#include "formats/error.hpp"

namespace palpate::cli {
namespace {

using runtime::BodyPoint;
using runtime::Contact;
using runtime::Pose;
using runtime::State;
using runtime::Tick;
using runtime::Vec3;

// A contact that was made, and poses that keep it in a state.
struct Case {
  std::unique_ptr<Contact> contact;
  std::vector<Pose> poses;
};

// Uniform over the area of the sampled part of the contact surface: patches of three sampled sites, or where there are
// none of one.
class RandomPoints {
public:
  explicit RandomPoints(const runtime::View& view) : view_(view) {
    sum_areas(3);
    if (empty()) sum_areas(1);
  }
  [[nodiscard]] bool empty() const { return !(sums_.back() > 0); }
  template <class Random>
  BodyPoint draw(Random& random) const {
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

private:
  void sum_areas(int least) {
    sums_.clear();
    double sum = 0;
    for (std::uint32_t t = 0; t < view_.meta->triangle_count; ++t) {
      int sampled = 0;
      for (const std::uint32_t site : view_.patches[view_.triangles[t].patch].vertex) {
        sampled += (view_.sites[site].flags & layout::site_outside) == 0 ? 1 : 0;
      }
      if (sampled >= least) sum += length(runtime::face_normal(view_, t));
      sums_.push_back(sum);
    }
  }

  const runtime::View& view_;
  std::vector<double> sums_;
};

// Rotation that takes the tool's direction `from` to `to` (unit): turns about the line between them.
Pose turned(const Vec3& from, const Vec3& to) {
  const Vec3 half = unit(from + to, runtime::any_orthogonal(from));
  return Pose::from_quaternion(0, half.x, half.y, half.z, {});
}

// A tool point that can touch and the outward direction there: the tip's rounding, or a vertex of the tool.
struct Feeler {
  Vec3 anchor, outward;
};

template <class Random>
Feeler draw_feeler(const runtime::View& view, std::uint32_t tool, Random& random) {
  const layout::ToolRecord& record = view.tools[tool];
  if (record.vertex_count == 1 || view.tool_vertices == nullptr) return {{0, 0, 0}, {0, 0, -1}};
  const std::uint32_t vertex = record.first_vertex + static_cast<std::uint32_t>(random() % record.vertex_count);
  const layout::ToolVertexRecord& v = view.tool_vertices[vertex];
  const Vec3 outward = unit(runtime::to_vec(v.normal), {0, 0, -1});
  return {runtime::to_vec(v.point) - static_cast<double>(record.probe_radius) * outward, outward};
}

// Presses in at a random place; false when something else touches first.
class Maker {
public:
  Maker(const runtime::View& view, const TickBenchOptions& options)
      : view_(view), options_(options), points_(view), random_(options.seed) {
    if (points_.empty()) throw Error(ExitCode::bad_input, "the response file has no sampled patch to press on");
  }

  // Empty cases where this attempt made no contact.
  void make(Case& press, Case& slide, Case& free) {
    const BodyPoint at = points_.draw(random_);
    const Vec3 c = position(view_, at), n = normal(view_, at);
    const Feeler feeler = draw_feeler(view_, options_.tool, random_);
    Pose pose = turned(feeler.outward, -n);
    const double probe = view_.tools[options_.tool].probe_radius, scale = view_.meta->depth_scale;
    const double depth = std::uniform_real_distribution<double>(0.2, 0.9)(random_) * scale;
    const auto at_height = [&](double height, const Vec3& aside) {
      pose.translation = c + (probe + height) * n + aside - pose.rotate(feeler.anchor);
      return pose;
    };
    auto contact = std::make_unique<Contact>(view_, options_.tool);
    Tick tick;
    for (double height = 0.5 * scale; height > -depth; height -= 0.01 * scale)
      tick = contact->tick(at_height(height, {}));
    if (tick.depth < 0.5 * depth || length(tick.body_point - c) > 0.5 * scale) return;
    const Vec3 aside = runtime::any_orthogonal(n);
    for (int i = 0; i < 16; ++i) press.poses.push_back(at_height(-depth + 1e-3 * scale * std::abs(i - 8), {}));
    for (int i = 0; i < 256; ++i) {
      slide.poses.push_back(at_height(-depth, 0.02 * scale * (i < 128 ? i : 256 - i) * aside));
    }
    for (int i = 0; i < 16; ++i) free.poses.push_back(at_height(4 * scale, 1e-3 * scale * i * aside));
    slide.contact = std::make_unique<Contact>(*contact);
    free.contact = std::make_unique<Contact>(view_, options_.tool);
    press.contact = std::move(contact);
  }

  BodyPoint point() { return points_.draw(random_); }

private:
  const runtime::View& view_;
  TickBenchOptions options_;
  RandomPoints points_;
  std::mt19937 random_;
};

// Keeps the times instead of printing them: processor time, for other programs must not count.
class Collector : public benchmark::BenchmarkReporter {
public:
  bool ReportContext(const Context& /*context*/) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (!run.error_occurred) nanoseconds.push_back(run.GetAdjustedCPUTime());
    }
  }
  std::vector<double> nanoseconds;
};

// Times `body` over its indices 0 .. count - 1.
TickTimes timed(std::size_t count, double seconds, const std::function<void(std::size_t, benchmark::State&)>& body) {
  benchmark::ClearRegisteredBenchmarks();
  for (std::size_t i = 0; i < count; ++i) {
    benchmark::RegisterBenchmark("tick", [&body, i](benchmark::State& state) { body(i, state); })->MinTime(seconds);
  }
  Collector collector;
  if (count > 0) benchmark::RunSpecifiedBenchmarks(&collector);
  benchmark::ClearRegisteredBenchmarks();
  std::sort(collector.nanoseconds.begin(), collector.nanoseconds.end());
  return {collector.nanoseconds};
}

TickTimes timed(std::vector<Case>& cases, double seconds) {
  return timed(cases.size(), seconds, [&](std::size_t i, benchmark::State& state) {
    Contact& contact = *cases[i].contact;
    const std::vector<Pose>& poses = cases[i].poses;
    std::size_t k = 0;
    for (const auto _ : state) {
      benchmark::DoNotOptimize(_);
      const Tick tick = contact.tick(poses[k]);
      benchmark::DoNotOptimize(tick);
      k = k + 1 < poses.size() ? k + 1 : 0;
    }
  });
}

}  // namespace

double TickTimes::quantile(double share) const {
  const auto last = static_cast<double>(nanoseconds.size() - 1);
  return nanoseconds[static_cast<std::size_t>(std::lround(share * last))];
}

TickBench bench_ticks(const runtime::View& view, const TickBenchOptions& options) {
  Maker maker(view, options);
  std::vector<Case> press, slide, free;
  std::vector<Vec3> near;
  const auto keep = [](std::vector<Case>& to, Case& made) {
    if (made.contact) to.push_back(std::move(made));
  };
  for (int tries = 0; tries < 20 * options.contacts && static_cast<int>(free.size()) < options.contacts; ++tries) {
    Case a, b, c;
    maker.make(a, b, c);
    keep(press, a);
    keep(slide, b);
    keep(free, c);
  }
  if (free.empty()) throw Error(ExitCode::bad_input, "the tool makes no contact with the sampled part of the body");
  for (int i = 0; i < 256; ++i) {
    const BodyPoint at = maker.point();
    near.push_back(position(view, at) + view.meta->depth_scale * normal(view, at));
  }
  TickBench result;
  result.contacts = static_cast<int>(free.size());
  result.press = timed(press, options.seconds);
  result.field = timed(press.size(), options.seconds, [&](std::size_t i, benchmark::State& state) {
    const runtime::Field& field = press[i].contact->field();
    std::vector<Vec3> deflections;
    const double scale = view.meta->depth_scale;
    const Vec3 aside = runtime::any_orthogonal(field.normal());
    for (int k = 0; k < 16; ++k) {
      deflections.push_back(4e-3 * scale * aside - (0.5 + 1e-3 * std::abs(k - 8)) * scale * field.normal());
    }
    std::size_t k = 0;
    for (const auto _ : state) {
      benchmark::DoNotOptimize(_);
      const runtime::FieldForce force = field.force(deflections[k]);
      benchmark::DoNotOptimize(force);
      k = k + 1 < deflections.size() ? k + 1 : 0;
    }
  });
  result.slide = timed(slide, options.seconds);
  result.free = timed(free, options.seconds);
  result.locate = timed(16, options.seconds, [&](std::size_t i, benchmark::State& state) {
    std::size_t k = i;
    for (const auto _ : state) {
      benchmark::DoNotOptimize(_);
      const runtime::Location found = locate(view, near[k]);
      benchmark::DoNotOptimize(found);
      k = (k + 1) % near.size();
    }
  });
  return result;
}

std::string machine_name() {
  std::ifstream info("/proc/cpuinfo");
  std::string line, name = "unknown processor";
  while (std::getline(info, line)) {
    if (line.rfind("model name", 0) != 0) continue;
    const std::size_t colon = line.find(": ");
    if (colon != std::string::npos) name = line.substr(colon + 2);
    break;
  }
  return name + ", " + std::to_string(std::thread::hardware_concurrency()) + " processors";
}

}  // namespace palpate::cli
