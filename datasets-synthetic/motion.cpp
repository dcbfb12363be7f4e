// SPDX-License-Identifier: GPL-3.0-or-later
// Motions as smooth steps between places: position and velocity are continuous, as a hand's are.
#include "datasets-synthetic/motion.hpp"

#include "precompute/algebra/rotation_between.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace palpate::synth {

namespace {

/// From 0 to 1 over [0, 1] with zero speed and acceleration at both ends (minimum jerk).
double smooth_step(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * t * (10 + t * (6 * t - 15));
}

/// Rotation that turns the tool's handle axis (+z) into `normal`.
Eigen::Quaterniond orientation(const Eigen::Vector3d& normal) {
  return algebra::rotation_between(Eigen::Vector3d::UnitZ(), normal).normalized();
}

class Rows {
public:
  explicit Rows(double rate) : rate_(rate) {}

  [[nodiscard]] double time() const { return static_cast<double>(count_) / rate_; }

  /// One row: the tip's pole at `tip`, the handle along `normal`.
  void add(const Eigen::Vector3d& tip, const Eigen::Vector3d& normal, double tip_offset) {
    const Eigen::Vector3d origin = tip + tip_offset * normal;
    const Eigen::Quaterniond q = orientation(normal);
    std::array<char, 256> line{};
    // "+ 0.0" turns a negative zero into zero.
    const int length =
        std::snprintf(line.data(), line.size(), "%.6f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f\n", time(), origin.x() + 0.0,
                      origin.y() + 0.0, origin.z() + 0.0, q.w() + 0.0, q.x() + 0.0, q.y() + 0.0, q.z() + 0.0);
    text_.append(line.data(), static_cast<std::size_t>(length));
    ++count_;
  }

  [[nodiscard]] std::string text() const { return text_; }

private:
  double rate_;
  std::size_t count_ = 0;
  std::string text_ = "t,x,y,z,qw,qx,qy,qz\n";
};

/// A place relative to a site: height along its normal and distance along its surface, reached at a time.
struct Key {
  double time, height, tangential;
};

}  // namespace

std::string probe_motion(const Site& site, const MotionOptions& options) {
  const Eigen::Vector3d side =
      (Eigen::Vector3d::UnitX() - site.normal * site.normal.x()).normalized();  // along x, in the tangent plane
  const std::array<Key, 8> keys{{{0.0, options.clearance, 0},
                                 {0.7, 0, 0},
                                 {1.3, -options.depth, 0},
                                 {1.5, -options.depth, 0},
                                 {1.8, -options.depth, options.tangential},
                                 {2.0, -options.depth, options.tangential},
                                 {2.3, -options.depth, 0},
                                 {3.0, options.clearance, 0}}};
  Rows rows(options.rate);
  std::size_t next = 1;
  while (rows.time() <= keys.back().time) {
    while (next + 1 < keys.size() && rows.time() > keys[next].time) ++next;
    const Key &from = keys[next - 1], &to = keys[next];
    const double share = smooth_step((rows.time() - from.time) / (to.time - from.time));
    const double height = from.height + share * (to.height - from.height);
    const double tangential = from.tangential + share * (to.tangential - from.tangential);
    rows.add(site.point + height * site.normal + tangential * side, site.normal, options.tip_offset);
  }
  return rows.text();
}

std::string scan_motion(const std::vector<Site>& sites, const MotionOptions& options) {
  constexpr double speed = 0.02, approach_time = 0.7;
  std::vector<double> begins{0.0};  // length of the path up to each site
  for (std::size_t i = 1; i < sites.size(); ++i) {
    begins.push_back(begins.back() + (sites[i].point - sites[i - 1].point).norm());
  }
  // The smooth step is up to 1.875 times as fast as its mean.
  const double scan_time = std::max(1.0, 1.875 * begins.back() / speed);
  Rows rows(options.rate);
  while (rows.time() <= 2 * approach_time + scan_time) {
    const double t = rows.time();
    const double along = begins.back() * smooth_step((t - approach_time) / scan_time);
    const auto after = std::upper_bound(begins.begin() + 1, begins.end() - 1, along);
    const auto i = static_cast<std::size_t>(after - begins.begin());
    const double share = (along - begins[i - 1]) / (begins[i] - begins[i - 1]);
    const Eigen::Vector3d point = sites[i - 1].point + share * (sites[i].point - sites[i - 1].point);
    const Eigen::Vector3d normal = (sites[i - 1].normal + share * (sites[i].normal - sites[i - 1].normal)).normalized();
    const double down = smooth_step(t / approach_time) - smooth_step((t - approach_time - scan_time) / approach_time);
    const double height = options.clearance - down * (options.clearance + options.depth / 2);
    rows.add(point + height * normal, normal, options.tip_offset);
  }
  return rows.text();
}

}  // namespace palpate::synth
