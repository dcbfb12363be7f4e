// SPDX-License-Identifier: GPL-3.0-or-later
// Writes small GLB files with every freedom of the format, right and wrong.
#pragma once

#include "formats/surface/surface.hpp"

#include <nlohmann/json.hpp>

#include <cstring>
#include <string>

namespace palpate::test {

using Json = nlohmann::json;

class Glb {
public:
  Json json = {{"asset", {{"version", "2.0"}}}, {"buffers", Json::array()}, {"bufferViews", Json::array()},
               {"accessors", Json::array()},    {"meshes", Json::array()},  {"nodes", Json::array()}};
  std::string data;

  /// Adds bytes as a buffer view and returns its number.
  int view(const std::string& bytes, int stride = 0) {
    Json entry = {{"buffer", 0}, {"byteOffset", data.size()}, {"byteLength", bytes.size()}};
    if (stride) entry["byteStride"] = stride;
    data += bytes;
    data.resize((data.size() + 3) / 4 * 4);
    json["bufferViews"].push_back(entry);
    return int(json["bufferViews"].size()) - 1;
  }

  int positions(const Surface& surface, int padding = 0) {
    std::string bytes;
    for (const auto& p : surface.vertices) {
      for (int k = 0; k < 3; ++k) put(bytes, float(p[k]));
      bytes.append(std::size_t(padding), '\x55');
    }
    return accessor(view(bytes, padding ? 12 + padding : 0), 5126, surface.vertices.size(), "VEC3");
  }

  /// Indices as numbers of `size` bytes.
  int indices(const std::vector<std::uint32_t>& list, int size) {
    std::string bytes;
    for (const auto index : list) {
      for (int k = 0; k < size; ++k) bytes += char(index >> (8 * k) & 0xff);
    }
    return accessor(view(bytes), size == 1 ? 5121 : size == 2 ? 5123 : 5125, list.size(), "SCALAR");
  }

  int accessor(int view, int component, std::size_t count, const char* type) {
    json["accessors"].push_back(
        {{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}, {"byteOffset", 0}});
    return int(json["accessors"].size()) - 1;
  }

  static std::vector<std::uint32_t> list(const Surface& surface) {
    std::vector<std::uint32_t> result;
    for (const auto& t : surface.triangles) {
      for (const auto v : t) result.push_back(std::uint32_t(v));
    }
    return result;
  }

  /// A mesh of one primitive; a node holds it when `in_node`. Returns the mesh's number.
  int mesh(const std::string& name, const Surface& surface, int index_size = 2, bool in_node = true) {
    const int point = positions(surface);
    Json primitive = {{"attributes", {{"POSITION", point}}}, {"indices", indices(list(surface), index_size)}};
    json["meshes"].push_back({{"name", name}, {"primitives", Json::array({primitive})}});
    const int number = int(json["meshes"].size()) - 1;
    if (in_node) json["nodes"].push_back({{"mesh", number}});
    return number;
  }

  [[nodiscard]] std::string bytes() const {
    Json document = json;
    if (document["buffers"].empty() && !data.empty()) document["buffers"] = {{{"byteLength", data.size()}}};
    auto text = document.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string out = "glTF";
    put(out, 2U);
    put(out, std::uint32_t(20 + text.size() + (data.empty() ? 0 : 8 + data.size())));
    put(out, std::uint32_t(text.size()));
    put(out, 0x4E4F534AU);
    out += text;
    if (!data.empty()) {
      put(out, std::uint32_t(data.size()));
      put(out, 0x004E4942U);
      out += data;
    }
    return out;
  }

  template <class Number>
  static void put(std::string& out, Number value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    out.append(raw, sizeof value);
  }
};

}  // namespace palpate::test
