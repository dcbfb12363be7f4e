// SPDX-License-Identifier: GPL-3.0-or-later
// palpate export: what was written is read back and is what the file's coefficients and the runtime say.
#include <cmath>
#include <cstring>
#include <map>
#include <sstream>

#include <tiny_gltf.h>

#include <nlohmann/json.hpp>

#include "formats/fields/surface_fields.hpp"
#include "formats/surface/surface_io.hpp"
#include "palpate/format/open.hpp"
#include "palpate/response/interpolation.hpp"
#include "tests/cli/palpate_program.hpp"
#include "tests/support/response_samples.hpp"

namespace palpate::test {
namespace {

using Json = nlohmann::json;
using Options = ResponseSampleOptions;
using Table = std::vector<std::map<std::string, std::string>>;

Table read_csv(const std::string& text) {
  std::istringstream lines(text);
  std::string line, cell;
  std::vector<std::string> names;
  Table table;
  while (std::getline(lines, line)) {
    std::istringstream cells(line + ",");
    std::vector<std::string> row;
    while (std::getline(cells, cell, ',')) row.push_back(cell);
    if (names.empty()) {
      names = row;
      continue;
    }
    EXPECT_EQ(row.size(), names.size()) << line;
    table.emplace_back();
    for (std::size_t i = 0; i < row.size(); ++i) table.back()[names[i]] = row[i];
  }
  return table;
}

class Export : public PalpateProgram {
protected:
  /// Writes the content as box.palp and opens it here too.
  void use(const ResponseFileContent& content) {
    content_ = content;
    bytes_ = encode(content);
    write_response_file(folder() / "box.palp", bytes_);
    view_ = runtime::View::open(bytes_.data(), bytes_.size()).view;
  }
  Table curves(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"export", "box.palp", "--curves", "curves.csv", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const RunResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.error;
    json_ = Json::parse(result.out);
    return read_csv(file_content(folder() / "curves.csv"));
  }

  ResponseFileContent content_;
  std::vector<std::byte> bytes_;
  runtime::View view_;
  Json json_;
};

double number(const std::map<std::string, std::string>& row, const char* name) { return std::stod(row.at(name)); }

/// Bernstein's polynomial of a response, its stored coefficients from `first` on, every `stride`-th.
double polynomial(const Response& r, int begin, int stride, int first, int degree, double s, double unit) {
  double sum = 0;
  for (int k = first; k <= degree; ++k) {
    sum += unit * r.coefficients[static_cast<std::size_t>(begin + stride * (k - first))] *
           response::binomial(degree, k) * std::pow(s, k) * std::pow(1 - s, degree - k);
  }
  return sum;
}

// Each row follows from the coefficients that were written.
TEST_F(Export, CurvesAreTheFilesCoefficients) {
  Options options;
  options.cells = 1;
  options.tools = Options::Tools::all;
  use(box_content(options));
  const Table table = curves({"--points", "7", "--depth", "0.004"});
  const std::size_t responses = content_.responses.size();
  ASSERT_EQ(table.size(), responses * 21);
  EXPECT_EQ(json_["rows"], table.size());
  EXPECT_EQ(json_["responses"], responses);
  const std::map<std::string, std::size_t> first{{"\"ball\"", 0}, {"\"rod\"", 1}, {"\"gem\"", 5}};
  const response::Degrees& d = content_.degrees;
  const response::Offsets o = response::offsets(d);
  std::map<std::string, int> kinds;
  for (const auto& row : table) {
    const std::size_t vertex = first.at(row.at("tool")) + std::stoul(row.at("tool_vertex"));
    const Response& r = content_.responses[std::stoul(row.at("site")) * 11 + vertex];
    const double z = number(row, "depth_m"), x = number(row, "x_m"), y = number(row, "y_m");
    const double s = std::sqrt(z / kDepthScale), unit = static_cast<double>(r.unit);
    const double force = polynomial(r, 0, 1, 2, d.normal, s, unit);
    if (row.at("kind") == "normal") {
      EXPECT_NEAR(number(row, "force_normal_N"), force, 1e-6);
      for (int axis = 0; axis < 2; ++axis) {
        EXPECT_NEAR(number(row, axis == 0 ? "force_x_N" : "force_y_N"),
                    -polynomial(r, o.bias + axis, 2, 2, d.bias, s, unit), 1e-6);
      }
    }
    EXPECT_NEAR(number(row, "friction_limit_N"),
                force * polynomial(r, o.friction, 1, 0, d.friction, s, layout::kFrictionUnit), 1e-6);
    EXPECT_EQ(row.at("status"), r.flags == layout::response_solved ? "solved" : "filled");
    if (row.at("kind") != "normal") {
      EXPECT_NEAR(z, std::min(0.004, r.depth_limit), 1e-8);
    }
    EXPECT_TRUE(x == 0 || row.at("kind") == "tangential_x");
    EXPECT_TRUE(y == 0 || row.at("kind") == "tangential_y");
    ++kinds[row.at("kind")];
    kinds["deepest"] += z > 0.999 * r.depth_limit && row.at("kind") == "normal" ? 1 : 0;
    kinds["widest"] += std::hypot(x, y) > 0.999 * kTangentialScale ? 1 : 0;
  }
  const int count = static_cast<int>(responses);
  EXPECT_EQ(kinds["normal"], 7 * count);
  EXPECT_EQ(kinds["tangential_y"], 7 * count);
  EXPECT_EQ(kinds["deepest"], count);
  EXPECT_EQ(kinds["widest"], 4 * count);
}

/// Pixels of a PNG file.
struct Pixels {
  int width = 0, height = 0;
  std::vector<unsigned char> rgb;
  [[nodiscard]] const unsigned char* at(int x, int y) const {
    return &rgb[3 * (std::size_t(y) * std::size_t(width) + std::size_t(x))];
  }
};

Pixels read_png(const std::string& bytes) {
  tinygltf::Image image;
  std::string error, warning;
  Pixels pixels;
  // The reader of glTF gives four channels.
  if (!tinygltf::LoadImageData(&image, 0, &error, &warning, 0, 0, reinterpret_cast<const unsigned char*>(bytes.data()),
                               static_cast<int>(bytes.size()), nullptr)) {
    ADD_FAILURE() << error;
    return pixels;
  }
  pixels.width = image.width;
  pixels.height = image.height;
  for (std::size_t k = 0; k < image.image.size(); k += 4)
    pixels.rgb.insert(pixels.rgb.end(), &image.image[k], &image.image[k] + 3);
  return pixels;
}

// Seen from above: the box's square top fills the picture's middle, its corners lie level.
TEST_F(Export, PictureShowsTheBodyFromTheCamera) {
  use(box_content({}));
  const std::vector<std::string> arguments{"export",   "box.palp", "--png",       "top.png", "--width",   "300",
                                           "--height", "240",      "--elevation", "90",      "--azimuth", "-90"};
  const RunResult result = run(arguments);
  ASSERT_EQ(result.exit_code, 0) << result.error;
  const std::string bytes = file_content(folder() / "top.png");
  const Pixels p = read_png(bytes);
  ASSERT_EQ(p.width, 300);
  ASSERT_EQ(p.height, 240);
  const auto white = [&](int x, int y) { return p.at(x, y)[0] == 255 && p.at(x, y)[1] == 255 && p.at(x, y)[2] == 255; };
  for (const int x : {0, 299}) {
    for (const int y : {0, 239}) EXPECT_TRUE(white(x, y)) << x << ", " << y;
  }
  EXPECT_FALSE(white(150, 108));
  std::size_t left = 0, right = 0;
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 150; ++x) {
      left += white(x, y) ? 0 : 1;
      right += white(299 - x, y) ? 0 : 1;
    }
  }
  EXPECT_GT(left, 5000U);
  EXPECT_NEAR(static_cast<double>(left), static_cast<double>(right), 0.02 * static_cast<double>(left));
  // The same file gives the same picture.
  ASSERT_EQ(run(arguments).exit_code, 0);
  EXPECT_EQ(file_content(folder() / "top.png"), bytes);
}

TEST_F(Export, AFrictionlessFileHasNormalCurvesWithoutLimit) {
  Options options;
  options.cells = 1;
  options.friction = false;
  use(box_content(options));
  const Table table = curves();
  EXPECT_EQ(table.size(), content_.responses.size() * 21);
  for (const auto& row : table) {
    EXPECT_EQ(row.at("kind"), "normal");
    EXPECT_EQ(row.at("friction_limit_N"), "");
  }
}

// A name in a file may hold what a table is made of.
TEST_F(Export, NamesAreQuoted) {
  Options options;
  options.cells = 1;
  ResponseFileContent content = box_content(options);
  content.tools[0].name = "5 \"mm\", round";
  use(content);
  ASSERT_EQ(run({"export", "box.palp", "--curves", "c.csv"}).exit_code, 0);
  EXPECT_NE(file_content(folder() / "c.csv").find("\n0,\"5 \"\"mm\"\", round\",0,"), std::string::npos);
}

/// The values of an accessor, which fill its buffer view.
template <class Value>
std::vector<Value> values(const tinygltf::Model& model, int index, int component, int type) {
  const tinygltf::Accessor& accessor = model.accessors.at(static_cast<std::size_t>(index));
  EXPECT_EQ(accessor.componentType, component);
  EXPECT_EQ(accessor.type, type);
  const tinygltf::BufferView& view = model.bufferViews.at(static_cast<std::size_t>(accessor.bufferView));
  std::vector<Value> list(accessor.count);
  EXPECT_EQ(view.byteLength, accessor.count * sizeof(Value));
  std::memcpy(list.data(), model.buffers.at(0).data.data() + view.byteOffset, view.byteLength);
  return list;
}

/// The numbers of a .vtu's array, in the file's order.
std::vector<double> vtu_array(const std::string& text, const std::string& name) {
  const std::size_t at = text.find("Name=\"" + name + "\"");
  EXPECT_NE(at, std::string::npos) << name;
  const std::size_t begin = text.find(">\n", at) + 2, end = text.find("</DataArray>", begin);
  std::istringstream numbers(text.substr(begin, end - begin));
  std::vector<double> list;
  for (double value = 0; numbers >> value;) list.push_back(value);
  EXPECT_TRUE(numbers.eof()) << name;
  return list;
}

TEST_F(Export, BodyIsTheContactSurfaceWithTheRuntimesForces) {
  Options options;
  options.tools = Options::Tools::all;
  options.subdivision = 3;
  use(ball_content(options));
  const RunResult result = run({"export", "box.palp", "--glb", "b.glb", "--vtu", "b.vtu", "--field", "friction",
                                "--depth", "0.003", "--tool", "rod", "--tool-vertex", "1", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  const Json json = Json::parse(result.out);

  tinygltf::Model model;
  std::string error, warning;
  const std::string glb = file_content(folder() / "b.glb");
  ASSERT_TRUE(tinygltf::TinyGLTF().LoadBinaryFromMemory(
      &model, &error, &warning, reinterpret_cast<const unsigned char*>(glb.data()), static_cast<unsigned>(glb.size())))
      << error;
  EXPECT_EQ(error + warning, "");
  EXPECT_EQ(model.asset.extras.Get("shown").Get<std::string>(), "friction");
  EXPECT_EQ(model.asset.extras.Get("depth_m").GetNumberAsDouble(), 0.003);
  const tinygltf::Primitive& body = model.meshes.at(0).primitives.at(0);
  const auto floats = [&](const char* name) {
    return values<float>(model, body.attributes.at(name), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_SCALAR);
  };
  using Three = std::array<float, 3>;
  using Colour = std::array<std::uint8_t, 4>;
  const auto points =
      values<Three>(model, body.attributes.at("POSITION"), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3);
  const auto normals =
      values<Three>(model, body.attributes.at("NORMAL"), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3);
  const auto colours =
      values<Colour>(model, body.attributes.at("COLOR_0"), TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_TYPE_VEC4);
  const auto corners = values<std::array<std::uint32_t, 1>>(model, body.indices, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
                                                            TINYGLTF_TYPE_SCALAR);
  const std::vector<float> stiffness = floats("_STIFFNESS"), force = floats("_FORCE"), limit = floats("_FRICTION"),
                           filled = floats("_FILLED");
  ASSERT_EQ(points.size(), content_.surface_vertices.size());
  ASSERT_EQ(corners.size(), 3 * content_.surface_triangles.size());
  ASSERT_EQ(stiffness.size(), points.size());
  EXPECT_EQ(json["vertices"], points.size());
  const auto [least, most] = std::minmax_element(limit.begin(), limit.end());
  EXPECT_EQ(json["fields"]["friction"]["least"].get<float>(), *least);
  EXPECT_EQ(json["fields"]["friction"]["most"].get<float>(), *most);
  EXPECT_LT(*least, 0.9f * *most);
  EXPECT_EQ(model.accessors[static_cast<std::size_t>(body.attributes.at("_FRICTION"))].minValues.at(0),
            static_cast<double>(*least));

  runtime::ToolPoint second;  // the rod's second vertex begins its second segment
  second.patch = 2;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const runtime::Location found = closest_point(
        view_,
        {static_cast<double>(points[i][0]), static_cast<double>(points[i][1]), static_cast<double>(points[i][2])});
    ASSERT_LT(std::abs(found.signed_distance), 1e-9);
    runtime::BlendedResponse<> response;
    response.blend(view_, 1, found.at, second, {1, 0, 0}, nullptr);
    const auto at = [&](double z) { return response.law().at(z).normal_force; };
    const double most_friction = response.law().at(0.003).friction_coefficient * at(0.003);
    EXPECT_NEAR(force[i], at(0.003), 1e-6 * at(0.003));
    EXPECT_NEAR(limit[i], most_friction, 1e-6 * most_friction);
    EXPECT_NEAR(filled[i], response.filled_share(), 1e-6);
    const double slope = (at(0.003 + 1e-7) - at(0.003 - 1e-7)) / 2e-7;
    EXPECT_NEAR(stiffness[i], slope, 1e-5 * slope);
    EXPECT_NEAR(dot(response.normal(), runtime::Vec3{normals[i][0], normals[i][1], normals[i][2]}), 1, 1e-6);
    const double share = (static_cast<double>(limit[i]) - *least) / (static_cast<double>(*most) - *least);
    EXPECT_EQ(colours[i], field_colour(share));
  }
  // As the mesh of a scene it is the closed body that was baked.
  const Surface surface = read_surface({folder() / "b.glb", {}, 1.0});
  EXPECT_EQ(surface.vertices.size(), points.size());
  EXPECT_EQ(surface.triangles.size(), content_.surface_triangles.size());

  const std::string vtu = file_content(folder() / "b.vtu");
  EXPECT_NE(vtu.find("<PointData Scalars=\"friction\""), std::string::npos);
  EXPECT_EQ(vtu_array(vtu, "depth_m"), std::vector<double>{0.003});
  const std::vector<double> vtu_stiffness = vtu_array(vtu, "stiffness"), vtu_limit = vtu_array(vtu, "friction"),
                            vtu_points = vtu_array(vtu, "points"), vtu_corners = vtu_array(vtu, "connectivity"),
                            offsets = vtu_array(vtu, "offsets"), types = vtu_array(vtu, "types");
  ASSERT_EQ(vtu_stiffness.size(), points.size());
  ASSERT_EQ(vtu_points.size(), 3 * points.size());
  ASSERT_EQ(vtu_corners.size(), corners.size());
  ASSERT_EQ(offsets.size(), corners.size() / 3);
  ASSERT_EQ(types.size(), corners.size() / 3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(static_cast<float>(vtu_stiffness[i]), stiffness[i]);
    EXPECT_EQ(static_cast<float>(vtu_limit[i]), limit[i]);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(static_cast<float>(vtu_points[3 * i + k]), points[i][k]);
  }
  for (std::size_t i = 0; i < corners.size(); ++i) EXPECT_EQ(vtu_corners[i], corners[i][0]);
  EXPECT_EQ(offsets.back(), static_cast<double>(corners.size()));
  EXPECT_EQ(types.back(), 5);
}

TEST_F(Export, BadInputsEndWithTheirCodeAndCause) {
  Options options;
  options.cells = 1;
  options.tools = Options::Tools::all;
  ResponseFileContent content = box_content(options);
  content.provenance = R"({"fit": {"normal": {"median": 0.01}}})";
  use(content);
  std::string damaged = file_content(folder() / "box.palp");
  damaged[damaged.size() / 2] ^= 1;
  write("damaged.palp", damaged);
  options.friction = false;
  write_response_file(folder() / "smooth.palp", encode(box_content(options)));
  struct Case {
    std::vector<std::string> arguments;
    int code;
    std::vector<std::string> cause;
  };
  const Case cases[] = {
      {{"box.palp"}, 1, {"nothing to write"}},
      {{"none.palp", "--curves", "c.csv"}, 4, {"none.palp", "No such file"}},
      {{"damaged.palp", "--curves", "c.csv"}, 2, {"damaged.palp", "checksum"}},
      {{"box.palp", "--curves", "none/c.csv"}, 4, {"none/c.csv", "cannot create"}},
      {{"box.palp", "--glb", "none/b.glb"}, 4, {"none/b.glb", "cannot create"}},
      {{"box.palp", "--vtu", "/dev/null/b.vtu"}, 4, {"/dev/null/b.vtu"}},
      {{"box.palp", "--png", "none/b.png"}, 4, {"none/b.png", "cannot create"}},
      {{"box.palp", "--png", "b.png", "--width", "10"}, 1, {"--width"}},
      {{"box.palp", "--curves", "c.csv", "--azimuth", "10"}, 1, {"--png"}},
      {{"box.palp", "--vtu", "b.vtu", "--field", "colour"}, 1, {"--field", "colour"}},
      {{"box.palp", "--vtu", "b.vtu", "--field", "error"}, 2, {"no error of single responses", "\"median\":0.01"}},
      {{"smooth.palp", "--glb", "b.glb", "--field", "error"}, 2, {"no error of single responses"}},
      {{"smooth.palp", "--glb", "b.glb", "--field", "friction"}, 2, {"smooth.palp", "frictionless"}},
      {{"box.palp", "--vtu", "b.vtu", "--depth", "0.006"}, 2, {"box.palp", "0.005"}},
      {{"box.palp", "--vtu", "b.vtu", "--depth", "0"}, 1, {"--depth"}},
      {{"box.palp", "--curves", "c.csv", "--points", "1"}, 1, {"--points"}},
      {{"box.palp", "--vtu", "b.vtu", "--tool", "knife"}, 2, {"no tool 'knife'", "ball, rod, gem"}},
      {{"box.palp", "--vtu", "b.vtu", "--tool", "rod", "--tool-vertex", "4"}, 2, {"'rod' has 4 vertices"}},
  };
  for (const Case& bad : cases) {
    std::vector<std::string> arguments{"export"};
    arguments.insert(arguments.end(), bad.arguments.begin(), bad.arguments.end());
    SCOPED_TRACE(testing::PrintToString(arguments));
    expect_failure(run(arguments), bad.code, bad.cause);
    for (const char* file : {"c.csv", "b.glb", "b.vtu", "b.png"})
      EXPECT_FALSE(std::filesystem::exists(folder() / file));
  }
  expect_failure(run({"export", "box.palp", "--curves", "c.csv"}, {.output = "/dev/full"}), 4, {"standard output"});
}

}  // namespace
}  // namespace palpate::test
