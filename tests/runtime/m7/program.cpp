// SPDX-License-Identifier: GPL-3.0-or-later
// The ticks of a program with the features FEATURES alone.
#include <optional>

#include "tests/runtime/m7/ticks.hpp"

namespace palpate::test {

namespace {
std::optional<runtime::BasicContact<FEATURES>> contact;
}  // namespace

template <>
ProgramTick begin_program<FEATURES>(const runtime::View& view, std::uint32_t tool) {
  contact.emplace(view, tool);
  return [](const runtime::Pose& pose, const runtime::Search& latest) { return contact->tick(pose, latest); };
}

}  // namespace palpate::test
