// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes that are wrong, each with the line, the key and the range that its message must name.
#include "formats/error.hpp"
#include "formats/scene.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>
#include <ostream>
#include <string>
#include <vector>

namespace palpate {
namespace {

struct Case {
  std::string name;
  std::string text;                   ///< follows "[body]\nsurface = \"a.ply\"\n", and so begins at line 3
  int line;                           ///< 0: no line expected
  std::vector<std::string> expected;  ///< parts of the message
};

/// For the test's name and output; otherwise the bytes of the case are printed.
[[maybe_unused]] void PrintTo(const Case& test_case, std::ostream* out) { *out << test_case.name; }

/// A key set to a bad value, with the range that must be shown.
Case bad(const std::string& section, const std::string& key, const std::string& value, const std::string& allowed) {
  const bool in_body = section == "body";
  const std::string text = (in_body ? "" : "[" + section + "]\n") + key + " = " + value + "\n";
  return {section + "_" + key + "_" + value, text, in_body ? 3 : 4, {section + "." + key + ": got ", allowed}};
}

std::vector<Case> cases() {
  std::vector<Case> all{
      bad("body", "repair", "\"fix\"", "\"auto\" | \"none\" | \"repair\" | \"wrap\""),
      bad("body", "repair", "\"warp\"", "did you mean \"wrap\"?"),
      bad("body", "repair", "1", "\"auto\""),
      bad("body", "units", "\"km\"", "\"mm\""),
      bad("body", "meshes", "[]", "one or more"),
      bad("body", "meshes", "[\"\"]", "not empty"),
      bad("body", "wrap_alpha", "-1", "0 <= x <= 10 m"),
      bad("body", "wrap_offset", "nan", "0 <= x <= 10 m"),
      bad("body", "smooth", "4", "0 <= x <= 3"),
      bad("material", "law", "\"rubber\"", "\"neo-hookean\" | \"mooney-rivlin\""),
      bad("material", "k2", "0", "0 < x <= 1000"),
      bad("material", "dispersion", "0.4", "0 <= x <= 0.333"),
      bad("material", "young", "0", "0 < x <= 1e+12 Pa"),
      bad("material", "young", "-5e3", "0 < x <= 1e+12 Pa"),
      bad("material", "young", "inf", "0 < x <= 1e+12 Pa"),
      bad("material", "young", "\"5e3\"", "a number, 0 < x"),
      bad("material", "young", "true", "a number"),
      bad("material", "young", "1979-05-27", "a number"),
      bad("material", "poisson", "0.5", "0 <= x <= 0.4999"),
      bad("material", "poisson", "-0.1", "0 <= x <= 0.4999"),
      bad("material", "poisson", "nan", "0 <= x <= 0.4999"),
      bad("tool", "radius", "0", "0 < x <= 1 m"),
      bad("tool", "radius", "-0.005", "0 < x <= 1 m"),
      bad("tool", "radius", "5", "0 < x <= 1 m"),
      bad("tool", "radius", "[0.005]", "a number"),
      bad("tool", "shape", "\"cube\"", "\"sphere\" | \"punch\" | \"capsule\" | \"mesh\" | \"cone\" | \"needle\""),
      bad("tool", "contacts", "\"some\"", "\"all\" | \"tip\""),
      bad("tool", "grasp_turn", "0.6", "0 <= x <= 0.5 rad"),
      bad("tool", "name", "\"\"", "not empty"),
      bad("tool", "name", "\"a\\u0007b\"", "control characters"),
      bad("tool", "name", "\"01234567890123456789012345678901\"", "at most 31 bytes"),
      bad("contact", "friction", "-0.1", "0 <= x <= 2"),
      bad("contact", "friction", "2.5", "0 <= x <= 2"),
      bad("sampling", "spacing", "0", "0 < x <= 1 m"),
      bad("sampling", "margin_spacing", "-1", "0 <= x <= 1 m"),
      bad("sampling", "depth", "0", "0 < x <= 1 m"),
      bad("sampling", "depth", "-0.0", "0 < x <= 1 m"),
      bad("sampling", "depth_fraction", "0.9", "0 < x <= 0.8"),
      bad("sampling", "depth_fraction", "0", "0 < x <= 0.8"),
      bad("sampling", "normal_points", "3", "4 <= x <= 64"),
      bad("sampling", "normal_points", "12.0", "a whole number"),
      bad("sampling", "normal_points", "9223372036854775807", "4 <= x <= 64"),
      bad("sampling", "tangential_depths", "1", "2 <= x <= 8"),
      bad("sampling", "tangential_directions", "5", "an even whole number, 4 <= x <= 16"),
      bad("sampling", "tangential_points", "17", "2 <= x <= 16"),
      bad("sampling", "max_refused", "0.6", "0 <= x <= 0.5"),
      bad("sampling", "within_box", "[0, 1]", "a table"),
      bad("response", "model", "\"radial\"", "\"separable\" | \"coupled\" | \"linear\""),
      bad("response", "order", "5", "0 <= x <= 4"),
      bad("response", "path_share", "1.1", "0 <= x <= 1"),
      bad("response", "search", "\"octree\"", "\"auto\" | \"none\" | \"bvh\""),
      bad("response", "tolerance", "0", "0 < x <= 0.99"),
      bad("response", "tolerance", "1", "0 < x <= 0.99"),
      bad("solver", "mesh_size", "0", "0.05 <= x <= 1"),
      bad("solver", "growth", "1.1", "0 < x <= 1"),
      bad("solver", "max_size", "-1", "0 <= x <= 10 m"),
      bad("solver", "rim_size", "-0.1", "0 <= x <= 1"),
      bad("solver", "rim_size", "1.5", "0 <= x <= 1"),
      bad("solver", "time_limit", "0", "0 < x <= 86400 s"),
  };
  const std::vector<Case> more{
      {"unknown_key", "[sampling]\ndeepth = 0.1\n", 4, {"sampling.deepth: unknown key", "did you mean 'depth'?"}},
      {"unknown_key_far",
       "[sampling]\nxyzzyplugh = 0.1\n",
       4,
       {"sampling.xyzzyplugh: unknown key", "Allowed here: spacing"}},
      {"unknown_section", "[samplings]\ndepth = 0.1\n", 3, {"samplings: unknown key", "did you mean 'sampling'?"}},
      {"unknown_dotted", "[contact]\nfriction.static = 0.1\n", 4, {"contact.friction: got a table"}},
      {"section_is_value", "[x]\n[response]\nmodel=\"separable\"\n", 3, {"x: unknown key"}},
      {"coupled_frictionless", "[response]\nmodel=\"coupled\"\n", 4, {"response.model: \"coupled\" needs", "friction"}},
      {"linear_frictionless", "[response]\nmodel=\"linear\"\n", 4, {"response.model: \"linear\" needs", "friction"}},
      {"coupled_order",
       "[contact]\nfriction=0.3\n[response]\nmodel=\"coupled\"\norder=1\n",
       7,
       {"response.order: got 1"}},
      {"array_section", "[[sampling]]\ndepth = 0.1\n", 3, {"sampling: got", "a table"}},
      {"capsule_without_modulus", "capsule_thickness = 1e-4\n", 1, {"body.capsule_young: missing"}},
      {"prestress_density", "[prestress]\ndensity = 1000\n", 4, {"prestress.density: changes nothing without gravity"}},
      {"prestress_cavity", "[prestress]\ncavity = \"c\"\n", 4, {"prestress.cavity: changes nothing without pressure"}},
      {"prestress_pressure", "[prestress]\npressure = -1\n", 4, {"prestress.pressure: got -1", "0 <= x"}},
      {"prestress_stretch", "[prestress]\nstretch = [1, 0, 1]\n", 4, {"prestress.stretch: got", "0.2 <= x <= 5"}},
      {"capsule_without_thickness", "capsule_young = 1e6\n", 1, {"body.capsule_thickness: missing"}},
      {"punch_edge",
       "[tool]\nshape = \"punch\"\nradius = 0.004\nedge_radius = 0.004\n",
       6,
       {"tool.edge_radius", "allowed x < radius = 0.004"}},
      {"punch_length",
       "[tool]\nshape = \"punch\"\nradius = 0.004\nlength = 0.0001\n",
       6,
       {"tool.length", "x >= edge_radius"}},
      {"sphere_with_length",
       "[tool]\nradius = 0.004\nlength = 0.1\n",
       5,
       {"tool.length", "shape \"sphere\" has no such key", "[\"radius\"]"}},
      {"turn_without_grasp",
       "[tool]\nradius = 0.004\ngrasp_turn = 0.1\n",
       5,
       {"tool.grasp_turn: only a tool that holds on turns", "grasp_depth"}},
      {"turn_too_small",
       "[tool]\nradius = 0.004\ngrasp_depth = 0.001\ngrasp_turn = 1e-4\n",
       6,
       {"tool.grasp_turn: got 1e-04", "0.01 to 0.5 rad"}},
      {"capsule_length_zero", "[tool]\nshape = \"capsule\"\nlength = 0\n", 5, {"tool.length: got 0", "0 < x <= 10 m"}},
      {"mesh_without_surface", "[tool]\nshape = \"mesh\"\n", 3, {"tool.surface: missing"}},
      {"mesh_with_radius",
       "[tool]\nshape = \"mesh\"\nsurface = \"t.ply\"\nradius = 0.1\n",
       6,
       {"tool.radius", "has no such key"}},
      {"mesh_with_contacts",
       "[tool]\nshape = \"mesh\"\nsurface = \"t.ply\"\ncontacts = \"tip\"\n",
       6,
       {"tool.contacts", "shape \"mesh\" has no such key"}},
      {"sphere_with_contacts",
       "[tool]\ncontacts = \"tip\"\n",
       4,
       {"tool.contacts", "shape \"sphere\" has no such key"}},
      {"more_depths_sideways_than_straight",
       "[sampling]\nnormal_points = 4\ntangential_depths = 5\n",
       5,
       {"sampling.tangential_depths: got 5", "2 <= x <= normal_points = 4"}},
      {"region_hidden",
       "[[region]]\nname = \".a\"\nsurface = \"b\"\n",
       4,
       {"region.name: got \".a\"", "no '.' at the beginning"}},
      {"region_in_a_folder",
       "[[region]]\nname = \"a/b\"\nsurface = \"c\"\n",
       4,
       {"region.name: got", "letters, digits"}},
      {"region_above", "[[region]]\nname = \"../x\"\nsurface = \"c\"\n", 4, {"region.name: got", "letters, digits"}},
      {"tool_units_alone", "[tool]\nshape = \"mesh\"\nunits = \"mm\"\n", 5, {"tool.units", "there is no 'surface'"}},
      {"cone_with_a_shaft", "[tool]\nshape = \"cone\"\nshaft_radius = 0.01\n", 5, {"tool.shaft_radius", "no such key"}},
      {"thin_shaft",
       "[tool]\nshape = \"needle\"\nradius = 0.001\nshaft_radius = 0.001\n",
       6,
       {"tool.shaft_radius: got 0.001", "x > radius"}},
      {"duplicate_tools", "[[tool]]\nname = \"a\"\n[[tool]]\nname = \"a\"\n", 5, {"tool.name: got \"a\" twice"}},
      {"duplicate_with_default", "[[tool]]\nname = \"tool2\"\n[[tool]]\n", 5, {"tool.name: got \"tool2\" twice"}},
      {"duplicate_regions",
       "[[region]]\nname=\"a\"\nsurface=\"b\"\n[[region]]\nname=\"a\"\nsurface=\"c\"\n",
       6,
       {"region.name: got \"a\" twice"}},
      {"empty_tools", "tool = []\n", 3, {"body.tool: unknown key"}},
      {"law_key_of_another",
       "[material]\nc10 = 500\n",
       4,
       {"material.c10", "law \"neo-hookean\" has no such key; it has: poisson, [\"young\", \"tissue\"]"}},
      {"law_and_young",
       "[material]\nlaw = \"mooney-rivlin\"\nc10 = 500\nc01 = 100\nyoung = 5000\n",
       7,
       {"material.young", "no such key"}},
      {"tissue_and_young",
       "[material]\nyoung = 5000\ntissue = \"liver\"\n",
       5,
       {"material.tissue", "either 'tissue' or 'young'"}},
      {"tissue_unknown", "[material]\ntissue = \"livre\"\n", 4, {"material.tissue", "did you mean \"liver\"?"}},
      {"law_without_its_key",
       "[material]\nlaw = \"mooney-rivlin\"\nc10 = 500\n",
       3,
       {"material.c01: missing", "\"mooney-rivlin\" needs it"}},
      {"law_without_stiffness",
       "[material]\nlaw = \"ogden\"\nterms = [[100, -2], [10, 2]]\n",
       3,
       {"material.terms", "shear modulus at small strain is -90 Pa", "x > 0"}},
      {"ogden_exponent", "[material]\nlaw = \"ogden\"\nterms = [[100, 0]]\n", 5, {"material.terms", "alpha not 0"}},
      {"ogden_single", "[material]\nlaw = \"ogden\"\nterms = [100, 2]\n", 5, {"material.terms", "[[mu, alpha], ...]"}},
      {"fibre_nowhere",
       "[material]\nlaw = \"holzapfel-ogden\"\nk1 = 1\nk2 = 1\nfibre = [0, 0, 0]\n",
       7,
       {"material.fibre", "length > 1e-9"}},
      {"fibre_along_nothing",
       "[material]\nlaw = \"holzapfel-ogden\"\nk1 = 1\nk2 = 1\nfibre = {units = \"mm\"}\n",
       7,
       {"material.fibre", "no 'centreline'"}},
      {"fibre_of_other_keys",
       "[material]\nlaw = \"holzapfel-ogden\"\nk1 = 1\nk2 = 1\nfibre = {centerline = \"a.obj\"}\n",
       7,
       {"material.fibre.centerline: unknown key", "did you mean 'centreline'?"}},
      {"fibre_in_miles",
       "[material]\nlaw = \"holzapfel-ogden\"\nk1 = 1\nk2 = 1\nfibre = {centreline = \"a.obj\", units = \"mi\"}\n",
       7,
       {"units: got \"mi\"", "\"mm\""}},
      {"labels_without_value", "[[region]]\nlabels = {image = \"a.nrrd\"}\n", 4, {"need both 'image' and 'value'"}},
      {"labels_of_half",
       "[[region]]\nlabels = {image = \"a.nrrd\", value = 1.5}\n",
       4,
       {"region.labels.value: got 1.5", "a whole number"}},
      {"labels_and_ball",
       "[[region]]\nlabels = {image = \"a.nrrd\", value = 1}\nsphere = {center = [0, 0, 0], radius = 1}\n",
       3,
       {"region: got 2 shapes"}},
      {"linear_locks", "[material]\nlaw = \"linear\"\npoisson = 0.49\n", 5, {"material.poisson: got 0.49", "0.45"}},
      {"region_law",
       "[[region]]\nsurface = \"r.ply\"\nlaw = \"ogden\"\n",
       3,
       {"region.terms: missing", "\"ogden\" needs it"}},
      {"region_without_surface",
       "[[region]]\nyoung = 1e4\n",
       3,
       {"region: got 0 shapes", "exactly one of surface, sphere"}},
      {"region_of_two_shapes",
       "[[region]]\nsurface = \"r.ply\"\nbox = {min = [0, 0, 0], max = [1, 1, 1]}\n",
       3,
       {"region: got 2 shapes"}},
      {"ball_without_radius", "[[region]]\nsphere = {center = [0, 0, 0]}\n", 4, {"needs 'center' and 'radius'"}},
      {"ball_of_nothing",
       "[[region]]\nsphere = {center = [0, 0, 0], radius = 0}\n",
       4,
       {"region.sphere.radius: got 0", "0 < x <= 10 m"}},
      {"flat_ellipsoid",
       "[[region]]\nellipsoid = {center = [0, 0, 0], radii = [0.01, 0, 0.01]}\n",
       4,
       {"region.ellipsoid.radii", "0 < x <= 10 m"}},
      {"region_modulus", "[[region]]\nsurface = \"r.ply\"\nyoung = -1\n", 5, {"region.young: got -1", "0 < x"}},
      {"support_nothing",
       "[[support]]\n",
       3,
       {"support: got 0 places", "exactly one of mesh, box, half_space, distance"}},
      {"support_two",
       "[[support]]\nmesh = \"a\"\nbox = {min = [0, 0, 0], max = [1, 1, 1]}\n",
       3,
       {"support: got 2 places"}},
      {"spring_without_stiffness",
       "[[support]]\nmesh = \"a\"\ntype = \"spring\"\n",
       3,
       {"support.stiffness: missing", "spring bed"}},
      {"stiff_slider",
       "[[support]]\nmesh = \"a\"\ntype = \"slider\"\nstiffness = 1e5\n",
       6,
       {"support.stiffness", "only a support of type \"spring\""}},
      {"support_unknown", "[[support]]\nmsh = \"a\"\n", 4, {"support.msh: unknown key", "did you mean 'mesh'?"}},
      {"box_flat",
       "[[support]]\nbox = {min = [0, 0, 0], max = [1, 0, 1]}\n",
       4,
       {"support.box", "every component of min below that of max"}},
      {"box_half", "[[support]]\nbox = {min = [0, 0, 0]}\n", 4, {"needs both 'min' and 'max'"}},
      {"box_nan", "[[support]]\nbox = {min = [0, 0, nan], max = [1, 1, 1]}\n", 4, {"support.box.min: got nan"}},
      {"box_two_numbers",
       "[[support]]\nbox = {min = [0, 0], max = [1, 1, 1]}\n",
       4,
       {"support.box.min: got [ 0, 0 ]", "[x, y, z]"}},
      {"normal_zero",
       "[[support]]\nhalf_space = {point = [0, 0, 0], normal = [0, 0, 0]}\n",
       4,
       {"support.half_space.normal", "a vector of length"}},
      {"half_space_half", "[[support]]\nhalf_space = {point = [0, 0, 0]}\n", 4, {"needs both 'point' and 'normal'"}},
      {"distance_half", "[[support]]\ndistance = {surface = \"a\"}\n", 4, {"needs both 'surface' and 'within'"}},
      {"distance_zero",
       "[[support]]\ndistance = {surface = \"a\", within = 0}\n",
       4,
       {"support.distance.within: got 0", "0 < x <= 10 m"}},
      {"margin",
       "[sampling]\nspacing = 0.01\nmargin_spacing = 0.02\n",
       5,
       {"sampling.margin_spacing: got 0.02", "x <= spacing = 0.01 m"}},
      {"recording_without_file", "[[measured]]\ntool = \"probe\"\n", 3, {"measured.file: missing"}},
      {"recording_reach", "[[measured]]\nfile = \"a.csv\"\nreach = 0\n", 5, {"measured.reach: got 0", "0 < x <= 1 m"}},
      {"recording_unknown", "[measured]\nfil = \"a.csv\"\n", 4, {"measured.fil: unknown key", "did you mean 'file'?"}},
      {"law_missing", "[[analytic]]\nyoung = 5000\n", 3, {"analytic.law: missing", "\"hertz\" | \"punch\""}},
      {"law_unknown", "[[analytic]]\nlaw = \"herz\"\n", 4, {"analytic.law: got \"herz\"", "did you mean \"hertz\"?"}},
      {"law_key_of_another",
       "[[analytic]]\nlaw = \"spring\"\nstiffness = 1\npoisson = 0.3\n",
       6,
       {"analytic.poisson: the law \"spring\" has no such key", "\"stiffness\""}},
      {"law_without_stiffness", "[[analytic]]\nlaw = \"winkler\"\n", 3, {"analytic.stiffness: missing", "winkler"}},
      {"law_sites", "[[analytic]]\nlaw = \"hertz\"\nsites = [1, -2]\n", 5, {"analytic.sites: got -2", "0 <= x"}},
      {"law_no_sites", "[[analytic]]\nlaw = \"hertz\"\nsites = []\n", 5, {"analytic.sites: got an empty array"}},
      {"law_box",
       "[[analytic]]\nlaw = \"hertz\"\nwithin_box = {min = [0, 0, 0]}\n",
       5,
       {"analytic.within_box", "both 'min' and 'max'"}},
      bad("analytic", "poisson", "0.6", "0 <= x <= 0.5"),
      bad("analytic", "thickness", "0", "0 < x <= 10 m"),
      bad("sources", "rest", "\"guessed\"", "\"solved\" | \"covered\""),
      {"duplicate_key", "[contact]\nfriction = 0.1\nfriction = 0.2\n", 5, {"not TOML"}},
      {"syntax", "[contact\nfriction = 0.1\n", 3, {"not TOML"}},
      {"open_string", "[tool]\nname = \"abc\n", 4, {"not TOML"}},
  };
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

class BadScene : public testing::TestWithParam<Case> {};

TEST_P(BadScene, IsRefusedWithItsCause) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("scene.toml", "[body]\nsurface = \"a.ply\"\n" + GetParam().text);
  try {
    read_scene(file);
    FAIL() << "was read";
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    EXPECT_EQ(message.find(file.string() + ":" + std::to_string(GetParam().line) + ": "), 0U) << message;
    for (const std::string& part : GetParam().expected) EXPECT_NE(message.find(part), std::string::npos) << message;
  }
}

INSTANTIATE_TEST_SUITE_P(Table, BadScene, testing::ValuesIn(cases()), [](const auto& test_case) {
  std::string name;
  for (const char c : test_case.param.name) name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return std::to_string(test_case.index) + "_" + name;
});

/// Whole files, for what does not follow a good beginning.
std::string message_of(const std::string& text, ExitCode code = ExitCode::bad_input) {
  const test::TemporaryFolder folder;
  try {
    read_scene(folder.write("scene.toml", text));
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    return std::string(error.what()).substr(folder.path().string().size() + 1);
  }
  ADD_FAILURE() << "was read: " << text;
  return "";
}

TEST(BadSceneFile, WithoutABody) {
  EXPECT_EQ(message_of("").rfind("scene.toml: body.surface: missing", 0), 0U) << message_of("");
  EXPECT_EQ(message_of("# nothing\n\n[body]\n").rfind("scene.toml:3: body.surface: missing", 0), 0U);
  EXPECT_EQ(message_of("body = 3\n").rfind("scene.toml:1: body: got 3; allowed a table", 0), 0U);
  EXPECT_NE(message_of("[body]\nsurface = []\n").find("scene.toml:2: body.surface: got an empty array"),
            std::string::npos);
  EXPECT_NE(message_of("[body]\nsurface = \"\"\n").find("body.surface: got \"\""), std::string::npos);
  EXPECT_NE(message_of("[body]\nsurface = [\"a\", 3]\n").find("body.surface: got 3"), std::string::npos);
  EXPECT_NE(message_of("[body]\nmeshes = [\"a\"]\n").find("body.meshes: there is no 'surface'"), std::string::npos);
  EXPECT_NE(message_of("[body]\nmeshes = [\"m\"]\nsurface = [\"a\", \"b\"]\n")
                .find("scene.toml:2: body.meshes: name the meshes of each"),
            std::string::npos);
  EXPECT_NE(message_of("tool = []\nbody = {surface = \"a\"}\n").find("scene.toml:1: tool: got an empty array"),
            std::string::npos);
  EXPECT_NE(message_of("tool = [1]\nbody = {surface = \"a\"}\n").find("scene.toml:1: tool: got 1"), std::string::npos);
}

TEST(BadSceneFile, KeyOutsideItsSection) {
  EXPECT_NE(message_of("depth = 0.1\n[body]\nsurface = \"a\"\n").find("belongs into the section [sampling]"),
            std::string::npos);
  EXPECT_NE(message_of("surface = \"a\"\n").find("belongs into the section [body]"), std::string::npos);
  EXPECT_NE(message_of("name = \"a/b\"\n[body]\nsurface = \"a\"\n").find("without '/'"), std::string::npos);
}

TEST(BadSceneFile, NotTextAtAll) {
  EXPECT_NE(message_of(std::string("glTF\2\0\0\0\xff\xfe\x00\x01", 12)).find("scene.toml:1: not TOML"),
            std::string::npos);
  EXPECT_NE(message_of(std::string(1000, '\0')).find("not TOML"), std::string::npos);
  EXPECT_NE(message_of(std::string(100'000, '[')).find("not TOML"), std::string::npos);
  EXPECT_NE(message_of(std::string((1 << 20) + 1, '#')).find("too large"), std::string::npos);
}

TEST(BadSceneFile, EveryTruncationIsReadOrRefused) {
  const std::string whole =
      "[body]\nsurface = \"a.ply\"\n[[support]]\nbox = {min = [0, 0, 0], max = [1, 1, 1]}\n[contact]\nfriction = "
      "0.25\n";
  const test::TemporaryFolder folder;
  int good = 0;
  for (std::size_t length = 0; length <= whole.size(); ++length) {
    const auto file = folder.write("scene.toml", whole.substr(0, length));
    try {
      read_scene(file);
      ++good;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::bad_input);
    }
  }
  EXPECT_GT(good, 3);  // whole, and where it is cut between sections
  EXPECT_LT(good, 60);
}

TEST(BadSceneFile, Missing) {
  const test::TemporaryFolder folder;
  for (const auto& path : {folder.path() / "none.toml", folder.path()}) {
    try {
      read_scene(path);
      FAIL() << path << " was read";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::io);
      EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace palpate
