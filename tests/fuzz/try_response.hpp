// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes as a response file: refused with a reason, or harmless in every call of a program.
#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

#include "palpate/contact/contact.hpp"
#include "palpate/format/checksum.hpp"
#include "palpate/format/open.hpp"
#include "palpate/response/interpolation.hpp"
#include "palpate/shared/tool_set.hpp"
#include "tests/fuzz/invariant.hpp"

namespace palpate::test {

/// Forces of contacts at every corner of the first triangles and at every tool's patches, from a push that barely
/// touches to a tool at the 1e6 m that the specification promises to answer with a number.
inline void try_fields(const runtime::View& view) {
  constexpr std::uint32_t kMost = 12;  // of each: a fuzzer wants many files a second
  const layout::Meta& m = *view.meta;
  const double z = m.depth_scale, x = m.tangential_scale > 0 ? m.tangential_scale : z;
  const double depths[] = {-z, 0, 1e-9 * z, 0.3 * z, z, 2.5 * z, 1e6}, asides[] = {0, 1e-6 * x, 0.5 * x, x, 3 * x, 1e6};
  for (std::uint32_t t = 0; t < m.triangle_count && t < kMost; ++t) {
    for (std::uint32_t tool = 0; tool < m.tool_count && tool < kMost; ++tool) {
      const layout::ToolRecord& record = view.tools[tool];
      const std::uint32_t patches = view.tool_patches != nullptr ? record.patch_count : 1;
      for (std::uint32_t p = 0; p < patches && p < kMost; ++p) {
        const double inside = 1.0 / 3;
        const runtime::BodyPoint at{t, {p % 2 == 0 ? inside : 0, p % 2 == 0 ? inside : 1, p % 2 == 0 ? inside : 0}};
        const runtime::ToolPoint on_tool{record.first_patch + p, {0.5, 0.25, 0.25}};
        runtime::BlendedResponse<> response;
        response.blend(view, tool, at, on_tool, {1, 0, 0}, nullptr);
        const runtime::Vec3 n = response.normal(), side = runtime::any_orthogonal(n), other = cross(n, side);
        expect(finite(n) && finite(position(view, at)), "a contact has a position and a normal");
        expect(response.filled_share() >= 0 && response.filled_share() <= 1 + 1e-9 && response.depth_limit() > 0,
               "shares and depths");
        for (const double depth : depths) {
          if (depth > 0) {
            const runtime::ResponseAtDepth terms = response.law().at(depth);
            expect(terms.friction_coefficient * terms.normal_force >= 0, "a friction limit is not negative");
          }
          for (const double aside : asides) {
            const runtime::Vec3 beside = aside * side + 0.4 * aside * other;
            expect(finite(response.force(beside - depth * n)), "forces are finite");
          }
        }
      }
    }
  }
}

/// Tools that fall on the body, slide, turn and leave.
inline void try_ticks(const runtime::View& view) {
  for (std::uint32_t tool = 0; tool < view.meta->tool_count && tool < 4; ++tool) {
    runtime::Contact contact(view, tool);
    const runtime::Vec3 c = position(view, {tool % view.meta->triangle_count, {0.4, 0.3, 0.3}});
    const double z = view.meta->depth_scale;
    for (int i = 0; i < 24; ++i) {
      const double turn = 0.02 * i;
      const runtime::Vec3 way{0.3 * i * z, -0.1 * i * z, (4 - 0.5 * (i < 16 ? i : 32 - i)) * z};
      const runtime::Tick tick = contact.tick(runtime::Pose::from_quaternion(1, turn, -0.5 * turn, turn, c + way));
      expect(finite(tick.force) && finite(tick.torque) && std::isfinite(tick.depth), "ticks are numbers");
    }
    const runtime::Tick far = contact.tick({{1, 0, 0, 0, 1, 0, 0, 0, 1}, {9e5, -9e5, 9e5}});
    expect(finite(far.force), "a tool far away is answered");
    expect(!std::isnan(closest_point(view, c).signed_distance), "a point has a distance");
  }
}

/// Two tools that press beside each other, each in the other's dent, where the file has a compliance.
inline void try_together(const runtime::View& view) {
  if (!view.has(layout::feature_compliance)) return;
  runtime::ToolSet<2> tools(view, {0, view.meta->tool_count - 1});
  const runtime::Vec3 c = position(view, {0, {0.4, 0.3, 0.3}}),
                      d = position(view, {view.meta->triangle_count - 1, {0.2, 0.3, 0.5}});
  const double z = view.meta->depth_scale;
  for (int i = 0; i < 24; ++i) {
    const runtime::Vec3 way{0.1 * i * z, 0, (4 - 0.5 * (i < 16 ? i : 32 - i)) * z};
    for (const runtime::Tick& tick :
         tools.tick({runtime::Pose{{1, 0, 0, 0, 1, 0, 0, 0, 1}, c + way},
                     runtime::Pose{{1, 0, 0, 0, 1, 0, 0, 0, 1}, (i % 2 == 0 ? c : d) + way}})) {
      expect(finite(tick.force) && finite(tick.torque), "ticks of tools beside each other are numbers");
    }
  }
}

/// Everything about a file that opened.
inline void try_view(const runtime::View& view) {
  try_fields(view);
  try_ticks(view);
  try_together(view);
  for (std::uint32_t tool = 0; tool < view.meta->tool_count; ++tool) {
    expect(view.find_tool(view.tools[tool].name) <= tool, "a tool is found by its name");
  }
  std::size_t zeros = 0;
  for (std::size_t i = 0; i < view.provenance_size; ++i) zeros += view.provenance[i] == 0 ? 1 : 0;
  expect(zeros <= view.provenance_size, "the provenance can be read");
}

/// The bytes as they are, then with a header and a checksum that are right, so that the rest is read. Returns whether
/// these opened. Aborts where a promise is broken.
inline bool try_response(const std::uint8_t* data, std::size_t size) {
  expect(runtime::View::open(data, size).error[0] != 0 || size >= sizeof(layout::FileHeader), "nothing is no file");
  if (size < sizeof(layout::FileHeader)) return false;
  size = size / layout::kAlignment * layout::kAlignment;
  std::vector<std::uint64_t> words(size / 8);  // no byte more: what is read beyond them is seen
  std::memcpy(words.data(), data, size);
  auto* header = reinterpret_cast<layout::FileHeader*>(words.data());
  std::memcpy(header->magic, layout::kMagic, sizeof layout::kMagic);
  header->version = layout::kVersion;
  header->file_size = size;
  header->checksum = checksum::of_file(reinterpret_cast<const unsigned char*>(words.data()), size,
                                       offsetof(layout::FileHeader, checksum));
  const runtime::OpenResult opened = runtime::View::open(words.data(), size);
  expect(opened.ok == (opened.error[0] == 0), "a refusal has a reason");
  if (opened) try_view(opened.view);
  return opened.ok;
}

}  // namespace palpate::test
