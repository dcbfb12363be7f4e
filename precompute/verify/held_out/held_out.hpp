// SPDX-License-Identifier: GPL-3.0-or-later
// Held-out solves: contacts that no fit has seen, drawn evenly over the body's area, solved by the bake's own
// entry point and compared with what the runtime answers.
#pragma once

#include "formats/journal/samples.hpp"
#include "formats/scene/scene.hpp"
#include "palpate/format/response_view.hpp"
#include "precompute/common/body.hpp"
#include "precompute/solve/pair/contact_case.hpp"
#include "precompute/tool/tool.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpate::verify {

/// One solved force with what the file answers to the same deflection. World (body) frame.
struct ForcePair {
  SampleKind kind = SampleKind::normal;
  Eigen::Vector3d deflection{0, 0, 0};  ///< m, p - c
  Eigen::Vector3d solved{0, 0, 0};      ///< N on the tool
  Eigen::Vector3d baked{0, 0, 0};       ///< N
  double error = 0.0;  ///< |baked - solved| / max(|solved|, 2 % of the contact's peak force, its floor)
  /// Kind path: of its first force the deflection (m) of the normal indentation that it left from; the tool goes
  /// straight from force to force.
  std::optional<Eigen::Vector3d> from;
  /// Kind grasped, of a tool that was turned.
  struct Turn {
    Eigen::Vector3d rotation{0, 0, 0};  ///< rad, axis times angle
    Eigen::Vector3d solved{0, 0, 0};    ///< N m on the tool about p
    Eigen::Vector3d baked{0, 0, 0};     ///< N m
    double error = 0.0;                 ///< |baked - solved| / max(|solved|, 2 % of the largest of the contact's turns)
  };
  std::optional<Turn> turn;
};

/// The friction limit at which a contact that is drawn tangentially slips as a whole.
struct LimitPair {
  double depth = 0.0;   ///< m
  double solved = 0.0;  ///< solved_limit()
  double baked = 0.0;
  double error = 0.0;  ///< |baked - solved| / solved
};

/// One held-out contact.
struct HeldOut {
  std::uint32_t tool = 0;        ///< index of the tool in the file
  std::uint32_t tool_patch = 0;  ///< of that tool
  Eigen::Vector3d tool_weights{1, 0, 0};
  ContactFrame frame;  ///< at c on the body's surface; n is the runtime's n(c)
  double spin = 0.0;   ///< rad, of the tool about n from its first sampled one; [0, 2 pi)
  /// Orientation of a tool with spins (tool frame to body frame).
  std::optional<Eigen::Matrix3d> orientation;
  bool at_pair = false;    ///< c and p are a pair that was sampled: between samples in the spin alone
  double depth = 0.0;      ///< m, deepest push
  double thickness = 0.0;  ///< m, of the body below c
  double filled = 0.0;     ///< share of the blend that was filled from neighbours
  double floor = 0.0;      ///< N, response.floor of the scene
  bool accepted = false;
  std::string cause;  ///< of a refused solve
  std::vector<ForcePair> forces;
  std::vector<LimitPair> limits;  ///< a direction each; none unless the scene requests solved friction limits
};

struct HeldOutOptions {
  std::uint32_t count = 40;  ///< contacts, [1, 100000]
  std::uint64_t seed = 1;
  unsigned threads = 1;  ///< [1, 1024]
  std::function<bool(const solve::ContactCase&, double depth)> touchable;  ///< empty: everywhere
  std::function<void(std::size_t done, std::size_t total)> progress;
};

struct HeldOutSet {
  std::vector<HeldOut> contacts;
  double untouchable_share = 0.0;  ///< of the drawn points: on or too near a support, or outside the sampled box
};

/// Draws the contacts (uniform over the body's area; uniform over the length or area of the tool's patches; uniform
/// over the spins of tools that have any, with as many contacts more at sampled pairs, between their spins alone) and
/// solves them at depths off the bake's grid, and with friction tangentially off its rays at three depths and along
/// test_paths; pulled and drawn aside where the tool holds on, and turned about other axes
/// by less where it turns; until the contact slips as a whole where the scene wants its friction limit solved. An
/// exception, also of a callback, ends every thread after the solve it is in and is rethrown.
HeldOutSet solve_held_out(const runtime::View& view, const Scene& scene, const Body& body,
                          const std::vector<tool::Tool>& tools, const HeldOutOptions& options);

/// Fills `baked` and `error` of every force and limit from the file, locating c as the runtime does. Throws
/// Error(bad_input) where a contact names a tool or a patch that the file does not have; `recorded` names their file.
void compare_with_file(const runtime::View& view, std::vector<HeldOut>& contacts, const std::string& recorded = {});

}  // namespace palpate::verify
