// SPDX-License-Identifier: GPL-3.0-or-later
// Volume meshes of block and ball by both backends: volume, regions, quality, grading, determinism.
#include "precompute/mesh/volume/volume_mesh.hpp"

#include "tests/mesh/bodies.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <thread>

namespace palpate::mesh {
namespace {

using Eigen::Vector3d;
using Backend = VolumeMeshOptions::Backend;

VolumeMeshOptions with(Backend backend) {
  VolumeMeshOptions options;
  options.backend = backend;
  return options;
}

double six_volumes(const TetMesh& m, std::size_t t) {
  const auto& n = m.tets[t];
  const Vector3d& a = m.nodes[n[0]];
  return (m.nodes[n[1]] - a).cross(m.nodes[n[2]] - a).dot(m.nodes[n[3]] - a);
}

double region_volume(const TetMesh& m, std::int32_t region) {
  double sum = 0;
  for (std::size_t t = 0; t < m.tets.size(); ++t) sum += m.regions[t] == region ? six_volumes(m, t) / 6 : 0;
  return sum;
}

double face_volume(const TetMesh& m) {
  double six = 0;
  for (const auto& f : m.faces) six += m.nodes[f[0]].dot(m.nodes[f[1]].cross(m.nodes[f[2]]));
  return six / 6;
}

// Mean edge length over the size field at its middle.
double mean_relative_edge(const TetMesh& m, const SizeField& size) {
  constexpr int edges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  double sum = 0;
  for (const auto& t : m.tets) {
    for (const auto& [a, b] : edges) {
      sum += (m.nodes[t[a]] - m.nodes[t[b]]).norm() / size((m.nodes[t[a]] + m.nodes[t[b]]) / 2);
    }
  }
  return sum / (6.0 * static_cast<double>(m.tets.size()));
}

void expect_sound(const VolumeMeshResult& r, const Vector3d& anchor) {
  ASSERT_TRUE(r.usable) << r.cause;
  EXPECT_EQ(r.cause, "");
  const TetMesh& m = r.mesh;
  ASSERT_EQ(m.regions.size(), m.tets.size());
  for (std::size_t t = 0; t < m.tets.size(); ++t) ASSERT_GT(six_volumes(m, t), 0);
  EXPECT_GE(r.quality.min_dihedral, 3.0);
  EXPECT_NEAR(face_volume(m) / r.quality.volume, 1, 1e-9) << "faces are closed and point out";
  double nearest = 1;
  for (std::int32_t v = 0; v < m.corner_count; ++v) nearest = std::min(nearest, (m.nodes[v] - anchor).norm());
  EXPECT_LE(nearest, 1e-6);
}

TEST(VolumeMesh, BlockIsGradedRoundTheTip) {
  const double r = 0.005;
  const Body block = test::block_body(r);
  const Vector3d tip(0, 0, 0);
  const SizeField size = test::size_round(tip, 0.35 * r, block.diagonal / 8);
  const VolumeMeshResult result = mesh_volume(block, size, {tip}, with(Backend::tetgen));
  expect_sound(result, tip);
  EXPECT_EQ(result.backend, "tetgen");
  EXPECT_NEAR(result.quality.volume_error, 0, 1e-12);
  RecordProperty("tets", static_cast<int>(result.mesh.tets.size()));
  RecordProperty("nodes", static_cast<int>(result.mesh.nodes.size()));
  EXPECT_GT(result.mesh.tets.size(), 500u);
  EXPECT_LT(result.mesh.tets.size(), 1600u);
  EXPECT_GT(result.mesh.nodes.size(), 900u);
  EXPECT_LT(result.mesh.nodes.size(), 2600u);
  EXPECT_NEAR(mean_relative_edge(result.mesh, size), 1, 0.15);
}

TEST(VolumeMesh, SitesOnEdgeAndCornerOfTheBlock) {
  const Body block = test::block_body(0.005);
  for (const Vector3d& site : {Vector3d(0.025, 0, 0), Vector3d(0.025, 0.025, 0), Vector3d(0.0245, 0.01, 0)}) {
    const SizeField size = test::size_round(site, 0.00175, 0.008);
    expect_sound(mesh_volume(block, size, {site}, with(Backend::tetgen)), site);
  }
}

TEST(VolumeMesh, BallManySites) {
  const Surface fine = test::sphere_surface({0, 0, 0}, 0.05, 5);
  const Body ball = test::body_of(fine, 0.006);
  for (int k = 0; k < 20; ++k) {
    const Vector3d site = fine.vertices[static_cast<std::size_t>(97 * k)];
    const VolumeMeshResult result =
        mesh_volume(ball, test::size_round(site, 0.00175, ball.diagonal / 8), {site}, with(Backend::tetgen));
    expect_sound(result, site);
    EXPECT_LT(std::abs(result.quality.volume_error), 0.002);
  }
}

Body ball_with_lump() {
  Body body = test::body_of(test::sphere_surface({0, 0, 0}, 0.05, 4), 0.006);
  test::add_inclusion(body, test::sphere_surface({0, 0, 0.035}, 0.008, 3), 0.0015);
  return body;
}

TEST(VolumeMesh, InclusionHasItsVolumeByEitherBackend) {
  const Body body = ball_with_lump();
  const Vector3d site = body.query->closest({0, 0, 0.05}).point;
  const SizeField size = test::size_round(site, 0.00175, 0.0125);
  const double lump = test::surface_volume(body.inclusions[0].query->surface());
  for (const Backend backend : {Backend::tetgen, Backend::mesh3}) {
    const VolumeMeshResult result = mesh_volume(body, size, {site}, with(backend));
    expect_sound(result, site);
    EXPECT_NEAR(region_volume(result.mesh, 1) / lump, 1, 0.15) << result.backend;
    EXPECT_NEAR((region_volume(result.mesh, 0) + region_volume(result.mesh, 1)) / result.quality.volume, 1, 1e-9);
    EXPECT_LT(std::abs(result.quality.volume_error), 0.08) << result.backend;
  }
}

TEST(VolumeMesh, HollowBallIsNotFilled) {
  const double outside = 0.01, inside = 0.008;
  Surface shell = test::sphere_surface({0, 0, 0}, outside, 4);
  const Surface wall = test::sphere_surface({0, 0, 0}, inside, 4);
  const auto first = static_cast<std::int32_t>(shell.vertices.size());
  shell.vertices.insert(shell.vertices.end(), wall.vertices.begin(), wall.vertices.end());
  for (const auto& t : wall.triangles) shell.triangles.push_back({t[0] + first, t[2] + first, t[1] + first});
  shell.parts.assign(shell.triangles.size(), 0);
  const Body body = test::body_of(shell, 0.002);
  const Vector3d site = body.query->closest({0, 0, outside}).point;
  const VolumeMeshResult r = mesh_volume(body, test::size_round(site, 0.0006, 0.004), {site}, with(Backend::tetgen));
  expect_sound(r, site);
  const double volume = test::surface_volume(shell);
  EXPECT_NEAR(region_volume(r.mesh, 0) / volume, 1, 0.08);
  for (std::int32_t v = 0; v < r.mesh.corner_count; ++v) EXPECT_GT(r.mesh.nodes[v].norm(), 0.95 * inside);
}

TEST(VolumeMesh, SmallDeepInclusionIsNotMissed) {
  Body body = test::body_of(test::sphere_surface({0, 0, 0}, 0.05, 4), 0.006);
  test::add_inclusion(body, test::sphere_surface({0.01, -0.01, -0.02}, 0.003, 3), 0.001);
  const Vector3d site = body.query->closest({0, 0, 0.05}).point;
  const SizeField size = test::size_round(site, 0.003, 0.015);
  const double lump = test::surface_volume(body.inclusions[0].query->surface());
  for (const Backend backend : {Backend::tetgen, Backend::mesh3}) {
    const VolumeMeshResult result = mesh_volume(body, size, {site}, with(backend));
    expect_sound(result, site);
    EXPECT_GT(region_volume(result.mesh, 1), 0.5 * lump) << result.backend;
  }
}

TEST(VolumeMesh, BlockByMesh3KeepsItsEdges) {
  const Body block = test::block_body(0.005);
  const Vector3d tip(0, 0, 0);
  const SizeField size = test::size_round(tip, 0.00175, block.diagonal / 8);
  const VolumeMeshResult result = mesh_volume(block, size, {tip}, with(Backend::mesh3));
  expect_sound(result, tip);
  EXPECT_EQ(result.backend, "mesh3");
  EXPECT_NEAR(result.quality.volume_error, 0, 1e-3);
  RecordProperty("tets", static_cast<int>(result.mesh.tets.size()));
  EXPECT_NEAR(mean_relative_edge(result.mesh, size), 1, 0.3);
}

bool same(const TetMesh& a, const TetMesh& b) {
  return a.nodes == b.nodes && a.tets == b.tets && a.regions == b.regions && a.faces == b.faces;
}

TEST(VolumeMesh, SameBytesAgainAndFromTwoThreads) {
  Body body = test::body_of(test::sphere_surface({0, 0, 0}, 0.05, 3), 0.01);
  test::add_inclusion(body, test::sphere_surface({0, 0, 0.025}, 0.015, 3), 0.004);
  const Vector3d site = body.query->closest({0, 0, 0.05}).point;
  const SizeField size = test::size_round(site, 0.005, 0.015);
  for (const Backend backend : {Backend::tetgen, Backend::mesh3}) {
    const VolumeMeshResult serial = mesh_volume(body, size, {site}, with(backend));
    VolumeMeshResult first, second;
    std::thread one([&] { first = mesh_volume(body, size, {site}, with(backend)); });
    std::thread two([&] { second = mesh_volume(body, size, {site}, with(backend)); });
    one.join();
    two.join();
    ASSERT_TRUE(serial.usable) << serial.cause;
    EXPECT_TRUE(same(serial.mesh, first.mesh)) << serial.backend;
    EXPECT_TRUE(same(serial.mesh, second.mesh)) << serial.backend;
  }
}

TEST(VolumeMesh, NoTimeIsACauseForEveryBackend) {
  const Body block = test::block_body(0.005);
  VolumeMeshOptions options;
  options.time_limit = 0;
  const VolumeMeshResult result = mesh_volume(block, test::size_round({0, 0, 0}, 0.002, 0.008), {}, options);
  EXPECT_FALSE(result.usable);
  EXPECT_NE(result.cause.find("TetGen: time limit"), std::string::npos) << result.cause;
  EXPECT_NE(result.cause.find("Mesh_3: time limit"), std::string::npos) << result.cause;
}

TEST(VolumeMesh, TimeThatPassesWithoutWorkDoesNotCount) {
  const Body block = test::block_body(0.005);
  VolumeMeshOptions options = with(Backend::mesh3);
  options.time_limit = 3;
  bool slept = false;
  const SizeField size = [&](const Vector3d& p) {
    if (!slept) std::this_thread::sleep_for(std::chrono::duration<double>(options.time_limit + 0.1));
    slept = true;
    return test::size_round({0, 0, 0}, 0.004, 0.01)(p);
  };
  const VolumeMeshResult result = mesh_volume(block, size, {}, options);
  EXPECT_TRUE(result.usable) << result.cause;
}

TEST(VolumeMesh, VolumeThatIsOffIsACauseForEveryBackend) {
  const Body body = ball_with_lump();
  const Vector3d site = body.query->closest({0, 0, 0.05}).point;
  const SizeField size = test::size_round(site, 0.00175, 0.0125);
  VolumeMeshOptions options;
  options.accept_volume = 1e-9;
  const VolumeMeshResult body_off = mesh_volume(body, size, {site}, options);
  EXPECT_FALSE(body_off.usable);
  EXPECT_EQ(body_off.cause.find("the body: volume off by "), 0U) << body_off.cause;
  EXPECT_NE(body_off.cause.find("Mesh_3: the body: volume off by "), std::string::npos) << body_off.cause;
  options = {};
  options.accept_inclusion = 1e-9;
  const VolumeMeshResult lump_off = mesh_volume(body, size, {site}, options);
  EXPECT_FALSE(lump_off.usable);
  EXPECT_EQ(lump_off.cause.find("region 'lump': volume off by "), 0U) << lump_off.cause;
  EXPECT_NE(lump_off.cause.find("Mesh_3: region 'lump'"), std::string::npos) << lump_off.cause;
}

TEST(VolumeMesh, BadSizeFieldIsACause) {
  const Body block = test::block_body(0.005);
  const VolumeMeshResult result = mesh_volume(
      block, [](const Vector3d&) { return -1.0; }, {}, with(Backend::tetgen));
  EXPECT_FALSE(result.usable);
  EXPECT_NE(result.cause.find("size field"), std::string::npos) << result.cause;
}

TEST(VolumeMesh, DemandThatNoMeshMeetsNamesTheAngle) {
  const Body block = test::block_body(0.005);
  VolumeMeshOptions options = with(Backend::tetgen);
  options.accept_dihedral = 60;
  const VolumeMeshResult result = mesh_volume(block, test::size_round({0, 0, 0}, 0.004, 0.01), {}, options);
  EXPECT_FALSE(result.usable);
  EXPECT_NE(result.cause.find("dihedral"), std::string::npos) << result.cause;
}

}  // namespace
}  // namespace palpate::mesh
