// SPDX-License-Identifier: GPL-3.0-or-later
// Makes the goldens of today's version of the response file: write_goldens FOLDER. README.md says when.
#include <cstdio>
#include <exception>
#include <random>
#include <stdexcept>

#include "formats/file.hpp"
#include "tests/goldens/goldens.hpp"
#include "tests/support/response_samples.hpp"

namespace palpate::test {
namespace {

using runtime::Vec3;
using runtime::View;
using Options = ResponseSampleOptions;

/// Numbers in [0, 1) that do not depend on the library's distributions.
class Draw {
public:
  double operator()() { return static_cast<double>(random_()) / 4294967296.0; }
  double between(double low, double high) { return low + (high - low) * (*this)(); }
  std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>(random_() % count); }
  /// Three weights; some of them all on one corner.
  void weights(std::vector<double>& to, bool corner) {
    const double a = corner ? 0 : (*this)(), b = corner ? 0 : (1 - a) * (*this)();
    to.insert(to.end(), {a, b, 1 - a - b});
  }

private:
  std::mt19937 random_{20241122};
};

std::string as_line(const View& view, const std::string& word, const std::vector<double>& asked) {
  std::string line = word;
  const auto put = [&](double value) {
    char text[40];
    std::snprintf(text, sizeof text, " %.17g", value);
    line += text;
  };
  for (const double value : asked) put(value);
  line += " =";
  for (const double value : answer(view, word, asked)) put(value);
  return line + "\n";
}

/// The sideways deflection along the sideways force of a straight push at which nothing of it is left along that line:
/// round it a coupled response's anchor rule has to add to what it dissipates. `otherwise` where there is no such
/// force.
Vec3 unloaded(const View& view, const std::vector<double>& contact, const Vec3& otherwise, const Vec3& n, double z) {
  const auto sideways = [&](const Vec3& aside) {
    std::vector<double> asked = contact;
    const Vec3 d = aside - z * n;
    asked.insert(asked.end(), {d.x, d.y, d.z});
    const std::vector<double> force = answer(view, "force", asked);
    return tangential({force[0], force[1], force[2]}, n);
  };
  const Vec3 along = unit(sideways({}), {});
  if (!(length(along) > 0)) return otherwise;
  double low = 0, high = 3 * view.meta->sideways_scale;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (dot(sideways(middle * along), along) > 0 ? low : high) = middle;
  }
  return low * along;
}

/// Contacts all over the body and the tools, depths from none to beyond the scale, deflections beyond the scale.
std::string forces(const View& view) {
  Draw draw;
  std::string text;
  const double depth = view.meta->depth_scale;
  const double sideways = view.meta->sideways_scale > 0 ? view.meta->sideways_scale : depth;
  for (int i = 0; i < 24; ++i) {
    const std::uint32_t triangle = draw.below(view.meta->triangle_count), tool = draw.below(view.meta->tool_count);
    const layout::ToolRecord& record = view.tools[tool];
    std::vector<double> contact{static_cast<double>(triangle)};
    draw.weights(contact, i % 8 == 0);
    const bool patched = view.tool_patches != nullptr && record.patch_count > 0;
    contact.push_back(tool);
    contact.push_back(patched ? record.first_patch + draw.below(record.patch_count) : 0);
    draw.weights(contact, i % 8 == 4 || !patched);
    const runtime::BodyPoint at{triangle, {contact[1], contact[2], contact[3]}};
    const Vec3 n = normal(view, at), x = runtime::any_orthogonal(n), y = cross(n, x);
    const double z = i == 0 ? 0 : draw.between(0.01, 1.4) * depth;
    const double angle = draw.between(0, 6.28), way = i % 5 == 1 ? 0 : draw.between(0, 1.5) * sideways;
    Vec3 aside = way * std::cos(angle) * x + way * std::sin(angle) * y;
    if (layout::is_coupled(*view.meta) && i % 8 == 2) aside = 0.9 * unloaded(view, contact, aside, n, z);
    const Vec3 deflection = aside - z * n;
    const auto with = [&](std::initializer_list<double> more) {
      std::vector<double> asked = contact;
      asked.insert(asked.end(), more);
      return asked;
    };
    text += as_line(view, "force", with({deflection.x, deflection.y, deflection.z}));
    if (view.spins != nullptr) {
      // Turned anyhow, the handle into the body, too.
      const Vec3 axis = runtime::unit({draw.between(-1, 1), draw.between(-1, 1), draw.between(-1, 1)}, {0, 0, 1});
      const double half = draw.between(0, 3.1);
      const auto pose = runtime::Pose::from_quaternion(std::cos(half), std::sin(half) * axis.x, std::sin(half) * axis.y,
                                                       std::sin(half) * axis.z, {});
      std::vector<double> asked = with({deflection.x, deflection.y, deflection.z});
      asked.insert(asked.end(), pose.rotation, pose.rotation + 9);
      text += as_line(view, "spun", asked);
    }
    if (layout::is_coupled(*view.meta) && i % 4 == 2) {
      const double deeper = z + draw.between(0.05, 0.5) * depth;
      text += as_line(view, "deepen", with({z, deeper, aside.x, aside.y, aside.z}));
    }
    const runtime::ToolPoint on_tool{static_cast<std::uint32_t>(contact[5]), {contact[6], contact[7], contact[8]}};
    if (!(runtime::GraspField(view, tool, at, on_tool).depth() > 0)) continue;
    // In and out, beyond what was sampled as well; turned up to three quarters of a half turn.
    const Vec3 held = aside + draw.between(-1.5, 1.5) * depth * n;
    text += as_line(view, "grasp", with({held.x, held.y, held.z}));
    if (view.turns == nullptr) continue;
    const double most = i % 2 == 0 ? 0.5 : 1.3;
    const Vec3 turn{draw.between(-most, most), draw.between(-most, most), draw.between(-most, most)};
    text += as_line(view, "turn", with({held.x, held.y, held.z, turn.x, turn.y, turn.z}));
  }
  for (int i = 0; i < 8; ++i) {
    text +=
        as_line(view, "distance", {draw.between(-0.05, 0.05), draw.between(-0.05, 0.05), draw.between(-0.03, 0.03)});
  }
  return text;
}

void write(const std::filesystem::path& folder, const std::string& name, const ResponseFileContent& content) {
  const std::vector<std::byte> bytes = encode(content);
  const runtime::OpenResult opened = View::open(bytes.data(), bytes.size());
  if (!opened) throw std::runtime_error(opened.error);
  write_response_file(folder / (name + ".palp"), bytes);
  write_file(folder / (name + ".forces"), forces(opened.view));
}

void write_all(const std::filesystem::path& folder) {
  Options options;
  options.cells = 1;
  write(folder, "separable", box_content(options));

  Options smooth = options;
  smooth.friction = smooth.lateral = false;
  write(folder, "frictionless", box_content(smooth));

  Options profile = options;
  profile.tools = Options::Tools::capsule;
  write(folder, "profile_tool", box_content(profile));

  Options all = options;
  all.friction = all.lateral = false;
  all.tools = Options::Tools::all;
  write(folder, "three_tools", box_content(all));

  Options search = options;
  search.search = true;
  search.subdivision = 3;
  write(folder, "search", box_content(search));

  Options sticking = options;
  sticking.lateral = false;
  sticking.coupled = 2;
  write(folder, "coupled_2", box_content(sticking));
  sticking.lateral = true;
  sticking.coupled = 4;
  write(folder, "coupled_4", box_content(sticking));
  sticking.bits = 12;
  write(folder, "coupled_12_bits", box_content(sticking));
  sticking.coupled = 2;
  sticking.bits = 8;
  write(folder, "coupled_8_bits", box_content(sticking));

  Options lean = options;
  lean.spring = true;
  write(folder, "linear", box_content(lean));

  Options rim = options;
  rim.rim = true;
  write(folder, "rim", box_content(rim));
  rim.relief = true;
  rim.coupled = 2;
  write(folder, "relief", box_content(rim));

  Options spins = options;
  spins.tools = Options::Tools::all;
  spins.spins = 5;
  write(folder, "spin", box_content(spins));
  spins.lateral = false;
  spins.coupled = 2;
  spins.spins = 2;
  write(folder, "spin_coupled", box_content(spins));

  // One of the tools holds on; its turns have a torque in the other file.
  Options holding = options;
  holding.lateral = false;
  holding.tools = Options::Tools::all;
  holding.grasp = true;
  write(folder, "grasp", box_content(holding));
  holding.tools = Options::Tools::sphere;
  holding.turn = true;
  write(folder, "turn", box_content(holding));
}

}  // namespace
}  // namespace palpate::test

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: write_goldens FOLDER\n"), 1;
  try {
    palpate::test::write_all(argv[1]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "write_goldens: %s\n", error.what());
    return 4;
  }
}
