// SPDX-License-Identifier: GPL-3.0-or-later
// Builds the plan: sites, untouchable pairs, hashes of the inputs.
#include "precompute/bake/plan.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "formats/io/error.hpp"
#include "formats/scene/scene.hpp"
#include "precompute/bake/reach.hpp"
#include "precompute/common/body.hpp"
#include "precompute/sites/haptic_mesh.hpp"
#include "precompute/solve/pair/pair.hpp"
#include "precompute/tool/tool.hpp"

namespace palpate::bake {
namespace {

using Eigen::Vector3d;

void add(Hasher& hasher, const Vector3d& v) { hasher.number(v.x()).number(v.y()).number(v.z()); }

void add(Hasher& hasher, const Surface& surface) {
  hasher.number(static_cast<std::int64_t>(surface.vertices.size()));
  for (const Vector3d& v : surface.vertices) add(hasher, v);
  hasher.number(static_cast<std::int64_t>(surface.triangles.size()));
  for (const auto& t : surface.triangles) hasher.bytes(t.data(), sizeof t);
  hasher.bytes(surface.parts.data(), surface.parts.size() * sizeof surface.parts[0]);
  for (const std::string& name : surface.part_names) hasher.text(name);
}

void add(Hasher& hasher, const std::shared_ptr<const geometry::CurveQuery>& fibres) {
  if (!fibres) return;
  hasher.number(static_cast<std::int64_t>(fibres->curves().points.size()));
  for (const Vector3d& p : fibres->curves().points) add(hasher, p);
  hasher.number(static_cast<std::int64_t>(fibres->curves().pieces.size()));
  for (const auto& piece : fibres->curves().pieces) hasher.bytes(piece.data(), sizeof piece);
}

Hash128 hash_body(const Body& body) {
  Hasher hasher;
  add(hasher, body.query->surface());
  add(hasher, body.base);
  add(hasher, body.fibres);
  for (const Inclusion& inclusion : body.inclusions) {
    add(hasher, inclusion.query->surface());
    add(hasher, inclusion.fibres);
  }
  for (const auto& support : body.support_surfaces) {
    if (support) add(hasher, support->surface());
  }
  return hasher.digest();
}

Hash128 hash_tool(const tool::Tool& tool) {
  Hasher hasher;
  for (const tool::ToolVertex& v : tool.vertices) {
    hasher.text(v.name).number(v.curvature_radius).number(v.flat_radius).number(v.meridian);
    add(hasher, v.point);
    add(hasher, v.normal);
    add(hasher, v.tangent);
  }
  for (const auto& p : tool.patches) hasher.bytes(p.data(), sizeof p);
  // Analytic shapes are in the scene's text; a mesh's shape is its file.
  if (tool.scene.shape == ToolScene::Shape::mesh) {
    hasher.text(to_hex(hash_file(tool.scene.surface.file))).number(tool.scene.edge_radius);
  }
  return hasher.digest();
}

Hash128 hash_mesh(const sites::HapticMesh& mesh) {
  Hasher hasher;
  for (std::size_t k = 0; k < mesh.points.size(); ++k) {
    add(hasher, mesh.points[k]);
    add(hasher, mesh.normals[k]);
    add(hasher, mesh.tangents[k]);
    hasher.number(mesh.depth[k]);
  }
  for (const auto& t : mesh.triangles) hasher.bytes(t.data(), sizeof t);
  return hasher.digest();
}

std::vector<PlanSite> make_sites(const sites::HapticMesh& mesh) {
  std::vector<PlanSite> sites(mesh.points.size());
  for (std::size_t k = 0; k < sites.size(); ++k) {
    ContactFrame& frame = sites[k].frame;
    frame.origin = mesh.points[k];
    frame.n = mesh.normals[k];
    frame.x = mesh.tangents[k];
    frame.y = frame.n.cross(frame.x);
    sites[k].depth = mesh.depth[k];
    sites[k].held = mesh.held[k] != 0;
    sites[k].selected = mesh.selected[k] != 0;
  }
  for (const auto& t : mesh.triangles) {
    const Vector3d &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
    const double third = (b - a).cross(c - a).norm() / 6;
    for (const std::int32_t v : t) sites[v].area += third;
  }
  return sites;
}

}  // namespace

void add_sites(Plan& plan, const Body& body, const sites::HapticMesh& mesh, const std::vector<tool::Tool>& tools,
               PairRole role) {
  const std::size_t known = plan.sites.size();
  plan.sites = make_sites(mesh);
  for (auto site = static_cast<std::uint32_t>(known); site < plan.sites.size(); ++site) {
    const PlanSite& at = plan.sites[site];
    for (std::uint32_t tool = 0; tool < tools.size(); ++tool) {
      for (std::uint32_t vertex = 0; vertex < tools[tool].vertices.size(); ++vertex) {
        const tool::ToolVertex& touching = tools[tool].vertices[vertex];
        const bool support = at.held || reaches_support({body, tools[tool], touching, at.frame}, at.depth);
        const bool unreachable = !support && at.selected && !can_touch_first({body, tools[tool], touching, at.frame});
        if (support || unreachable || !at.selected) {
          plan.skipped.push_back({site, tool, vertex,
                                  support       ? SkipReason::support
                                  : unreachable ? SkipReason::unreachable
                                                : SkipReason::outside});
        } else {
          plan.pairs.push_back({site, tool, vertex, at.frame, at.depth, role});
        }
      }
    }
  }
  double area = 0, on_support = 0, in_folds = 0;
  std::size_t vertices = 0;
  for (const tool::Tool& tool : tools) vertices += tool.vertices.size();
  for (const PlanSite& site : plan.sites) area += static_cast<double>(vertices) * site.area;
  for (const SkippedPair& pair : plan.skipped) {
    if (pair.reason == SkipReason::support) on_support += plan.sites[pair.site].area;
    if (pair.reason == SkipReason::unreachable) in_folds += plan.sites[pair.site].area;
  }
  plan.support_share = area > 0 ? on_support / area : 0.0;
  plan.unreachable_share = area > 0 ? in_folds / area : 0.0;
}

Plan make_plan(const Scene& scene, const Body& body, const sites::HapticMesh& mesh,
               const std::vector<tool::Tool>& tools, PairRole role) {
  Plan plan;
  plan.inputs.solver = solve::kSolverRevision;
  plan.inputs.scene = hash128(canonical_text(scene, CanonicalScope::solves));
  plan.inputs.body = hash_body(body);
  plan.inputs.haptic_mesh = hash_mesh(mesh);
  for (const tool::Tool& tool : tools) plan.inputs.tools.push_back(hash_tool(tool));

  add_sites(plan, body, mesh, tools, role);
  for (std::uint32_t tool = 0; tool < tools.size(); ++tool) {
    for (std::uint32_t vertex = 0; vertex < tools[tool].vertices.size(); ++vertex) {
      bool planned = false;
      for (const PairPlan& pair : plan.pairs) planned = planned || (pair.tool == tool && pair.tool_vertex == vertex);
      if (!planned) {
        throw Error(ExitCode::bad_input,
                    scene.file.string() + ": tool '" + tools[tool].name + "' vertex " + std::to_string(vertex) +
                        " can touch no site: supports (and sampling.within_box) leave none of the " +
                        std::to_string(plan.sites.size()) + " sites free");
      }
    }
  }
  return plan;
}

}  // namespace palpate::bake
