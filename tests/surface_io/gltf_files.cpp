// SPDX-License-Identifier: GPL-3.0-or-later
// glTF: names, transforms, primitives and index types.
#include "tests/support/shapes.hpp"
#include "tests/surface_io/glb.hpp"
#include "tests/surface_io/scratch.hpp"

namespace palpate::test {
namespace {

Surface unit_box() { return box_surface({0, 0, 0}, {1, 1, 1}); }

Eigen::AlignedBox3d bounds(const Surface& s) {
  Eigen::AlignedBox3d box;
  for (const auto& v : s.vertices) box.extend(v);
  return box;
}

void expect_bounds(const Surface& s, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  EXPECT_LE((bounds(s).min() - low).norm(), 1e-6) << bounds(s).min().transpose();
  EXPECT_LE((bounds(s).max() - high).norm(), 1e-6) << bounds(s).max().transpose();
}

TEST(Gltf, IndexTypes) {
  const Scratch scratch;
  for (const int size : {1, 2, 4}) {
    Glb glb;
    glb.mesh("box", unit_box(), size);
    const Surface s = read(scratch.write("box.glb", glb.bytes()));
    EXPECT_EQ(s.vertices.size(), 8U);
    EXPECT_EQ(s.triangles.size(), 12U);
    EXPECT_NEAR(surface_volume(s), 1.0, 1e-6);
    EXPECT_EQ(s.part_names, std::vector<std::string>{"box"});
  }
}

TEST(Gltf, NoIndicesAndSplitVerticesAreOneSurface) {
  const Scratch scratch;
  Glb glb;
  Surface soup;
  const Surface box = unit_box();
  for (const auto& t : box.triangles) {
    for (const auto v : t) soup.vertices.push_back(box.vertices[std::size_t(v)]);
  }
  const int point = glb.positions(soup, 8);  // interleaved with 8 bytes of something else
  glb.json["meshes"].push_back({{"primitives", Json::array({{{"attributes", {{"POSITION", point}}}}})}});
  const Surface s = read(scratch.write("soup.glb", glb.bytes()));  // and no node holds it
  EXPECT_EQ(s.vertices.size(), 8U);
  EXPECT_TRUE(closed_and_oriented(s));
  EXPECT_EQ(s.part_names, std::vector<std::string>{"mesh 0"});
}

TEST(Gltf, StripsAndFans) {
  const Scratch scratch;
  for (const int mode : {5, 6}) {
    Glb glb;
    Surface square;
    square.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    const int point = glb.positions(square);
    const std::vector<std::uint32_t> order =
        mode == 5 ? std::vector<std::uint32_t>{0, 1, 2, 3, 3} : std::vector<std::uint32_t>{0, 1, 3, 2};
    const int index = glb.indices(order, 2);
    glb.json["meshes"].push_back(
        {{"name", "m"},
         {"primitives", Json::array({{{"attributes", {{"POSITION", point}}}, {"indices", index}, {"mode", mode}}})}});
    const Surface s = read(scratch.write("strip.glb", glb.bytes()));
    ASSERT_EQ(s.triangles.size(), 2U) << mode;
    for (const auto& t : s.triangles) {
      const auto& a = s.vertices[std::size_t(t[0])];
      EXPECT_GT((s.vertices[std::size_t(t[1])] - a).cross(s.vertices[std::size_t(t[2])] - a).z(), 0.9);
    }
  }
}

TEST(Gltf, SeveralPrimitivesAreOnePart) {
  const Scratch scratch;
  Glb glb;
  const Surface box = unit_box();
  const int point = glb.positions(box);
  const auto list = Glb::list(box);
  Json primitives = Json::array();
  for (const auto& [first, last, size] : {std::tuple{0, 12, 1}, {12, 36, 4}}) {
    const int index = glb.indices({list.begin() + first, list.begin() + last}, size);
    primitives.push_back({{"attributes", {{"POSITION", point}}}, {"indices", index}});
  }
  primitives.push_back({{"attributes", {{"POSITION", point}}}, {"mode", 1}});  // lines: no surface
  glb.json["meshes"].push_back({{"name", "two"}, {"primitives", primitives}});
  const Surface s = read(scratch.write("two.glb", glb.bytes()));
  EXPECT_TRUE(closed_and_oriented(s));
  EXPECT_EQ(s.part_names.size(), 1U);
}

TEST(Gltf, TransformsOfTheWholeHierarchy) {
  const Scratch scratch;
  Glb glb;
  glb.mesh("box", unit_box(), 2, false);
  const double half = std::sqrt(0.5);
  // Child: scaled by (1, 2, 3); parent: a quarter turn about z; grandparent: a matrix that moves by (10, 0, 0).
  glb.json["nodes"] = {
      {{"name", "root"}, {"children", {1}}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 0, 0, 1}}},
      {{"children", {2}}, {"rotation", {0, 0, half, half}}, {"translation", {0, 0, 5}}},
      {{"mesh", 0}, {"scale", {1, 2, 3}}}};
  glb.json["scenes"] = {{{"nodes", {0}}}};
  const Surface s = read(scratch.write("h.glb", glb.bytes()), {}, 0.1);
  expect_bounds(s, {0.8, 0, 0.5}, {1.0, 0.1, 0.8});
  EXPECT_NEAR(surface_volume(s), 6e-3, 1e-8);
}

TEST(Gltf, MirroredNodeStaysOutward) {
  const Scratch scratch;
  for (const Json& scale : {Json{-1, 1, 1}, Json{-2, -1, -1}, Json{-1, -1, 1}}) {
    Glb glb;
    glb.mesh("box", unit_box());
    glb.json["nodes"][0]["scale"] = scale;
    EXPECT_GT(surface_volume(read(scratch.write("m.glb", glb.bytes()))), 0.9) << scale;
  }
}

TEST(Gltf, NamesOfMeshesNodesAndGroups) {
  const Scratch scratch;
  Glb glb;
  for (int i = 0; i < 3; ++i) {
    glb.mesh("mesh" + std::to_string(i), box_surface({double(i), 0, 0}, {i + 0.5, 1, 1}), 2, false);
  }
  glb.json["nodes"] = {{{"name", "group"}, {"children", {1, 2}}},
                       {{"name", "a"}, {"mesh", 0}},
                       {{"name", "b"}, {"mesh", 1}, {"children", {3}}},
                       {{"name", "c"}, {"mesh", 2}}};
  const auto file = scratch.write("n.glb", glb.bytes());
  EXPECT_EQ(read(file).part_names, (std::vector<std::string>{"mesh0", "mesh1", "mesh2"}));
  EXPECT_EQ(read(file, {"mesh2", "a"}).part_names, (std::vector<std::string>{"mesh2", "a"}));
  EXPECT_EQ(read(file, {"group"}).part_names, (std::vector<std::string>{"mesh0", "mesh1", "mesh2"}));
  expect_bounds(read(file, {"b"}), {1, 0, 0}, {1.5, 1, 1});     // a node with a mesh stands for that mesh alone
  EXPECT_EQ(read(file, {"a", "mesh0"}).triangles.size(), 12U);  // named twice, taken once
  expect_error([&] { read(file, {"liver"}); }, ExitCode::bad_input, {"n.glb", "'liver'", "mesh0, mesh1, mesh2"});
}

TEST(Gltf, TextFormWithEmbeddedAndNeighbouringBuffers) {
  const Scratch scratch;
  Glb glb;
  glb.mesh("box", unit_box());
  scratch.write("box.bin", glb.data);
  glb.json["buffers"] = {{{"byteLength", glb.data.size()}, {"uri", "box.bin"}}};
  EXPECT_NEAR(surface_volume(read(scratch.write("box.gltf", glb.json.dump()))), 1.0, 1e-6);
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string code;
  for (std::size_t i = 0; i < glb.data.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k)
      word = word << 8 | (i + k < glb.data.size() ? std::uint8_t(glb.data[i + k]) : 0);
    for (std::size_t k = 0; k < 4; ++k) code += i + k > glb.data.size() ? '=' : digits[word >> (18 - 6 * k) & 63];
  }
  for (const char* type : {"application/octet-stream", "application/gltf-buffer", "", "text/plain;charset=US-ASCII"}) {
    SCOPED_TRACE(type);
    glb.json["buffers"][0]["uri"] = std::string("data:") + type + ";base64," + code;
    EXPECT_NEAR(surface_volume(read(scratch.write("box.gltf", glb.json.dump()))), 1.0, 1e-6);
  }
  for (const auto& bad : {std::string("data:,box"), "data:;base64," + code.substr(0, 40)}) {
    glb.json["buffers"][0]["uri"] = bad;
    expect_error([&] { read(scratch.write("box.gltf", glb.json.dump())); }, ExitCode::bad_input, {"box.gltf"});
  }
  glb.json["buffers"][0]["uri"] = "missing.bin";
  expect_error([&] { read(scratch.write("box.gltf", glb.json.dump())); }, ExitCode::bad_input,
               {"box.gltf", "missing.bin"});
  glb.json["buffers"][0]["uri"] = "../../etc/passwd";
  expect_error([&] { read(scratch.write("box.gltf", glb.json.dump())); }, ExitCode::bad_input,
               {"box.gltf", "buffers[0]"});
}

TEST(Gltf, ImagesAndOtherExtrasAreNotTouched) {
  const Scratch scratch;
  Glb glb;
  glb.mesh("box", unit_box());
  glb.json["images"] = {{{"bufferView", 0}, {"mimeType", "image/png"}}};
  glb.json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 4}, {"byteLength", 8}});
  glb.json["materials"] = {{{"pbrMetallicRoughness", "nonsense"}}};
  glb.json["skins"] = "nonsense";
  EXPECT_EQ(read(scratch.write("i.glb", glb.bytes())).triangles.size(), 12U);
}

}  // namespace
}  // namespace palpate::test
