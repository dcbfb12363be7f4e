// SPDX-License-Identifier: MIT
// A response file read in place: opened and validated once, so that evaluation needs no checks.
#pragma once

#include "palpate/response_layout.hpp"

#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace palpate::runtime {

struct OpenResult;

namespace detail {

/// A T where it is `kept`, else nothing: what a feature needs to remember.
struct Nothing {};
template <bool kept, class T>
using If = std::conditional_t<kept, T, Nothing>;

/// What is taken for a tool that a file does not have: no contact of it ticks.
inline constexpr layout::ToolRecord kNoTool{};
/// Of a view that was not opened, as of a file that was refused: without a tool every tick of a contact is a fault, and
/// a search finds the one point that is there.
inline constexpr layout::Meta kNoMeta{};
inline constexpr layout::SurfaceTriangle kNoTriangle{};
inline constexpr layout::Point kNoPoint{};

/// A microcontroller: memory is small and nowhere far, and what counts is the longest tick.
#if defined(__ARM_ARCH_PROFILE) && __ARM_ARCH_PROFILE == 'M'
inline constexpr bool kSmall = true;
#else
inline constexpr bool kSmall = false;
#endif

/// Reads a byte of every line of a cache, for nothing but that the others come with it. Processors may ignore a
/// prefetch of a page whose address they do not know, which in a large file is most.
inline void touch([[maybe_unused]] const void* from, [[maybe_unused]] std::uint32_t bytes) {
  if constexpr (!kSmall) {
    constexpr std::uint32_t kLine = 64;
    const auto* const at = static_cast<const volatile unsigned char*>(from);
    for (std::uint32_t k = 0; k < bytes; k += kLine) static_cast<void>(at[k]);
    static_cast<void>(at[bytes - 1]);
  }
}

}  // namespace detail

/// Pointers into the bytes of a response file. Copyable; the bytes must outlive it and stay as they are.
struct View {
  const unsigned char* bytes = nullptr;
  std::size_t size = 0;
  std::uint32_t features = 0;  ///< layout::Feature bits
  const layout::Meta* meta = &detail::kNoMeta;
  const layout::Site* sites = nullptr;
  const layout::Point* vertices = &detail::kNoPoint;
  const layout::SurfaceTriangle* triangles = &detail::kNoTriangle;
  const layout::ToolRecord* tools = nullptr;
  const layout::ToolVertexRecord* tool_vertices = nullptr;  ///< null when every tool has one vertex
  const layout::ToolPatch* tool_patches = nullptr;          ///< null with tool_vertices
  const std::uint32_t* spins = nullptr;  ///< a tool vertex; null when every point of a tool has one spin
  const unsigned char* responses = nullptr;
  std::uint32_t response_size = 0;        ///< bytes of one of these
  std::uint32_t head_size = 0;            ///< and of what is before its curves
  bool coupled = false;                   ///< they are of the coupled model
  const unsigned char* grasps = nullptr;  ///< null when no tool holds on
  const unsigned char* turns = nullptr;   ///< null when no tool's turns have a torque
  const layout::SearchNode* search = nullptr;
  const char* provenance = nullptr;  ///< JSON text, not zero-terminated
  std::size_t provenance_size = 0;

  /// Checks `size` bytes at `data` (aligned to 8) against the specification; defined in open.hpp. `kFeatures`
  /// (layout::Feature bits): what the program can do with a file; one that holds more is refused by name.
  /// Depth scales from 1e-9 m on are opened, but thresholds are made for 1e-6 m and more: a vector shorter than 1e-12 m
  /// has no direction.
  template <std::uint32_t kFeatures = layout::feature_all>
  static OpenResult open(const void* data, std::size_t size);
  /// For bytes that open() has accepted before and that nobody can have changed since: checks header, table of contents
  /// and META, neither the checksum nor a record, which takes microseconds however large the file is. With any other
  /// bytes what follows is undefined.
  template <std::uint32_t kFeatures = layout::feature_all>
  static OpenResult open_trusted(const void* data, std::size_t size);

  [[nodiscard]] const layout::FileHeader& header() const { return *reinterpret_cast<const layout::FileHeader*>(bytes); }
  [[nodiscard]] const layout::SectionEntry* sections() const {
    return reinterpret_cast<const layout::SectionEntry*>(bytes + sizeof(layout::FileHeader));
  }
  /// Bytes of a section, 0 when it is absent.
  [[nodiscard]] std::uint64_t section_bytes(layout::Section id) const {
    for (std::uint32_t i = 0; i < header().section_count; ++i) {
      if (sections()[i].id == static_cast<std::uint32_t>(id)) return sections()[i].size;
    }
    return 0;
  }
  [[nodiscard]] const layout::ResponseHead& response_head(std::uint64_t index) const {
    return *reinterpret_cast<const layout::ResponseHead*>(responses + index * response_size);
  }
  /// Of a file with reliefs (relief.hpp).
  [[nodiscard]] double relief(std::uint64_t index) const {
    return static_cast<double>(*reinterpret_cast<const float*>(&response_head(index) + 1));
  }
  /// Coefficients of Fn; those of Fx then Fy; those of gx, gy, phix, phiy, mu. Of a separable file.
  [[nodiscard]] const float* normal_coefs(std::uint64_t index) const {
    return reinterpret_cast<const float*>(after_head(index));
  }
  [[nodiscard]] const float* lateral_coefs(std::uint64_t index) const {
    return normal_coefs(index) + meta->normal_coefs;
  }
  [[nodiscard]] const float* friction_coefs(std::uint64_t index) const {
    return lateral_coefs(index) + 2 * meta->lateral_coefs;
  }
  /// N of one unit of a coupled response's coefficients.
  [[nodiscard]] float coupled_unit(std::uint64_t index) const {
    return *reinterpret_cast<const float*>(coupled_law(index));
  }
  /// count(degrees) of them, as whole numbers.
  void coupled_coefs(std::uint64_t index, std::int16_t* to) const {
    layout::unpack_coupled(coupled_law(index), coupled::places(layout::coupled_degrees(*meta)), meta->coef_bits, to);
  }
  /// Of a coupled file.
  [[nodiscard]] const unsigned char* coupled_law(std::uint64_t index) const { return after_head(index); }
  /// Has a response's memory brought, for a caller that has something else to do before it reads it.
  void fetch(std::uint64_t index) const { detail::touch(responses + index * response_size, response_size); }
  [[nodiscard]] const layout::GraspHead& grasp_head(std::uint64_t index) const {
    return *reinterpret_cast<const layout::GraspHead*>(grasps + index * layout::grasp_size(meta->grasp_coefs));
  }
  /// Coefficients of Fx, Fy, Fn, kxx, kxy, kyy.
  [[nodiscard]] const float* grasp_curves(std::uint64_t index) const {
    return reinterpret_cast<const float*>(grasps + index * layout::grasp_size(meta->grasp_coefs) +
                                          sizeof(layout::GraspHead));
  }
  [[nodiscard]] const layout::TurnHead& turn_head(std::uint64_t index) const {
    return *reinterpret_cast<const layout::TurnHead*>(turns + index * layout::turn_size(meta->grasp_coefs));
  }
  /// Coefficients of T, K and C, see layout::kTurnCurves.
  [[nodiscard]] const float* turn_curves(std::uint64_t index) const {
    return reinterpret_cast<const float*>(turns + index * layout::turn_size(meta->grasp_coefs) +
                                          sizeof(layout::TurnHead));
  }
  [[nodiscard]] bool has(layout::Feature feature) const { return (features & feature) != 0; }
  /// A tool by its index; one without extent where there is none of that index.
  [[nodiscard]] const layout::ToolRecord& tool(std::uint32_t index) const {
    return index < meta->tool_count ? tools[index] : detail::kNoTool;
  }
  /// Index of the tool of that name, or tool_count, with which every tick of a contact is a fault.
  [[nodiscard]] std::uint32_t find_tool(const char* name) const {
    for (std::uint32_t i = 0; i < meta->tool_count; ++i) {
      const char *a = tools[i].name, *b = name;
      while (*a != 0 && *a == *b) ++a, ++b;
      if (*a == *b) return i;
    }
    return meta->tool_count;
  }

private:
  [[nodiscard]] const unsigned char* after_head(std::uint64_t index) const {
    return responses + index * response_size + head_size;
  }
};

/// What opening ended with: a view, or the fault.
struct OpenResult {
  View view;
  bool ok = false;
  char error[200] = {};  ///< names the fault and where it is; empty when ok
  explicit operator bool() const { return ok; }
};

}  // namespace palpate::runtime
