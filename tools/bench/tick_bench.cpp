// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/tick_bench.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fstream>
#include <functional>
#include <memory>
#include <numeric>
#include <random>
#include <thread>

#include "tools/bench/tick_cases.hpp"

namespace palpate::cli {
namespace {

using runtime::BodyPoint;
using runtime::Contact;
using Blend = runtime::BlendedResponse<>;
using runtime::Pose;
using runtime::Tick;
using runtime::ToolPoint;
using runtime::Vec3;
using runtime::View;

// The measured function of a row is never inlined and has the row's name, by which tools/instructions.sh finds it.
namespace row {
struct press {};
struct field {};
struct slide {};
struct free {};
struct locate {};
struct blend {};
struct anew {};
struct random {};
struct five {};
struct joint {};
struct plain {};
struct network {};
}  // namespace row
template <class Row, class Once>
[[gnu::noinline]] auto measured(const Once& once, std::size_t i, std::size_t k) {
  return once(i, k);
}

Vec3 build_and_push(const View& view, std::uint32_t tool, const BodyPoint& at, const ToolPoint& on, Blend& blend) {
  blend.blend(view, tool, at, on, {1, 0, 0}, {});
  return blend.force((-0.5 * view.meta->depth_scale) * blend.normal());
}

// Keeps the times of repetitions instead of printing them: processor time, for other programs must not count.
class Collector : public benchmark::BenchmarkReporter {
public:
  bool ReportContext(const Context& /*context*/) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.run_type == Run::RT_Iteration && !run.error_occurred) nanoseconds.push_back(run.GetAdjustedCPUTime());
    }
  }
  std::vector<double> nanoseconds;
};

// Means of so many blocks of so many calls each, the k-th call of once(i, k).
template <class Row, class Once>
std::vector<double> blocks(std::size_t calls, int count, const Once& once, std::size_t i, std::size_t& k) {
  const auto block = [&](benchmark::State& state) {
    std::size_t next = k;
    for (const auto _ : state) {
      benchmark::DoNotOptimize(_);
      const auto answer = measured<Row>(once, i, next++);
      benchmark::DoNotOptimize(answer);
    }
    k = next;
  };
  const auto iterations = static_cast<benchmark::IterationCount>(calls);
  benchmark::RegisterBenchmark("tick", block)->Iterations(iterations)->Repetitions(count);
  Collector collector;
  benchmark::RunSpecifiedBenchmarks(&collector);
  benchmark::ClearRegisteredBenchmarks();
  return collector.nanoseconds;
}

// After how many calls a row has been everywhere it goes, or at enough random places for their mean.
constexpr std::size_t kRound = 256, kRandomRound = 1U << 13;

// Times once(i, k) over the indices i = 0 .. count - 1, each for k = 0, 1, ...: in blocks of whole rounds, long beside
// the reading of the clock and short beside what others on the machine do.
template <class Row, class Once>
TickTimes timed(Row /*row*/, std::size_t count, double seconds, const Once& once, std::size_t round = kRound) {
  constexpr double kBlockNanoseconds = 3e4, kFewest = 3, kMost = 1e6;
  TickTimes times;
  std::vector<double> means;
  for (std::size_t i = 0; i < count; ++i) {
    std::size_t k = 0;
    const double warm = std::max(1.0, static_cast<double>(round) * blocks<Row>(round, 1, once, i, k).front());
    const double rounds = std::ceil(std::clamp(kBlockNanoseconds / warm, 1.0, kMost));
    const double repetitions = std::clamp(1e9 * seconds / (rounds * warm), kFewest, kMost);
    const std::vector<double> block =
        blocks<Row>(static_cast<std::size_t>(rounds) * round, static_cast<int>(repetitions), once, i, k);
    times.nanoseconds.push_back(*std::min_element(block.begin(), block.end()));
    means.push_back(std::accumulate(block.begin(), block.end(), 0.0) / static_cast<double>(block.size()));
  }
  std::sort(times.nanoseconds.begin(), times.nanoseconds.end());
  std::sort(means.begin(), means.end());
  times.mean = means[means.size() / 2];
  return times;
}

// The k-th of them, round and round. They are a power of two, for a division would be timed as well.
template <class T>
const T& around(const std::vector<T>& all, std::size_t k) {
  return all[k & (all.size() - 1)];
}
// A count known at compile time, because the modulus of a vector's size would need a division.
constexpr std::size_t kFew = 16;
template <class T>
const T& around(const std::array<T, kFew>& all, std::size_t k) {
  return all[k % kFew];
}

Tick next_tick(TickCase& of, std::size_t k) { return of.contact->tick(around(of.poses, k)); }

// Deflections about half the depth scale, a little aside.
std::array<Vec3, kFew> deflections(const View& view, const Vec3& n) {
  std::array<Vec3, kFew> all;
  const double scale = view.meta->depth_scale;
  for (int k = 0; k < static_cast<int>(kFew); ++k) {
    all[k] = 4e-3 * scale * runtime::any_orthogonal(n) - (0.5 + 1e-3 * std::abs(k - 8)) * scale * n;
  }
  return all;
}

// A contact's point of its tool, moved to the middle of its patch: all vertices of that are interpolated between.
ToolPoint amid_patch(const View& view, std::uint32_t tool, ToolPoint on) {
  if (view.tool_patches == nullptr || view.tools[tool].vertex_count == 1) return on;
  const bool profile = view.tools[tool].kind == static_cast<std::uint32_t>(layout::ToolKind::profile);
  for (int l = 0; l < 3; ++l) on.weights[l] = profile ? (l < 2 ? 0.5 : 0) : 1.0 / 3;
  return on;
}

// Points of the triangle about its middle, as c passes them.
std::array<BodyPoint, kFew> within_triangle(std::uint32_t triangle) {
  std::array<BodyPoint, kFew> all;
  for (int k = 0; k < static_cast<int>(kFew); ++k) {
    const double aside = 0.01 * std::abs(k - 8);
    all[k] = {triangle, {0.3 + aside, 0.36, 0.34 - aside}};
  }
  return all;
}

// F = sum over the patches' corners of weight times force: Mahvash and Hayward, IEEE CG&A 24(2), 2004.
class Plain {
public:
  Plain(const View& view, std::uint32_t tool, const BodyPoint& at, const ToolPoint& on) {
    double body[3];
    runtime::site_weights(view, at, body);
    const auto& sites = view.triangle(at.triangle).site;
    for (int k = 0; k < 3; ++k) {
      const BodyPoint site = closest_point(view, vertex(view, sites[k])).at;
      for (int l = 0; l < 3; ++l) {
        if (!(on.weights[l] > 0)) continue;
        ToolPoint vertex = on;
        for (int m = 0; m < 3; ++m) vertex.weights[m] = m == l ? 1 : 0;
        responses_.emplace_back().blend(view, tool, site, vertex, {1, 0, 0}, {});
        weights_.push_back(body[k] * on.weights[l]);
      }
    }
  }
  [[nodiscard]] Vec3 force(const Vec3& deflection) const {
    Vec3 sum;
    for (std::size_t i = 0; i < weights_.size(); ++i) sum = sum + weights_[i] * responses_[i].force(deflection);
    return sum;
  }

private:
  std::vector<Blend> responses_;
  std::vector<double> weights_;
};

// F = sum of weights phi(|q - centre|), the multiquadric (Hardy 1971), in the 32-bit numbers of a file.
class Network {
public:
  explicit Network(std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> draw(-1, 1);
    for (Centre& c : centres_) {
      for (float* value : {&c.x, &c.y, &c.z, &c.fx, &c.fy, &c.fz}) *value = draw(random);
    }
  }
  [[nodiscard]] Vec3 force(const Vec3& q) const {
    constexpr float kBreadth2 = 0.01F;
    const auto x = static_cast<float>(q.x), y = static_cast<float>(q.y), z = static_cast<float>(q.z);
    float fx = 0, fy = 0, fz = 0;
    for (const Centre& c : centres_) {
      const float phi = std::sqrt((x - c.x) * (x - c.x) + (y - c.y) * (y - c.y) + (z - c.z) * (z - c.z) + kBreadth2);
      fx += phi * c.fx;
      fy += phi * c.fy;
      fz += phi * c.fz;
    }
    return {fx, fy, fz};
  }

private:
  struct Centre {
    float x, y, z, fx, fy, fz;
  };
  std::vector<Centre> centres_ = std::vector<Centre>(1000);
};

// Strokes of one contact after the other, over and over until so many ticks are timed, one by one.
EveryTick every_tick(std::vector<TickCases>& cases, std::uint64_t ticks) {
  EveryTick times;
  times.all.nanoseconds.reserve(ticks);
  std::vector<double>& least = times.undisturbed.nanoseconds;
  while (times.all.nanoseconds.size() < ticks) {
    std::size_t place = 0;  // of the tick among those of all strokes
    for (TickCases& of : cases) {
      const Pose in = of.slide.poses.front(), out = of.free.poses.front();
      Contact& contact = *of.free.contact;
      const auto timed_tick = [&](const Pose& pose) {
        if (times.all.nanoseconds.size() == ticks) return;
        const auto begun = std::chrono::steady_clock::now();
        const Tick tick = contact.tick(pose);
        benchmark::DoNotOptimize(tick);
        const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - begun;
        times.all.nanoseconds.push_back(took.count());
        if (place == least.size()) least.push_back(took.count());
        least[place] = std::min(least[place], took.count());
        ++place;
      };
      constexpr int kApproach = 256;
      Pose pose = in;
      const auto approach = [&](double share) {
        pose.translation = out.translation + share * (in.translation - out.translation);
        timed_tick(pose);
      };
      for (int k = 0; k < kApproach; ++k) approach(static_cast<double>(k) / kApproach);
      for (const Pose& aside : of.slide.poses) timed_tick(aside);
      for (int k = kApproach; k > 0; --k) approach(static_cast<double>(k) / kApproach);
      timed_tick(out);
    }
  }
  for (Times* sorted : {&times.all, &times.undisturbed}) {
    std::sort(sorted->nanoseconds.begin(), sorted->nanoseconds.end());
  }
  return times;
}

}  // namespace

double Times::quantile(double share) const {
  const auto last = static_cast<double>(nanoseconds.size() - 1);
  return nanoseconds[static_cast<std::size_t>(std::lround(share * last))];
}

namespace {

/// Five of the pressed contacts in one set, which has pressed them from outside.
class Hand {
public:
  Hand(const View& view, std::uint32_t tool, const std::array<TickCase*, 5>& fingers)
      : fingers_(fingers),
        tools_(std::make_unique<runtime::ToolSet<5>>(view, std::array{tool, tool, tool, tool, tool})) {
    constexpr int kSteps = 200;
    for (int step = 0; step <= kSteps; ++step) {
      const double above = 2 * view.meta->depth_scale * (1 - static_cast<double>(step) / kSteps);
      std::array<Pose, 5> poses;
      for (std::size_t k = 0; k < poses.size(); ++k) {
        poses[k] = fingers_[k]->poses.front();
        poses[k].translation = poses[k].translation + above * fingers_[k]->contact->state().place.normal;
      }
      tools_->tick(poses);
    }
  }
  Vec3 tick(std::size_t tick) {
    std::array<Pose, 5> poses;
    for (std::size_t k = 0; k < poses.size(); ++k) poses[k] = around(fingers_[k]->poses, tick);
    Vec3 sum;
    for (const Tick& each : tools_->tick(poses)) sum = sum + each.force;
    return sum;
  }

private:
  std::array<TickCase*, 5> fingers_;
  std::unique_ptr<runtime::ToolSet<5>> tools_;
};

}  // namespace

TickBench bench_ticks(const View& view, const TickBenchOptions& options) {
  std::vector<TickCases> cases = random_contacts(view, options.tool, options.contacts, options.seed);
  std::vector<std::array<Vec3, kFew>> pushed;
  std::vector<Blend> fields;
  for (TickCases& c : cases) {
    const Tick touched = next_tick(c.press, 0);
    fields.emplace_back().blend(view, options.tool, touched.at, amid_patch(view, options.tool, touched.on_tool.at),
                               {1, 0, 0}, {});
    pushed.push_back(deflections(view, fields.back().normal()));
  }
  const RandomPoints points(view);
  std::mt19937 random(options.seed);
  std::vector<Vec3> near;
  for (int i = 0; i < 256; ++i) {
    const BodyPoint at = points.draw(random);
    near.push_back(position(view, at) + view.meta->depth_scale * smooth_normal(view, at));
  }
  const auto each = [&](auto row, const auto& once) { return timed(row, cases.size(), options.seconds, once); };
  TickBench result;
  result.contacts = static_cast<int>(cases.size());
  result.press = each(row::press(), [&](std::size_t i, std::size_t k) { return next_tick(cases[i].press, k); });
  result.field =
      each(row::field(), [&](std::size_t i, std::size_t k) { return fields[i].force(around(pushed[i], k)); });
  result.slide = each(row::slide(), [&](std::size_t i, std::size_t k) { return next_tick(cases[i].slide, k); });
  result.free = each(row::free(), [&](std::size_t i, std::size_t k) { return next_tick(cases[i].free, k); });
  result.locate = timed(row::locate(), 16, options.seconds,
                        [&](std::size_t i, std::size_t k) { return closest_point(view, around(near, i + k)); });
  return result;
}

LatencyBench bench_latency(const View& view, const View& large, const TickBenchOptions& options, std::uint64_t ticks) {
  std::vector<TickCases> cases = random_contacts(view, options.tool, options.contacts, options.seed);
  std::vector<std::array<BodyPoint, kFew>> sliding;
  std::vector<ToolPoint> on_tool;
  std::vector<Plain> plain;
  std::vector<std::array<Vec3, kFew>> pushed;
  for (TickCases& c : cases) {
    const Tick touched = next_tick(c.press, 0);
    sliding.push_back(within_triangle(touched.at.triangle));
    on_tool.push_back(amid_patch(view, options.tool, touched.on_tool.at));
    plain.emplace_back(view, options.tool, touched.at, on_tool.back());
    pushed.push_back(deflections(view, c.press.contact->response().normal()));
  }
  constexpr std::size_t kPlaces = 1U << 19;  // far more than a cache holds of a large file
  std::mt19937 random(options.seed);
  const auto drawn = [&](const View& of, std::size_t count) {
    const RandomPoints points(of);
    std::vector<BodyPoint> places(count);
    for (BodyPoint& place : places) place = points.draw(random);
    return places;
  };
  const std::vector<BodyPoint> places = drawn(large, kPlaces), few = drawn(view, kFew);
  const Network network(options.seed);
  std::vector<std::size_t> first;  // of the places
  std::vector<std::array<TickCase*, 5>> hands(cases.size());
  for (std::size_t i = 0; i < cases.size(); ++i) {
    first.push_back(i * kPlaces / cases.size());
    for (std::size_t finger = 0; finger < hands[i].size(); ++finger) {
      hands[i][finger] = &cases[(i + finger) % cases.size()].press;
    }
  }
  Blend field;
  const auto each = [&](auto row, const auto& once, std::size_t round = kRound) {
    return timed(row, cases.size(), options.seconds, once, round);
  };
  LatencyBench result;
  result.responses = 3 * runtime::tool_corners(view, options.tool, on_tool.front()).count;
  result.blend = each(row::blend(), [&](std::size_t i, std::size_t k) {
    return build_and_push(view, options.tool, around(sliding[i], k), on_tool[i], field);
  });
  result.anew = each(row::anew(), [&](std::size_t i, std::size_t k) {
    return build_and_push(view, options.tool, around(few, k), on_tool[i], field);
  });
  result.random = each(
      row::random(),
      [&](std::size_t i, std::size_t k) {
        return build_and_push(large, options.tool, around(places, first[i] + k), on_tool[i], field);
      },
      kRandomRound);
  result.five = each(row::five(), [&](std::size_t i, std::size_t k) {
    Vec3 sum;
    for (TickCase* finger : hands[i]) sum = sum + next_tick(*finger, k).force;
    return sum;
  });
  std::vector<Hand> sets;
  for (const auto& fingers : hands) sets.emplace_back(view, options.tool, fingers);
  result.joint = each(row::joint(), [&](std::size_t i, std::size_t k) { return sets[i].tick(k); });
  result.plain = each(row::plain(), [&](std::size_t i, std::size_t k) { return plain[i].force(around(pushed[i], k)); });
  result.network =
      each(row::network(), [&](std::size_t i, std::size_t k) { return network.force(around(pushed[i], k)); });
  result.every = every_tick(cases, ticks);
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
