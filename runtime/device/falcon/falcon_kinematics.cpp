// SPDX-License-Identifier: MIT
#include "device/falcon/falcon_kinematics.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::device::falcon {
namespace {

// Lengths in m, named as in the documents.
constexpr double a = 0.060;                 // lower link
constexpr double b = 0.1025;                // parallelogram
constexpr double c = 0.01443;               // grip's centre to the forearm, along the arm's plane
constexpr double d = 0.01125, e = 0.01125;  // parallelogram's ends to the hinges
constexpr double f = -0.025, r = 0.040, s = -0.02309;

constexpr double kRadians = 0.017453292519943295;  // of a degree
constexpr double kZeroAngle = 35 * kRadians, kPerStep = 0.0364347 * kRadians;
constexpr double kCountsPerTorque = -10000;

struct Direction {
  double cosine, sine;
};

// phi = 105, -15, -135 degrees.
constexpr double kSin15 = 0.25881904510252074, kCos15 = 0.9659258262890683, kHalfRoot = 0.7071067811865476;
constexpr std::array<Direction, 3> kArms = {{{-kSin15, kCos15}, {kCos15, -kSin15}, {-kHalfRoot, -kHalfRoot}}};

// The grip in an arm's plane: `out` from the arm's axis, `up`, and what the forearm bridges there.
struct InPlane {
  bool reached = false;
  double out = 0, up = 0, forearm = 0;
  double slope = 0;  // cot theta3: how much shorter it gets for a metre aside
};

InPlane in_plane(const Vec3& tip, const Direction& way) {
  InPlane p;
  p.out = way.cosine * tip.x + way.sine * tip.y - r + c;
  p.up = tip.z;
  const double aside = -way.sine * tip.x + way.cosine * tip.y - s + f;  // b cos theta3
  const double squared = (b - aside) * (b + aside);
  // Written so that a NaN is refused. Within 0.1 mm of the parallelogram lying flat nothing is left to compute with.
  if (!(squared > 2e-4 * b) || !(p.up > 0)) return p;
  const double across = std::sqrt(squared);  // b sin theta3
  p.forearm = d + e + across;
  p.slope = aside / across;
  p.reached = true;
  return p;
}

Vec3 in_space(double out, double aside, double up, const Direction& way) {
  return {way.cosine * out - way.sine * aside, way.sine * out + way.cosine * aside, up};
}

// Three rows and what solves by them (Cramer's rule): not finite where they lie in a plane.
struct Rows {
  Vec3 bc, ca, ab;
  double volume;  // negative the way the Falcon is assembled; 0 where the grip could move with all motors held

  explicit Rows(const std::array<Vec3, 3>& row)
      : bc(cross(row[1], row[2])), ca(cross(row[2], row[0])), ab(cross(row[0], row[1])), volume(dot(row[0], bc)) {}

  // x of row_i . x = right_i
  [[nodiscard]] Vec3 solve(const Triple& right) const {
    return (1 / volume) * (right[0] * bc + right[1] * ca + right[2] * ab);
  }
  // x of sum of x_i row_i = sum
  [[nodiscard]] Triple parts(const Vec3& sum) const {
    return {dot(bc, sum) / volume, dot(ca, sum) / volume, dot(ab, sum) / volume};
  }
};

// How much too far the ends of each forearm are apart (m), and the gradients of that.
struct Gaps {
  bool defined = false, bent = true;  // bent: each knee the way it is built
  Triple gap{};
  std::array<Vec3, 3> pull;

  [[nodiscard]] double size() const { return std::hypot(gap[0], gap[1], gap[2]); }
  [[nodiscard]] Rows rows() const { return Rows(pull); }
  [[nodiscard]] bool as_built() const { return bent && rows().volume < 0; }
};

Gaps gaps(const Vec3& tip, const std::array<Direction, 3>& knee) {
  Gaps g;
  for (std::size_t i = 0; i < 3; ++i) {
    const InPlane p = in_plane(tip, kArms[i]);
    if (!p.reached) return g;
    const double out = p.out - a * knee[i].cosine, up = p.up - a * knee[i].sine, apart = std::hypot(out, up);
    if (!(apart > 1e-3)) return g;
    g.gap[i] = apart - p.forearm;
    g.pull[i] = in_space(out / apart, p.slope, up / apart, kArms[i]);
    g.bent = g.bent && knee[i].cosine * up - knee[i].sine * out > -1e-9;
  }
  g.defined = true;
  return g;
}

Reached newton(const std::array<Direction, 3>& knee, const Vec3& start) {
  constexpr int kMostSteps = 40;
  constexpr double kSettled = 1e-13, kFarthest = 0.05;  // m
  Reached result{false, start, 0};
  Gaps now = gaps(start, knee);
  if (!now.defined) return result;
  for (int evaluations = 1; evaluations < kMostSteps; ++result.steps) {
    Vec3 step = -now.rows().solve(now.gap);
    const double size = length(step);
    if (!std::isfinite(size)) return result;
    if (size < kSettled) {
      result.ok = now.as_built() && now.size() < 1e-12;
      return result;
    }
    if (size > kFarthest) step = (kFarthest / size) * step;
    // Half as far until it is in the domain and not worse; what rounding leaves is never better, and good enough.
    for (;; step = 0.5 * step) {
      if (evaluations++ >= kMostSteps) return result;
      const Gaps next = gaps(result.tip + step, knee);
      if (next.defined && (next.size() < now.size() || next.size() < 1e-15)) {
        result.tip = result.tip + step;
        now = next;
        break;
      }
      if (now.size() < 1e-15) {
        result.ok = now.as_built();
        return result;
      }
    }
  }
  return result;
}

}  // namespace

Arms inverse(const Vec3& tip) {
  Arms arms;
  for (std::size_t i = 0; i < 3; ++i) {
    const InPlane p = in_plane(tip, kArms[i]);
    if (!p.reached) return arms;
    // t = tan(angle / 2) solves (k + 2 a out) t^2 - 4 a up t + (k - 2 a out) = 0; the root with minus the square root,
    // written so that nothing cancels and nothing is divided by zero while up > 0.
    const double k = p.out * p.out + p.up * p.up + a * a - p.forearm * p.forearm;
    const double inside = 4 * a * a * (p.out * p.out + p.up * p.up) - k * k;
    if (!(inside >= 0)) return arms;
    Arm& arm = arms.arm[i];
    arm.angle = 2 * std::atan2(k - 2 * a * p.out, 2 * a * p.up + std::sqrt(inside));
    const double out = p.out - a * std::cos(arm.angle), up = p.up - a * std::sin(arm.angle);
    arm.pull = in_space(out / p.forearm, p.slope, up / p.forearm, kArms[i]);
    // a sin(theta2 - theta1), which is sqrt(inside) / (2 forearm).
    arm.lever = std::sqrt(inside) / (2 * p.forearm);
  }
  arms.reached = true;
  return arms;
}

Reached forward(const Triple& angles, const Vec3& start) {
  std::array<Direction, 3> knee;
  for (std::size_t i = 0; i < 3; ++i) knee[i] = {std::cos(angles[i]), std::sin(angles[i])};
  const Reached warm = newton(knee, start);
  return warm.ok ? warm : newton(knee, kCentre);
}

Triple torques(const Arms& arms, const Vec3& force) {
  const auto& arm = arms.arm;
  // The forearms' tensions, which add up to the force.
  const Triple tension = Rows({arm[0].pull, arm[1].pull, arm[2].pull}).parts(force);
  return {arm[0].lever * tension[0], arm[1].lever * tension[1], arm[2].lever * tension[2]};
}

double angle_of(std::int16_t encoder) { return kZeroAngle + kPerStep * encoder; }

std::int16_t encoder_of(double angle) {
  const double steps = (angle - kZeroAngle) / kPerStep;
  return static_cast<std::int16_t>(std::lround(std::clamp(steps, -32768.0, 32767.0)));
}

std::array<std::int16_t, 3> motors(const Triple& torques) {
  Triple counts;
  double most = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    counts[i] = kCountsPerTorque * torques[i];
    if (!std::isfinite(counts[i])) return {};
    most = std::max(most, std::fabs(counts[i]));
  }
  const double scale = most > kMostCounts ? kMostCounts / most : 1;
  std::array<std::int16_t, 3> rounded;
  for (std::size_t i = 0; i < 3; ++i) rounded[i] = static_cast<std::int16_t>(std::lround(scale * counts[i]));
  return rounded;
}

}  // namespace palpate::device::falcon
