// SPDX-License-Identifier: GPL-3.0-or-later
// Drawing, solving and comparing held-out contacts.
#include "precompute/verify/held_out/held_out.hpp"

#include "formats/io/error.hpp"
#include "palpate/contact/bonded_contact.hpp"
#include "palpate/response/interpolation.hpp"
#include "precompute/bake/parallel.hpp"
#include "precompute/sites/haptic_mesh.hpp"
#include "precompute/solve/pair/pair.hpp"
#include "precompute/solve/pair/solved_limit.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <numbers>
#include <random>
#include <utility>

namespace palpate::verify {
namespace {

using Eigen::Vector3d;

Vector3d to_eigen(const runtime::Vec3& v) { return {v.x, v.y, v.z}; }
runtime::Vec3 to_runtime(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

runtime::Pose pose_of(const Eigen::Matrix3d& rotation) {
  runtime::Pose pose;
  for (int k = 0; k < 9; ++k) pose.rotation[k] = rotation(k / 3, k % 3);
  return pose;
}

// Uniform in [0, 1): the standard distributions differ between libraries, this does not.
double uniform(std::mt19937_64& engine) { return static_cast<double>(engine() >> 11) * 0x1.0p-53; }

Vector3d random_weights(std::mt19937_64& engine) {
  const double a = std::sqrt(uniform(engine)), b = uniform(engine);
  return {1 - a, a * (1 - b), a * b};
}

// Picks an index with probability proportional to its share of the last running sum.
std::size_t pick(const std::vector<double>& running, double u) {
  const auto at = std::upper_bound(running.begin(), running.end(), u * running.back());
  return std::min<std::size_t>(static_cast<std::size_t>(at - running.begin()), running.size() - 1);
}

// Cumulative areas of the triangles that a tool can reach from outside.
std::vector<double> running_areas(const Body& body) {
  const Surface& surface = body.query->surface();
  std::vector<double> sums;
  double sum = 0;
  for (std::size_t k = 0; k < surface.triangles.size(); ++k) {
    const auto& t = surface.triangles[k];
    const bool reached = body.cavity.empty() || body.cavity[k] == 0;
    const Vector3d &a = surface.vertices[t[0]], &b = surface.vertices[t[1]], &c = surface.vertices[t[2]];
    sums.push_back(sum += reached ? 0.5 * (b - a).cross(c - a).norm() : 0.0);
  }
  return sums;
}

// Length of a profile's segment, area of a triangle; 1 for the only patch of a tip.
std::vector<double> running_tool_sizes(const tool::Tool& tool) {
  std::vector<double> sums;
  double sum = 0;
  for (const auto& p : tool.patches) {
    const tool::ToolVertex &a = tool.vertices[p[0]], &b = tool.vertices[p[1]], &c = tool.vertices[p[2]];
    double size = 1.0;
    if (tool.kind == tool::ToolKind::profile && p[0] != p[1]) size = std::abs(b.meridian - a.meridian);
    if (tool.kind == tool::ToolKind::mesh) size = 0.5 * (b.point - a.point).cross(c.point - a.point).norm();
    sums.push_back(sum += size);
  }
  return sums;
}

// The frame that the runtime uses at a point of the contact surface: n(c), and the sites' tangents carried to it.
ContactFrame frame_at(const runtime::View& view, const runtime::BodyPoint& at, const Vector3d& origin) {
  ContactFrame frame;
  frame.origin = origin;
  frame.n = to_eigen(runtime::smooth_normal(view, at));
  double weights[3];
  runtime::site_weights(view, at, weights);
  const auto& sites = view.triangle(at.triangle).site;
  Vector3d tangent = Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const layout::Site& site = view.sites[sites[k]];
    const Vector3d n = to_eigen(runtime::to_vec(site.normal)), t = to_eigen(runtime::to_vec(site.tangent));
    const double cosine = n.dot(frame.n);
    tangent += weights[k] * (cosine > -0.999 ? t - (t.dot(frame.n) / (1 + cosine)) * (n + frame.n) : t);
  }
  tangent -= tangent.dot(frame.n) * frame.n;
  frame.x = tangent.norm() > 1e-9 ? tangent.normalized() : Vector3d(frame.n.unitOrthogonal());
  frame.y = frame.n.cross(frame.x);
  return frame;
}

// Three right-angled axes off the bake's, turned with `start` about the normal: each has its part of twist and rolling.
std::vector<Vector3d> held_out_turns(double angle, double start) {
  const Eigen::Matrix3d axes =
      (Eigen::AngleAxisd(start, Vector3d::UnitZ()) * Eigen::AngleAxisd(0.6, Vector3d(1, 1, 0).normalized()))
          .toRotationMatrix();
  return {0.7 * angle * axes.col(0), -0.7 * angle * axes.col(1), 0.7 * angle * axes.col(2)};
}

// `start`: of the tangential directions, in the frame at which the tool was baked. It leaves the bake's rays without
// turning the tool, so that x, y and what lies between them are compared.
solve::PairPath held_out_path(const Scene& scene, const ToolScene& tool, double depth, double start) {
  solve::PairPath path = solve::bake_path(scene, depth);
  // Off the grid of the bake everywhere but at the deepest point.
  const int n = scene.sampling.normal_points;
  for (int k = 1; k < n; ++k) path.normal_depths[k - 1] = depth * std::pow((k - 0.4) / (n - 0.4), 2);
  path.normal_depths[n - 1] = depth;
  if (path.friction > 0) {
    path.tangential_depths = {path.normal_depths[n / 3], path.normal_depths[2 * n / 3], depth};
    path.tangential_directions = 3;
    path.tangential_start = start;
    path.tangential_points = 2;
    path.slip_directions = 2;
    path.side_paths = solve::test_paths(path, start);
  }
  solve::add_grasp(path, scene, tool, depth);
  if (path.grasp_depth > 0) {
    const double spacing = path.grasp_depths[1] - path.grasp_depths[0];
    for (double& d : path.grasp_depths) d += d < 0 ? 0.4 * spacing : -0.4 * spacing;
    path.grasp_directions = 2;
    if (tool.grasp_turn > 0) path.grasp_turns = held_out_turns(tool.grasp_turn, start);
    path.tangential_start = start;
  }
  return path;
}

// The tool's vertex that presses, turned about its normal.
tool::ToolVertex pressing(const tool::Tool& tool, const HeldOut& contact) {
  return tool::spun(tool::interpolate(tool, static_cast<std::int32_t>(contact.tool_patch), contact.tool_weights),
                    contact.spin);
}

void solve(const Scene& scene, const Body& body, const tool::Tool& tool, HeldOut& contact, double start) {
  const tool::ToolVertex vertex = pressing(tool, contact);
  const ContactFrame& frame = contact.frame;
  solve::PairPath path = held_out_path(scene, tool.scene, contact.depth, start);
  if (contact.at_pair) {  // these are of pushes alone
    path.slip_points = 0;
    path.side_paths.clear();
  }
  const PairResult result = solve::solve_pair({body, tool, vertex, frame}, path, solve::pair_options(scene));
  contact.floor = scene.response.floor;
  contact.accepted = result.outcome.accepted;
  contact.cause = result.outcome.cause;
  if (!contact.accepted) return;
  std::optional<Vector3d> from;
  std::map<double, const Sample*> normal;  // by depth
  for (const Sample& s : result.samples) {
    if (s.kind == SampleKind::normal) normal[s.deflection.z()] = &s;
    if (s.kind == SampleKind::slipping) {
      const auto before = normal.find(s.deflection.z());
      if (s.friction_limit > 0 && before != normal.end()) {
        contact.limits.push_back(
            {s.deflection.z(), solve::solved_limit(s, *before->second, scene.sampling.depth), 0.0, 0.0});
      }
      continue;
    }
    ForcePair f;
    f.kind = s.kind;
    f.deflection = frame.to_world({s.deflection.x(), s.deflection.y(), -s.deflection.z()});
    f.solved = frame.to_world(s.force);
    if (!s.rotation.isZero(0)) {
      f.turn = ForcePair::Turn{frame.to_world(s.rotation), frame.to_world(s.torque), Vector3d::Zero(), 0.0};
    }
    if (s.kind == SampleKind::path && s.index % solve::kPathStride == 0) {
      from = f.deflection;
      continue;
    }
    f.from = std::exchange(from, std::nullopt);
    contact.forces.push_back(f);
  }
}

// A path of a contact that sticks: the tangential deflection follows the tool from force to force, and a deepening keeps
// the tangential force, because new area is unstressed.
class Replay {
public:
  explicit Replay(const runtime::BlendedResponse<>& response) : response_(response) {}
  runtime::Vec3 go(const ForcePair& to) {
    constexpr int kSteps = 32;
    const runtime::Vec3& n = response_.normal();
    if (to.from) {
      tool_ = to_runtime(*to.from);
      held_ = {};
    }
    const runtime::Vec3 step = (1.0 / kSteps) * (to_runtime(to.deflection) - tool_);
    for (int k = 0; k < kSteps; ++k) {
      const double before = -dot(tool_, n);
      tool_ = tool_ + step;
      held_ = held_ + response_.in_plane(step);
      const double depth = -dot(tool_, n);
      if (!(depth > before)) continue;
      const runtime::ResponseLaw& law = response_.law();
      held_ = before > 0 ? solve(law.at(depth).stiffness, law.at(before).stiffness * held_) : runtime::Vec2{};
    }
    return response_.force(response_.in_space(held_) + dot(tool_, n) * n);
  }

private:
  const runtime::BlendedResponse<>& response_;
  runtime::Vec3 tool_;
  runtime::Vec2 held_;
};

// Puts a contact on the surface nearest to a point; false where nothing can touch there.
bool place(const runtime::View& view, const Scene& scene, const Body& body, const tool::Tool& tool,
           const HeldOutOptions& options, const runtime::Vec3& point, HeldOut& contact) {
  const runtime::Location at = runtime::closest_point(view, point);
  contact.frame = frame_at(view, at.at, body.query->closest(to_eigen(at.point)).point);
  contact.thickness = body.query->thickness(contact.frame.origin, contact.frame.n);
  contact.depth = std::min(scene.sampling.depth, scene.sampling.depth_fraction * contact.thickness);
  const tool::ToolVertex vertex = pressing(tool, contact);
  if (tool.scene.spins > 1) contact.orientation = tool::touching_pose(vertex, contact.frame).linear();
  return !options.touchable || options.touchable({body, tool, vertex, contact.frame}, contact.depth);
}

// The corner of a tool patch that is this vertex alone; false where no patch has it.
bool corner_of(const tool::Tool& tool, std::int32_t vertex, HeldOut& contact) {
  for (std::size_t p = 0; p < tool.patches.size(); ++p) {
    const auto& corners = tool.patches[p];
    const auto at = std::find(corners.begin(), corners.end(), vertex) - corners.begin();
    if (at == 3) continue;
    contact.tool_patch = static_cast<std::uint32_t>(p);
    contact.tool_weights = Vector3d::Unit(at);
    return true;
  }
  return false;
}

// All spins of a tool's vertex were solved at the site.
bool solved(const runtime::View& view, std::uint32_t site, std::uint32_t vertex, std::uint32_t spins) {
  for (std::uint32_t k = 0; k < spins; ++k) {
    const auto& head = view.response_head(layout::response_index(*view.meta, site, vertex + k));
    if (head.flags != layout::response_solved) return false;
  }
  return true;
}

// Draws options.count contacts at sampled pairs of tools with spins, between the sampled spins.
void draw_spins(const runtime::View& view, const Scene& scene, const Body& body, const std::vector<tool::Tool>& tools,
                const HeldOutOptions& options, std::mt19937_64& engine, std::vector<HeldOut>& contacts,
                std::vector<double>& starts) {
  if (view.spins == nullptr) return;
  struct Candidate {
    std::uint32_t tool, vertex, site;
  };
  std::vector<Candidate> candidates;
  for (std::uint32_t tool = 0; tool < tools.size(); ++tool) {
    for (std::uint32_t vertex = 0; vertex < tools[tool].vertices.size(); ++vertex) {
      const int spins = tools[tool].vertices[vertex].spins;
      for (std::uint32_t site = 0; spins > 1 && site < view.meta->site_count; ++site) {
        if (solved(view, site, view.tools[tool].first_vertex + vertex, static_cast<std::uint32_t>(spins))) {
          candidates.push_back({tool, vertex, site});
        }
      }
    }
  }
  const std::size_t most = 1000 + 100 * static_cast<std::size_t>(options.count);
  std::uint32_t found = 0;
  for (std::size_t drawn = 0; !candidates.empty() && found < options.count && drawn < most; ++drawn) {
    const auto index = static_cast<std::size_t>(uniform(engine) * static_cast<double>(candidates.size()));
    const Candidate& pair = candidates[std::min(index, candidates.size() - 1)];
    HeldOut contact;
    contact.at_pair = true;
    contact.tool = pair.tool;
    contact.spin = 2 * std::numbers::pi * uniform(engine);
    const double start = 2 * std::numbers::pi * uniform(engine);
    const tool::Tool& tool = tools[pair.tool];
    if (!corner_of(tool, static_cast<std::int32_t>(pair.vertex), contact) ||
        !place(view, scene, body, tool, options, runtime::vertex(view, pair.site), contact)) {
      continue;
    }
    contacts.push_back(contact);
    starts.push_back(start);
    ++found;
  }
}

}  // namespace

HeldOutSet solve_held_out(const runtime::View& view, const Scene& scene, const Body& body,
                          const std::vector<tool::Tool>& tools, const HeldOutOptions& options) {
  if (options.count < 1 || options.count > 100000) {
    throw Error(ExitCode::usage, "held-out contacts: got " + std::to_string(options.count) + "; allowed 1 to 100000");
  }
  HeldOutSet set;
  std::mt19937_64 engine(options.seed);
  const Surface& surface = body.query->surface();
  const std::vector<double> areas = running_areas(body);
  std::vector<double> starts;
  std::size_t drawn = 0;
  const std::size_t most = 1000 + 100 * static_cast<std::size_t>(options.count);
  for (; set.contacts.size() < options.count && drawn < most; ++drawn) {
    HeldOut contact;
    contact.tool = static_cast<std::uint32_t>(set.contacts.size() % tools.size());
    const tool::Tool& tool = tools[contact.tool];
    const auto& t = surface.triangles[pick(areas, uniform(engine))];
    const Vector3d w = random_weights(engine);
    const Vector3d point =
        w[0] * surface.vertices[t[0]] + w[1] * surface.vertices[t[1]] + w[2] * surface.vertices[t[2]];
    contact.tool_patch = static_cast<std::uint32_t>(pick(running_tool_sizes(tool), uniform(engine)));
    const double along = uniform(engine);
    if (tool.kind == tool::ToolKind::profile) contact.tool_weights = {1 - along, along, 0};
    if (tool.kind == tool::ToolKind::mesh) contact.tool_weights = random_weights(engine);
    const double start = 2 * std::numbers::pi * uniform(engine);
    if (tool.scene.spins > 1) contact.spin = 2 * std::numbers::pi * uniform(engine);
    if (!sites::within_box(scene, point)) continue;
    if (!place(view, scene, body, tool, options, to_runtime(point), contact)) continue;
    set.contacts.push_back(contact);
    starts.push_back(start);
  }
  if (set.contacts.empty())
    throw Error(ExitCode::bad_input, "no part of the body can be touched: the supports cover it");
  set.untouchable_share = 1 - static_cast<double>(set.contacts.size()) / static_cast<double>(drawn);
  draw_spins(view, scene, body, tools, options, engine, set.contacts, starts);

  std::size_t done = 0;
  bool telling = false;
  std::mutex guard;  // of the two and the progress
  bake::parallel_for(set.contacts.size(), options.threads, [&](std::size_t k) {
    solve(scene, body, tools[set.contacts[k].tool], set.contacts[k], starts[k]);
    const std::lock_guard lock(guard);
    // A callback that threw is not called again by the other threads.
    if (!options.progress || std::exchange(telling, true)) return;
    options.progress(++done, set.contacts.size());
    telling = false;
  });
  compare_with_file(view, set.contacts);
  return set;
}

namespace {

/// The place on its tool. `contact` is called `what` in messages.
runtime::ToolPoint tool_point(const runtime::View& view, const HeldOut& contact, const std::string& what) {
  if (contact.tool >= view.meta->tool_count) {
    throw Error(ExitCode::bad_input, what + " names tool " + std::to_string(contact.tool) +
                                         "; the number of tools of the response file is " +
                                         std::to_string(view.meta->tool_count));
  }
  const layout::ToolRecord& tool = view.tools[contact.tool];
  runtime::ToolPoint point;
  if (tool.patch_count == 0) return point;
  if (contact.tool_patch >= tool.patch_count) {
    throw Error(ExitCode::bad_input, what + " names tool patch " + std::to_string(contact.tool_patch) +
                                         "; the number of patches of the response file's tool is " +
                                         std::to_string(tool.patch_count));
  }
  point.patch = tool.first_patch + contact.tool_patch;
  for (int k = 0; k < 3; ++k) point.weights[k] = contact.tool_weights[k];
  return point;
}

void check_bonded(const runtime::BondedResponse<true>& bonded, const HeldOut& contact, const std::string& what) {
  for (const ForcePair& f : contact.forces) {
    if (f.kind == SampleKind::grasped && !(bonded.depth() > 0)) {
      throw Error(ExitCode::bad_input, what + " is grasped; the response file has no grasp for that tool");
    }
    if (f.turn && !(bonded.rotated() > 0)) {
      throw Error(ExitCode::bad_input, what + " is turned; the response file has no turns for that tool");
    }
  }
}

void compare_contact(const runtime::View& view, HeldOut& contact, const std::string& what) {
  const runtime::ToolPoint point = tool_point(view, contact, what);
  const runtime::Location at = runtime::closest_point(view, to_runtime(contact.frame.origin));
  const runtime::Pose pose = contact.orientation ? pose_of(*contact.orientation) : runtime::Pose{};
  const runtime::Pose* const orientation = contact.orientation ? &pose : nullptr;
  runtime::BlendedResponse<> response;
  response.blend(view, contact.tool, at.at, point, {1, 0, 0}, orientation);
  contact.filled = response.filled_share();
  const runtime::BondedResponse<true> bonded(view, contact.tool, at.at, point, orientation);
  check_bonded(bonded, contact, what);
  double peak = 0, peak_torque = 0;
  for (const ForcePair& f : contact.forces) {
    peak = std::max(peak, f.solved.norm());
    if (f.turn) peak_torque = std::max(peak_torque, f.turn->solved.norm());
  }
  Replay replay(response);
  for (ForcePair& f : contact.forces) {
    const runtime::Vec3 deflection = to_runtime(f.deflection);
    const Vector3d rotation = f.turn ? f.turn->rotation : Vector3d::Zero();
    const runtime::BondedForce held =
        f.kind == SampleKind::grasped ? bonded.at(deflection, to_runtime(rotation)) : runtime::BondedForce{};
    f.baked = to_eigen(f.kind == SampleKind::path      ? replay.go(f)
                       : f.kind == SampleKind::grasped ? held.force
                                                       : response.force(deflection));
    if (f.turn) {
      f.turn->baked = to_eigen(held.torque);
      f.turn->error = (f.turn->baked - f.turn->solved).norm() / std::max(f.turn->solved.norm(), 0.02 * peak_torque);
    }
    f.error = (f.baked - f.solved).norm() / std::max({f.solved.norm(), 0.02 * peak, contact.floor});
  }
  for (LimitPair& l : contact.limits) {
    l.baked = response.law().at(l.depth).friction_coefficient;
    l.error = std::abs(l.baked - l.solved) / l.solved;
  }
}

}  // namespace

void compare_with_file(const runtime::View& view, std::vector<HeldOut>& contacts, const std::string& recorded) {
  const std::string where = recorded.empty() ? "" : recorded + ": ";
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    compare_contact(view, contacts[k], where + "contact " + std::to_string(k));
  }
}

}  // namespace palpate::verify
