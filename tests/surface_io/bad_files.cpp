// SPDX-License-Identifier: GPL-3.0-or-later
// Bad files: each kind ends in an Error that names file and cause; none crashes or hangs.
#include "tests/support/shapes.hpp"
#include "tests/surface_io/glb.hpp"
#include "tests/surface_io/scratch.hpp"

#include <limits>
#include <random>

namespace palpate::test {
namespace {

const std::vector<std::string> extensions = {".obj", ".off", ".ply", ".stl", ".glb", ".gltf"};

std::string content(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string good_file(const Scratch& scratch, const std::string& extension) {
  const Surface box = box_surface({0, 0, 0}, {1, 1, 1});
  if (extension == ".glb") {
    Glb glb;
    glb.mesh("box", box);
    return glb.bytes();
  }
  write_surface(box, scratch / ("good" + extension));
  return content(scratch / ("good" + extension));
}

TEST(BadFile, MissingFolderUnknownAndEmpty) {
  const Scratch scratch;
  std::filesystem::create_directory(scratch / "folder.ply");
  for (const auto& extension : extensions) {
    expect_error([&] { read(scratch / ("none" + extension)); }, ExitCode::io, {"none" + extension, "No such file"});
    const auto file = scratch.write("empty" + extension, "");
    expect_error([&] { read(file); }, ExitCode::bad_input, {"empty" + extension, "empty"});
    const auto blank = scratch.write("blank" + extension, " \n\n");
    expect_error([&] { read(blank); }, ExitCode::bad_input, {"blank" + extension});
  }
  expect_error([&] { read(scratch / "folder.ply"); }, ExitCode::io, {"folder.ply", "not a regular file"});
  expect_error([&] { read(scratch.write("a.fbx", "x")); }, ExitCode::bad_input, {"a.fbx", "'.fbx'", ".glb"});
  const auto obj = scratch.write("a.obj", "v 0 0 0\n");
  expect_error([&] { read(obj); }, ExitCode::bad_input, {"a.obj", "no triangles"});
  for (const double unit : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    expect_error([&] { read(obj, {}, unit); }, ExitCode::bad_input, {"unit"});
  }
}

TEST(BadFile, BinaryGarbage) {
  const Scratch scratch;
  std::mt19937 random(1);
  for (const auto& extension : extensions) {
    for (const std::size_t size : {1U, 19U, 84U, 5000U}) {
      std::string bytes;
      for (std::size_t i = 0; i < size; ++i) bytes += char(random() & 0xff);
      const auto file = scratch.write("garbage" + extension, bytes);
      expect_error([&] { read(file); }, ExitCode::bad_input, {"garbage" + extension});
    }
  }
}

TEST(BadFile, EveryTruncation) {
  const Scratch scratch;
  for (const std::string extension : {".off", ".ply", ".stl", ".glb"}) {
    const auto good = good_file(scratch, extension);
    for (std::size_t length = 1; length + 2 < good.size(); ++length) {
      const auto file = scratch.write("cut" + extension, good.substr(0, length));
      expect_error([&] { read(file); }, ExitCode::bad_input, {"cut" + extension});
    }
  }
  // A text OBJ says nothing of its length: what is cut inside a number or a face cannot all be seen.
  const auto obj = good_file(scratch, ".obj");
  for (std::size_t length = 1; length < obj.size(); ++length) {
    const auto file = scratch.write("cut.obj", obj.substr(0, length));
    try {
      EXPECT_LE(read(file).triangles.size(), 12U);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::bad_input);
    }
  }
}

TEST(BadFile, EverySingleByteChanged) {
  const Scratch scratch;
  std::mt19937 random(7);
  for (const std::string extension : {".obj", ".off", ".ply", ".stl", ".glb"}) {
    const auto good = good_file(scratch, extension);
    for (std::size_t at = 0; at < good.size(); ++at) {
      auto bytes = good;
      bytes[at] = char(random() & 0xff);
      const auto file = scratch.write("changed" + extension, bytes);
      try {
        for (const auto& vertex : read(file).vertices) ASSERT_TRUE(vertex.allFinite());
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::bad_input) << error.what();
      }
    }
  }
}

TEST(BadFile, CoordinatesThatAreNoNumbers) {
  const Scratch scratch;
  for (const std::string bad : {"nan", "inf", "-inf", "1e999", "x", "1.0.0"}) {
    const auto obj = scratch.write("n.obj", "v 0 0 0\nv 1 0 0\nv 0 " + bad + " 0\nf 1 2 3\n");
    expect_error([&] { read(obj); }, ExitCode::bad_input, {"n.obj:3", "vertex 3", bad});
    const auto off = scratch.write("n.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 " + bad + " 0\n3 0 1 2\n");
    expect_error([&] { read(off); }, ExitCode::bad_input, {"n.off:5", "vertex 2", bad});
    const auto ply =
        scratch.write("n.ply",
                      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
                      "float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 "
                      "0\n0 " +
                          bad + " 0\n3 0 1 2\n");
    expect_error([&] { read(ply); }, ExitCode::bad_input, {"n.ply:12", "vertex 2"});
    const auto stl =
        scratch.write("n.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 " + bad +
                                   " 0\nendloop\nendfacet\nendsolid\n");
    expect_error([&] { read(stl); }, ExitCode::bad_input, {"n.stl:6", "facet 0", bad});
  }
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Surface box = box_surface({0, 0, 0}, {1, 1, 1});
    box.vertices[5].y() = bad;
    write_surface(box, scratch / "n.stl");
    expect_error([&] { read(scratch / "n.stl"); }, ExitCode::bad_input, {"n.stl", "facet", "not finite"});
    Glb glb;
    glb.mesh("heart", box);
    const auto file = scratch.write("n.glb", glb.bytes());
    expect_error([&] { read(file); }, ExitCode::bad_input, {"n.glb", "'heart'", "vertex 5", "not finite"});
  }
}

TEST(BadFile, IndicesOutOfRange) {
  const Scratch scratch;
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (const std::string bad : {"4", "0", "-4", "99999999999", "1.5", "x"}) {
    const auto file = scratch.write("i.obj", points + "f 1 2 " + bad + "\n");
    expect_error([&] { read(file); }, ExitCode::bad_input, {"i.obj:4", bad});
  }
  for (const std::string bad : {"3", "-1", "2147483648", "x", ""}) {
    const auto off = scratch.write("i.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 " + bad + "\n");
    expect_error([&] { read(off); }, ExitCode::bad_input, {"i.off:6", "face 0", bad});
  }
  Surface bad = box_surface({0, 0, 0}, {1, 1, 1});
  bad.triangles[4][1] = 200;
  Glb glb;
  glb.mesh("box", bad, 1);
  const auto file = scratch.write("i.glb", glb.bytes());
  expect_error([&] { read(file); }, ExitCode::bad_input, {"i.glb", "'box'", "index 200", "element 13", "0..7"});
}

TEST(BadFile, PlyHeadersThatAskForTooMuch) {
  const Scratch scratch;
  const auto header = [](const std::string& vertices, const std::string& faces, const std::string& form) {
    return "ply\nformat " + form + " 1.0\nelement vertex " + vertices +
           "\nproperty float x\nproperty float y\nproperty float z\nelement face " + faces +
           "\nproperty list uchar int vertex_indices\nend_header\n";
  };
  for (const std::string form : {"ascii", "binary_little_endian"}) {
    for (const std::string count : {"4000000000", "2000000000", "-1", "99999999999999999999"}) {
      const auto file = scratch.write("huge.ply", header(count, count, form) + "0 0 0 0 0 0\n");
      expect_error([&] { read(file); }, ExitCode::bad_input, {"huge.ply"});
    }
  }
  const auto list = scratch.write("list.ply", header("3", "1", "ascii") + "0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n");
  expect_error([&] { read(list); }, ExitCode::bad_input, {"list.ply:13", "face 0", "corners"});
  const auto order =
      scratch.write("order.ply", "ply\nformat ascii 1.0\nelement camera 0\nelement vertex 0\nend_header\n");
  expect_error([&] { read(order); }, ExitCode::bad_input, {"order.ply", "vertex and face"});
}

struct BadGlb {
  const char* name;
  const char* piece;
  std::function<void(Glb&)> spoil;
};

TEST(BadFile, GltfReferencesAndBounds) {
  const Scratch scratch;
  const std::vector<BadGlb> all = {
      {"view beyond its buffer", "bufferViews[0]", [](Glb& g) { g.json["bufferViews"][0]["byteLength"] = 100000; }},
      {"view that overflows", "bufferViews[0]",
       [](Glb& g) { g.json["bufferViews"][0]["byteOffset"] = 0xffffffffffffffffULL; }},
      {"negative offset", "bufferViews[0]", [](Glb& g) { g.json["bufferViews"][0]["byteOffset"] = -4; }},
      {"accessor beyond its view", "elements need", [](Glb& g) { g.json["accessors"][0]["count"] = 9; }},
      {"accessor of 2^31", "elements need", [](Glb& g) { g.json["accessors"][0]["count"] = 0x7fffffff; }},
      {"accessor offset", "elements need", [](Glb& g) { g.json["accessors"][0]["byteOffset"] = 90; }},
      {"index count", "elements need", [](Glb& g) { g.json["accessors"][1]["count"] = 3000; }},
      {"odd index count", "not whole triangles", [](Glb& g) { g.json["accessors"][1]["count"] = 35; }},
      {"stride below an element", "byteStride", [](Glb& g) { g.json["bufferViews"][0]["byteStride"] = 8; }},
      {"stride of 1", "byteStride", [](Glb& g) { g.json["bufferViews"][0]["byteStride"] = 1; }},
      {"buffer longer than the chunk", "buffers[0]",
       [](Glb& g) {
         g.json["buffers"] = {{{"byteLength", 1 << 20}}};
       }},
      {"buffer of nothing", "buffers[0]",
       [](Glb& g) {
         g.json["buffers"] = {{{"byteLength", 0}}};
       }},
      {"missing accessor", "POSITION",
       [](Glb& g) { g.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 7; }},
      {"missing index accessor", "indices", [](Glb& g) { g.json["meshes"][0]["primitives"][0]["indices"] = 7; }},
      {"missing view", "accessors[0]", [](Glb& g) { g.json["accessors"][0]["bufferView"] = 7; }},
      {"missing buffer", "bufferViews[0]", [](Glb& g) { g.json["bufferViews"][0]["buffer"] = 7; }},
      {"missing mesh", "nodes[0]", [](Glb& g) { g.json["nodes"][0]["mesh"] = 7; }},
      {"missing child", "nodes[0]", [](Glb& g) { g.json["nodes"][0]["children"] = {7}; }},
      {"own child", "ring", [](Glb& g) { g.json["nodes"][0]["children"] = {0}; }},
      {"ring of nodes", "ring",
       [](Glb& g) {
         g.json["nodes"] = {{{"mesh", 0}}, {{"children", {2}}}, {{"children", {1}}, {"mesh", 0}}};
       }},
      {"two parents", "two parents",
       [](Glb& g) {
         g.json["nodes"] = {{{"mesh", 0}}, {{"children", {0}}}, {{"children", {0}}}};
       }},
      {"missing scene", "scene", [](Glb& g) { g.json["scene"] = 3; }},
      {"missing scene node", "scenes[0]",
       [](Glb& g) {
         g.json["scenes"] = {{{"nodes", {5}}}};
       }},
      {"positions of whole numbers of 32 bits", "POSITION",
       [](Glb& g) { g.json["accessors"][0]["componentType"] = 5125; }},
      {"skin", "skin", [](Glb& g) { g.json["nodes"][0]["skin"] = 0; }},
      {"morph", "morph targets",
       [](Glb& g) {
         g.json["meshes"][0]["weights"] = {0, 0.5};
       }},
      {"instances", "EXT_mesh_gpu_instancing",
       [](Glb& g) { g.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = Json::object(); }},
      {"positions of two", "POSITION", [](Glb& g) { g.json["accessors"][0]["type"] = "VEC2"; }},
      {"indices of floats", "indices", [](Glb& g) { g.json["accessors"][1]["componentType"] = 5126; }},
      {"sparse positions", "sparse",
       [](Glb& g) {
         g.json["accessors"][0]["sparse"] = {{"count", 1}};
       }},
      {"sparse indices", "sparse",
       [](Glb& g) {
         g.json["accessors"][1]["sparse"] = {{"count", 1}};
       }},
      {"compressed", "KHR_draco", [](Glb& g) { g.json["extensionsRequired"] = {"KHR_draco_mesh_compression"}; }},
      {"unknown mode", "mode 9", [](Glb& g) { g.json["meshes"][0]["primitives"][0]["mode"] = 9; }},
      {"flat node", "node 0",
       [](Glb& g) {
         g.json["nodes"][0]["scale"] = {1, 1, 0};
       }},
      {"short matrix", "matrix",
       [](Glb& g) {
         g.json["nodes"][0]["matrix"] = {1, 2, 3};
       }},
      {"perspective", "affine",
       [](Glb& g) { g.json["nodes"][0]["matrix"] = {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; }},
      {"no rotation", "rotation",
       [](Glb& g) {
         g.json["nodes"][0]["rotation"] = {0, 0, 0, 0};
       }},
      {"no primitives", "no triangles", [](Glb& g) { g.json["meshes"][0]["primitives"] = Json::array(); }},
      {"meshes of the wrong kind", "meshes", [](Glb& g) { g.json["meshes"] = "x"; }},
      {"nodes of the wrong kind", "nodes",
       [](Glb& g) {
         g.json["nodes"] = {1, 2};
       }},
      {"buffer elsewhere", "buffers[0]",
       [](Glb& g) {
         g.json["buffers"] = {{{"byteLength", 9}, {"uri", "/etc/passwd"}}};
       }},
  };
  for (const auto& bad : all) {
    SCOPED_TRACE(bad.name);
    Glb glb;
    glb.mesh("box", box_surface({0, 0, 0}, {1, 1, 1}));
    bad.spoil(glb);
    const auto file = scratch.write("bad.glb", glb.bytes());
    expect_error([&] { read(file); }, ExitCode::bad_input, {"bad.glb", bad.piece});
  }
}

// Lengths in the container of the kind that made tinygltf's loader overrun its memory.
TEST(BadFile, GlbChunkLengths) {
  const Scratch scratch;
  const auto good = good_file(scratch, ".glb");
  for (const std::size_t field : {8U, 12U, 20U}) {
    for (const std::uint32_t value : {0U, 1U, 19U, 0x7fffffffU, 0xffffffecU, 0xffffffffU}) {
      auto bytes = good;
      std::uint32_t json = 0;
      std::memcpy(&json, good.data() + 12, 4);
      const std::size_t at = field == 20 ? 20 + json : field;  // 20: the binary chunk's length
      std::memcpy(bytes.data() + at, &value, 4);
      const auto file = scratch.write("chunk.glb", bytes);
      expect_error([&] { read(file); }, ExitCode::bad_input, {"chunk.glb"});
    }
  }
}

TEST(BadFile, DeepAndWideJson) {
  const Scratch scratch;
  const std::string deep(200000, '[');
  expect_error([&] { read(scratch.write("deep.gltf", deep)); }, ExitCode::bad_input, {"deep.gltf"});
  Glb glb;
  glb.mesh("box", box_surface({0, 0, 0}, {1, 1, 1}), 2, false);
  for (int n = 0; n < 50000; ++n) glb.json["nodes"].push_back({{"children", {n + 1}}});
  glb.json["nodes"].push_back({{"mesh", 0}});
  EXPECT_EQ(read(scratch.write("chain.glb", glb.bytes())).triangles.size(), 12U);
}

}  // namespace
}  // namespace palpate::test
