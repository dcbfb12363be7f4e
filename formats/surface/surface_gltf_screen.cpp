// SPDX-License-Identifier: MIT
// The glTF screen: container lengths, then JSON reduced to checked members.
#include "formats/surface/surface_gltf_screen.hpp"

#include "formats/io/error.hpp"

#include <nlohmann/json.hpp>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

namespace palpate {
namespace {

using Json = nlohmann::json;

struct Container {
  std::string json;
  std::string binary;
  bool has_binary = false;
};

class GltfScreen {
public:
  explicit GltfScreen(const std::filesystem::path& file) : file_(file) {}

  [[noreturn]] void fail(const std::string& cause) const {
    throw Error(ExitCode::bad_input, file_.string() + ": " + cause);
  }

  Container open(const std::string& bytes) const {
    static_assert(std::endian::native == std::endian::little, "GLB words are read in place");
    const auto word = [&](std::size_t at) {
      std::uint32_t value = 0;
      std::memcpy(&value, bytes.data() + at, 4);
      return value;
    };
    if (bytes.size() < 20 || bytes.substr(0, 4) != "glTF") fail("not a GLB file: it does not begin with 'glTF'");
    if (word(4) != 2) fail("GLB version " + std::to_string(word(4)) + " is not supported (allowed: 2)");
    if (word(8) > bytes.size()) {
      fail("truncated: the header announces " + std::to_string(word(8)) + " bytes, the file has " +
           std::to_string(bytes.size()));
    }
    const std::uint64_t end = word(8);
    Container container;
    std::uint64_t at = 12;
    for (int chunk = 0; at < end; ++chunk) {
      if (end - at < 8) fail("truncated in the header of chunk " + std::to_string(chunk));
      const std::uint64_t length = word(at);
      const auto kind = word(at + 4);
      if (length > end - at - 8) fail("chunk " + std::to_string(chunk) + " is longer than the file");
      if (chunk == 0 && kind != 0x4E4F534A) fail("the first chunk is not JSON");
      if (chunk == 0) container.json = bytes.substr(at + 8, length);
      if (chunk == 1 && kind == 0x004E4942) {
        container.binary = bytes.substr(at + 8, length);
        container.has_binary = true;
      }
      at += 8 + (length + 3) / 4 * 4;
    }
    return container;
  }

  Json reduce(const std::string& text, const Container& container, bool binary) {
    const Json document = Json::parse(text, nullptr, false);
    if (document.is_discarded() || !document.is_object()) fail("its JSON is truncated or damaged");
    check_required(document);
    for (const auto* key : {"buffers", "bufferViews", "accessors", "meshes", "nodes", "scenes"}) {
      if (!document.contains(key)) continue;
      if (!document[key].is_array()) fail(std::string(key) + " is not an array");
      for (const auto& entry : document[key]) {
        if (!entry.is_object()) fail(std::string(key) + " holds something that is not an object");
      }
    }
    Json reduced = {{"asset", {{"version", "2.0"}}}};
    reduced["buffers"] = buffers(document, container, binary);
    reduced["bufferViews"] = views(document, reduced["buffers"]);
    reduced["accessors"] = accessors(document);
    reduced["meshes"] = meshes(document);
    reduced["nodes"] = nodes(document);
    reduced["scenes"] = scenes(document);
    if (document.contains("scene")) {
      reduced["scene"] = reference(document, "scene", "scene", document, "scenes");
    }
    return reduced;
  }

private:
  // Extensions that change no shape, or whose shapes are read (quantised positions).
  void check_required(const Json& document) const {
    if (!document.contains("extensionsRequired")) return;
    const auto& required = document["extensionsRequired"];
    if (!required.is_array()) fail("extensionsRequired is not an array");
    for (const auto& entry : required) {
      if (!entry.is_string()) fail("extensionsRequired holds something that is not a text");
      const auto name = entry.get<std::string>();
      const auto is = [&](const char* start) { return name.rfind(start, 0) == 0; };
      if (name == "KHR_mesh_quantization" || is("KHR_materials_") || is("KHR_texture_") || is("EXT_texture_") ||
          is("KHR_lights_") || is("EXT_lights_") || is("MSFT_texture_") || is("KHR_xmp") || is("KHR_animation_") ||
          is("EXT_materials_")) {
        continue;
      }
      fail("it requires the extension " + entry.dump(-1, ' ', true) +
           ", which is not supported: export the surface without compression");
    }
  }

  static std::string decoded(const std::string& uri) {
    const auto digit = [](char c) {
      return c >= '0' && c <= '9'   ? c - '0'
             : c >= 'a' && c <= 'f' ? c - 'a' + 10
             : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                    : -1;
    };
    std::string text;
    for (std::size_t k = 0; k < uri.size(); ++k) {
      if (uri[k] == '%' && k + 2 < uri.size() && digit(uri[k + 1]) >= 0 && digit(uri[k + 2]) >= 0) {
        text += char(16 * digit(uri[k + 1]) + digit(uri[k + 2]));
        k += 2;
      } else {
        text += uri[k];
      }
    }
    return text;
  }

  static bool has_extension(const Json& object, const char* name) {
    return object.contains("extensions") && object["extensions"].is_object() && object["extensions"].contains(name);
  }

  static std::size_t size(const Json& document, const char* key) {
    return document.contains(key) ? document[key].size() : 0;
  }

  static const Json& list(const Json& document, const char* key) {
    static const Json none = Json::array();
    return document.contains(key) ? document[key] : none;
  }

  std::int64_t whole(const Json& object, const char* key, const std::string& where, std::int64_t fallback) const {
    if (!object.contains(key)) {
      if (fallback < 0) fail(where + ": " + key + " is missing");
      return fallback;
    }
    const auto& value = object[key];
    // 2^31 bounds every sum below far away from an overflow.
    if (!value.is_number_integer() || value < 0 || value > 0x7fffffff) {
      fail(where + ": " + key + " is not a whole number from 0 to 2147483647");
    }
    return value.get<std::int64_t>();
  }

  std::int64_t reference(const Json& object, const char* key, const std::string& where, const Json& document,
                         const char* target) const {
    const auto index = whole(object, key, where, -1);
    const auto count = size(document, target);
    if (std::size_t(index) >= count) {
      fail(where + ": " + key + " " + std::to_string(index) + " is outside 0.." +
           std::to_string(std::int64_t(count) - 1) + " (" + target + ")");
    }
    return index;
  }

  static void copy_name(const Json& from, Json& to) {
    if (from.contains("name") && from["name"].is_string()) to["name"] = from["name"];
  }

  Json buffers(const Json& document, const Container& container, bool binary) const {
    Json result = Json::array();
    for (const auto& buffer : list(document, "buffers")) {
      const auto where = "buffers[" + std::to_string(result.size()) + "]";
      const auto length = whole(buffer, "byteLength", where, -1);
      if (length == 0) fail(where + " is empty");
      Json entry = {{"byteLength", length}};
      if (buffer.contains("uri")) {
        if (!buffer["uri"].is_string()) fail(where + ": uri is not a text");
        auto uri = buffer["uri"].get<std::string>();
        if (uri.rfind("data:", 0) == 0) {
          // Any media type, or none; the loader accepts a few names alone.
          const auto data = uri.find(";base64,");
          if (data == std::string::npos) fail(where + ": uri has embedded data that are not base64");
          uri.replace(0, data, "data:application/octet-stream");
        } else if (const auto name = decoded(uri);
                   name.empty() || name.front() == '/' || name.find("..") != std::string::npos ||
                   name.find('\0') != std::string::npos || name.find(':') != std::string::npos) {
          // An organ file may not name files elsewhere on this machine.
          fail(where + ": uri must be embedded data or a plain file name beside the file");
        }
        entry["uri"] = std::move(uri);
      } else if (has_extension(buffer, "EXT_meshopt_compression")) {
        fail(where +
             " has its data under EXT_meshopt_compression alone, which is not supported: export the surface "
             "without compression");
      } else if (!binary || result.size() != 0 || !container.has_binary) {
        fail(where + " has no data");
      } else if (std::size_t(length) > container.binary.size()) {
        fail(where + ": byteLength " + std::to_string(length) + " exceeds the " +
             std::to_string(container.binary.size()) + " bytes of the binary chunk");
      }
      result.push_back(std::move(entry));
    }
    return result;
  }

  Json views(const Json& document, const Json& all) const {
    Json result = Json::array();
    for (const auto& view : list(document, "bufferViews")) {
      const auto where = "bufferViews[" + std::to_string(result.size()) + "]";
      const auto buffer = reference(view, "buffer", where, document, "buffers");
      const auto offset = whole(view, "byteOffset", where, 0);
      const auto length = whole(view, "byteLength", where, -1);
      const auto stride = whole(view, "byteStride", where, 0);
      const auto available = all[std::size_t(buffer)]["byteLength"].get<std::int64_t>();
      if (offset + length > available) {
        fail(where + " ends at byte " + std::to_string(offset + length) + " of a buffer of " +
             std::to_string(available));
      }
      if (stride != 0 && (stride < 4 || stride > 252 || stride % 4 != 0)) {
        fail(where + ": byteStride " + std::to_string(stride) + " is not a multiple of 4 from 4 to 252");
      }
      Json entry = {{"buffer", buffer}, {"byteOffset", offset}, {"byteLength", length}};
      if (stride != 0) entry["byteStride"] = stride;
      result.push_back(std::move(entry));
    }
    return result;
  }

  Json accessors(const Json& document) const {
    Json result = Json::array();
    for (const auto& accessor : list(document, "accessors")) {
      const auto where = "accessors[" + std::to_string(result.size()) + "]";
      Json entry = {{"componentType", whole(accessor, "componentType", where, -1)},
                    {"count", whole(accessor, "count", where, -1)},
                    {"byteOffset", whole(accessor, "byteOffset", where, 0)}};
      if (!accessor.contains("type") || !accessor["type"].is_string()) fail(where + ": type is missing");
      entry["type"] = accessor["type"];
      if (accessor.contains("bufferView")) {
        entry["bufferView"] = reference(accessor, "bufferView", where, document, "bufferViews");
      }
      if (accessor.contains("normalized")) {
        if (!accessor["normalized"].is_boolean()) fail(where + ": normalized is not true or false");
        entry["normalized"] = accessor["normalized"];
      }
      if (accessor.contains("sparse")) entry["sparse"] = sparse(accessor["sparse"], where + ".sparse", document);
      result.push_back(std::move(entry));
    }
    return result;
  }

  Json sparse(const Json& given, const std::string& where, const Json& document) const {
    const auto part = [&](const char* key) -> const Json& {
      if (!given.is_object() || !given.contains(key) || !given[key].is_object())
        fail(where + ": " + key + " is missing");
      return given[key];
    };
    const Json &indices = part("indices"), &values = part("values");
    return {{"count", whole(given, "count", where, -1)},
            {"indices",
             {{"bufferView", reference(indices, "bufferView", where, document, "bufferViews")},
              {"byteOffset", whole(indices, "byteOffset", where, 0)},
              {"componentType", whole(indices, "componentType", where, -1)}}},
            {"values",
             {{"bufferView", reference(values, "bufferView", where, document, "bufferViews")},
              {"byteOffset", whole(values, "byteOffset", where, 0)}}}};
  }

  // Shapes that a mesh takes on beside its own. At rest their weights are zero, and they change nothing.
  void refuse_morphs(const Json& object, const std::string& where) const {
    if (!object.contains("weights") || !object["weights"].is_array()) return;
    for (const auto& weight : object["weights"]) {
      if (weight.is_number() && weight.get<double>() == 0) continue;
      fail(where + " has morph targets with weights other than 0, which are not applied: apply them before export");
    }
  }

  Json meshes(const Json& document) const {
    Json result = Json::array();
    for (const auto& mesh : list(document, "meshes")) {
      const auto where = "meshes[" + std::to_string(result.size()) + "]";
      Json entry = {{"primitives", Json::array()}};
      copy_name(mesh, entry);
      refuse_morphs(mesh, where);
      if (!mesh.contains("primitives") || !mesh["primitives"].is_array()) fail(where + ": primitives are missing");
      for (const auto& primitive : mesh["primitives"]) {
        const auto place = where + ".primitives[" + std::to_string(entry["primitives"].size()) + "]";
        if (!primitive.is_object() || !primitive.contains("attributes") || !primitive["attributes"].is_object()) {
          fail(place + ": attributes are missing");
        }
        Json kept = {{"mode", whole(primitive, "mode", place, 4)}};
        kept["attributes"] = Json::object();
        kept["attributes"]["POSITION"] = reference(primitive["attributes"], "POSITION", place, document, "accessors");
        if (primitive.contains("indices")) {
          kept["indices"] = reference(primitive, "indices", place, document, "accessors");
        }
        for (const char* key : {"indices", "POSITION"}) {
          const auto& from = std::string(key) == "indices" ? kept : kept["attributes"];
          if (!from.contains(key)) continue;
          const auto& used = document["accessors"][from[key].get<std::size_t>()];
          if (used.contains("bufferView") || used.contains("sparse")) continue;
          if (has_extension(primitive, "KHR_draco_mesh_compression")) {
            fail(place +
                 " has its data under KHR_draco_mesh_compression alone, which is not supported: export the "
                 "surface without Draco compression");
          }
          fail(place + ": " + key + " has no data: its accessor names no bufferView");
        }
        entry["primitives"].push_back(std::move(kept));
      }
      result.push_back(std::move(entry));
    }
    return result;
  }

  Json numbers(const Json& node, const char* key, std::size_t count, const std::string& where) const {
    const auto& value = node[key];
    bool good = value.is_array() && value.size() == count;
    for (std::size_t i = 0; good && i < count; ++i)
      good = value[i].is_number() && std::isfinite(value[i].get<double>());
    if (!good) fail(where + ": " + key + " is not " + std::to_string(count) + " finite numbers");
    return value;
  }

  Json nodes(const Json& document) const {
    Json result = Json::array();
    const auto count = size(document, "nodes");
    std::vector<int> parents(count, -1);
    for (const auto& node : list(document, "nodes")) {
      const auto where = "nodes[" + std::to_string(result.size()) + "]";
      Json entry = Json::object();
      copy_name(node, entry);
      if (node.contains("mesh")) {
        entry["mesh"] = reference(node, "mesh", where, document, "meshes");
        refuse_morphs(node, where);
        if (node.contains("skin")) {
          fail(where + " has a skin, which is not applied: apply the armature to the mesh before export");
        }
        if (has_extension(node, "EXT_mesh_gpu_instancing")) {
          fail(where +
               " has instances by EXT_mesh_gpu_instancing, which are not supported: make them meshes of their own");
        }
      }
      constexpr std::array<std::pair<const char*, std::size_t>, 4> transforms = {
          {{"matrix", 16}, {"translation", 3}, {"rotation", 4}, {"scale", 3}}};
      for (const auto& [key, length] : transforms) {
        if (node.contains(key)) entry[key] = numbers(node, key, length, where);
      }
      if (node.contains("children")) {
        if (!node["children"].is_array()) fail(where + ": children is not an array");
        entry["children"] = Json::array();
        for (const auto& child : node["children"]) {
          if (!child.is_number_integer() || child < 0 || child >= count) {
            fail(where + ": a child is outside 0.." + std::to_string(count - 1));
          }
          const auto index = child.get<std::size_t>();
          if (parents[index] >= 0) fail("nodes[" + std::to_string(index) + "] has two parents");
          parents[index] = int(result.size());
          entry["children"].push_back(index);
        }
      }
      result.push_back(std::move(entry));
    }
    // With one parent each, what cannot be reached from a root is on a ring or hangs from one.
    std::vector<std::size_t> reached;
    for (std::size_t node = 0; node < count; ++node) {
      if (parents[node] < 0) reached.push_back(node);
    }
    for (std::size_t next = 0; next < reached.size(); ++next) {
      const auto& node = result[reached[next]];
      if (!node.contains("children")) continue;
      for (const auto& child : node["children"]) reached.push_back(child.get<std::size_t>());
    }
    if (reached.size() < count) fail("nodes form a ring: one is its own ancestor");
    return result;
  }

  Json scenes(const Json& document) const {
    Json result = Json::array();
    for (const auto& scene : list(document, "scenes")) {
      const auto where = "scenes[" + std::to_string(result.size()) + "]";
      Json entry = {{"nodes", Json::array()}};
      if (scene.contains("nodes")) {
        if (!scene["nodes"].is_array()) fail(where + ": nodes is not an array");
        for (const auto& node : scene["nodes"]) {
          if (!node.is_number_integer() || node < 0 || node >= size(document, "nodes")) {
            fail(where + ": a node is outside 0.." + std::to_string(std::int64_t(size(document, "nodes")) - 1));
          }
          entry["nodes"].push_back(node);
        }
      }
      result.push_back(std::move(entry));
    }
    return result;
  }

  const std::filesystem::path& file_;
};

void append_word(std::string& out, std::size_t value) {
  const auto word = static_cast<std::uint32_t>(value);
  out.append(reinterpret_cast<const char*>(&word), 4);
}

}  // namespace

std::string screen_gltf(const std::string& bytes, const std::filesystem::path& file, bool binary) {
  GltfScreen screen(file);
  const auto container = binary ? screen.open(bytes) : Container{bytes, {}, false};
  auto json = screen.reduce(container.json, container, binary).dump(-1, ' ', true, Json::error_handler_t::replace);
  if (!binary) return json;
  json.resize((json.size() + 3) / 4 * 4, ' ');
  auto data = container.binary;
  data.resize((data.size() + 3) / 4 * 4, '\0');
  std::string glb = "glTF";
  append_word(glb, 2);
  append_word(glb, 20 + json.size() + (data.empty() ? 0 : 8 + data.size()));
  append_word(glb, json.size());
  append_word(glb, 0x4E4F534A);
  glb += json;
  if (!data.empty()) {
    append_word(glb, data.size());
    append_word(glb, 0x004E4942);
    glb += data;
  }
  return glb;
}

}  // namespace palpate
