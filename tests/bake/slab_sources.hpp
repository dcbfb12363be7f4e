// SPDX-License-Identifier: GPL-3.0-or-later
// A slab whose responses are recorded or follow a closed form, and rows that a tool on it might record.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "formats/io/error.hpp"
#include "palpate/format/open.hpp"
#include "palpate/response/interpolation.hpp"
#include "precompute/pipeline/pipeline.hpp"
#include "precompute/pipeline/sources.hpp"
#include "tests/support/slab.hpp"
#include "tests/support/temporary_folder.hpp"

namespace palpate::test {

using pipeline::Pipeline;
using runtime::Vec3;

inline constexpr double kDepth = 0.002, kRadius = 0.005, kYoung = 5000, kPoisson = 0.49;

inline Vec3 vec(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

struct Opened {
  std::vector<std::byte> bytes;
  runtime::View view;
  explicit Opened(std::vector<std::byte> b) : bytes(std::move(b)) {
    const runtime::OpenResult opened = runtime::View::open(bytes.data(), bytes.size());
    EXPECT_TRUE(opened) << opened.error;
    view = opened.view;
  }
  Opened(const Opened&) = delete;
  Opened& operator=(const Opened&) = delete;

  [[nodiscard]] std::size_t count(std::uint32_t flags) const {
    std::size_t n = 0;
    for (std::uint32_t k = 0; k < view.meta->response_count; ++k) n += view.response_head(k).flags == flags ? 1 : 0;
    return n;
  }
  /// Force (body frame) of the first tool at a site.
  [[nodiscard]] Vec3 force(const bake::PlanSite& site, const Vec3& deflection) const {
    return force(site, 0, deflection);
  }
  [[nodiscard]] Vec3 force(const bake::PlanSite& site, std::uint32_t tool, const Vec3& deflection) const {
    runtime::BlendedResponse<> response;
    response.blend(view, tool, closest_point(view, vec(site.frame.origin)).at, {}, {1, 0, 0}, nullptr);
    return response.force(deflection);
  }
  [[nodiscard]] nlohmann::json provenance() const {
    return nlohmann::json::parse(std::string(view.provenance, view.provenance_size));
  }
};

/// A slab of 60 x 60 x 20 mm that is touched at a few sites in the middle of its top.
class Sources : public testing::Test {
protected:
  Sources() { folder_.write("slab.off", kSlabOff); }

  [[nodiscard]] std::filesystem::path write_scene(const std::string& more, const std::string& tool) const {
    return folder_.write("slab.toml", R"([body]
surface = "slab.off"
[material]
young = 5000
[[support]]
half_space = {point = [0, 0, 0.0001], normal = [0, 0, 1]}
[sampling]
spacing = 0.012
depth = 0.002
normal_points = 6
within_box = {min = [-0.013, -0.013, 0.019], max = [0.013, 0.013, 0.021]}
[solver]
mesh_size = 0.7
[[tool]]
)" + tool + more);
  }

  [[nodiscard]] Pipeline open(const std::string& more, const std::string& recording = {},
                              const std::string& tool = "radius = 0.005\n") const {
    const auto file = write_scene(more, tool);
    std::vector<std::filesystem::path> measured;
    if (!recording.empty()) measured.push_back(folder_.write("recording.csv", recording));
    Pipeline p = pipeline::prepare(file, {folder_.path() / "work", folder_.path() / "slab.palp", measured});
    pipeline::plan(p);
    return p;
  }

  static Opened fitted(const Pipeline& p) {
    pipeline::fit(p);
    return Opened(read_bytes(p.paths.response));
  }

  /// The message of a bad input.
  template <class Action>
  static std::string message_of(const Action& action) {
    try {
      action();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::bad_input) << error.what();
      return error.what();
    }
    return "took it without complaint";
  }

  TemporaryFolder folder_;
};

/// Must never be called.
inline PairResult no_solver(const PairPlan& /*pair*/, const solve::SampleSink& /*sink*/) {
  ADD_FAILURE() << "nothing has to be solved";
  return {};
}

struct Row {
  Eigen::Vector3d deflection, force;  // body frame
};

inline std::string csv(const Eigen::Vector3d& point, const std::vector<Row>& rows) {
  std::string text = "# made by a test\nx,y,z,dx,dy,dz,fx,fy,fz\n";
  for (const Row& r : rows) {
    char line[300];
    std::snprintf(line, sizeof line, "%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", point.x(), point.y(), point.z(),
                  r.deflection.x(), r.deflection.y(), r.deflection.z(), r.force.x(), r.force.y(), r.force.z());
    text += line;
  }
  return text;
}

inline double hertz(double d) { return 4.0 / 3 * kYoung / (1 - kPoisson * kPoisson) * std::sqrt(kRadius * d) * d; }

/// Normal indentations down the middle of the slab's top, harder by `factor` than Hertz's.
inline std::vector<Row> pushes(double factor, int count = 60, double deepest = kDepth) {
  std::vector<Row> rows;
  for (int k = 1; k <= count; ++k) {
    const double d = deepest * k / count;
    rows.push_back({{0, 0, -d}, {0, 0, factor * hertz(d)}});
  }
  return rows;
}

inline std::uint32_t nearest_pair(const Pipeline& p, const Eigen::Vector3d& point) {
  std::uint32_t best = 0;
  for (std::uint32_t k = 0; k < p.plan.pairs.size(); ++k) {
    const auto far = [&](std::uint32_t pair) { return (p.plan.pairs[pair].frame.origin - point).norm(); };
    if (far(k) < far(best)) best = k;
  }
  return best;
}

}  // namespace palpate::test
