// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/verify_contacts.hpp"

#include "formats/io/error.hpp"
#include "formats/scene/scene.hpp"
#include "precompute/bake/reach.hpp"
#include "precompute/verify/contact_checks.hpp"
#include "tools/bench/tick_bench.hpp"
#include "tools/cli/contact_case.hpp"
#include "tools/cli/output.hpp"
#include "tools/cli/verify_checks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace palpate::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kCoulomb = 0.02;  // largest relative deviation from mu

ContactCase contacts_of(const ContactsCommand& command) {
  return command.scene.empty() ? block_contact(0.02, 0.01, 1e-4, 0.3) : scene_contacts(command.scene, command.contacts);
}

verify::ContactCheckOptions options_of(const ContactsCommand& command, const Globals& globals) {
  verify::ContactCheckOptions options;
  options.radii = command.radii;
  options.touchable = bake::can_be_pressed;
  options.threads = static_cast<unsigned>(globals.threads);
  options.progress = [&globals](std::size_t done, std::size_t total) {
    note(globals, "solved: " + std::to_string(done) + " of " + std::to_string(total));
  };
  return options;
}

void publish(const ContactsCommand& command, const Globals& globals, const Json& json, const std::string& text) {
  if (!command.report.empty()) write_report(command.report, json);
  if (globals.json) {
    print_json(json);
  } else {
    print(text);
  }
}

Json to_json(const verify::BenchContact& contact, const verify::CheckedSlide& slide) {
  const solve::SlideResult& r = slide.result;
  Json steps = Json::array();
  for (const solve::SlideStep& s : r.steps) {
    steps.push_back({{"travelled_m", s.travelled},
                     {"force_N", list(s.force)},
                     {"slipping", s.slipping},
                     {"work_J", s.work},
                     {"stored_J", s.stored},
                     {"dissipated_J", s.dissipated}});
  }
  return {{"c", list(contact.frame.origin)},
          {"n", list(contact.frame.n)},
          {"x", list(contact.frame.x)},
          {"angle", slide.angle},
          {"depth_m", contact.depth},
          {"contact_radius_m", r.contact_radius},
          {"usable", r.usable},
          {"cause", r.cause},
          {"ratio", r.ratio},
          {"ratio_deviation", r.spread},
          {"ratio_of_slopes", r.predicted},
          {"local_ratio", r.local_ratio},
          {"gross_slip_at_m", r.gross_at},
          {"energy_imbalance", r.imbalance},
          {"nodes", r.nodes},
          {"factorisations", r.factorisations},
          {"seconds", slide.seconds},
          {"steps", steps}};
}

std::string row(const verify::BenchContact& contact, const verify::CheckedSlide& slide, std::size_t k) {
  const solve::SlideResult& r = slide.result;
  if (!r.usable) return printed("| %zu | %.3g |", k, 1e3 * contact.depth) + " refused: " + r.cause + " |\n";
  return printed("| %zu | %.3g | %.3g | %.4f | %.2f %% | %.4f | %.4f | %.3f | %.2f %% | %u | %.1f |\n", k,
                 1e3 * contact.depth, 1e3 * r.contact_radius, r.ratio, 100 * r.spread, r.predicted, r.local_ratio,
                 r.gross_at / r.contact_radius, 100 * r.imbalance, r.nodes, slide.seconds);
}

// Up to twice the way to full slip.
std::string transition(const solve::SlideResult& r, double friction) {
  std::string text = "\n| way, contact radii | tangential force / mu P | share that slips |\n|---|---|---|\n";
  for (const solve::SlideStep& s : r.steps) {
    if (s.travelled > 2 * r.gross_at) break;
    text += printed("| %.4f | %.3f | %.2f |\n", s.travelled / r.contact_radius, s.force.x() / s.force.z() / friction,
                    s.slipping);
  }
  return text;
}

}  // namespace

void run_slide(const ContactsCommand& command, const Globals& globals) {
  const ContactCase c = contacts_of(command);
  const double mu = c.scene.friction;
  if (!(mu > 0)) throw Error(ExitCode::usage, "--slide: the scene has no friction");
  const std::vector<verify::CheckedSlide> slides =
      verify::check_slides(c.scene, c.body, c.tool, c.contacts, options_of(command, globals));

  Json json{{"slide", c.name},
            {"machine", machine_name()},
            {"friction", mu},
            {"radii", command.radii},
            {"contacts", Json::array()}};
  std::string text = c.name + printed(": slides of %.3g contact radii, friction %.3g\n\n", command.radii, mu) +
                     "| contact | depth, mm | contact radius, mm | force ratio | deviates by | of the slopes | "
                     "point by point | full slip at, radii | energy off | nodes | s |\n"
                     "|---|---|---|---|---|---|---|---|---|---|---|\n";
  std::size_t usable = 0;
  const solve::SlideResult* first = nullptr;
  double local = 0, force = 0;
  for (std::size_t k = 0; k < slides.size(); ++k) {
    const solve::SlideResult& r = slides[k].result;
    json["contacts"].push_back(to_json(c.contacts[k], slides[k]));
    text += row(c.contacts[k], slides[k], k);
    if (!r.usable) continue;
    if (usable++ == 0) first = &r;
    local = std::max(local, std::abs(r.local_ratio / mu - 1));
    force = std::max(force, std::abs(r.ratio / mu - 1));
  }
  if (first != nullptr) text += transition(*first, mu);
  publish(command, globals, json, text);
  if (usable == 0) throw Error(ExitCode::numerical, "no slide is usable; the first: " + slides.front().result.cause);
  // On a deep or curved contact the force ratio is more than mu: the tool climbs what piles up before it.
  const double off = command.scene.empty() ? std::max(local, force) : local;
  if (off > kCoulomb) {
    throw Error(ExitCode::tolerance,
                printed("slides differ from Coulomb's law by %.2f %%, allowed %.0f %%", 100 * off, 100 * kCoulomb));
  }
}

void run_two_tips(const ContactsCommand& command, const Globals& globals) {
  const ContactCase c = contacts_of(command);
  const std::vector<verify::CheckedTogether> all =
      verify::check_together(c.scene, c.body, c.tool, c.contacts, options_of(command, globals));

  Json json{{"two_tips", c.name}, {"machine", machine_name()}, {"contacts", Json::array()}};
  std::string text =
      c.name + ": two tips, solved without friction\n\n" +
      "| contact | spacing, contact radii | one alone, N | one of two, N | sum of single contacts is off by "
      "| nodes | s |\n|---|---|---|---|---|---|---|\n";
  std::size_t usable = 0;
  for (const verify::CheckedTogether& tips : all) {
    const solve::TogetherResult& r = tips.result;
    const verify::BenchContact& contact = c.contacts[tips.contact];
    json["contacts"].push_back({{"c", list(contact.frame.origin)},
                                {"n", list(contact.frame.n)},
                                {"x", list(contact.frame.x)},
                                {"depth_m", contact.depth},
                                {"spacing_radii", tips.spacing},
                                {"usable", r.usable},
                                {"cause", r.cause},
                                {"alone_N", list(r.alone)},
                                {"together_N", list(r.together)},
                                {"difference", r.difference},
                                {"nodes", r.nodes},
                                {"seconds", tips.seconds}});
    usable += r.usable;
    text += r.usable ? printed("| %zu | %.3g | %.4g | %.4g | %.1f %% | %u | %.1f |\n", tips.contact, tips.spacing,
                               0.5 * (r.alone[0] + r.alone[1]).z(), 0.5 * (r.together[0] + r.together[1]).z(),
                               100 * r.difference, r.nodes, tips.seconds)
                     : printed("| %zu | %.3g |", tips.contact, tips.spacing) + " refused: " + r.cause + " |\n";
  }
  publish(command, globals, json, text);
  if (usable == 0) throw Error(ExitCode::numerical, "no solve is usable; the first: " + all.front().result.cause);
}

}  // namespace palpate::cli
