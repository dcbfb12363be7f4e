// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the goldens of this version of the response file: write_goldens FOLDER. README.md says when.
#include <cstdio>
#include <exception>
#include <random>
#include <stdexcept>

#include "formats/io/file.hpp"
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

/// Contacts all over the body and the tools, depths from none to beyond the scale, deflections beyond the scale.
std::string forces(const View& view) {
  Draw draw;
  std::string text;
  const double depth = view.meta->depth_scale;
  const double tangential = view.meta->tangential_scale > 0 ? view.meta->tangential_scale : depth;
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
    const Vec3 n = smooth_normal(view, at), x = runtime::any_orthogonal(n), y = cross(n, x);
    const double z = i == 0 ? 0 : draw.between(0.01, 1.4) * depth;
    const double angle = draw.between(0, 6.28), way = i % 5 == 1 ? 0 : draw.between(0, 1.5) * tangential;
    const Vec3 aside = way * std::cos(angle) * x + way * std::sin(angle) * y;
    const Vec3 deflection = aside - z * n;
    const auto with = [&](std::initializer_list<double> more) {
      std::vector<double> asked = contact;
      asked.insert(asked.end(), more);
      return asked;
    };
    text += as_line(view, "force", with({deflection.x, deflection.y, deflection.z}));
    if (view.spins != nullptr) {
      // Any rotation, with the handle in the body as well.
      const Vec3 axis = runtime::unit({draw.between(-1, 1), draw.between(-1, 1), draw.between(-1, 1)}, {0, 0, 1});
      const double half = draw.between(0, 3.1);
      const auto pose = runtime::Pose::from_quaternion(std::cos(half), std::sin(half) * axis.x, std::sin(half) * axis.y,
                                                       std::sin(half) * axis.z, {});
      std::vector<double> asked = with({deflection.x, deflection.y, deflection.z});
      asked.insert(asked.end(), pose.rotation, pose.rotation + 9);
      text += as_line(view, "spun", asked);
    }
    const runtime::ToolPoint on_tool{static_cast<std::uint32_t>(contact[5]), {contact[6], contact[7], contact[8]}};
    const runtime::BondedResponse<true> bonded(view, tool, at, on_tool);
    if (!(bonded.depth() > 0)) continue;
    // Depths of both signs and beyond the sampled ones, rotations up to three quarters of a half turn.
    const Vec3 held = aside + draw.between(-1.5, 1.5) * depth * n;
    text += as_line(view, "bonded", with({held.x, held.y, held.z}));
    if (view.bonded_torque == nullptr) continue;
    const double most = i % 2 == 0 ? 0.5 : 1.3;
    const Vec3 turn{draw.between(-most, most), draw.between(-most, most), draw.between(-most, most)};
    text += as_line(view, "torque", with({held.x, held.y, held.z, turn.x, turn.y, turn.z}));
  }
  for (int i = 0; i < 12 && view.compliance != nullptr; ++i) {
    std::vector<double> points;
    for (int k = 0; k < 2; ++k) {
      points.push_back(draw.below(view.meta->triangle_count));
      draw.weights(points, i % 6 == 5);
    }
    text += as_line(view, "compliance", points);
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
  write(folder, "quadratic", box_content(options));

  Options smooth = options;
  smooth.friction = false;
  write(folder, "frictionless_bias", box_content(smooth));
  smooth.bias = false;
  write(folder, "frictionless", box_content(smooth));

  Options profile = options;
  profile.tools = Options::Tools::capsule;
  write(folder, "profile_tool", box_content(profile));

  Options all = smooth;
  all.tools = Options::Tools::all;
  write(folder, "three_tools", box_content(all));

  Options search = options;
  search.search = true;
  search.subdivision = 3;
  write(folder, "search", box_content(search));

  Options packed = options;
  packed.bits = 12;
  write(folder, "bits_12", box_content(packed));
  packed.bits = 8;
  packed.bias = false;
  write(folder, "bits_8", box_content(packed));

  Options spring = options;
  spring.spring = true;
  write(folder, "spring", box_content(spring));

  Options softening = options;
  softening.softening = true;
  write(folder, "softening", box_content(softening));

  Options spins = options;
  spins.tools = Options::Tools::all;
  spins.spins = 5;
  write(folder, "spin", box_content(spins));

  // One of three tools bonds to the body. The tool of the other file was rotated as well.
  Options bonded = options;
  bonded.bias = false;
  bonded.tools = Options::Tools::all;
  bonded.bonded = true;
  write(folder, "bonded", box_content(bonded));
  bonded.tools = Options::Tools::sphere;
  bonded.bonded_torque = true;
  write(folder, "bonded_torque", box_content(bonded));

  Options shared = smooth;
  shared.modes = 8;
  write(folder, "compliance", box_content(shared));
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
