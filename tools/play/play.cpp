// SPDX-License-Identifier: GPL-3.0-or-later
// The force loop without a device.
#include "tools/play/play.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tools/play/other_walls.hpp"
#include "tools/play/plot.hpp"

namespace palpate::cli {
namespace {

using runtime::State;
using runtime::Tick;

const char* state_name(State state) {
  switch (state) {
    case State::free:
      return "free";
    case State::stick:
      return "stick";
    case State::slide:
      return "slide";
    case State::released:
      return "released";
    case State::fault:
      break;
  }
  return "fault";
}

bool of_glove(const std::vector<PlayedRow>& rows) { return !rows.empty() && rows.front().finger > 0; }

std::string fingers_svg(const std::vector<PlayedRow>& rows, const std::string& title) {
  std::vector<double> time;
  PlotPanel force = finger_panel("force (N)"), depth = finger_panel("depth (mm)");
  for (const PlayedRow& row : rows) {
    if (row.finger == 1) time.push_back(row.time);
    const auto k = static_cast<std::size_t>(row.finger - 1);
    force.series[k].values.push_back(length(row.tick.force));
    depth.series[k].values.push_back(1e3 * row.tick.depth);
  }
  return line_plot_svg(title, "time (s)", time, {force, depth});
}

int steps_between(const MotionRow& a, const MotionRow& b, double reach, double longest) {
  double cosine = 0;
  for (int k = 0; k < 4; ++k) cosine += a.quaternion[k] * b.quaternion[k];
  const double turn = 2 * std::acos(std::min(1.0, std::abs(cosine)));
  const double way = length(b.position - a.position) + turn * reach;
  return static_cast<int>(std::clamp(std::ceil(way / longest), 1.0, 10000.0));
}

}  // namespace

void account(PlaySummary& summary, const Tick& tick, double seconds) {
  const bool touching = tick.touches();
  ++summary.ticks;
  summary.peak_force = std::max(summary.peak_force, length(tick.force));
  summary.peak_torque = std::max(summary.peak_torque, length(tick.torque));
  summary.peak_depth = std::max(summary.peak_depth, tick.depth);
  if (touching) summary.contact_time += seconds;
  if (tick.state == State::slide) summary.slide_time += seconds;
  summary.contacts += touching && !summary.touching ? 1 : 0;
  summary.touching = touching;
}

void add(PlaySummary& summary, const PlaySummary& other) {
  summary.ticks = std::max(summary.ticks, other.ticks);
  summary.starts_inside = summary.starts_inside || other.starts_inside;
  summary.peak_force = std::max(summary.peak_force, other.peak_force);
  summary.peak_torque = std::max(summary.peak_torque, other.peak_torque);
  summary.peak_depth = std::max(summary.peak_depth, other.peak_depth);
  summary.contact_time += other.contact_time;
  summary.slide_time += other.slide_time;
  summary.contacts += other.contacts;
  summary.touching = summary.touching || other.touching;
  summary.rows_extrapolated += other.rows_extrapolated;
  summary.rows_filled += other.rows_filled;
  summary.rows_other_contacts += other.rows_other_contacts;
  summary.rows_near += other.rows_near;
}

namespace {

template <class Contact>
std::vector<PlayedRow> play_with(Contact&& contact, const runtime::View& view, std::uint32_t tool,
                                 const std::vector<MotionRow>& motion, PlaySummary& summary) {
  summary = {};
  const OtherWalls walls(view, tool);
  const double reach = runtime::ToolShape<>(view, tool).extent();
  const double longest = 0.01 * view.meta->depth_scale;
  std::vector<PlayedRow> rows;
  rows.reserve(motion.size());
  for (std::size_t i = 0; i < motion.size(); ++i) {
    const MotionRow& from = motion[i > 0 ? i - 1 : 0];
    const int steps = i > 0 ? steps_between(from, motion[i], reach, longest) : 1;
    const double duration = (motion[i].time - from.time) / steps;
    Tick tick;
    bool extrapolated = false, filled = false;
    for (int k = 1; k <= steps; ++k) {
      tick = contact.tick(pose_between(from, motion[i], k / static_cast<double>(steps)));
      account(summary, tick, duration);
      extrapolated = extrapolated || tick.extrapolated;
      filled = filled || tick.filled_share > 0.5;
    }
    summary.rows_extrapolated += extrapolated ? 1 : 0;
    summary.rows_filled += filled ? 1 : 0;
    summary.rows_other_contacts += OtherWalls::missed(contact, pose_between(from, motion[i], 1), tick) ? 1 : 0;
    summary.rows_near += walls.near(contact) ? 1 : 0;
    summary.starts_inside = summary.starts_inside || (i == 0 && summary.touching);
    rows.push_back({motion[i].time, tick});
  }
  return rows;
}

}  // namespace

std::vector<PlayedRow> play(const runtime::View& view, std::uint32_t tool, const std::vector<MotionRow>& motion,
                            PlaySummary& summary, bool single) {
  return single ? play_with(runtime::Contact(view, tool), view, tool, motion, summary)
                : play_with(runtime::ContactSet<3>(view, tool), view, tool, motion, summary);
}

std::string forces_csv(const std::vector<PlayedRow>& rows) {
  const bool glove = of_glove(rows);
  std::string text = std::string("t,") + (glove ? "finger," : "") + "fx,fy,fz,tx,ty,tz,state,depth,cx,cy,cz\n";
  for (const PlayedRow& row : rows) {
    const Tick& t = row.tick;
    char line[400];
    std::snprintf(line, sizeof line, "%.9g,", row.time);
    text += line;
    if (glove) text += std::to_string(row.finger) + ",";
    std::snprintf(line, sizeof line, "%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%s,%.9g", t.force.x, t.force.y, t.force.z,
                  t.torque.x, t.torque.y, t.torque.z, state_name(t.state), t.depth);
    text += line;
    if (t.touches()) {
      std::snprintf(line, sizeof line, ",%.9g,%.9g,%.9g\n", t.body_point.x, t.body_point.y, t.body_point.z);
      text += line;
    } else {
      text += ",,,\n";  // no contact point without contact
    }
  }
  return text;
}

std::string forces_svg(const std::vector<PlayedRow>& rows, const std::string& title) {
  if (of_glove(rows)) return fingers_svg(rows, title);
  std::vector<double> time;
  PlotPanel force{"force (N)", {{"x", {}}, {"y", {}}, {"z", {}}, {"magnitude", {}}}};
  PlotPanel depth{"depth (mm)", {{"depth", {}}}};
  for (const PlayedRow& row : rows) {
    time.push_back(row.time);
    const runtime::Vec3& f = row.tick.force;
    const double values[] = {f.x, f.y, f.z, length(f)};
    for (std::size_t k = 0; k < 4; ++k) force.series[k].values.push_back(values[k]);
    depth.series[0].values.push_back(1e3 * row.tick.depth);
  }
  return line_plot_svg(title, "time (s)", time, {force, depth});
}

}  // namespace palpate::cli
