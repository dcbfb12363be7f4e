// SPDX-License-Identifier: MIT
// glTF meshes into a soup: chooses by name, walks the node tree, reads accessors with every bound checked.
#include "formats/surface/surface_gltf.hpp"

#include "formats/io/error.hpp"
#include "formats/surface/surface_gltf_screen.hpp"
#include "formats/surface/surface_plain.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include <tiny_gltf.h>

namespace palpate {
namespace {

using Index = std::int64_t;

// One mesh placed in the world.
struct Instance {
  int mesh = 0;
  int node = -1;
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  std::string part;  ///< the name it goes by
};

class GltfReader {
public:
  GltfReader(const tinygltf::Model& model, const std::filesystem::path& file) : model_(model), file_(file) {}

  Surface read(const std::vector<std::string>& wanted) {
    place_all();
    Surface surface;
    for (const auto& instance : chosen(wanted)) append(instance, surface);
    return surface;
  }

private:
  [[noreturn]] void fail(const std::string& cause) const {
    throw Error(ExitCode::bad_input, file_.string() + ": " + cause);
  }

  const std::string& mesh_name(int mesh) const { return model_.meshes[std::size_t(mesh)].name; }

  Eigen::Affine3d local_transform(int number) const {
    const auto& node = model_.nodes[std::size_t(number)];
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    if (!node.matrix.empty()) {
      matrix = Eigen::Map<const Eigen::Matrix4d>(node.matrix.data());
    } else {
      Eigen::Affine3d transform = Eigen::Affine3d::Identity();
      if (!node.translation.empty()) transform.translate(Eigen::Map<const Eigen::Vector3d>(node.translation.data()));
      if (!node.rotation.empty()) {
        const Eigen::Quaterniond rotation(Eigen::Map<const Eigen::Vector4d>(node.rotation.data()));
        if (!(rotation.norm() > 1e-6)) fail(node_label(number) + ": rotation is not a quaternion");
        transform.rotate(rotation.normalized());
      }
      if (!node.scale.empty()) transform.scale(Eigen::Map<const Eigen::Vector3d>(node.scale.data()));
      matrix = transform.matrix();
    }
    if (!(matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).isZero(1e-9)) {
      fail(node_label(number) + ": matrix is not affine");
    }
    const double scale = matrix.topLeftCorner<3, 3>().cwiseAbs().maxCoeff();
    const double determinant = matrix.topLeftCorner<3, 3>().determinant();
    if (!std::isfinite(determinant) || !(std::abs(determinant) > 1e-12 * scale * scale * scale)) {
      fail(node_label(number) + ": its transform flattens everything (scale 0?)");
    }
    return Eigen::Affine3d(matrix);
  }

  std::string node_label(int number) const {
    return "node " + std::to_string(number) + " '" + model_.nodes[std::size_t(number)].name + "'";
  }

  // Every mesh of the scene, parents before children; every mesh as it is when no node holds one.
  void place_all() {
    parents_.assign(model_.nodes.size(), -1);
    for (std::size_t n = 0; n < model_.nodes.size(); ++n) {
      for (const int child : model_.nodes[n].children) parents_[std::size_t(child)] = int(n);
    }
    std::vector<std::pair<int, Eigen::Affine3d>> open;
    std::vector<int> roots;
    if (!model_.scenes.empty()) {
      const auto scene = std::size_t(std::max(0, model_.defaultScene));
      roots = model_.scenes[scene].nodes;
    } else {
      for (std::size_t n = 0; n < parents_.size(); ++n) {
        if (parents_[n] < 0) roots.push_back(int(n));
      }
    }
    // A scene may list a node below one it also lists: each counts once.
    std::set<int> seen;
    for (auto root = roots.rbegin(); root != roots.rend(); ++root)
      open.emplace_back(*root, Eigen::Affine3d::Identity());
    while (!open.empty()) {
      const auto [number, above] = open.back();
      open.pop_back();
      if (!seen.insert(number).second) continue;
      const auto& node = model_.nodes[std::size_t(number)];
      const Eigen::Affine3d transform = above * local_transform(number);
      if (node.mesh >= 0) {
        const auto& name = mesh_name(node.mesh);
        instances_.push_back({node.mesh, number, transform, name.empty() ? node.name : name});
      }
      for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
        open.emplace_back(*child, transform);
    }
    const bool any_node =
        std::any_of(model_.nodes.begin(), model_.nodes.end(), [](const auto& n) { return n.mesh >= 0; });
    for (std::size_t m = 0; !any_node && m < model_.meshes.size(); ++m) {
      instances_.push_back({int(m), -1, Eigen::Affine3d::Identity(), mesh_name(int(m))});
    }
    for (auto& instance : instances_) {
      if (instance.part.empty()) instance.part = "mesh " + std::to_string(instance.mesh);
    }
  }

  bool is_below(int node, int ancestor) const {
    while (node >= 0 && node != ancestor) node = parents_[std::size_t(node)];
    return node == ancestor;
  }

  std::vector<Instance> chosen(const std::vector<std::string>& wanted) const {
    if (wanted.empty()) return instances_;
    std::vector<Instance> result;
    std::set<std::size_t> taken;
    for (const auto& name : wanted) {
      bool found = false;
      const auto take = [&](std::size_t i, bool by_node) {
        found = true;
        if (!taken.insert(i).second) return;
        result.push_back(instances_[i]);
        if (by_node) result.back().part = name;
      };
      for (std::size_t i = 0; i < instances_.size(); ++i) {
        const auto& instance = instances_[i];
        const bool by_node = instance.node >= 0 && model_.nodes[std::size_t(instance.node)].name == name;
        if (instance.part == name || by_node) take(i, by_node);
      }
      // A node without a mesh is a group: it stands for every mesh below, under their own names.
      for (std::size_t n = 0; n < model_.nodes.size(); ++n) {
        if (model_.nodes[n].name != name || model_.nodes[n].mesh >= 0) continue;
        for (std::size_t i = 0; i < instances_.size(); ++i) {
          if (is_below(instances_[i].node, int(n))) take(i, false);
        }
      }
      if (!found) missing(name);
    }
    return result;
  }

  [[noreturn]] void missing(const std::string& name) const {
    std::string list;
    for (const auto& instance : instances_) list += (list.empty() ? "" : ", ") + instance.part;
    fail("no mesh named '" + name + "'; there are: " + (list.empty() ? "none" : list));
  }

  struct Bytes {
    const unsigned char* first = nullptr;
    Index stride = 0;
  };

  static Index component_size(int type) {
    switch (type) {
      case TINYGLTF_COMPONENT_TYPE_BYTE:
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return 1;
      case TINYGLTF_COMPONENT_TYPE_SHORT:
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return 2;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      case TINYGLTF_COMPONENT_TYPE_FLOAT:
        return 4;
      default:
        return 0;
    }
  }

  // Little-endian machine: the bytes are in place.
  static double component(const unsigned char* at, int type, bool normalized) {
    const auto get = [&](auto number) {
      std::memcpy(&number, at, sizeof number);
      return number;
    };
    switch (type) {
      case TINYGLTF_COMPONENT_TYPE_BYTE:
        return normalized ? std::max(get(std::int8_t{}) / 127.0, -1.0) : double(get(std::int8_t{}));
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return normalized ? get(std::uint8_t{}) / 255.0 : double(get(std::uint8_t{}));
      case TINYGLTF_COMPONENT_TYPE_SHORT:
        return normalized ? std::max(get(std::int16_t{}) / 32767.0, -1.0) : double(get(std::int16_t{}));
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return normalized ? get(std::uint16_t{}) / 65535.0 : double(get(std::uint16_t{}));
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return double(get(std::uint32_t{}));
      default:
        return double(get(0.0F));
    }
  }

  // `count` elements of `size` bytes from `offset` of a view on; all of them inside the buffer.
  Bytes elements(int view_number, Index offset, Index count, Index size, const std::string& where) const {
    const auto& view = model_.bufferViews[std::size_t(view_number)];
    const auto& buffer = model_.buffers[std::size_t(view.buffer)];
    const Index stride = view.byteStride == 0 ? size : Index(view.byteStride);
    const Index end = offset + (count - 1) * stride + size;
    if (stride < size) fail(where + ": byteStride " + std::to_string(stride) + " is less than an element");
    if (end > Index(view.byteLength) || Index(view.byteOffset) + end > Index(buffer.data.size())) {
      fail(where + ": " + std::to_string(count) + " elements need " + std::to_string(end) +
           " bytes of a buffer view of " + std::to_string(view.byteLength));
    }
    return {buffer.data.data() + view.byteOffset + offset, stride};
  }

  // All numbers of an accessor, `width` an element; a sparse one's values put in place of zeros or of its own.
  std::vector<double> numbers(const tinygltf::Accessor& accessor, Index width, const std::string& where) const {
    const Index size = component_size(accessor.componentType);
    const auto count = Index(accessor.count);
    std::vector<double> result;
    if (count == 0) return result;
    const auto fill = [&](const Bytes& bytes, Index n, auto&& store) {
      for (Index i = 0; i < n; ++i) {
        for (Index k = 0; k < width; ++k) {
          store(i, k,
                component(bytes.first + i * bytes.stride + k * size, accessor.componentType, accessor.normalized));
        }
      }
    };
    if (accessor.bufferView >= 0) {
      const Bytes bytes = elements(accessor.bufferView, Index(accessor.byteOffset), count, width * size, where);
      result.reserve(std::size_t(count * width));
      fill(bytes, count, [&](Index, Index, double value) { result.push_back(value); });
    } else {
      constexpr Index kMostZeros = 100'000'000;
      if (count > kMostZeros) fail(where + ": more than 100 million elements without data");
      result.assign(std::size_t(count * width), 0.0);
    }
    if (!accessor.sparse.isSparse || accessor.sparse.count == 0) return result;
    const auto& sparse = accessor.sparse;
    const Index index_size = component_size(sparse.indices.componentType);
    if (sparse.indices.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT || index_size == 0) {
      fail(where + ": sparse indices are not unsigned 8, 16 or 32-bit numbers");
    }
    const Bytes places = elements(sparse.indices.bufferView, sparse.indices.byteOffset, sparse.count, index_size,
                                  where + " sparse indices");
    const Bytes values = elements(sparse.values.bufferView, sparse.values.byteOffset, sparse.count, width * size,
                                  where + " sparse values");
    fill(values, sparse.count, [&](Index i, Index k, double value) {
      const auto at = Index(component(places.first + i * places.stride, sparse.indices.componentType, false));
      if (at < 0 || at >= count) fail(where + ": sparse index " + std::to_string(at) + " is out of range");
      result[std::size_t(at * width + k)] = value;
    });
    return result;
  }

  std::vector<Index> indices(const tinygltf::Primitive& primitive, Index vertices, const std::string& where) const {
    std::vector<Index> result;
    if (primitive.indices < 0) {
      for (Index i = 0; i < vertices; ++i) result.push_back(i);
      return result;
    }
    const auto& accessor = model_.accessors[std::size_t(primitive.indices)];
    if (accessor.count == 0) return result;
    const int type = accessor.componentType;
    if ((type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
         type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) ||
        accessor.type != TINYGLTF_TYPE_SCALAR) {
      fail(where + ": indices are not unsigned 8, 16 or 32-bit numbers");
    }
    for (const double number : numbers(accessor, 1, where + " indices")) {
      const auto index = Index(number);
      if (index >= vertices) {
        fail(where + ": index " + std::to_string(index) + " (element " + std::to_string(result.size()) +
             ") is outside 0.." + std::to_string(vertices - 1));
      }
      result.push_back(index);
    }
    return result;
  }

  // In the mesh's own coordinates, numbers of 24 bits have to hold the shape.
  void check_digits(const std::vector<double>& numbers, const std::string& where) const {
    Eigen::AlignedBox3d box;
    for (std::size_t k = 0; k + 2 < numbers.size(); k += 3) {
      box.extend(Eigen::Vector3d(numbers[k], numbers[k + 1], numbers[k + 2]));
    }
    if (box.isEmpty()) return;
    const double step = 0x1p-23 * std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
    constexpr double kCoarsestFloat = 5e-4;  // of the diagonal
    if (numbers.size() < 300 || !(step > kCoarsestFloat * box.diagonal().norm())) return;
    fail(where +
         ": lies so far from the mesh's origin that its 32-bit numbers have lost the shape: move it to the "
         "origin before export");
  }

  std::vector<Eigen::Vector3d> positions(const tinygltf::Primitive& primitive, const Eigen::Affine3d& transform,
                                         const std::string& where) const {
    const auto& accessor = model_.accessors[std::size_t(primitive.attributes.at("POSITION"))];
    const int type = accessor.componentType;
    if (component_size(type) == 0 || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT ||
        accessor.type != TINYGLTF_TYPE_VEC3) {
      fail(where + ": POSITION is not three 32-bit floats or 8 or 16-bit whole numbers");
    }
    const std::vector<double> all = numbers(accessor, 3, where + " POSITION");
    std::vector<Eigen::Vector3d> result;
    for (std::size_t i = 0; 3 * i + 2 < all.size(); ++i) {
      const Eigen::Vector3d placed = transform * Eigen::Vector3d(all[3 * i], all[3 * i + 1], all[3 * i + 2]);
      if (!placed.allFinite() || placed.cwiseAbs().maxCoeff() > largest_coordinate) {
        fail(where + ": vertex " + std::to_string(i) + ": a coordinate is not finite or beyond 1e15");
      }
      result.push_back(placed);
    }
    if (type == TINYGLTF_COMPONENT_TYPE_FLOAT) check_digits(all, where);
    return result;
  }

  static std::vector<std::array<Index, 3>> triangles(int mode, const std::vector<Index>& list) {
    std::vector<std::array<Index, 3>> result;
    if (mode == TINYGLTF_MODE_TRIANGLES) {
      for (std::size_t i = 0; i + 2 < list.size(); i += 3) result.push_back({list[i], list[i + 1], list[i + 2]});
    } else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
      for (std::size_t i = 0; i + 2 < list.size(); ++i) {
        const std::size_t odd = i % 2;
        result.push_back({list[i], list[i + 1 + odd], list[i + 2 - odd]});
      }
    } else if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
      for (std::size_t i = 1; i + 1 < list.size(); ++i) result.push_back({list[0], list[i], list[i + 1]});
    }
    // The repeated corners of a strip are its way to turn, not faults of the surface.
    if (mode != TINYGLTF_MODE_TRIANGLES) {
      std::erase_if(result, [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
    }
    return result;
  }

  void append(const Instance& instance, Surface& surface) const {
    const auto part = static_cast<std::int32_t>(surface.part_names.size());
    const bool mirrored = instance.transform.linear().determinant() < 0;
    // glTF splits a vertex wherever a normal or a texture jumps: what is at the same place is one point.
    std::map<std::array<double, 3>, std::int32_t> known;
    const auto first = surface.triangles.size();
    const auto& mesh = model_.meshes[std::size_t(instance.mesh)];
    for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
      const auto& primitive = mesh.primitives[p];
      if (primitive.mode < TINYGLTF_MODE_TRIANGLES) continue;  // points and lines are no surface
      const auto where = "mesh '" + instance.part + "' primitive " + std::to_string(p);
      if (primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN) fail(where + ": unknown mode " + std::to_string(primitive.mode));
      const auto points = positions(primitive, instance.transform, where);
      const auto list = indices(primitive, Index(points.size()), where);
      if (primitive.mode == TINYGLTF_MODE_TRIANGLES && list.size() % 3 != 0) {
        fail(where + ": " + std::to_string(list.size()) + " indices are not whole triangles");
      }
      for (const auto& corners : triangles(primitive.mode, list)) {
        std::array<std::int32_t, 3> triangle{};
        for (std::size_t k = 0; k < 3; ++k) {
          const auto& point = points[std::size_t(corners[k])];
          const auto [entry, fresh] =
              known.try_emplace({point.x(), point.y(), point.z()}, static_cast<std::int32_t>(surface.vertices.size()));
          if (fresh) surface.vertices.push_back(point);
          triangle[k] = entry->second;
        }
        if (mirrored) std::swap(triangle[1], triangle[2]);
        surface.triangles.push_back(triangle);
      }
    }
    if (surface.triangles.size() == first) return;
    surface.part_names.push_back(instance.part);
    surface.parts.resize(surface.triangles.size(), part);
  }

  const tinygltf::Model& model_;
  const std::filesystem::path& file_;
  std::vector<int> parents_;
  std::vector<Instance> instances_;
};

}  // namespace

Surface read_gltf(const std::string& bytes, const std::filesystem::path& file, const std::vector<std::string>& wanted,
                  bool binary) {
  const auto screened = screen_gltf(bytes, file, binary);
  tinygltf::TinyGLTF loader;
  tinygltf::Model model;
  std::string error, warning;
  const auto folder = file.has_parent_path() ? file.parent_path().string() : std::string(".");
  const auto length = static_cast<unsigned int>(screened.size());
  const bool done =
      binary ? loader.LoadBinaryFromMemory(&model, &error, &warning,
                                           reinterpret_cast<const unsigned char*>(screened.data()), length, folder)
             : loader.LoadASCIIFromString(&model, &error, &warning, screened.data(), length, folder);
  if (!done) {
    constexpr std::size_t kLongest = 200;  // it may quote embedded data
    error.resize(std::min(error.size(), kLongest));
    while (!error.empty() && error.back() == '\n') error.pop_back();
    throw Error(ExitCode::bad_input, file.string() + ": " + (error.empty() ? "tinygltf cannot read it" : error));
  }
  return GltfReader(model, file).read(wanted);
}

}  // namespace palpate
