// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/verify_together.hpp"

#include "formats/io/error.hpp"
#include "palpate/format/open.hpp"
#include "precompute/bake/reach.hpp"
#include "tools/bench/tick_bench.hpp"
#include "tools/cli/output.hpp"
#include "tools/cli/verify_checks.hpp"
#include "tools/verify/press_together.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

namespace palpate::cli {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

/// The largest error on the block at a spacing (contact radii).
double allowed_on_block(double spacing) { return spacing < 1.25 ? 0.06 : spacing < 1.75 ? 0.02 : 0.01; }

/// Forces of the runtime, each in the frame of its place (x, y, n).
struct RuntimeForces {
  std::vector<Vector3d> together, alone;
  double share = 1;
};

template <int Count>
RuntimeForces press(const runtime::View& view, const ContactCase& c, const verify::CheckedTogether& solved,
                    double aside) {
  constexpr auto kCount = static_cast<std::size_t>(Count);
  runtime::ToolSet<Count> tools(view, {});
  std::vector<runtime::Contact> single(kCount, runtime::Contact(view, 0));
  RuntimeForces forces{std::vector<Vector3d>(kCount), std::vector<Vector3d>(kCount)};
  press_together(tools, c, solved, aside, [&](const auto& poses, const auto& ticks) {
    for (std::size_t i = 0; i < kCount; ++i) {
      const auto local = [&](const runtime::Vec3& f) { return solved.places[i].to_local(Vector3d(f.x, f.y, f.z)); };
      forces.together[i] = local(ticks[i].force);
      forces.alone[i] = local(single[i].tick(poses[i]).force);
    }
  });
  forces.share = tools.joint()->share();
  return forces;
}

RuntimeForces press(const runtime::View& view, const ContactCase& c, const verify::CheckedTogether& solved,
                    double aside) {
  switch (solved.places.size()) {
    case 2:
      return press<2>(view, c, solved, aside);
    case 3:
      return press<3>(view, c, solved, aside);
    case 4:
      return press<4>(view, c, solved, aside);
    default:
      return press<5>(view, c, solved, aside);
  }
}

std::vector<double> spacings_of(verify::Layout layout) {
  if (layout == verify::Layout::ring) return {1.5, 2, 3};
  if (layout == verify::Layout::random) return {1, 8};
  return {1, 1.5, 2, 4, 8};
}

std::vector<ContactCase> cases_of(const TogetherCommand& command, verify::Layout layout) {
  if (!command.scene.empty()) return {scene_contacts(command.scene, command.contacts)};
  if (layout != verify::Layout::pinch) return {block_contact(kBlockHalf, kBlockRadius, kBlockDepth, 0)};
  std::vector<ContactCase> slabs;
  for (const double thickness : {0.01, 0.02, 0.04}) {
    slabs.push_back(slab_contact(kBlockHalf, thickness, kBlockRadius, kBlockDepth));
  }
  return slabs;
}

void check_command(const TogetherCommand& command) {
  const bool line = command.layout == "line";
  if (command.layout == "pinch" && command.count != 2) {
    throw Error(ExitCode::usage,
                "--together: " + std::to_string(command.count) + " tools in layout 'pinch'; allowed 2");
  }
  if (command.aside > 0 && (command.scene.empty() || !line)) {
    throw Error(ExitCode::usage, "--aside belongs to --together of a scene with friction in layout 'line'");
  }
  if (command.aside > 0 && !(read_scene(command.scene).friction > 0)) {
    throw Error(ExitCode::usage, "--aside: " + command.scene + " has no friction");
  }
}

/// Largest relative errors among the tools of one solve.
struct TogetherErrors {
  double runtime = 0, normal = 0, sum = 0, alone = 0;

  TogetherErrors(const solve::TogetherResult& solved, const RuntimeForces& forces) {
    for (std::size_t i = 0; i < solved.together.size(); ++i) {
      const Vector3d& exact = solved.together[i];
      const double size = exact.norm();
      runtime = std::max(runtime, (forces.together[i] - exact).norm() / size);
      normal = std::max(normal, std::abs(forces.together[i].z() - exact.z()) / size);
      sum = std::max(sum, (solved.alone[i] - exact).norm() / size);
      alone = std::max(alone, (forces.alone[i] - solved.alone[i]).norm() / solved.alone[i].norm());
    }
  }
};

/// The rows of all cases.
class TogetherTable {
public:
  explicit TogetherTable(const TogetherCommand& command) : command_(command) {}

  /// `file`: the scene's; null on a block.
  void add(const ContactCase& c, const std::vector<verify::CheckedTogether>& all, const runtime::View* file) {
    std::optional<BlockResponse> block;
    text_ +=
        c.name + ": " + std::to_string(command_.count) + " tools, layout " + command_.layout +
        (c.scene.friction > 0 ? ", sticking\n\n" : ", without friction\n\n") +
        "| contact | spacing, contact radii | first of the tools solved, N | sum is off by | runtime is off by | along "
        "the normal | one alone is off by | share of C |\n|---|---|---|---|---|---|---|---|\n";
    for (const verify::CheckedTogether& checked : all) {
      const solve::TogetherResult& r = checked.result;
      if (!r.usable) {
        text_ += printed("| %zu | %.3g |", checked.contact, checked.spacing) + " refused: " + r.cause + " |\n";
        rows_.push_back({{"spacing_radii", checked.spacing}, {"usable", false}, {"cause", r.cause}});
        if (first_cause_.empty()) first_cause_ = r.cause;
        continue;
      }
      if (file != nullptr) {
        add_row(c, checked, *file);
        continue;
      }
      if (!block) block.emplace(c);
      const std::vector<std::byte> bytes = block->file(r);
      add_row(c, checked, runtime::View::open(bytes.data(), bytes.size()).view);
    }
    text_ += '\n';
  }

  /// Prints, and throws where the errors are beyond their limits.
  void publish(const Globals& globals) {
    if (errors_.empty()) throw Error(ExitCode::numerical, "no solve is usable; the first: " + first_cause_);
    std::sort(errors_.begin(), errors_.end());
    const double p95 = errors_[static_cast<std::size_t>(std::ceil(0.95 * double(errors_.size()))) - 1];
    text_ += printed("forces of %zu sets of tools: 95th percentile off by %.2f %%\n", errors_.size(), 100 * p95);
    const Json json{{"together", command_.count},
                    {"layout", command_.layout},
                    {"machine", machine_name()},
                    {"contacts", rows_},
                    {"p95", p95}};
    if (!command_.report.empty()) write_report(command_.report, json);
    globals.json ? print_json(json) : print(text_);
    if (!beyond_.empty()) throw Error(ExitCode::tolerance, "--together: " + beyond_);
    if (!by_spacing() && p95 > command_.max_p95) {
      throw Error(ExitCode::tolerance, printed("--together: the 95th percentile is off by %.2f %%, allowed %.3g %%",
                                               100 * p95, 100 * command_.max_p95));
    }
  }

private:
  [[nodiscard]] bool by_spacing() const {
    return command_.scene.empty() && command_.layout == "line" && command_.count == 2;
  }

  void add_row(const ContactCase& c, const verify::CheckedTogether& checked, const runtime::View& view) {
    const solve::TogetherResult& r = checked.result;
    const RuntimeForces forces = press(view, c, checked, command_.aside * c.contacts[checked.contact].depth);
    const TogetherErrors e(r, forces);
    errors_.push_back(e.runtime);
    const double allowed = allowed_on_block(checked.spacing);
    if (by_spacing() && e.runtime > allowed && beyond_.empty()) {
      beyond_ = printed("at %.3g contact radii the force is off by %.2f %%, allowed %.3g %%", checked.spacing,
                        100 * e.runtime, 100 * allowed);
    }
    text_ += printed("| %zu | %.3g | %.4g | %.1f %% | %.2f %% | %.2f %% | %.2f %% | %.2f |\n", checked.contact,
                     checked.spacing, r.together[0].norm(), 100 * e.sum, 100 * e.runtime, 100 * e.normal, 100 * e.alone,
                     forces.share);
    rows_.push_back({{"contact", checked.contact},
                     {"spacing_radii", checked.spacing},
                     {"usable", true},
                     {"solved_N", list(r.together)},
                     {"runtime_N", list(forces.together)},
                     {"solved_alone_N", list(r.alone)},
                     {"runtime_alone_N", list(forces.alone)},
                     {"sum_error", e.sum},
                     {"error", e.runtime},
                     {"normal_error", e.normal},
                     {"alone_error", e.alone},
                     {"share", forces.share}});
  }

  const TogetherCommand& command_;
  Json rows_ = Json::array();
  std::string text_, beyond_, first_cause_;
  std::vector<double> errors_;
};

}  // namespace

void run_together(const TogetherCommand& command, const Globals& globals) {
  check_command(command);
  const verify::Layout layout = *verify::layout_of(command.layout);
  std::unique_ptr<ResponseInput> input;
  if (!command.scene.empty()) input = response_with_compliance(command.scene, command.response);
  TogetherTable table(command);
  for (const ContactCase& c : cases_of(command, layout)) {
    verify::ContactCheckOptions options;
    options.spacings = spacings_of(layout);
    options.layout = layout;
    options.count = command.count;
    options.sticking = c.scene.friction > 0;
    options.aside = command.aside;
    options.touchable = bake::can_be_pressed;
    if (!input) options.alone_depth = c.scene.sampling.depth;
    options.threads = static_cast<unsigned>(globals.threads);
    options.progress = [&globals](std::size_t done, std::size_t total) {
      note(globals, "solved: " + std::to_string(done) + " of " + std::to_string(total));
    };
    const auto all = verify::check_together(c.scene, c.body, c.tool, c.contacts, options);
    table.add(c, all, input ? &input->view() : nullptr);
  }
  table.publish(globals);
}

}  // namespace palpate::cli
