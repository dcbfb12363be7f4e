// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes that are right: defaults, every section, the reference and the canonical text.
#include "formats/scene/scene.hpp"
#include "formats/scene/scene_sources.hpp"
#include "formats/scene/tissues.hpp"

#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

class SceneTest : public testing::Test {
protected:
  Scene read(const std::string& text) { return read_scene(folder_.write("liver.toml", text)); }
  test::TemporaryFolder folder_;
};

TEST_F(SceneTest, FiveLinesAreEnough) {
  const Scene scene = read("[body]\nsurface = \"a.glb\"\nunits = \"mm\"\n[tool]\nradius = 0.004\n");
  EXPECT_EQ(scene.name, "liver");
  ASSERT_EQ(scene.body.surfaces.size(), 1U);
  EXPECT_EQ(scene.body.surfaces[0].file, folder_.path() / "a.glb");  // relative to the scene file
  EXPECT_EQ(scene.body.surfaces[0].unit, 0.001);
  EXPECT_TRUE(scene.body.surfaces[0].meshes.empty());
  EXPECT_EQ(scene.material.young, 5e3);
  EXPECT_EQ(scene.material.poisson, 0.49);
  EXPECT_TRUE(scene.supports.empty());
  ASSERT_EQ(scene.tools.size(), 1U);
  EXPECT_EQ(scene.tools[0].name, "tool");
  EXPECT_EQ(scene.tools[0].shape, ToolScene::Shape::sphere);
  EXPECT_EQ(scene.tools[0].radius, 0.004);
  EXPECT_EQ(scene.friction, 0.0);
  EXPECT_EQ(scene.sampling.depth, 0.004);
  EXPECT_FALSE(scene.sampling.within_box.has_value());
  EXPECT_EQ(scene.response.search, ResponseScene::Search::automatic);
}

TEST_F(SceneTest, NamesMayBeAsLongAndVariedAsTheirFilesAllow) {
  const std::string longest(31, 'x');
  const Scene scene = read("[body]\nsurface = \"a\"\n[tool]\nname = \"" + longest +
                           "\"\n[[region]]\nname = \"Vena-cava_2 b.1\"\nsurface = \"b\"\n[solver]\nrim_size = 1\n"
                           "[sampling]\nnormal_points = 4\ntangential_depths = 4\n");
  EXPECT_EQ(scene.tools[0].name, longest);
  EXPECT_EQ(scene.regions[0].name, "Vena-cava_2 b.1");
  EXPECT_EQ(scene.solver.rim_size, 1.0);
  EXPECT_EQ(scene.sampling.tangential_depths, 4);
}

TEST_F(SceneTest, OneLineIsEnoughToo) {
  const Scene scene = read("body = {surface = \"/abs/a.stl\"}");
  EXPECT_EQ(scene.body.surfaces[0].file, "/abs/a.stl");
  EXPECT_EQ(scene.tools.size(), 1U);
}

TEST_F(SceneTest, LawsWithModuliOfTheirOwnSetYoungsModulus) {
  const Scene mooney = read(R"(body = {surface = "a.ply"}
[material]
law = "mooney-rivlin"
c10 = 500
c01 = 300
poisson = 0.45
)");
  EXPECT_EQ(mooney.material.law, MaterialScene::Law::mooney_rivlin);
  EXPECT_NEAR(mooney.material.young, 2 * 1600 * 1.45, 1e-9);
  const Scene ogden = read(R"(body = {surface = "a.ply"}
material = {law = "ogden", terms = [[200, 8], [-10, -2]]}
region = {surface = "b.ply", law = "veronda-westmann", c1 = 100, beta = 4}
)");
  ASSERT_EQ(ogden.material.terms.size(), 2U);
  EXPECT_NEAR(ogden.material.young, 2 * 810 * 1.49, 1e-9);
  EXPECT_NEAR(ogden.regions[0].material.young, 2 * 400 * 1.49, 1e-9);
  const Scene fibres = read(R"(body = {surface = "a.ply"}
material = {law = "holzapfel-ogden", young = 9000, k1 = 2000, k2 = 0.8, fibre = [0, 3, 4]}
)");
  EXPECT_EQ(fibres.material.young, 9000);
  EXPECT_LT((fibres.material.fibre - Eigen::Vector3d(0, 0.6, 0.8)).norm(), 1e-15);
  // Keys of another law change nothing, keys of this law do.
  Scene changed = fibres;
  changed.material.c10 = 7;
  EXPECT_EQ(canonical_text(changed), canonical_text(fibres));
  changed.material.k1 = 7;
  EXPECT_NE(canonical_text(changed), canonical_text(fibres));
}

TEST_F(SceneTest, FibresAlongACentreline) {
  const std::string text = R"(body = {surface = "a.ply"}
[material]
law = "holzapfel-ogden"
k1 = 2000
k2 = 0.8
)";
  const Scene scene = read(text + "fibre = {centreline = \"muscle.obj\", meshes = [\"biceps\"], units = \"mm\"}\n");
  EXPECT_EQ(scene.material.centreline.file, folder_.path() / "muscle.obj");
  EXPECT_EQ(scene.material.centreline.meshes, std::vector<std::string>{"biceps"});
  EXPECT_EQ(scene.material.centreline.unit, 0.001);
  EXPECT_TRUE(scene.material.fibre.isZero(0));
  // No path is in the canonical text; names and units are.
  const std::string canonical = canonical_text(scene);
  EXPECT_EQ(canonical, canonical_text(read(text + "fibre = {centreline = \"b/c.csv\", meshes = [\"biceps\"], units = "
                                                  "\"mm\"}\n")));
  for (const char* other : {"{centreline = \"muscle.obj\", units = \"mm\"}", "[1, 0, 0]",
                            "{centreline = \"muscle.obj\", meshes = [\"biceps\"]}"}) {
    EXPECT_NE(canonical, canonical_text(read(text + "fibre = " + other + "\n"))) << other;
  }
}

TEST_F(SceneTest, RegionsOfALabelImage) {
  const auto region = [&](const std::string& labels) {
    return read("body = {surface = \"a.ply\"}\n[[region]]\nlabels = " + labels + "\nyoung = 1e4\n");
  };
  const Scene scene = region("{image = \"seg.nrrd\", value = -2, units = \"mm\"}");
  ASSERT_EQ(scene.regions.size(), 1U);
  EXPECT_EQ(scene.regions[0].shape, RegionScene::Shape::labels);
  EXPECT_EQ(scene.regions[0].labels.file, folder_.path() / "seg.nrrd");
  EXPECT_EQ(scene.regions[0].labels.unit, 0.001);
  EXPECT_EQ(scene.regions[0].labels.values, std::vector<int>{-2});
  EXPECT_EQ(scene.regions[0].material.young, 1e4);
  EXPECT_EQ(canonical_text(scene), canonical_text(region("{image = \"x/y.mha\", value = -2, units = \"mm\"}")));
  EXPECT_NE(canonical_text(scene), canonical_text(region("{image = \"seg.nrrd\", value = -3, units = \"mm\"}")));
  EXPECT_NE(canonical_text(scene), canonical_text(region("{image = \"seg.nrrd\", value = -2}")));
}

TEST_F(SceneTest, TissuesSetYoungsModulusFromTheirPublications) {
  for (const Tissue& tissue : tissues()) {
    const Scene scene = read("body = {surface = \"a.ply\"}\nmaterial = {tissue = \"" + std::string(tissue.name) +
                             "\", poisson = 0.45}\n");
    EXPECT_NEAR(scene.material.young, 2.9 * tissue.shear, 1e-9);
    EXPECT_GT(std::string(tissue.source).size(), 20U);
  }
}

TEST_F(SceneTest, EverySection) {
  const Scene scene = read(R"(
name = "case 7"
[body]
surface = "organ.glb"
meshes = ["capsule", "bare_area"]
units = "cm"
repair = "wrap"
wrap_alpha = 0.002
wrap_offset = 1e-4
smooth = 2
capsule_thickness = 1e-4
capsule_young = 1e6
[material]
young = 4000
poisson = 0
[[region]]
surface = "tumour.ply"
young = 5e4
[[region]]
name = "vessel"
surface = "vessel.ply"
poisson = 0.3
[[support]]
mesh = "bare_area"
[[support]]
box = {min = [-1, -1, -1], max = [1, 1, 0]}
[[support]]
half_space = {point = [0, 0, 0.01], normal = [0, 0, 2]}
[[support]]
distance = {surface = "spine.stl", units = "mm", within = 0.002}
[[tool]]
[[tool]]
name = "flat"
shape = "punch"
radius = 0.004
edge_radius = 0.0005
length = 0.02
grasp_depth = 0.003
grasp_turn = 0.2
[[tool]]
shape = "capsule"
radius = 0.003
length = 0.04
contacts = "tip"
[[tool]]
shape = "mesh"
surface = "grasper.obj"
spacing = 0.002
spins = 12
[contact]
friction = 0.3
[sampling]
spacing = 0.01
margin_spacing = 0.01
depth = 0.004
depth_fraction = 0.5
normal_points = 10
tangential_depths = 3
tangential_directions = 6
tangential_points = 4
friction_limit = "solved"
max_refused = 0.1
within_box = {min = [0, 0, 0], max = [1, 1, 1]}
sites = [[0, 0, 0.1], [0.1, 0, 0.2]]
[response]
search = "bvh"
tolerance = 0.03
[solver]
mesh_size = 0.3
growth = 0.5
max_size = 0.02
rim_size = 0.05
time_limit = 60
memory_limit = 200
)");
  EXPECT_EQ(scene.name, "case 7");
  EXPECT_EQ(scene.body.surfaces[0].meshes, (std::vector<std::string>{"capsule", "bare_area"}));
  EXPECT_EQ(scene.body.repair, RepairMode::wrap);
  EXPECT_EQ(scene.body.wrap_offset, 1e-4);
  EXPECT_EQ(scene.body.smooth, 2);
  EXPECT_EQ(scene.body.capsule_thickness, 1e-4);
  EXPECT_EQ(scene.body.capsule_young, 1e6);
  EXPECT_EQ(scene.material.poisson, 0.0);
  ASSERT_EQ(scene.regions.size(), 2U);
  EXPECT_EQ(scene.regions[0].name, "region");
  EXPECT_EQ(scene.regions[0].material.young, 5e4);
  EXPECT_EQ(scene.regions[0].material.poisson, 0.49);
  EXPECT_EQ(scene.regions[1].name, "vessel");
  ASSERT_EQ(scene.supports.size(), 4U);
  EXPECT_EQ(scene.supports[0].kind, SupportScene::Kind::mesh);
  EXPECT_EQ(scene.supports[0].mesh, "bare_area");
  EXPECT_EQ(scene.supports[1].box_max, Eigen::Vector3d(1, 1, 0));
  EXPECT_EQ(scene.supports[2].normal, Eigen::Vector3d(0, 0, 1));  // made a unit vector
  EXPECT_EQ(scene.supports[3].kind, SupportScene::Kind::distance);
  EXPECT_EQ(scene.supports[3].other.file, folder_.path() / "spine.stl");
  EXPECT_EQ(scene.supports[3].other.unit, 0.001);
  EXPECT_EQ(scene.supports[3].within, 0.002);
  ASSERT_EQ(scene.tools.size(), 4U);
  EXPECT_EQ(scene.tools[0].name, "tool");
  EXPECT_TRUE(scene.tools[0].whole);
  EXPECT_EQ(scene.tools[1].shape, ToolScene::Shape::punch);
  EXPECT_TRUE(scene.tools[1].whole);
  EXPECT_EQ(scene.tools[1].edge_radius, 0.0005);
  EXPECT_EQ(scene.tools[1].grasp_depth, 0.003);
  EXPECT_EQ(scene.tools[1].grasp_turn, 0.2);
  EXPECT_EQ(scene.tools[2].name, "tool3");
  EXPECT_FALSE(scene.tools[2].whole);
  EXPECT_EQ(scene.tools[2].spins, 1);
  EXPECT_EQ(scene.tools[3].spins, 12);
  EXPECT_EQ(scene.tools[3].surface.file, folder_.path() / "grasper.obj");
  EXPECT_EQ(scene.friction, 0.3);
  EXPECT_EQ(scene.sampling.tangential_directions, 6);
  EXPECT_EQ(scene.sampling.friction_limit, SamplingScene::FrictionLimit::solved);
  ASSERT_TRUE(scene.sampling.within_box.has_value());
  EXPECT_EQ(scene.response.search, ResponseScene::Search::bvh);
  EXPECT_EQ(scene.solver.rim_size, 0.05);
  EXPECT_EQ(scene.solver.time_limit, 60.0);
  EXPECT_EQ(scene.solver.memory_limit, 200.0);
  ASSERT_EQ(scene.sampling.sites.size(), 2U);
  EXPECT_EQ(scene.sampling.sites[1], Eigen::Vector3d(0.1, 0, 0.2));
}

TEST_F(SceneTest, VolumetricSplitIsInTheTextWhereItIsGiven) {
  const std::string body = "[body]\nsurface = \"a.ply\"\n";
  const Scene isochoric = read(body + "[material]\nyoung = 1000\nvolumetric = \"isochoric\"\n");
  EXPECT_EQ(isochoric.material.volumetric, MaterialScene::Volumetric::isochoric);
  const Scene coupled = read(body + "[material]\nyoung = 1000\nvolumetric = \"coupled\"\n");
  EXPECT_EQ(canonical_text(coupled), canonical_text(read(body + "[material]\nyoung = 1000\n")));
  EXPECT_NE(canonical_text(isochoric), canonical_text(coupled));
}

TEST_F(SceneTest, ComplianceIsOfTheFileAlone) {
  const std::string body = "[body]\nsurface = \"a.ply\"\n";
  EXPECT_EQ(read(body).compliance.between, ComplianceScene::Between::none);
  const Scene scene = read(body + "[compliance]\nmodes = 32\n");
  EXPECT_EQ(scene.compliance.between, ComplianceScene::Between::contacts);
  EXPECT_EQ(scene.compliance.tolerance, 0.03);
  EXPECT_EQ(scene.compliance.modes, 32);
  // A scene that gains the section keeps its solves.
  EXPECT_EQ(canonical_text(scene, CanonicalScope::solves), canonical_text(read(body), CanonicalScope::solves));
  EXPECT_NE(canonical_text(scene), canonical_text(read(body)));
  EXPECT_EQ(canonical_text(read(body + "[compliance]\nbetween = \"none\"\n")), canonical_text(read(body)));
}

TEST_F(SceneTest, Prestress) {
  const std::string body = "body = {surface = \"a\"}\n";
  const PrestressScene none = read(body + "[prestress]\n").prestress;
  EXPECT_FALSE(none.any());
  EXPECT_EQ(canonical_text(read(body + "[prestress]\npressure = 0\nstretch = [1, 1, 1]\n")),
            canonical_text(read(body)));
  const PrestressScene all = read(body + R"([prestress]
gravity = [0, -9.81, 0]
density = 1040
pressure = 800
cavity = "lumen"
stretch = [1.1, 1, 0.9]
)")
                                 .prestress;
  EXPECT_TRUE(all.any());
  EXPECT_EQ(all.gravity, Eigen::Vector3d(0, -9.81, 0));
  EXPECT_EQ(all.density, 1040);
  EXPECT_EQ(all.pressure, 800);
  EXPECT_EQ(all.cavity, "lumen");
  EXPECT_EQ(all.stretch, Eigen::Vector3d(1.1, 1, 0.9));
  // Every key that acts is in the text that solves are known by.
  const std::string text = canonical_text(read(body + "[prestress]\ngravity = [0, 0, -1]\npressure = 1\n"));
  EXPECT_NE(text, canonical_text(read(body + "[prestress]\ngravity = [0, 0, -1]\ndensity = 1061\npressure = 1\n")));
  EXPECT_NE(text, canonical_text(read(body + "[prestress]\ngravity = [0, 0, -1]\npressure = 1\ncavity = \"c\"\n")));
}

TEST_F(SceneTest, SeveralFilesEachWithItsOwn) {
  const Scene scene = read(R"([body]
units = "mm"
surface = ["a.stl", {file = "b.glb", meshes = ["x"]}, {file = "c.ply", units = "m"}])");
  ASSERT_EQ(scene.body.surfaces.size(), 3U);
  EXPECT_EQ(scene.body.surfaces[0].unit, 0.001);
  EXPECT_EQ(scene.body.surfaces[1].unit, 0.001);
  EXPECT_EQ(scene.body.surfaces[1].meshes, std::vector<std::string>{"x"});
  EXPECT_EQ(scene.body.surfaces[2].unit, 1.0);
}

TEST_F(SceneTest, TheReferenceIsTheDefaultScene) {
  const std::string reference = scene_reference();
  const Scene scene = read(reference);
  const Scene least = read("body = {surface = \"FILE\"}");
  EXPECT_EQ(canonical_text(scene), canonical_text(least));
}

TEST_F(SceneTest, TheReferenceHasEveryKeyThatTheCommentedLinesShow) {
  // With the examples of what is left out by default taken in, it still reads.
  std::string text = scene_reference();
  for (const char* line : {"name = \"liver\"", "meshes = [\"NAME\"]", "within_box = {"}) {
    const auto at = text.find(std::string("# ") + line);
    ASSERT_NE(at, std::string::npos) << line;
    text.erase(at, 2);
  }
  const Scene scene = read(text);
  EXPECT_EQ(scene.name, "liver");
  EXPECT_EQ(scene.body.surfaces[0].meshes, std::vector<std::string>{"NAME"});
  EXPECT_TRUE(scene.sampling.within_box.has_value());
}

// A response that is recorded or follows a law changes the file and no solve.
TEST_F(SceneTest, SourcesOfResponses) {
  const std::string body = "[body]\nsurface = \"a.ply\"\n";
  const std::string sources =
      "[sources]\nrest = \"filled\"\n[[measured]]\nfile = \"sub/a.csv\"\n[[measured]]\nfile = \"b.csv\"\n"
      "tool = \"probe\"\nreach = 0.002\n[[analytic]]\nlaw = \"winkler\"\nstiffness = 1e6\nsites = [7, "
      "3]\n[[analytic]]\n"
      "law = \"layer\"\nthickness = 0.01\nmesh = \"rib\"\nwithin_box = {min = [0, 0, 0], max = [1, 1, 1]}\n";
  const Scene with = read(body + sources);
  const SceneSources scene = read_sources(folder_.path() / "liver.toml");
  EXPECT_EQ(scene.rest, SceneSources::Rest::filled);
  ASSERT_EQ(scene.measured.size(), 2U);
  EXPECT_EQ(scene.measured[0].file, folder_.path() / "sub/a.csv");
  EXPECT_EQ(scene.measured[1].tool, "probe");
  EXPECT_EQ(scene.measured[1].reach, 0.002);
  ASSERT_EQ(scene.analytic.size(), 2U);
  EXPECT_EQ(scene.analytic[0].law, AnalyticScene::Law::winkler);
  EXPECT_EQ(scene.analytic[0].sites, (std::vector<int>{3, 7}));
  EXPECT_FALSE(scene.analytic[0].young);
  EXPECT_EQ(scene.analytic[1].thickness, 0.01);
  EXPECT_EQ(scene.analytic[1].mesh, "rib");
  EXPECT_TRUE(scene.analytic[1].within_box);
  EXPECT_EQ(canonical_text(with), canonical_text(read(body)));
  const SceneSources none = read_sources(folder_.path() / "liver.toml");
  EXPECT_EQ(none.rest, SceneSources::Rest::solved);
  EXPECT_EQ(canonical_text(none), "");
  SceneSources other = scene;
  other.analytic[0].stiffness = 2e6;
  EXPECT_NE(canonical_text(other), canonical_text(scene));
  EXPECT_EQ(canonical_text(scene).rfind("sources.rest = \"filled\"\n", 0), 0U);
  other.analytic[0].tangential_stiffness = 3e6;
  EXPECT_NE(canonical_text(other).find("analytic.tangential_stiffness = 3e+06\n"), std::string::npos);
  other = scene;
  other.measured[0].file = "elsewhere.csv";
  EXPECT_EQ(canonical_text(other), canonical_text(scene));
}

TEST_F(SceneTest, CanonicalTextFollowsResultsNotPathsNorNames) {
  const std::string base = "[body]\nsurface = \"a.ply\"\n[contact]\nfriction = 0.1\n";
  const std::string text = canonical_text(read(base));
  EXPECT_EQ(text,
            canonical_text(read("name = \"other\"\n[body]\nsurface = \"sub/b.ply\"\n[contact]\nfriction = 1e-1\n")));
  for (const char* more :
       {"[sampling]\ndepth = 0.00500001\n", "[material]\nyoung = 5001\n", "[[support]]\nmesh = \"x\"\n",
        "[solver]\ngrowth = 0.71\n", "[solver]\nrim_size = 0.1\n", "[response]\ntolerance = 0.04\n",
        "[tool]\nradius = 0.0051\n", "[[region]]\nsurface = \"r.ply\"\n", "[prestress]\ngravity = [0, 0, -1]\n",
        "[prestress]\npressure = 10\n", "[prestress]\nstretch = [1, 1.01, 1]\n"}) {
    EXPECT_NE(text, canonical_text(read(base + more))) << more;
  }
  const auto solves = [&](const std::string& more) {
    return canonical_text(read(base + more), CanonicalScope::solves);
  };
  EXPECT_EQ(
      solves(""),
      solves("[response]\ntolerance = 0.04\nmax_residual = 2\nsearch = \"none\"\n[sampling]\nmax_refused = 0.5\n"));
  EXPECT_NE(solves(""), solves("[sampling]\nnormal_points = 13\n"));
  // A tool that is not turned keeps its solves.
  const std::string grasp = "[tool]\ngrasp_depth = 0.001\n";
  EXPECT_NE(solves(""), solves(grasp));
  EXPECT_EQ(solves(grasp), solves(grasp + "grasp_turn = 0\n"));
  EXPECT_NE(solves(grasp), solves(grasp + "grasp_turn = 0.1\n"));
  const std::string stem = "[tool]\nshape = \"capsule\"\n";
  EXPECT_EQ(solves(stem), solves(stem + "spins = 1\n"));
  EXPECT_NE(solves(stem), solves(stem + "spins = 8\n"));
  EXPECT_NE(solves(""), solves("[response]\npath_share = 0.5\n"));
  const std::string frictionless = "[body]\nsurface = \"a.ply\"\n";
  EXPECT_EQ(canonical_text(read(frictionless), CanonicalScope::solves),
            canonical_text(read(frictionless + "[response]\npath_share = 0.5\n"), CanonicalScope::solves));
  // Nothing of the machine is in it.
  EXPECT_EQ(text.find(folder_.path().string()), std::string::npos);
}

TEST_F(SceneTest, EarlierTextsHaveTheEarlierDefaults) {
  const std::string base = "[body]\nsurface = \"a.ply\"\n[contact]\nfriction = 0.1\n";
  const auto contains = [](const std::vector<std::string>& texts, const std::string& text) {
    return std::find(texts.begin(), texts.end(), text) != texts.end();
  };
  const Scene scene = read(base);
  const std::vector<std::string> earlier = earlier_canonical_texts(scene);
  EXPECT_EQ(earlier.size(), 3U);
  EXPECT_TRUE(contains(earlier, canonical_text(read(base + "[sampling]\ntangential_depths = 2\n"),
                                               CanonicalScope::solves)));
  std::size_t without_paths = 0;
  for (const std::string& text : earlier) without_paths += text.find("sampling.coupled") == std::string::npos ? 1 : 0;
  EXPECT_EQ(without_paths, 2U);
  EXPECT_FALSE(contains(earlier, canonical_text(scene, CanonicalScope::solves)));
  EXPECT_EQ(earlier_canonical_texts(read(base + "[sampling]\ntangential_depths = 4\n")).size(), 1U);
}

}  // namespace
}  // namespace palpate
