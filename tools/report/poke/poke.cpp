// SPDX-License-Identifier: GPL-3.0-or-later
// The runtime as a WebAssembly module: opens the bytes of a response file, shows its surface and curves, and ticks a
// tool. Every function is an export; a caller reads results from the module's memory. The module imports nothing.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "palpate/palpate.hpp"
#include "tools/inspect/one_response.hpp"

#define PALPATE_EXPORT(name) __attribute__((export_name(#name))) name

namespace {

using namespace palpate;
using runtime::Vec3;

/// Doubles that one tick gives.
enum TickField : std::size_t {
  kState = 0,
  kForce = 1,
  kTorque = 4,
  kDepth = 7,
  kFrictionLimit = 8,
  kFilledShare = 9,
  kExtrapolated = 10,
  kNormal = 11,
  kBodyPoint = 14,
  kToolPoint = 17,
  kTickFields = 20
};

std::unique_ptr<unsigned char[]> bytes;
runtime::OpenResult opened;
std::optional<runtime::ContactSet<3>> contact;
double pose[7];  ///< m, then a quaternion w, x, y, z
double tick_fields[kTickFields];
std::vector<float> numbers;
std::vector<std::uint32_t> indices;

void put(const Vec3& v, std::size_t at) {
  tick_fields[at] = v.x;
  tick_fields[at + 1] = v.y;
  tick_fields[at + 2] = v.z;
}

void push(const Vec3& v) {
  for (const double x : {v.x, v.y, v.z}) numbers.push_back(static_cast<float>(x));
}

/// A corner of the surface for every vertex, each vertex once.
template <class Function>
void for_each_vertex(Function&& function) {
  const runtime::View& view = opened.view;
  std::vector<bool> seen(view.meta->vertex_count);
  for (std::uint32_t t = 0; t < view.meta->triangle_count; ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t v = view.triangle(t).vertex[k];
      if (seen[v]) continue;
      seen[v] = true;
      runtime::BodyPoint at{t, {0, 0, 0}};
      at.bary[k] = 1;
      function(v, at);
    }
  }
}

}  // namespace

extern "C" {

/// Memory for the bytes of a file.
unsigned char* PALPATE_EXPORT(reserve_file)(std::size_t size) {
  contact.reset();
  bytes.reset(new unsigned char[size]);
  return bytes.get();
}

/// Validates and opens the bytes; an empty text, or the fault.
const char* PALPATE_EXPORT(open_file)(std::size_t size) {
  opened = runtime::View::open(bytes.get(), size);
  if (opened) contact.emplace(opened.view, 0);
  return opened.error;
}

std::uint32_t PALPATE_EXPORT(vertex_count)() { return opened.view.meta->vertex_count; }
std::uint32_t PALPATE_EXPORT(triangle_count)() { return opened.view.meta->triangle_count; }

/// m, x, y, z of every vertex of the contact surface.
const float* PALPATE_EXPORT(positions)() {
  numbers.clear();
  for (std::uint32_t v = 0; v < opened.view.meta->vertex_count; ++v) push(vertex(opened.view, v));
  return numbers.data();
}

/// Smooth unit normals of the vertices.
const float* PALPATE_EXPORT(normals)() {
  numbers.assign(3 * std::size_t{opened.view.meta->vertex_count}, 0);
  for_each_vertex([](std::uint32_t v, const runtime::BodyPoint& at) {
    const Vec3 n = smooth_normal(opened.view, at);
    numbers[3 * v] = static_cast<float>(n.x);
    numbers[3 * v + 1] = static_cast<float>(n.y);
    numbers[3 * v + 2] = static_cast<float>(n.z);
  });
  return numbers.data();
}

/// Three vertices of every triangle, counter-clockwise from outside.
const std::uint32_t* PALPATE_EXPORT(triangles)() {
  indices.clear();
  for (std::uint32_t t = 0; t < opened.view.meta->triangle_count; ++t) {
    for (const std::uint32_t v : opened.view.triangle(t).vertex) indices.push_back(v);
  }
  return indices.data();
}

/// The three sites of every vertex's patch.
const std::uint32_t* PALPATE_EXPORT(vertex_sites)() {
  indices.assign(3 * std::size_t{opened.view.meta->vertex_count}, 0);
  for_each_vertex([](std::uint32_t v, const runtime::BodyPoint& at) {
    for (std::size_t k = 0; k < 3; ++k) indices[3 * v + k] = opened.view.triangle(at.triangle).site[k];
  });
  return indices.data();
}

/// Weights of these sites.
const float* PALPATE_EXPORT(vertex_weights)() {
  numbers.assign(3 * std::size_t{opened.view.meta->vertex_count}, 0);
  for_each_vertex([](std::uint32_t v, const runtime::BodyPoint& at) {
    double weights[3];
    site_weights(opened.view, at, weights);
    for (std::size_t k = 0; k < 3; ++k) numbers[3 * v + k] = static_cast<float>(weights[k]);
  });
  return numbers.data();
}

/// Baked normal force (N) of a site and a tool vertex (counted over all tools) at `count` depths (m).
/// `depths` is the memory of reserve_numbers; the forces replace the depths.
float* PALPATE_EXPORT(reserve_numbers)(std::size_t count) {
  numbers.assign(count, 0);
  return numbers.data();
}
void PALPATE_EXPORT(normal_forces)(std::uint32_t site, std::uint32_t tool_vertex) {
  const runtime::ResponseLaw law =
      cli::response_law(opened.view, layout::response_index(*opened.view.meta, site, tool_vertex));
  for (float& x : numbers) x = x > 0 ? static_cast<float>(law.at(double{x}).normal_force) : 0.0F;
}
/// Baked force against a tangential deflection along (direction_x, direction_y), unit, at one depth (m): `numbers`
/// holds deflections (m) and is replaced by forces (N) against that direction.
void PALPATE_EXPORT(tangential_forces)(std::uint32_t site, std::uint32_t tool_vertex, double depth, double direction_x,
                                       double direction_y) {
  const runtime::ResponseAtDepth r =
      cli::response_law(opened.view, layout::response_index(*opened.view.meta, site, tool_vertex)).at(depth);
  const runtime::Vec2 along{direction_x, direction_y};
  for (float& x : numbers) x = static_cast<float>(-dot(r.bias + r.stiffness * (double{x} * along), along));
}

/// The pose of the next tick: x, y, z (m), quaternion w, x, y, z, in the body's frame.
double* PALPATE_EXPORT(tool_pose)() { return pose; }
/// Begins anew with a tool of the file.
void PALPATE_EXPORT(take_tool)(std::uint32_t tool) { contact.emplace(opened.view, tool); }
/// One tick at the pose; the fields in the order of TickField.
const double* PALPATE_EXPORT(tick)() {
  const runtime::Tick t =
      contact->tick(runtime::Pose::from_quaternion(pose[3], pose[4], pose[5], pose[6], {pose[0], pose[1], pose[2]}));
  tick_fields[kState] = static_cast<double>(t.state);
  put(t.force, kForce);
  put(t.torque, kTorque);
  tick_fields[kDepth] = t.depth;
  tick_fields[kFrictionLimit] = t.friction_limit;
  tick_fields[kFilledShare] = t.filled_share;
  tick_fields[kExtrapolated] = t.extrapolated ? 1 : 0;
  put(t.normal, kNormal);
  put(t.body_point, kBodyPoint);
  put(t.tool_point, kToolPoint);
  return tick_fields;
}

}  // extern "C"
