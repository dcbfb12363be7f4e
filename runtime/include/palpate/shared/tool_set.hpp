// SPDX-License-Identifier: MIT
// Several tools on one body: two instruments, five fingertips.
#pragma once

#include "palpate/contact/contact.hpp"
#include "palpate/contact/superposition.hpp"
#include "palpate/shared/joint_contacts.hpp"

#include <array>
#include <cstddef>
#include <optional>
#include <utility>

namespace palpate::runtime {

/// Count tools, each with a contact of its own. In a file with compliance each tool feels the dents of the others
/// (JointContacts). Without, the forces are those of each tool alone; superposition() bounds the error of adding them
/// where the tools are near each other. kFeatures as for BasicContact.
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
    if (joint_) joint_->reset();
    error_ = SuperpositionError{};
  }

  /// One tick of each tool, in order.
  std::array<Tick, kCount> tick(const std::array<Pose, kCount>& tools) {
    return together(tools, StillBody{&contacts_[0].view()},
                    [&](std::size_t k, const Pose& tool) { return contacts_[k].tick(tool); });
  }
  /// The same against a body that moves, deforms or changes its stiffness.
  template <class Body>
  std::array<Tick, kCount> tick(const std::array<Pose, kCount>& tools, const Body& body) {
    return together(tools, body, [&](std::size_t k, const Pose& tool) { return contacts_[k].tick(tool, body); });
  }
  /// The same with searches that are made elsewhere, one of each tool.
  std::array<Tick, kCount> tick(const std::array<Pose, kCount>& tools, const std::array<Search, kCount>& latest) {
    return together(tools, StillBody{&contacts_[0].view()},
                    [&](std::size_t k, const Pose& tool) { return contacts_[k].tick(tool, latest[k]); });
  }

  /// Values of the last tick.
  [[nodiscard]] const SuperpositionError& superposition() const { return error_; }
  /// The balance of the contacts; null where the file has no compliance.
  [[nodiscard]] const JointContacts<Count, kFeatures>* joint() const { return joint_ ? &*joint_ : nullptr; }
  [[nodiscard]] const BasicContact<kFeatures>& contact(int k) const { return contacts_[static_cast<std::size_t>(k)]; }

private:
  template <std::size_t... K>
  ToolSet(const View& view, const std::array<std::uint32_t, kCount>& tools, std::index_sequence<K...>)
      : contacts_{BasicContact<kFeatures>(view, tools[K])...}, radii_{ContactRadius(view, tools[K])...} {
    if ((kFeatures & layout::feature_compliance) != 0 && view.has(layout::feature_compliance)) joint_.emplace(view);
  }

  template <class Body, class TickAt>
  std::array<Tick, kCount> together(const std::array<Pose, kCount>& tools, const Body& body, const TickAt& tick_at) {
    if constexpr ((kFeatures & layout::feature_compliance) != 0) {
      if (joint_) {
        return joint_->tick(contacts_, tools, tick_at, [&](const BodyPoint& at) { return body.frame(at); });
      }
    }
    std::array<Tick, kCount> ticks;
    error_ = SuperpositionError{};
    for (std::size_t k = 0; k < kCount; ++k) {
      ticks[k] = tick_at(k, tools[k]);
      for (std::size_t j = 0; j < k; ++j) error_.add(ticks[j], radii_[j], ticks[k], radii_[k]);
    }
    return ticks;
  }

  std::array<BasicContact<kFeatures>, kCount> contacts_;
  std::array<ContactRadius, kCount> radii_;
  SuperpositionError error_;
  std::optional<JointContacts<Count, kFeatures>> joint_;
};

}  // namespace palpate::runtime
