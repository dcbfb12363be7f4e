// SPDX-License-Identifier: MIT
// The contact surface of a response file: triangle grids over the patches and the search tree over them.
#include "formats/error.hpp"
#include "formats/response.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

namespace palpate {
namespace {

// Numbers grid points so that a point on a shared edge or corner is one vertex: its key is the sites it
// depends on with their whole-number weights.
class GridNumbers {
public:
  std::uint32_t number(const std::array<std::uint32_t, 3>& sites, const std::array<std::uint32_t, 3>& steps) {
    Key key;
    for (int k = 0; k < 3; ++k) {
      if (steps[k] > 0) key.push_back({sites[k], steps[k]});
    }
    std::sort(key.begin(), key.end());
    return numbers_.try_emplace(key, static_cast<std::uint32_t>(numbers_.size())).first->second;
  }

  [[nodiscard]] std::vector<GridVertex> vertices(std::uint32_t k) const {
    std::vector<GridVertex> result(numbers_.size());
    for (const auto& [key, number] : numbers_) {
      GridVertex& vertex = result[number];
      vertex.sites.fill(key.front().first);
      for (std::size_t i = 0; i < key.size(); ++i) {
        vertex.sites[i] = key[i].first;
        vertex.weights[i] = static_cast<double>(key[i].second) / k;
      }
    }
    return result;
  }

private:
  using Key = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  std::map<Key, std::uint32_t> numbers_;
};

struct Box {
  Triple lower{1e300, 1e300, 1e300}, upper{-1e300, -1e300, -1e300};
  void add(const Triple& p) {
    for (int k = 0; k < 3; ++k) {
      lower[k] = std::min(lower[k], p[k]);
      upper[k] = std::max(upper[k], p[k]);
    }
  }
};

constexpr std::uint32_t kLeafTriangles = 4;

class TreeBuilder {
public:
  explicit TreeBuilder(const ResponseFileContent& c) : content_(c), order_(c.surface_triangles.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    for (const ResponseTriangle& t : c.surface_triangles) {
      Triple centre{0, 0, 0};
      for (const std::uint32_t v : t.vertices) {
        for (int k = 0; k < 3; ++k) centre[k] += c.surface_vertices[v][k] / 3;
      }
      centres_.push_back(centre);
    }
    nodes.emplace_back();
    build(0, 0, static_cast<std::uint32_t>(order_.size()));
  }

  std::vector<layout::SearchNode> nodes;
  [[nodiscard]] const std::vector<std::uint32_t>& order() const { return order_; }

private:
  // Halves by the median of the centres along the longest axis: depth is log2 of the number of triangles.
  void build(std::uint32_t node, std::uint32_t begin, std::uint32_t end) {
    Box box, centres;
    for (std::uint32_t i = begin; i < end; ++i) {
      centres.add(centres_[order_[i]]);
      for (const std::uint32_t v : content_.surface_triangles[order_[i]].vertices)
        box.add(content_.surface_vertices[v]);
    }
    for (int k = 0; k < 3; ++k) {
      // Vertices are stored as floats: their box is taken after the same rounding.
      nodes[node].lower[k] = static_cast<float>(box.lower[k]);
      nodes[node].upper[k] = static_cast<float>(box.upper[k]);
    }
    if (end - begin <= kLeafTriangles) {
      nodes[node].first = begin;
      nodes[node].count = end - begin;
      return;
    }
    int axis = 0;
    for (int k = 1; k < 3; ++k) {
      if (centres.upper[k] - centres.lower[k] > centres.upper[axis] - centres.lower[axis]) axis = k;
    }
    std::sort(order_.begin() + begin, order_.begin() + end, [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(centres_[a][axis], a) < std::pair(centres_[b][axis], b);
    });
    const auto left = static_cast<std::uint32_t>(nodes.size());
    nodes[node].first = left;
    nodes[node].count = 0;
    nodes.resize(nodes.size() + 2);
    const std::uint32_t middle = begin + (end - begin) / 2;
    build(left, begin, middle);
    build(left + 1, middle, end);
  }

  const ResponseFileContent& content_;
  std::vector<std::uint32_t> order_;
  std::vector<Triple> centres_;
};

}  // namespace

std::vector<GridVertex> subdivide_surface(ResponseFileContent& c, std::uint32_t k) {
  if (k < 1 || k > layout::kMaxSubdivision) {
    throw Error(ExitCode::bad_input, "response file: subdivision " + std::to_string(k) + ", allowed 1 to " +
                                         std::to_string(layout::kMaxSubdivision));
  }
  c.subdivision = k;
  c.surface_triangles.clear();
  c.surface_vertices.clear();
  c.search.clear();
  GridNumbers numbers;
  for (std::uint32_t patch = 0; patch < c.patches.size(); ++patch) {
    const auto corner = [&](ResponseTriangle& t, int i, std::uint32_t a, std::uint32_t b) {
      t.grid[i] = {static_cast<std::uint16_t>(a), static_cast<std::uint16_t>(b)};
      t.vertices[i] = numbers.number(c.patches[patch], {a, b, k - a - b});
    };
    for (std::uint32_t a = 0; a < k; ++a) {
      for (std::uint32_t b = 0; a + b < k; ++b) {
        ResponseTriangle up;
        up.patch = patch;
        corner(up, 0, a + 1, b);
        corner(up, 1, a, b + 1);
        corner(up, 2, a, b);
        c.surface_triangles.push_back(up);
        if (a + b + 2 > k) continue;
        ResponseTriangle down;
        down.patch = patch;
        corner(down, 0, a + 1, b);
        corner(down, 1, a + 1, b + 1);
        corner(down, 2, a, b + 1);
        c.surface_triangles.push_back(down);
      }
    }
  }
  std::vector<GridVertex> vertices = numbers.vertices(k);
  for (const GridVertex& v : vertices) {
    Triple p{0, 0, 0};
    for (int i = 0; i < 3; ++i) {
      for (int axis = 0; axis < 3; ++axis) p[axis] += v.weights[i] * c.sites[v.sites[i]].position[axis];
    }
    c.surface_vertices.push_back(p);
  }
  return vertices;
}

void add_search(ResponseFileContent& c) {
  if (c.surface_triangles.empty()) throw Error(ExitCode::bad_input, "response file: contact surface: is empty");
  TreeBuilder tree(c);
  std::vector<ResponseTriangle> sorted;
  sorted.reserve(tree.order().size());
  for (const std::uint32_t t : tree.order()) sorted.push_back(c.surface_triangles[t]);
  c.surface_triangles = std::move(sorted);
  c.search = std::move(tree.nodes);
}

}  // namespace palpate
