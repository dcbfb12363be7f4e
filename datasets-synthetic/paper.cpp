// SPDX-License-Identifier: GPL-3.0-or-later
#include "datasets-synthetic/paper.hpp"

#include "datasets-synthetic/shapes.hpp"
#include "formats/io/file.hpp"
#include "formats/surface/surface_io.hpp"

#include <string>

namespace palpate::synth {

namespace {

// A strip of 80 x 20 x 4 mm: held at its ends it bends under any tool before the tool dents it.
const std::string kStrip = R"(
[body]
surface = "figure-2-strip.ply"

[material]
young = 2e5
poisson = 0.49
)";

const std::string kThreeTools = R"(
[[tool]]
name = "large sphere"
radius = 0.008

[[tool]]
name = "small sphere"
radius = 0.002

[[tool]]
name = "flat punch"
shape = "punch"
radius = 0.0015
edge_radius = 0.0003
length = 0.02

[sampling]
normal_points = 10
spacing = 0.01
within_box = {min = [-0.005, -0.005, -0.0005], max = [0.005, 0.005, 0.0005]}
)";

const std::string kLoose = R"(# Figure 2 (b, e) of Hayward and Mahvash (2004): a rubber strip held at its ends only.
)" + kStrip + R"(
[[support]]
half_space = {point = [-0.037, 0, 0], normal = [1, 0, 0]}

[[support]]
half_space = {point = [0.037, 0, 0], normal = [-1, 0, 0]}
)" + kThreeTools + R"(depth = 0.002
)";

const std::string kFirm = R"(# Figure 2 (c, f) of Hayward and Mahvash (2004): the same strip on a firm bed.
)" + kStrip + R"(
[[support]]
half_space = {point = [0, 0, -0.00399999], normal = [0, 0, 1]}
)" + kThreeTools + R"(depth = 0.0007
)";

const std::string kSoft = R"(
[body]
surface = "figure-4-sample.ply"

[material]
young = 2e5
poisson = 0.49

[[support]]
half_space = {point = [0, 0, -0.00999999], normal = [0, 0, 1]}

[[tool]]
name = "blunt tool"
radius = 0.004

[contact]
friction = 1.0

[sampling]
normal_points = 8
tangential_points = 5
spacing = 0.01
depth = 0.0015
within_box = {min = [-0.005, -0.005, -0.0005], max = [0.005, 0.005, 0.0005]}
)";

const std::string kHomogeneous = R"(# Figure 4 (a to c, g to j) of Hayward and Mahvash (2004): a homogeneous sample.
)" + kSoft;

const std::string kInclusion =
    R"(# Figure 4 (d to f) of Hayward and Mahvash (2004): the same sample, a hard lump on one side.
)" + kSoft +
    R"(
[[region]]
name = "lump"
sphere = {center = [0.006, 0, -0.0035], radius = 0.003}
young = 1e7
poisson = 0.49
)";

}  // namespace

PaperScenes write_paper_scenes(const std::filesystem::path& folder) {
  make_folder(folder);
  write_surface(box({0.08, 0.02, 0.004}, 0.005, "strip"), folder / "figure-2-strip.ply");
  write_surface(box({0.08, 0.02, 0.01}, 0.005, "sample"), folder / "figure-4-sample.ply");
  const PaperScenes scenes{folder / "figure-2-loose.toml", folder / "figure-2-firm.toml",
                           folder / "figure-4-homogeneous.toml", folder / "figure-4-inclusion.toml"};
  write_file(scenes.loose, kLoose);
  write_file(scenes.firm, kFirm);
  write_file(scenes.homogeneous, kHomogeneous);
  write_file(scenes.inclusion, kInclusion);
  return scenes;
}

}  // namespace palpate::synth
