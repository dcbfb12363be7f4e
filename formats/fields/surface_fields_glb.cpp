// SPDX-License-Identifier: MIT
// GLB of a surface with fields, by tinygltf.
#include "formats/fields/surface_fields.hpp"

#include "formats/io/error.hpp"
#include "formats/io/file.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>

#include <tiny_gltf.h>

namespace palpate {
namespace {

class GlbWriter {
public:
  explicit GlbWriter(const SurfaceFields& surface) : surface_(surface) {
    model_.asset.version = "2.0";
    model_.asset.generator = "palpate";
    model_.buffers.emplace_back();
  }

  std::string bytes(const SurfaceField& shown) {
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.attributes["POSITION"] = vectors(surface_.points, "position (m)");
    primitive.attributes["NORMAL"] = vectors(surface_.normals, "normal");
    primitive.attributes["COLOR_0"] = colours(shown);
    for (const SurfaceField& field : surface_.fields) {
      std::string name = "_" + field.name;
      std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::toupper(c); });
      primitive.attributes[name] = scalars(field);
    }
    primitive.indices = add(surface_.triangles.data(), 12 * surface_.triangles.size(), 3 * surface_.triangles.size(),
                            TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR,
                            TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER, "triangles");
    primitive.material = 0;
    tinygltf::Material material;
    material.pbrMetallicRoughness.metallicFactor = 0;
    material.pbrMetallicRoughness.roughnessFactor = 1;
    model_.materials.push_back(material);
    tinygltf::Mesh mesh;
    mesh.name = "body";
    mesh.primitives.push_back(primitive);
    model_.meshes.push_back(mesh);
    tinygltf::Node node;
    node.mesh = 0;
    model_.nodes.push_back(node);
    tinygltf::Scene scene;
    scene.nodes.push_back(0);
    model_.scenes.push_back(scene);
    model_.defaultScene = 0;
    tinygltf::Value::Object extras{{"shown", tinygltf::Value(shown.name)}, {"unit", tinygltf::Value(shown.unit)}};
    for (const auto& [name, number] : surface_.numbers) extras[name] = tinygltf::Value(number);
    model_.asset.extras = tinygltf::Value(std::move(extras));
    std::ostringstream stream;
    tinygltf::TinyGLTF().WriteGltfSceneToStream(&model_, stream, false, true);
    return std::move(stream).str();
  }

private:
  /// Adds bytes as a buffer view and an accessor; returns the accessor's number. All elements are of 4 bytes.
  int add(const void* data, std::size_t size, std::size_t count, int component, int type, int target,
          const std::string& name) {
    std::vector<unsigned char>& to = model_.buffers[0].data;
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = to.size();
    view.byteLength = size;
    view.target = target;
    to.insert(to.end(), static_cast<const unsigned char*>(data), static_cast<const unsigned char*>(data) + size);
    model_.bufferViews.push_back(view);
    tinygltf::Accessor accessor;
    accessor.bufferView = static_cast<int>(model_.bufferViews.size()) - 1;
    accessor.name = name;
    accessor.componentType = component;
    accessor.type = type;
    accessor.count = count;
    model_.accessors.push_back(accessor);
    return static_cast<int>(model_.accessors.size()) - 1;
  }

  int vectors(const std::vector<std::array<float, 3>>& list, const std::string& name) {
    const int number = add(list.data(), 12 * list.size(), list.size(), TINYGLTF_COMPONENT_TYPE_FLOAT,
                           TINYGLTF_TYPE_VEC3, TINYGLTF_TARGET_ARRAY_BUFFER, name);
    tinygltf::Accessor& accessor = model_.accessors.back();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] =
          std::minmax_element(list.begin(), list.end(), [k](const auto& a, const auto& b) { return a[k] < b[k]; });
      accessor.minValues.push_back(static_cast<double>((*low)[k]));
      accessor.maxValues.push_back(static_cast<double>((*high)[k]));
    }
    return number;
  }

  int scalars(const SurfaceField& field) {
    const int number = add(field.values.data(), 4 * field.values.size(), field.values.size(),
                           TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_SCALAR, TINYGLTF_TARGET_ARRAY_BUFFER,
                           field.name + (field.unit.empty() ? "" : " (" + field.unit + ")"));
    const auto [low, high] = field.range();
    model_.accessors.back().minValues = {static_cast<double>(low)};
    model_.accessors.back().maxValues = {static_cast<double>(high)};
    return number;
  }

  int colours(const SurfaceField& field) {
    const auto [low, high] = field.range();
    const double from = low, size = static_cast<double>(high) - from;
    std::vector<std::array<std::uint8_t, 4>> list;
    for (const float value : field.values) {
      list.push_back(field_colour(size > 0 ? (static_cast<double>(value) - from) / size : 0));
    }
    const int number = add(list.data(), 4 * list.size(), list.size(), TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE,
                           TINYGLTF_TYPE_VEC4, TINYGLTF_TARGET_ARRAY_BUFFER, "colour of " + field.name);
    model_.accessors.back().normalized = true;
    return number;
  }

  const SurfaceFields& surface_;
  tinygltf::Model model_;
};

/// sRGB of viridis at 0, 1/8, ... 1.
constexpr std::uint8_t kViridis[9][3] = {{68, 1, 84},    {71, 45, 123}, {59, 82, 139},  {44, 114, 142}, {33, 145, 140},
                                         {40, 174, 128}, {94, 201, 98}, {173, 220, 48}, {253, 231, 37}};

}  // namespace

std::pair<float, float> SurfaceField::range() const {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return {*low, *high};
}

std::array<std::uint8_t, 4> field_colour(double share) {
  const double at = 8 * std::clamp(share, 0.0, 1.0);
  const int i = std::min(7, static_cast<int>(at));
  std::array<std::uint8_t, 4> colour{0, 0, 0, 255};
  for (int k = 0; k < 3; ++k) {
    const double s = (kViridis[i][k] + (at - i) * (kViridis[i + 1][k] - kViridis[i][k])) / 255;
    const double linear = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);  // IEC 61966-2-1
    colour[k] = static_cast<std::uint8_t>(std::lround(255 * linear));
  }
  return colour;
}

void write_glb(const SurfaceFields& surface, const std::string& shown, const std::filesystem::path& path) {
  const auto field = std::find_if(surface.fields.begin(), surface.fields.end(),
                                  [&](const SurfaceField& f) { return f.name == shown; });
  if (field == surface.fields.end()) throw Error(ExitCode::bad_input, path.string() + ": no field '" + shown + "'");
  const double size =
      12.0 * static_cast<double>(surface.triangles.size()) +
      (28.0 + 4.0 * static_cast<double>(surface.fields.size())) * static_cast<double>(surface.points.size());
  if (size > 2e9) throw Error(ExitCode::bad_input, path.string() + ": the surface does not fit a GLB's 2 GiB");
  write_file(path, GlbWriter(surface).bytes(*field));
}

}  // namespace palpate
