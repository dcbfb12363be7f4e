// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/pipeline/recorded_pairs.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <optional>

#include "formats/io/error.hpp"
#include "formats/recording/recording.hpp"
#include "precompute/bake/tool_lookup.hpp"
#include "precompute/sites/haptic_mesh.hpp"
#include "precompute/solve/pair/pair.hpp"

namespace palpate::pipeline {
namespace {

using Eigen::Vector3d;
using PairName = std::array<std::uint32_t, 3>;  // site, tool, tool vertex

constexpr double kTangentialOverDepth = 0.05;  // at most, of a normal indentation
constexpr double kShallow = 0.1;    // of the sampled depth: the same of what is shallower
constexpr double kFacing = 0.5;     // least cosine between the normals of a contact and of its site
constexpr double kReach = 0.25;     // of sampling.spacing

std::map<PairName, std::uint32_t> pairs_by_name(const bake::Plan& plan) {
  std::map<PairName, std::uint32_t> result;
  for (std::uint32_t k = 0; k < plan.pairs.size(); ++k) {
    result[{plan.pairs[k].site, plan.pairs[k].tool, plan.pairs[k].tool_vertex}] = k;
  }
  return result;
}

const char* reason_text(const bake::Plan& plan, const PairName& name) {
  for (const bake::SkippedPair& pair : plan.skipped) {
    if (PairName{pair.site, pair.tool, pair.tool_vertex} != name) continue;
    return pair.reason == bake::SkipReason::support       ? "is on or beside a support"
           : pair.reason == bake::SkipReason::unreachable ? "lies in a fold narrower than the tool"
                                                          : "is outside the region that is sampled";
  }
  return "is not planned";
}

/// Rows of one recording, made samples of the pairs that they belong to.
class Recorder {
public:
  Recorder(const Scene& scene, const Body& body, const std::vector<tool::Tool>& tools, const bake::Plan& plan)
      : scene_(scene),
        body_(body),
        tools_(tools),
        plan_(plan),
        pairs_(pairs_by_name(plan)),
        aside_(solve::bake_path(scene, scene.sampling.depth).tangential_reach) {}

  void read(const MeasuredScene& measured, fit::PairSources& to) const {
    const Recording recording = read_recording(measured.file);
    to.recordings.push_back(hash_file(measured.file));
    std::optional<Contact> contact;  // of the row before: most rows begin where that one did
    for (std::size_t k = 0; k < recording.rows.size(); ++k) {
      const RecordedRow& row = recording.rows[k];
      const std::string where = measured.file.string() + ":" + std::to_string(row.line);
      const std::uint32_t tool = tool_of(row, measured, where);
      if (row.tool_vertex >= static_cast<std::int64_t>(tools_[tool].vertices.size())) {
        throw Error(ExitCode::bad_input, where + ": the tool '" + tools_[tool].name + "' has " +
                                             std::to_string(tools_[tool].vertices.size()) +
                                             " contact vertices, counted from 0; got " +
                                             std::to_string(row.tool_vertex));
      }
      const bool same = k > 0 && row.point == recording.rows[k - 1].point && row.site == recording.rows[k - 1].site;
      if (!same) contact = contact_of(row, measured, where);
      const PairName name{contact->site, tool, static_cast<std::uint32_t>(row.tool_vertex)};
      const auto pair = pairs_.find(name);
      if (pair == pairs_.end()) {
        throw Error(ExitCode::bad_input, where + ": its site " + std::to_string(contact->site) + " " +
                                             reason_text(plan_, name) + ": no response of this scene is there");
      }
      add(row, *contact, plan_.pairs[pair->second], where, to.external[pair->second]);
    }
  }

private:
  struct Contact {
    std::uint32_t site = 0;
    Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  // carries vectors from there to the site
  };

  std::uint32_t tool_of(const RecordedRow& row, const MeasuredScene& measured, const std::string& where) const {
    const std::string& name = row.tool.empty() ? measured.tool : row.tool;
    if (name.empty() && tools_.size() > 1) {
      throw Error(ExitCode::bad_input, where + ": names no tool, and the scene has " + std::to_string(tools_.size()) +
                                           ": a column 'tool', or the key 'tool' of [[measured]], says which");
    }
    const std::uint32_t tool = name.empty() ? 0 : bake::find_tool(tools_, name, where);
    bake::refuse_grasps(tools_[tool], where);
    return tool;
  }

  Contact contact_of(const RecordedRow& row, const MeasuredScene& measured, const std::string& where) const {
    Contact contact;
    if (row.site) {
      if (*row.site >= static_cast<std::int64_t>(plan_.sites.size())) {
        throw Error(ExitCode::bad_input, where + ": there is no site " + std::to_string(*row.site) + "; the body has " +
                                             std::to_string(plan_.sites.size()));
      }
      contact.site = static_cast<std::uint32_t>(*row.site);
      return contact;
    }
    const double reach = measured.reach > 0 ? measured.reach : kReach * scene_.sampling.spacing;
    const geometry::ClosestPoint closest = body_.query->closest(row.point);
    if (closest.distance > reach) {
      char text[160];
      std::snprintf(text, sizeof text, ": the contact lies %.3g mm off the body's surface, allowed %.3g mm",
                    1e3 * closest.distance, 1e3 * reach);
      throw Error(ExitCode::bad_input, where + text);
    }
    const Vector3d normal = body_.query->normal(closest.point, sites::normal_radius(scene_));
    double nearest = std::numeric_limits<double>::infinity();
    for (std::uint32_t k = 0; k < plan_.sites.size(); ++k) {
      const ContactFrame& frame = plan_.sites[k].frame;
      const double distance = (frame.origin - closest.point).squaredNorm();
      // Through a thin wall, the other face's sites may be the nearer ones.
      if (distance >= nearest || frame.n.dot(normal) <= kFacing) continue;
      nearest = distance;
      contact.site = k;
    }
    if (!std::isfinite(nearest)) {
      throw Error(ExitCode::bad_input, where + ": no site of the body faces as its surface does there");
    }
    const Vector3d &to = plan_.sites[contact.site].frame.n, axis = normal.cross(to);
    contact.turn = Eigen::Quaterniond(1 + normal.dot(to), axis.x(), axis.y(), axis.z()).normalized();
    return contact;
  }

  void add(const RecordedRow& row, const Contact& contact, const PairPlan& pair, const std::string& where,
           fit::ExternalSamples& to) const {
    const Vector3d deflection = pair.frame.to_local(contact.turn * row.deflection);
    Sample sample;
    sample.deflection = {deflection.x(), deflection.y(), -deflection.z()};
    sample.force = pair.frame.to_local(contact.turn * row.force);
    const double depth = sample.deflection.z(), tangential = sample.deflection.head<2>().norm();
    const bool normal = tangential <= kTangentialOverDepth * std::max(depth, kShallow * pair.depth);
    to.measured = true;
    const bool aside = !normal && (!(scene_.friction > 0) || tangential > aside_ * depth);
    std::size_t* const passed = row.weight == 0                 ? &to.passed.weightless
                                : !(depth > 0)                  ? &to.passed.out
                                : depth > scene_.sampling.depth ? &to.passed.deep
                                : aside                         ? &to.passed.aside
                                                                : nullptr;
    if (passed != nullptr) {
      ++*passed;
      return;
    }
    sample.kind = normal ? SampleKind::normal : SampleKind::tangential;
    // Held-out samples are drawn by it.
    sample.index = static_cast<std::uint16_t>(to.samples.size() % 0xFFFF);
    sample.friction_limit = scene_.friction;
    sample.weight = row.weight;
    to.samples.push_back(sample);
    to.rows.push_back(where);
  }

  const Scene& scene_;
  const Body& body_;
  const std::vector<tool::Tool>& tools_;
  const bake::Plan& plan_;
  std::map<PairName, std::uint32_t> pairs_;
  double aside_;  // over the depth, as far as a bake pushes
};

}  // namespace

void read_recordings(const Scene& scene, const std::vector<MeasuredScene>& measured, const Body& body,
                     const std::vector<tool::Tool>& tools, const bake::Plan& plan, fit::PairSources& sources) {
  const Recorder recorder(scene, body, tools, plan);
  for (const MeasuredScene& one : measured) recorder.read(one, sources);
}

}  // namespace palpate::pipeline
