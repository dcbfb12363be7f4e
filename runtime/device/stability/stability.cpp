// SPDX-License-Identifier: MIT
#include "device/stability/stability.hpp"

#include "device/device.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <vector>

namespace palpate::device {
namespace {

using Mat3 = std::array<double, 9>;

Mat3 product(const Mat3& a, const Mat3& b) {
  Mat3 c{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) c[3 * i + j] += a[3 * i + k] * b[3 * k + j];
    }
  }
  return c;
}

/// exp(a) by halving, Taylor's series and squaring.
Mat3 exponential(Mat3 a) {
  double size = 0;
  for (const double v : a) size = std::max(size, std::fabs(v));
  const int halvings = size > 0 ? std::max(0, std::ilogb(size) + 4) : 0;
  for (double& v : a) v = std::ldexp(v, -halvings);
  Mat3 sum{1, 0, 0, 0, 1, 0, 0, 0, 1}, term = sum;
  for (int k = 1; k <= 14; ++k) {
    term = product(term, a);
    for (double& v : term) v /= k;
    for (int i = 0; i < 9; ++i) sum[i] += term[i];
  }
  for (int k = 0; k < halvings; ++k) sum = product(sum, sum);
  return sum;
}

/// The loop from force to position at the samples: stiffness K closes it to
/// p(z) = z^(whole + 1) (z^2 + a1 z + a0) + K (n2 z^2 + n1 z + n0).
struct SampledLoop {
  int whole = 0;  ///< periods of delay
  double a1, a0, n2, n1, n0;

  SampledLoop(double mass, double damping, double stiffness, double period, double delay) {
    // Position, velocity and held force over a time.
    const auto over = [&](double t) {
      return exponential({0, t, 0, -stiffness / mass * t, -damping / mass * t, t / mass, 0, 0, 0});
    };
    whole = static_cast<int>(std::floor(delay / period * (1 + 1e-12)));
    const double rest = std::max(0.0, delay - whole * period);
    const Mat3 all = over(period), first = over(rest), second = over(period - rest);
    // Forces enter as the older one until `rest`, then the newer one.
    const double new_x = second[2], new_v = second[5];
    const double old_x = second[0] * first[2] + second[1] * first[5];
    const double old_v = second[3] * first[2] + second[4] * first[5];
    a1 = -(all[0] + all[4]);
    a0 = all[0] * all[4] - all[1] * all[3];
    n2 = new_x;
    n1 = old_x - all[4] * new_x + all[1] * new_v;
    n0 = all[1] * old_v - all[4] * old_x;
  }

  /// Coefficients, highest first.
  [[nodiscard]] std::vector<double> polynomial(double k) const {
    std::vector<double> p(static_cast<std::size_t>(whole) + 4, 0.0);
    p[0] = 1, p[1] = a1, p[2] = a0;
    const std::size_t last = p.size() - 1;
    p[last - 2] += k * n2, p[last - 1] += k * n1, p[last] += k * n0;
    return p;
  }

  [[nodiscard]] bool settles(double k) const {
    std::vector<double> p = polynomial(k), next;
    while (p.size() > 1) {
      const double share = p.back() / p.front();
      if (!(std::fabs(share) < 1)) return false;
      next.assign(p.size() - 1, 0.0);
      for (std::size_t i = 0; i < next.size(); ++i) next[i] = p[i] - share * p[p.size() - 1 - i];
      p.swap(next);
    }
    return true;
  }

  [[nodiscard]] double size_at(double angle, double k) const {
    const std::complex<double> z = std::polar(1.0, angle);
    return std::abs(std::polar(1.0, angle * (whole + 1)) * (z * z + a1 * z + a0) + k * (n2 * z * z + n1 * z + n0));
  }

  /// Smallest k that does not settle, and the angle of its root on the unit circle.
  [[nodiscard]] std::pair<double, double> onset() const {
    double low = 0, high = 1e-3;
    constexpr double kMost = 1e9;
    for (; settles(high); high *= 1.05) {
      if (high > kMost) return {HUGE_VAL, 0};
      low = high;
    }
    if (low == 0) return {0, 0};
    for (int i = 0; i < 50; ++i) {
      const double middle = 0.5 * (low + high);
      (settles(middle) ? low : high) = middle;
    }
    // The root is where p is smallest on the circle: among angles that grow by 2 %, then by thirds.
    constexpr double kGrowth = 1.02;
    double best = kPi;
    for (double angle = kPi; angle > 1e-4; angle /= kGrowth) {
      if (size_at(angle, low) < size_at(best, low)) best = angle;
    }
    double from = best / kGrowth, to = std::fmin(kPi, best * kGrowth);
    for (int i = 0; i < 40; ++i) {
      const double third = (to - from) / 3, left = from + third, right = to - third;
      if (size_at(left, low) < size_at(right, low)) {
        to = right;
      } else {
        from = left;
      }
    }
    return {low, 0.5 * (from + to)};
  }
};

double delay(const PlantOptions& plant, const LoopTiming& timing) {
  return plant.delay_in + plant.delay_out + timing.computing;
}

/// Describing function of a rounding quantiser (Gelb and Vander Velde 1968, section 2.3) at an amplitude: 0 below half
/// a step.
double gain_of_steps(double step, double amplitude) {
  if (!(step > 0) || amplitude > 1e3 * step) return 1;
  double gain = 0;
  for (double edge = 0.5 * step; edge < amplitude; edge += step) {
    gain += 4 * step / (kPi * amplitude) * std::sqrt(1 - edge * edge / (amplitude * amplitude));
  }
  return gain;
}

}  // namespace

std::optional<std::string> LoopTiming::validate() const {
  if (!(period >= 1e-6 && period <= 1)) return "period is " + std::to_string(period) + " s, allowed 1e-6 to 1";
  if (!(computing >= 0 && computing <= 0.1))
    return "computing is " + std::to_string(computing) + " s, allowed 0 to 0.1";
  return std::nullopt;
}

PassiveStiffness passive_stiffness(const PlantOptions& device, const LoopTiming& timing, int axes, double damper) {
  const double late = delay(device, timing), periods = std::ceil(late / timing.period * (1 - 1e-12));
  PassiveStiffness k;
  k.by_damping = 2 * std::fmax(0, device.damping - damper) / (late + timing.period * (1 + periods));
  k.by_friction = HUGE_VAL;
  if (device.resolution > 0) {
    k.by_friction = 2 * device.friction / (std::sqrt(axes) * device.resolution) - 2 * damper / timing.period;
    k.by_friction = std::fmax(0, k.by_friction);
  }
  return k;
}

Onset onset_of_oscillation(const PlantOptions& plant, const LoopTiming& timing, double amplitude) {
  const double mass = plant.mass + plant.hand.mass, damping = plant.damping + plant.hand.damping;
  Onset onset;
  double friction = 0;  // N s/m
  // Friction raises the onset, and with it the frequency, at which friction weighs less: few rounds settle it.
  for (int round = 0; round < 20; ++round) {
    const SampledLoop loop(mass, damping + friction, plant.hand.stiffness, timing.period, delay(plant, timing));
    const auto [stiffness, angle] = loop.onset();
    const double omega = angle / timing.period;
    onset = {stiffness / gain_of_steps(plant.resolution, amplitude), omega / (2 * kPi)};
    if (!(omega > 0) || !(plant.friction > 0) || !std::isfinite(amplitude)) break;
    const double next = 4 * plant.friction / (kPi * omega * amplitude);
    if (std::fabs(next - friction) <= 1e-4 * (damping + friction)) break;
    friction = 0.5 * (friction + next);
  }
  return onset;
}

bool settles(const PlantOptions& plant, const LoopTiming& timing, double stiffness) {
  return SampledLoop(plant.mass + plant.hand.mass, plant.damping + plant.hand.damping, plant.hand.stiffness,
                     timing.period, delay(plant, timing))
      .settles(stiffness);
}

}  // namespace palpate::device
