// SPDX-License-Identifier: MIT
#include "device/glove/hand_calibration.hpp"

#include "device/device.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace palpate::device {
namespace {

constexpr double kLeastAngle = 0.2;  // rad, least range of a joint's angle over the poses
constexpr double kApart = 0.010;     // m, least distance between two poses' tips of a finger of typical size

std::string text(const char* format, double value, double bound) {
  char line[120];
  std::snprintf(line, sizeof line, format, value, bound);
  return line;
}

std::string of(std::size_t finger, std::size_t joint) {
  return std::string(finger_name(finger)) + ", " + joint_name(joint) + ": ";
}

bool measured(const HandModel& hand, std::size_t finger, std::size_t joint) {
  return joint != Joint::spread || hand[finger].side != 0;
}

/// The values of one sensor in one pose.
struct Reading {
  double mean = 0, deviation = 0;
};

Reading reading_of(const KeyPose& pose, std::size_t finger, std::size_t joint) {
  const auto count = static_cast<double>(pose.frames.size());
  Reading reading;
  for (const HandJoints& frame : pose.frames) reading.mean += frame[finger][joint] / count;
  double squares = 0;
  for (const HandJoints& frame : pose.frames) {
    const double off = frame[finger][joint] - reading.mean;
    squares += off * off / count;
  }
  reading.deviation = std::sqrt(squares);
  return reading;
}

/// Checks the recording of a pose: the first fault found, empty when there is none.
std::string fault(const KeyPose& pose, const HandModel& hand, const CalibrationOptions& options) {
  if (pose.frames.size() < options.least_frames) {
    return text("%.0f frames, at least %.0f are needed", static_cast<double>(pose.frames.size()),
                static_cast<double>(options.least_frames));
  }
  for (std::size_t f = 0; f < kFingers; ++f) {
    if (pose.tips && !finite((*pose.tips)[f])) return std::string(finger_name(f)) + ": its tip is not finite";
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (!measured(hand, f, j)) continue;
      if (!std::isfinite(pose.angles[f][j])) return of(f, j) + "the angle of the pose is not finite";
      for (const HandJoints& frame : pose.frames) {
        const double raw = frame[f][j];
        if (!std::isfinite(raw)) return of(f, j) + "a reading is not finite";
        if (raw <= options.sensor_low || raw >= options.sensor_high) {
          return of(f, j) + text("the sensor is saturated: it reads %g, the end of its range is %g", raw,
                                 raw <= options.sensor_low ? options.sensor_low : options.sensor_high);
        }
      }
    }
  }
  return {};
}

/// Fits the sensor's line; what is wrong with it.
std::string fit_sensor(const std::vector<KeyPose>& poses, std::size_t f, std::size_t j,
                       const CalibrationOptions& options, HandCalibration& result) {
  std::vector<Reading> readings;
  double angle_mean = 0, raw_mean = 0, unrest = 0;
  const auto count = static_cast<double>(poses.size());
  for (const KeyPose& pose : poses) {
    readings.push_back(reading_of(pose, f, j));
    angle_mean += pose.angles[f][j] / count;
    raw_mean += readings.back().mean / count;
    unrest = std::max(unrest, readings.back().deviation);
  }
  double square = 0, product = 0;
  for (std::size_t p = 0; p < poses.size(); ++p) {
    const double angle = poses[p].angles[f][j] - angle_mean;
    square += angle * angle;
    product += angle * (readings[p].mean - raw_mean);
  }
  const auto by_angle = [&](const KeyPose& a, const KeyPose& b) { return a.angles[f][j] < b.angles[f][j]; };
  const auto [low, high] = std::minmax_element(poses.begin(), poses.end(), by_angle);
  const double range = high->angles[f][j] - low->angles[f][j];
  if (!(range >= kLeastAngle)) {
    return text("the poses move it by only %.2g rad, at least %.2g are needed", range, kLeastAngle);
  }
  SensorLine& line = result.sensors[f][j];
  line.per_radian = product / square;
  line.at_zero = raw_mean - line.per_radian * angle_mean;
  const double moved = std::fabs(line.per_radian) * range,
               least = options.least_share * (options.sensor_high - options.sensor_low);
  if (!(moved >= least)) return text("it did not move enough: its sensor by %.3g, at least %.3g", moved, least);
  if (!(unrest <= options.most_unrest * moved)) {
    return text("it moved while a pose was held: its sensor by %.3g, at most %.3g", unrest,
                options.most_unrest * moved);
  }
  for (std::size_t p = 0; p < poses.size(); ++p) {
    const double error = std::fabs((readings[p].mean - line.at_zero) / line.per_radian - poses[p].angles[f][j]);
    result.angle_error = std::max(result.angle_error, error);
    if (!(error <= options.most_angle_error)) {
      return text("the poses contradict one another by %.2g rad, at most %.2g", error, options.most_angle_error);
    }
  }
  return {};
}

/// Finds the finger's size and root; what is wrong with it.
std::string fit_size(const std::vector<KeyPose>& poses, std::size_t f, const CalibrationOptions& options,
                     HandCalibration& result) {
  FingerModel& finger = result.hand[f];
  std::vector<Vec3> chain, tips;
  Vec3 chain_mean, tip_mean;
  for (const KeyPose& pose : poses) {
    if (!pose.tips) continue;
    chain.push_back(finger.tip(pose.angles[f]).translation - finger.base.translation);
    tips.push_back((*pose.tips)[f]);
    chain_mean = chain_mean + chain.back();
    tip_mean = tip_mean + tips.back();
  }
  if (tips.size() < 2) return "its tip was measured in fewer than two poses";
  const double share = 1 / static_cast<double>(tips.size());
  chain_mean = share * chain_mean;
  tip_mean = share * tip_mean;
  double square = 0, product = 0;
  for (std::size_t p = 0; p < tips.size(); ++p) {
    const Vec3 out = chain[p] - chain_mean;
    square += dot(out, out);
    product += dot(out, tips[p] - tip_mean);
  }
  if (!(square >= kApart * kApart)) {
    return text("its tip hardly moves between the poses in which it was measured: %.2g m, at least %.2g",
                std::sqrt(square), kApart);
  }
  const double size = product / square;
  result.size[f] = size;
  if (!(size >= options.smallest && size <= options.largest)) {
    return text("%.3g times as long as a typical one, which is out of range (bound %.3g)", size,
                size < options.smallest ? options.smallest : options.largest);
  }
  finger.base.translation = tip_mean - size * chain_mean;
  for (double& bone : finger.bones) bone *= size;
  for (std::size_t p = 0; p < tips.size(); ++p) {
    const double error = length(finger.base.translation + size * chain[p] - tips[p]);
    result.tip_error = std::max(result.tip_error, error);
    if (!(error <= options.most_tip_error)) {
      return text("the measured tips fit no size: off by %.2g m, at most %.2g", error, options.most_tip_error);
    }
  }
  return {};
}

}  // namespace

std::vector<KeyPose> extreme_poses() {
  std::vector<KeyPose> poses(3);
  poses[0].name = "flat";
  poses[1].name = "spread";
  poses[2].name = "fist";
  constexpr double kSpread[kFingers] = {40, 20, 0, 15, 35};  // degrees, from the middle finger
  for (std::size_t f = 0; f < kFingers; ++f) {
    const bool thumb = f == 0;
    poses[1].angles[f][Joint::spread] = kSpread[f] * kPi / 180;
    poses[2].angles[f][Joint::root] = (thumb ? 40 : 90) * kPi / 180;
    poses[2].angles[f][Joint::middle] = (thumb ? 55 : 100) * kPi / 180;
  }
  return poses;
}

std::optional<std::string> CalibrationOptions::validate() const {
  if (!(std::isfinite(sensor_low) && std::isfinite(sensor_high) && sensor_low < sensor_high)) {
    return text("sensor_low is %g and sensor_high %g, must be finite and rise", sensor_low, sensor_high);
  }
  if (least_frames < 1) return "least_frames is 0, must be at least 1";
  if (!(least_share > 0 && least_share < 1)) return text("least_share is %g, allowed are 0 to %g", least_share, 1);
  if (!(most_unrest > 0 && most_unrest < 1)) return text("most_unrest is %g, allowed are 0 to %g", most_unrest, 1);
  if (!(most_angle_error > 0)) return text("most_angle_error is %g rad, must be above %g", most_angle_error, 0);
  if (!(most_tip_error > 0)) return text("most_tip_error is %g m, must be above %g", most_tip_error, 0);
  if (!(smallest > 0 && smallest < largest)) {
    return text("smallest is %g and largest %g, must be above 0 and rise", smallest, largest);
  }
  return {};
}

HandJoints HandCalibration::angles(const HandJoints& raw) const {
  HandJoints result{};
  for (std::size_t f = 0; f < kFingers; ++f) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (measured(hand, f, j)) result[f][j] = (raw[f][j] - sensors[f][j].at_zero) / sensors[f][j].per_radian;
    }
  }
  return result;
}

HandCalibration calibrate_hand(const std::vector<KeyPose>& poses, const CalibrationOptions& options) {
  HandCalibration result;
  result.hand = typical_hand();
  if (const auto wrong = options.validate()) {
    result.problem = *wrong;
    return result;
  }
  if (poses.size() < 2) {
    result.problem = text("%.0f poses, at least %.0f are needed", static_cast<double>(poses.size()), 2);
    return result;
  }
  for (const KeyPose& pose : poses) {
    if (const std::string wrong = fault(pose, result.hand, options); !wrong.empty()) {
      result.problem = "pose " + pose.name + ": " + wrong;
      return result;
    }
  }
  for (std::size_t f = 0; f < kFingers; ++f) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (!measured(result.hand, f, j)) continue;
      if (const std::string wrong = fit_sensor(poses, f, j, options, result); !wrong.empty()) {
        result.problem = of(f, j) + wrong;
        return result;
      }
    }
    if (const std::string wrong = fit_size(poses, f, options, result); !wrong.empty()) {
      result.problem = std::string(finger_name(f)) + ": " + wrong;
      return result;
    }
  }
  result.problem.clear();
  return result;
}

}  // namespace palpate::device
