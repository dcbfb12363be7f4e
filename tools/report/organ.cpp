// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/organ.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "tools/inspect/one_response.hpp"
#include "tools/report/numbers.hpp"

namespace palpate::report {
namespace {

Json triple(double x, double y, double z) { return {rounded(x), rounded(y), rounded(z)}; }
Json triple(const float (&v)[3]) { return triple(double{v[0]}, double{v[1]}, double{v[2]}); }
Json triple(const Eigen::Vector3d& v) { return triple(v.x(), v.y(), v.z()); }

Json rounded_list(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double v : values) list.push_back(rounded(v));
  return list;
}

/// Sites that share a patch with each site.
std::vector<std::set<std::uint32_t>> neighbours(const runtime::View& view) {
  std::vector<std::set<std::uint32_t>> near(view.meta->site_count);
  for (std::uint32_t patch = 0; patch < view.meta->patch_count; ++patch) {
    std::uint32_t site[3];
    view.patch_sites(patch, site);
    for (int k = 0; k < 3; ++k) {
      near[site[k]].insert(site[(k + 1) % 3]);
      near[site[k]].insert(site[(k + 2) % 3]);
    }
  }
  return near;
}

/// Estimated interpolation error midway between sites: a quarter of how far each solved site's stiffness is off the
/// mean of its neighbours, because that error grows as the square of the distance. NaN where a site was not solved.
std::vector<double> neighbour_errors(const runtime::View& view, const std::vector<double>& stiffness,
                                     std::uint32_t tool_vertex) {
  std::vector<double> errors(stiffness.size(), std::numeric_limits<double>::quiet_NaN());
  const auto near = neighbours(view);
  const auto filled = [&](std::uint32_t site) {
    return view.response_head(layout::response_index(*view.meta, site, tool_vertex)).flags == layout::response_filled;
  };
  for (std::uint32_t site = 0; site < stiffness.size(); ++site) {
    double sum = 0, weight = 0;
    for (const std::uint32_t other : near[site]) {
      if (filled(other)) continue;
      const double away = length(runtime::vertex(view, other) - runtime::vertex(view, site));
      if (!(away > 0)) continue;
      sum += stiffness[other] / away;
      weight += 1 / away;
    }
    if (filled(site) || !(weight > 0) || !(stiffness[site] > 0)) continue;
    errors[site] = 0.25 * std::abs(sum / weight - stiffness[site]) / stiffness[site];
  }
  return errors;
}

/// Tangential pushes along one direction at each depth: the first that was solved.
Json tangential_rays(const std::vector<Sample>& samples) {
  constexpr double kSame = 1e-6;  // of the depth, and of a unit direction
  Json rays = Json::array();
  double depth = -1;
  Eigen::Vector2d direction(0, 0);
  for (const Sample& s : samples) {
    if (s.kind != SampleKind::tangential) continue;
    const Eigen::Vector2d aside = s.deflection.head<2>();
    const double z = s.deflection.z(), way = aside.norm();
    if (!(way > 0)) continue;
    if (std::abs(z - depth) > kSame * z) {
      depth = z;
      direction = aside / way;
      rays.push_back({{"depth_m", rounded(z)},
                      {"direction", {rounded(direction.x()), rounded(direction.y())}},
                      {"push_m_N", Json::array()}});
    }
    if ((aside / way - direction).norm() > kSame) continue;
    rays.back()["push_m_N"].push_back({rounded(way), rounded(-s.force.head<2>().dot(direction))});
  }
  return rays;
}

}  // namespace

Json organ_of_file(const runtime::View& view) {
  const layout::Meta& m = *view.meta;
  Json organ{{"depth_scale_m", m.depth_scale}, {"field_depth_m", m.depth_scale / 2}};
  Json& sites = organ["sites"];
  for (std::uint32_t k = 0; k < m.site_count; ++k) {
    const layout::Site& site = view.sites[k];
    sites["position_m"].push_back(triple(view.vertices[k].xyz));
    sites["tangent"].push_back(triple(site.tangent));
    sites["normal"].push_back(triple(site.normal));
    sites["depth_m"].push_back(rounded(double{site.depth_limit}));
    sites["held"].push_back((site.flags & layout::site_held) != 0 ? 1 : 0);
    sites["outside"].push_back((site.flags & layout::site_outside) != 0 ? 1 : 0);
  }
  for (std::uint32_t t = 0; t < m.tool_count; ++t) {
    const layout::ToolRecord& record = view.tools[t];
    Json tool{{"name", record.name},
              {"kind", record.kind},
              {"radius_m", rounded(double{record.radius})},
              {"probe_radius_m", rounded(double{record.probe_radius})},
              {"axis_length_m", rounded(double{record.axis_length})},
              {"first_vertex", record.first_vertex},
              {"vertices", record.vertex_count}};
    std::vector<double> stiffness;
    for (std::uint32_t k = 0; k < m.site_count; ++k) {
      const std::uint64_t index = layout::response_index(m, k, record.first_vertex);
      const runtime::ResponseAtDepth at = cli::response_law(view, index).at(m.depth_scale / 2);
      stiffness.push_back(at.normal_slope);
      tool["force_N"].push_back(rounded(at.normal_force));
      if (layout::has_friction(m)) tool["friction_coefficient"].push_back(rounded(at.friction_coefficient));
      tool["source"].push_back(layout::source_name(view.response_head(index).flags));
    }
    tool["stiffness_N_per_m"] = rounded_list(stiffness);
    tool["error_neighbours"] = rounded_list(neighbour_errors(view, stiffness, record.first_vertex));
    organ["tools"].push_back(tool);
  }
  return organ;
}

void add_bake(Json& organ, const runtime::View& view, const pipeline::Pipeline& p, const JournalContent& journal,
              const fit::FitReport& fit) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  organ["sites"]["thickness_m"] = rounded_list(p.mesh.thickness);
  std::vector<std::vector<double>> fitted(view.meta->tool_count, std::vector<double>(view.meta->site_count, kNone));
  std::vector<std::vector<double>> solved = fitted;
  for (const fit::PairFigures& figures : fit.pairs) {
    const PairPlan& pair = p.plan.pairs[figures.pair];
    if (pair.tool_vertex == 0) fitted[pair.tool][pair.site] = figures.p95;
  }
  for (const auto& [index, content] : journal.pairs) {
    const PairPlan& pair = p.plan.pairs[index];
    const bool used = pair.role != PairRole::hidden && content.outcome && content.outcome->accepted;
    if (pair.tool_vertex != 0 || !used) continue;
    double worst = 0;
    for (const Sample& s : content.samples) {
      if (s.kind == SampleKind::normal && s.deflection.z() > 0.25 * pair.depth) {
        worst = std::max(worst, s.error_estimate);
      }
    }
    solved[pair.tool][pair.site] = worst;
  }
  for (std::size_t t = 0; t < view.meta->tool_count; ++t) {
    organ["tools"][t]["error_fit"] = rounded_list(fitted[t]);
    organ["tools"][t]["error_solve"] = rounded_list(solved[t]);
  }
  organ["regions"] = Json::array();
  for (const Inclusion& inclusion : p.body.inclusions) {
    Json region{{"name", inclusion.name}, {"young_Pa", rounded(small_strain_young(inclusion.material))}};
    for (const auto& v : inclusion.base.vertices) region["points_m"].push_back(triple(v));
    for (const auto& t : inclusion.base.triangles) region["triangles"].push_back(t);
    organ["regions"].push_back(region);
  }
  organ["young_Pa"] = rounded(small_strain_young(p.scene.material));
}

Json solved_curves(const pipeline::Pipeline& p, const JournalContent& journal) {
  std::vector<std::uint32_t> first_vertex;
  std::uint32_t vertices = 0;
  for (const tool::Tool& tool : p.tools) {
    first_vertex.push_back(vertices);
    vertices += static_cast<std::uint32_t>(tool.vertices.size());
  }
  Json pairs = Json::array();
  for (const auto& [index, content] : journal.pairs) {
    const PairPlan& pair = p.plan.pairs[index];
    if (!content.outcome || pair.role == PairRole::hidden) continue;
    Json json{{"site", pair.site}, {"tool_vertex", first_vertex[pair.tool] + pair.tool_vertex}};
    if (!content.outcome->accepted) {
      json["refused"] = content.outcome->cause;
    } else {
      json["normal_m_N"] = Json::array();
      for (const Sample& sample : content.samples) {
        if (sample.kind != SampleKind::normal) continue;
        json["normal_m_N"].push_back({rounded(sample.deflection.z()), rounded(sample.force.z())});
      }
      json["tangential"] = tangential_rays(content.samples);
    }
    pairs.push_back(json);
  }
  return pairs;
}

Json held_out_places(const std::vector<verify::HeldOut>& contacts) {
  Json places = Json::array();
  for (const verify::HeldOut& contact : contacts) {
    Json place{{"c_m", triple(contact.frame.origin)},
               {"n", triple(contact.frame.n)},
               {"tool", contact.tool},
               {"accepted", contact.accepted}};
    if (!contact.accepted) place["cause"] = contact.cause;
    double normal = 0, tangential = 0;
    place["normal_m_N_N"] = Json::array();
    for (const verify::ForcePair& f : contact.forces) {
      if (f.kind == SampleKind::normal) {
        normal = std::max(normal, f.error);
        place["normal_m_N_N"].push_back({rounded(-f.deflection.dot(contact.frame.n)),
                                         rounded(f.solved.dot(contact.frame.n)),
                                         rounded(f.baked.dot(contact.frame.n))});
      } else if (f.kind == SampleKind::tangential) {
        tangential = std::max(tangential, f.error);
      }
    }
    place["error"] = rounded(normal);
    place["error_tangential"] = rounded(tangential);
    places.push_back(place);
  }
  return places;
}

}  // namespace palpate::report
