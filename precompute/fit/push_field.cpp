// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/fit/push_field.hpp"

#include "precompute/algebra/rotation_between.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace palpate::fit {
namespace {

constexpr double kMostGrowth = 0.4;  // of the logarithm of a force from a solved site to one beside it

constexpr int kPoints = 12;  // of an extrapolated push

double inverse_distance(const bake::PlanSite& a, const bake::PlanSite& b) {
  return 1.0 / std::max((a.frame.origin - b.frame.origin).norm(), 1e-9);
}

/// Components (x, y, n) in another frame of a force that turns with the normal.
Eigen::Vector3d turned(const Eigen::Vector3d& force, const ContactFrame& from, const ContactFrame& to) {
  const Eigen::Vector3d tangential = force.x() * from.x + force.y() * from.y;
  const Eigen::Vector3d there = algebra::rotation_between(from.n, to.n) * tangential;
  return {there.dot(to.x), there.dot(to.y), force.z()};
}

}  // namespace

PushField::PushField(const std::vector<bake::PlanSite>& sites, const SiteGraph& graph,
                     const std::map<std::uint32_t, NormalCurve>& curves)
    : sites_(sites), graph_(graph), curves_(sites.size()), solved_(sites.size(), 0), blends_(sites.size()) {
  for (const auto& [site, curve] : curves) {
    curves_[site] = curve;
    solved_[site] = 1;
  }
  for (std::uint32_t site = 0; site < sites.size(); ++site) {
    const auto& near = graph[site];
    if (solved(site) || std::none_of(near.begin(), near.end(), [&](std::uint32_t n) { return solved(n); })) continue;
    extrapolated_.emplace(site, extrapolate(site));
  }
  for (const auto& [site, curve] : extrapolated_) curves_[site] = curve;
  for (std::uint32_t site = 0; site < sites.size(); ++site) {
    if (curves_[site]) blends_[site] = {{site, 1.0}};
  }
  blend_others();
}

Eigen::Vector3d PushField::force(std::uint32_t site, double depth, const ContactFrame& frame) const {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  for (const auto& [from, weight] : blends_[site]) {
    force += weight * turned(curves_[from]->force(depth), sites_[from].frame, frame);
  }
  return force;
}

Eigen::Vector3d PushField::slope(std::uint32_t site, double depth) const {
  const ContactFrame& frame = sites_[site].frame;
  const double here = std::log(curves_[site]->force(depth).z());
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (const std::uint32_t near : graph_[site]) {
    if (!solved(near)) continue;
    const Eigen::Vector2d d = frame.to_local(sites_[near].frame.origin - frame.origin).head<2>();
    const double weight = 1.0 / std::max(d.squaredNorm(), 1e-18);
    normal += weight * d * d.transpose();
    right += weight * (std::log(curves_[near]->force(depth).z()) - here) * d;
  }
  // One edge alone leaves the direction across it without a slope.
  normal.diagonal().array() += 1e-3 * std::max(normal.trace(), 1e-12);
  const Eigen::Vector2d g = normal.ldlt().solve(right);
  return g.x() * frame.x + g.y() * frame.y;
}

NormalCurve PushField::extrapolate(std::uint32_t site) const {
  const bake::PlanSite& here = sites_[site];
  std::vector<Sample> samples;
  for (int k = 1; k <= kPoints; ++k) {
    const double depth = here.depth * k * k / (static_cast<double>(kPoints) * kPoints);
    double total = 0;
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    for (const std::uint32_t near : graph_[site]) {
      if (!solved(near)) continue;
      const bake::PlanSite& there = sites_[near];
      const double weight = inverse_distance(here, there);
      const double growth = slope(near, depth).dot(here.frame.origin - there.frame.origin);
      Eigen::Vector3d at = turned(curves_[near]->force(depth), there.frame, here.frame);
      at.z() *= std::exp(std::clamp(growth, -kMostGrowth, kMostGrowth));
      total += weight;
      force += weight * at;
    }
    Sample sample;
    sample.deflection = {0, 0, depth};
    sample.force = force / total;
    samples.push_back(sample);
  }
  return NormalCurve(samples);
}

void PushField::blend_others() {
  for (bool grown = true; grown;) {
    grown = false;
    std::vector<std::pair<std::uint32_t, std::map<std::uint32_t, double>>> filled;
    for (std::uint32_t site = 0; site < blends_.size(); ++site) {
      if (known(site)) continue;
      double total = 0;
      std::map<std::uint32_t, double> blend;
      for (const std::uint32_t near : graph_[site]) {
        if (!known(near)) continue;
        const double weight = inverse_distance(sites_[near], sites_[site]);
        total += weight;
        for (const auto& [from, share] : blends_[near]) blend[from] += weight * share;
      }
      if (blend.empty()) continue;
      for (auto& [from, share] : blend) share /= total;
      filled.emplace_back(site, std::move(blend));
    }
    for (auto& [site, blend] : filled) {
      blends_[site].assign(blend.begin(), blend.end());
      grown = true;
    }
  }
}

}  // namespace palpate::fit
