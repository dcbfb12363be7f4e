// SPDX-License-Identifier: MIT
// Several tools on one body: two instruments, five fingertips.
#pragma once

#include "palpate/contact/contact.hpp"
#include "palpate/contact/superposition.hpp"

#include <array>
#include <cstddef>
#include <utility>

namespace palpate::runtime {

/// Count tools, each with a contact of its own. Their forces are those of each tool alone; superposition() bounds the
/// error of adding them where the tools are near each other. kFeatures as for BasicContact.
template <int Count, std::uint32_t kFeatures = layout::feature_all>
class ToolSet {
  static constexpr std::size_t kCount = static_cast<std::size_t>(Count);

public:
  /// `tools`: indices into the file's tools, which may repeat.
  ToolSet(const View& view, const std::array<std::uint32_t, kCount>& tools)
      : ToolSet(view, tools, std::make_index_sequence<kCount>()) {}
  ToolSet(const View&&, const std::array<std::uint32_t, kCount>&) = delete;

  void reset() {
    for (BasicContact<kFeatures>& contact : contacts_) contact.reset();
    error_ = SuperpositionError{};
  }

  /// One tick of each tool, in order.
  std::array<Tick, kCount> tick(const std::array<Pose, kCount>& tools) {
    return together([&](std::size_t k) { return contacts_[k].tick(tools[k]); });
  }
  /// The same against a body that moves, deforms or changes its stiffness.
  template <class Body>
  std::array<Tick, kCount> tick(const std::array<Pose, kCount>& tools, const Body& body) {
    return together([&](std::size_t k) { return contacts_[k].tick(tools[k], body); });
  }
  /// The same with searches that are made elsewhere, one of each tool.
  std::array<Tick, kCount> tick(const std::array<Pose, kCount>& tools, const std::array<Search, kCount>& latest) {
    return together([&](std::size_t k) { return contacts_[k].tick(tools[k], latest[k]); });
  }

  /// Values of the last tick.
  [[nodiscard]] const SuperpositionError& superposition() const { return error_; }
  [[nodiscard]] const BasicContact<kFeatures>& contact(int k) const { return contacts_[static_cast<std::size_t>(k)]; }

private:
  template <std::size_t... K>
  ToolSet(const View& view, const std::array<std::uint32_t, kCount>& tools, std::index_sequence<K...>)
      : contacts_{BasicContact<kFeatures>(view, tools[K])...}, radii_{ContactRadius(view, tools[K])...} {}

  template <class TickOf>
  std::array<Tick, kCount> together(const TickOf& tick_of) {
    std::array<Tick, kCount> ticks;
    error_ = SuperpositionError{};
    for (std::size_t k = 0; k < kCount; ++k) {
      ticks[k] = tick_of(k);
      for (std::size_t j = 0; j < k; ++j) error_.add(ticks[j], radii_[j], ticks[k], radii_[k]);
    }
    return ticks;
  }

  std::array<BasicContact<kFeatures>, kCount> contacts_;
  std::array<ContactRadius, kCount> radii_;
  SuperpositionError error_;
};

}  // namespace palpate::runtime
