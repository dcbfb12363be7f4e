// SPDX-License-Identifier: GPL-3.0-or-later
// JSON of held-out contacts, both ways.
#include "precompute/verify/held_out/recorded.hpp"

#include "formats/io/error.hpp"
#include "formats/io/file.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

namespace palpate::verify {
namespace {

using Json = nlohmann::ordered_json;
using Eigen::Vector3d;

constexpr std::size_t kLargestReport = std::size_t{1} << 30;

constexpr std::pair<SampleKind, std::string_view> kKinds[] = {{SampleKind::normal, "normal"},
                                                              {SampleKind::tangential, "tangential"},
                                                              {SampleKind::path, "path"},
                                                              {SampleKind::grasped, "grasped"}};

Json list(const Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

Vector3d vector(const Json& j, const char* key) {
  const Json& a = j.at(key);
  if (!a.is_array() || a.size() != 3) throw std::runtime_error(std::string(key) + " is not a list of three numbers");
  Vector3d v;
  for (int k = 0; k < 3; ++k) v[k] = a[static_cast<std::size_t>(k)].get<double>();
  if (!v.allFinite()) throw std::runtime_error(std::string(key) + " is not finite");
  return v;
}

HeldOut contact_from(const Json& j) {
  HeldOut c;
  c.tool = j.at("tool").get<std::uint32_t>();
  c.tool_patch = j.at("tool_patch").get<std::uint32_t>();
  c.tool_weights = vector(j, "tool_weights");
  c.frame.origin = vector(j, "c");
  c.frame.n = vector(j, "n");
  c.frame.x = vector(j, "x");
  c.frame.y = c.frame.n.cross(c.frame.x);
  if (j.contains("tool_x")) {
    const Vector3d x = vector(j, "tool_x"), z = vector(j, "tool_z");
    c.orientation.emplace() << x, z.cross(x), z;
    if (!(*c.orientation * c.orientation->transpose()).isIdentity(1e-6)) {
      throw std::runtime_error("tool_x and tool_z are not two unit vectors at a right angle");
    }
  }
  c.spin = j.value("spin_rad", 0.0);
  c.at_pair = j.value("at_pair", false);
  c.depth = j.at("depth_m").get<double>();
  c.thickness = j.value("thickness_m", 0.0);
  c.floor = j.value("floor_N", 0.0);
  if (!(c.floor >= 0)) throw std::runtime_error("floor_N is below 0");
  c.accepted = j.at("accepted").get<bool>();
  c.cause = j.value("cause", "");
  for (const Json& f : j.at("forces")) {
    ForcePair force;
    const auto kind = f.at("kind").get<std::string>();
    const auto known =
        std::find_if(std::begin(kKinds), std::end(kKinds), [&](const auto& k) { return k.second == kind; });
    if (known == std::end(kKinds)) {
      throw std::runtime_error("kind is '" + kind + "'; allowed normal, tangential, path, grasped");
    }
    force.kind = known->first;
    if (f.contains("from_m")) force.from = vector(f, "from_m");
    force.deflection = vector(f, "deflection_m");
    force.solved = vector(f, "solved_N");
    if (f.contains("rotation_rad")) {
      force.turn = ForcePair::Turn{vector(f, "rotation_rad"), vector(f, "solved_Nm"), Vector3d::Zero(), 0.0};
      if (force.kind != SampleKind::grasped || !(force.turn->rotation.norm() <= std::numbers::pi)) {
        throw std::runtime_error("rotation_rad: only a grasped tool is turned, by at most pi");
      }
    }
    c.forces.push_back(force);
  }
  for (const Json& l : j.value("limits", Json::array())) {
    LimitPair limit;
    limit.depth = l.at("depth_m").get<double>();
    limit.solved = l.at("solved").get<double>();
    if (!(limit.solved > 0)) throw std::runtime_error("limits: solved is not above 0");
    c.limits.push_back(limit);
  }
  return c;
}

}  // namespace

nlohmann::ordered_json to_json(const std::vector<HeldOut>& contacts) {
  Json all = Json::array();
  for (const HeldOut& c : contacts) {
    Json forces = Json::array();
    for (const ForcePair& f : c.forces) {
      const auto kind =
          std::find_if(std::begin(kKinds), std::end(kKinds), [&](const auto& k) { return k.first == f.kind; });
      forces.push_back({{"kind", kind->second},
                        {"deflection_m", list(f.deflection)},
                        {"solved_N", list(f.solved)},
                        {"baked_N", list(f.baked)},
                        {"error", f.error}});
      if (f.from) forces.back()["from_m"] = list(*f.from);
      if (!f.turn) continue;
      forces.back()["rotation_rad"] = list(f.turn->rotation);
      forces.back()["solved_Nm"] = list(f.turn->solved);
      forces.back()["baked_Nm"] = list(f.turn->baked);
      forces.back()["error_torque"] = f.turn->error;
    }
    all.push_back({{"tool", c.tool},
                   {"tool_patch", c.tool_patch},
                   {"tool_weights", list(c.tool_weights)},
                   {"c", list(c.frame.origin)},
                   {"n", list(c.frame.n)},
                   {"x", list(c.frame.x)},
                   {"depth_m", c.depth},
                   {"thickness_m", c.thickness},
                   {"filled", c.filled},
                   {"accepted", c.accepted},
                   {"cause", c.cause},
                   {"forces", forces}});
    if (c.floor > 0) all.back()["floor_N"] = c.floor;
    if (c.orientation) {
      all.back()["spin_rad"] = c.spin;
      all.back()["tool_x"] = list(c.orientation->col(0));
      all.back()["tool_z"] = list(c.orientation->col(2));
      all.back()["at_pair"] = c.at_pair;
    }
    Json limits = Json::array();
    for (const LimitPair& l : c.limits) {
      limits.push_back({{"depth_m", l.depth}, {"solved", l.solved}, {"baked", l.baked}, {"error", l.error}});
    }
    if (!limits.empty()) all.back()["limits"] = limits;
  }
  return all;
}

nlohmann::ordered_json to_json(const ErrorStatistics& s, const std::vector<HeldOut>& contacts) {
  Json worst = {{"error", s.worst}, {"contact", s.worst_contact}, {"depth_m", s.worst_depth}};
  if (s.worst_contact < contacts.size()) worst["c"] = list(contacts[s.worst_contact].frame.origin);
  return {{"count", s.count},
          {"median", s.median},
          {"p95", s.p95},
          {"worst", worst},
          {"within", {{"1%", s.within_1}, {"2%", s.within_2}, {"5%", s.within_5}, {"10%", s.within_10}}}};
}

std::vector<HeldOut> read_recorded(const std::filesystem::path& file) {
  Json report;
  try {
    report = Json::parse(read_file(file, "report of a verify", kLargestReport));
  } catch (const Json::exception& e) {
    throw Error(ExitCode::bad_input, file.string() + ": not JSON: " + e.what());
  }
  if (!report.is_object() || !report.contains("held_out")) {
    throw Error(ExitCode::bad_input, file.string() + ": not a report of palpate verify: it has no 'held_out'");
  }
  std::vector<HeldOut> contacts;
  try {
    for (const Json& j : report["held_out"]) contacts.push_back(contact_from(j));
  } catch (const std::exception& e) {
    throw Error(ExitCode::bad_input,
                file.string() + ": held-out contact " + std::to_string(contacts.size()) + ": " + e.what());
  }
  if (contacts.empty()) throw Error(ExitCode::bad_input, file.string() + ": the list 'held_out' is empty");
  return contacts;
}

}  // namespace palpate::verify
