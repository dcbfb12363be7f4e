// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/run.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "formats/io/error.hpp"
#include "tools/play/motion_file.hpp"
#include "tools/play/play.hpp"
#include "tools/report/numbers.hpp"
#ifdef PALPATE_DRIVE
#include "tools/play/play_run.hpp"
#endif

namespace palpate::report {
namespace {

struct Row {
  double time = 0;
  runtime::Pose pose;
  runtime::Vec3 force;
  double depth = 0;
  int state = 0;
};

Json triple(const runtime::Vec3& v) { return {rounded(v.x), rounded(v.y), rounded(v.z)}; }

Json quaternion(const runtime::Pose& pose) {
  const Eigen::Quaterniond q(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(pose.rotation).eval());
  return {rounded(q.w()), rounded(q.x()), rounded(q.y()), rounded(q.z())};
}

Json columns(const std::vector<Row>& rows, std::size_t most) {
  Json json{{"rows", rows.size()},         {"time_s", Json::array()},  {"position_m", Json::array()},
            {"quaternion", Json::array()}, {"force_N", Json::array()}, {"depth_m", Json::array()},
            {"state", Json::array()}};
  const std::size_t step = std::max<std::size_t>(1, (rows.size() + most - 1) / most);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (k % step != 0 && k + 1 != rows.size()) continue;
    const Row& r = rows[k];
    json["time_s"].push_back(rounded(r.time));
    json["position_m"].push_back(triple(r.pose.translation));
    json["quaternion"].push_back(quaternion(r.pose));
    json["force_N"].push_back(triple(r.force));
    json["depth_m"].push_back(rounded(r.depth));
    json["state"].push_back(r.state);
  }
  return json;
}

}  // namespace

Json played_run(const std::string& file, const cli::ResponseInput& response, const std::string& tool,
                std::size_t most) {
  std::vector<Row> rows;
#ifdef PALPATE_DRIVE
  if (cli::is_run(file)) {
    const device::RunLog log = cli::read_run(file);
    if (log.hand) throw Error(ExitCode::bad_input, file + ": is a glove's run; runs of one tool are played back");
    const std::uint32_t index = response.tool(tool.empty() ? log.header.tool_name : tool);
    const cli::PlayedRun played = cli::play_run(log, response, index);
    const runtime::DeviceFrame frame = device::device_frame(log.header);
    for (std::size_t k = 0; k < played.rows.size(); ++k) {
      const runtime::Tick& tick = played.rows[k].tick;
      const runtime::Pose pose = frame.to_scene(device::to_input(log.records[k]).sample.pose);
      rows.push_back({played.rows[k].time, pose, tick.force, tick.depth, static_cast<int>(tick.state)});
    }
    Json json = columns(rows, most);
    json["command"] = "palpate play " + file;
    json["tool"] = index;
    json["complete"] = log.complete;
    return json;
  }
#endif
  const std::uint32_t index = response.tool(tool);
  const std::vector<cli::MotionRow> motion = cli::read_motion(file);
  cli::PlaySummary summary;
  const std::vector<cli::PlayedRow> played = cli::play(response.view(), index, motion, summary);
  for (std::size_t k = 0; k < played.size(); ++k) {
    const runtime::Tick& tick = played[k].tick;
    rows.push_back({played[k].time, cli::pose_between(motion[k], motion[k], 1), tick.force, tick.depth,
                    static_cast<int>(tick.state)});
  }
  Json json = columns(rows, most);
  json["command"] = "palpate play FILE.palp " + file;
  json["tool"] = index;
  json["complete"] = true;
  return json;
}

}  // namespace palpate::report
