// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/verify/contact_checks.hpp"

#include "precompute/bake/parallel.hpp"
#include "precompute/sites/haptic_mesh.hpp"

#include <algorithm>
#include <chrono>
#include <mutex>
#include <numbers>

namespace palpate::verify {
namespace {

constexpr int kDirections = 4;

// Calls work(k) for each, with its time and the progress.
template <class Work>
void each(std::size_t count, const ContactCheckOptions& options, Work&& work) {
  std::size_t done = 0;
  std::mutex guard;
  bake::parallel_for(count, options.threads, [&](std::size_t k) {
    const auto start = std::chrono::steady_clock::now();
    auto& result = work(k);
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const std::lock_guard lock(guard);
    ++done;
    if (options.progress) options.progress(done, count);
  });
}

// `solve(angle)` in the first direction whose cause does not begin with `off_surface`: those are refused unmeshed.
template <class Solve>
auto first_free(double& angle, const char* off_surface, Solve&& solve) {
  auto result = solve(angle = 0.0);
  for (int k = 1; k < kDirections && result.cause.rfind(off_surface, 0) == 0; ++k) {
    result = solve(angle = 2 * std::numbers::pi * k / kDirections);
  }
  return result;
}

// m, between two of the places; 0 for one.
double least_distance(const std::vector<ContactFrame>& places) {
  double least = 0;
  for (std::size_t a = 0; a < places.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const double distance = (places[a].origin - places[b].origin).norm();
      least = least > 0 ? std::min(least, distance) : distance;
    }
  }
  return least;
}

// Why a bake has nothing for a tool at a place and depth; empty where it has.
std::string unbaked(const Scene& scene, const solve::ContactCase& at, double depth,
                    const ContactCheckOptions& options) {
  const Eigen::Vector3d& p = at.frame.origin;
  if (!sites::within_box(scene, p)) return "place: outside sampling.within_box";
  const double room = scene.sampling.depth_fraction * at.body.query->thickness(p, at.frame.n);
  if (room < (1 - 1e-9) * depth) return "place: sampling.depth_fraction ends at " + std::to_string(1e3 * room) + " mm";
  if (options.touchable && !options.touchable(at, depth)) return "place: at a support or in a fold";
  return {};
}

}  // namespace

std::vector<CheckedSlide> check_slides(const Scene& scene, const Body& body, const tool::Tool& tool,
                                       const std::vector<BenchContact>& contacts, const ContactCheckOptions& options) {
  std::vector<CheckedSlide> all(contacts.size());
  each(all.size(), options, [&](std::size_t k) -> CheckedSlide& {
    solve::SlidePath path;
    path.depth = contacts[k].depth;
    path.friction = scene.friction;
    path.radii = options.radii;
    all[k].result = first_free(all[k].angle, "path:", [&](double angle) {
      path.angle = angle;
      return solve::solve_slide({body, tool, tool.vertices.at(0), contacts[k].frame}, path, solve::pair_options(scene));
    });
    return all[k];
  });
  return all;
}

std::vector<CheckedStroke> check_strokes(const Scene& scene, const Body& body, const tool::Tool& tool,
                                         const std::vector<BenchContact>& contacts,
                                         const ContactCheckOptions& options) {
  solve::PairOptions solver = solve::pair_options(scene);
  solver.refine *= options.stroke_refine;
  const std::size_t kinds = standard_strokes({1.0, 1.0, scene.friction}).size();
  std::vector<CheckedStroke> all(contacts.size() * kinds);
  each(all.size(), options, [&](std::size_t k) -> CheckedStroke& {
    CheckedStroke& stroke = all[k];
    stroke.contact = k / kinds;
    const BenchContact& contact = contacts[stroke.contact];
    StrokeScale scale{options.stroke_depth * contact.depth, 0.0, scene.friction, body.material.poisson, 0.0};
    scale.contact_radius = tool::contact_radius(tool.vertices.at(0), scale.depth);
    stroke.result = first_free(stroke.angle, "path:", [&](double angle) {
      scale.angle = angle;
      NamedStroke named = standard_strokes(scale).at(k % kinds);
      stroke.name = named.name;
      return solve::solve_stroke({body, tool, tool.vertices.at(0), contact.frame}, named.path, solver);
    });
    return stroke;
  });
  return all;
}

std::vector<CheckedTogether> check_together(const Scene& scene, const Body& body, const tool::Tool& tool,
                                            const std::vector<BenchContact>& contacts,
                                            const ContactCheckOptions& options) {
  const bool random = options.layout == Layout::random;
  const std::size_t layouts = options.layout == Layout::pinch ? 1 : random ? options.draws : options.spacings.size();
  std::vector<CheckedTogether> all(contacts.size() * layouts);
  each(all.size(), options, [&](std::size_t k) -> CheckedTogether& {
    CheckedTogether& checked = all[k];
    checked.contact = k / layouts;
    const BenchContact& contact = contacts[checked.contact];
    const double radius = tool::contact_radius(tool.vertices.at(0), contact.depth);
    LayoutOptions layout;
    layout.layout = options.layout;
    layout.count = options.count;
    layout.aside = radius;
    layout.normal_radius = sites::normal_radius(scene);
    layout.spacing = radius * options.spacings.at(random ? 0 : k % layouts);
    if (random) {
      const auto [least, most] = std::minmax_element(options.spacings.begin(), options.spacings.end());
      layout.spacing = radius * *least;
      layout.farthest = radius * *most;
    }
    Places places;
    for (int turn = 0; turn < kDirections; ++turn) {
      layout.angle = 2 * std::numbers::pi * turn / kDirections;
      layout.seed = static_cast<std::uint32_t>(1 + kDirections * k + static_cast<std::size_t>(turn));
      places = lay_out(body, contact.frame, layout);
      for (std::size_t i = 1; places.cause.empty() && i < places.frames.size(); ++i) {
        places.cause = unbaked(scene, {body, tool, tool.vertices.at(0), places.frames[i]}, contact.depth, options);
      }
      if (places.cause.empty()) break;
    }
    checked.places = places.frames;
    checked.spacing = least_distance(places.frames) / radius;
    checked.result.cause = places.cause;
    if (!places.cause.empty()) return checked;
    solve::TogetherPath path;
    path.places = places.frames;
    path.depth = contact.depth;
    path.sticking = options.sticking || options.aside > 0;
    path.aside = options.aside * contact.depth;
    path.alone_depth = options.alone_depth;
    checked.result = solve::solve_together(body, tool, tool.vertices.at(0), path, solve::pair_options(scene));
    return checked;
  });
  return all;
}

}  // namespace palpate::verify
