// SPDX-License-Identifier: MIT
// The contact surface of a response file: triangle grids over the patches and the search tree over them.
#include "formats/io/error.hpp"
#include "formats/response/response.hpp"

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
  void add(const Box& box) {
    add(box.lower);
    add(box.upper);
  }
  [[nodiscard]] double width() const { return upper[0] - lower[0] + upper[1] - lower[1] + upper[2] - lower[2]; }
};

// A search measures two triangles in the time of two boxes.
constexpr std::uint32_t kLeafTriangles = 6;
static_assert(kLeafTriangles <= layout::SearchNode::kMaxLeaf);

class TreeBuilder {
public:
  explicit TreeBuilder(const ResponseFileContent& c)
      : triangles_(c.surface_triangles), left_(c.surface_triangles.size()) {
    // Boxes are of the vertices as they are stored, as floats.
    for (const Triple& p : c.surface_vertices) {
      points_.push_back({{static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])}});
    }
    grid = layout::grid_over(points_.data(), points_.size());
    std::vector<Triple> centres;
    for (const ResponseTriangle& t : c.surface_triangles) {
      Triple centre{0, 0, 0};
      Box box;
      for (const std::uint32_t v : t.vertices) {
        box.add(c.surface_vertices[v]);
        for (int k = 0; k < 3; ++k) centre[k] += c.surface_vertices[v][k] / 3;
      }
      boxes_.push_back(box);
      centres.push_back(centre);
    }
    behind_.resize(boxes_.size());
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<std::uint32_t>& order = orders_[axis];
      order.resize(boxes_.size());
      std::iota(order.begin(), order.end(), 0u);
      std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return std::pair(centres[a][axis], a) < std::pair(centres[b][axis], b);
      });
    }
    nodes.emplace_back();
    build(0, 0, static_cast<std::uint32_t>(boxes_.size()));
  }

  std::vector<layout::SearchNode> nodes;
  layout::SearchGrid grid{};
  [[nodiscard]] const std::vector<std::uint32_t>& order() const { return orders_[0]; }

private:
  struct Split {
    int axis = 0;
    std::uint32_t middle = 0;
  };

  void build(std::uint32_t node, std::uint32_t begin, std::uint32_t end) {
    layout::SearchNode& box = nodes[node];
    box = layout::kEmptyNode;
    for (std::uint32_t i = begin; i < end; ++i) {
      for (const std::uint32_t v : triangles_[orders_[0][i]].vertices) layout::hold_point(grid, points_[v].xyz, box);
    }
    if (end - begin <= kLeafTriangles) {
      box.set(begin, end - begin);
      return;
    }
    const Split split = best_split(begin, end);
    for (std::uint32_t i = begin; i < end; ++i) left_[orders_[split.axis][i]] = i < split.middle;
    for (std::vector<std::uint32_t>& order : orders_) {
      std::stable_partition(order.begin() + begin, order.begin() + end, [&](std::uint32_t t) { return left_[t]; });
    }
    const auto left = static_cast<std::uint32_t>(nodes.size());
    nodes[node].set(left, 0);
    nodes.resize(nodes.size() + 2);
    build(left, begin, split.middle);
    build(left + 1, split.middle, end);
  }

  // How often a search meets a box that is small beside its distance goes with the box's mean width, and what it does
  // then with the number of triangles: their product is least (Goldsmith and Salmon's rule, IEEE CG&A 7(5), 1987, for
  // points instead of rays). A third at least lies on either side, so the depth is below twice log2 of their number.
  [[nodiscard]] Split best_split(std::uint32_t begin, std::uint32_t end) {
    const std::uint32_t least = (end - begin) / 3;
    Split best{0, begin + (end - begin) / 2};
    double cost = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      const std::vector<std::uint32_t>& order = orders_[axis];
      Box behind, before;
      for (std::uint32_t i = end; i-- > begin;) {
        behind.add(boxes_[order[i]]);
        behind_[i] = behind.width();
      }
      for (std::uint32_t i = begin + 1; i + least <= end; ++i) {
        before.add(boxes_[order[i - 1]]);
        if (i - begin < least) continue;
        const double here = before.width() * (i - begin) + behind_[i] * (end - i);
        if (here < cost) {
          cost = here;
          best = {axis, i};
        }
      }
    }
    return best;
  }

  const std::vector<ResponseTriangle>& triangles_;
  std::vector<layout::Point> points_;
  std::vector<Box> boxes_;
  std::array<std::vector<std::uint32_t>, 3> orders_;  // by their centres' coordinates
  std::vector<char> left_;
  std::vector<double> behind_;  // m, widths of what lies from there on
};

}  // namespace

std::vector<GridVertex> subdivide_surface(ResponseFileContent& c, std::uint32_t k) {
  if (k < 1 || k > layout::kMaxSubdivision) {
    throw Error(ExitCode::bad_input, "response file: subdivision " + std::to_string(k) + ", allowed 1 to " +
                                         std::to_string(layout::kMaxSubdivision));
  }
  c.subdivision = k;
  c.surface_triangles.clear();
  c.surface_vertices.resize(c.sites.size());
  c.search.clear();
  GridNumbers numbers;
  for (std::uint32_t site = 0; site < c.sites.size(); ++site) numbers.number({site, site, site}, {k, 0, 0});
  for (std::uint32_t patch = 0; patch < c.patches.size(); ++patch) {
    const auto corner = [&](ResponseTriangle& t, int i, std::uint32_t a, std::uint32_t b) {
      t.grid[i] = {static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b)};
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
  for (std::size_t n = c.sites.size(); n < vertices.size(); ++n) {
    Triple p{0, 0, 0};
    for (int i = 0; i < 3; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        p[axis] += vertices[n].weights[i] * c.surface_vertices[vertices[n].sites[i]][axis];
      }
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
  c.search_grid = tree.grid;
}

}  // namespace palpate
