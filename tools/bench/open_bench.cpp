// SPDX-License-Identifier: GPL-3.0-or-later
// Files of repeated bodies, and the time to open one.
#include "tools/bench/open_bench.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <ctime>

#include "formats/io/error.hpp"
#include "palpate/format/mapped_file.hpp"

namespace palpate::cli {
namespace {

using layout::Section;

std::uint64_t aligned(std::uint64_t at) {
  return (at + layout::kAlignment - 1) / layout::kAlignment * layout::kAlignment;
}

/// Copies of a search tree under one: a node over several copies has two children, one over one is that copy's root.
class Forest {
public:
  Forest(const runtime::View& view, std::uint32_t copies) : view_(view), nodes_(1) {
    nodes_.reserve(std::size_t{copies} * view.meta->search_nodes + copies);
    build(0, 0, copies);
  }
  [[nodiscard]] const std::vector<layout::SearchNode>& nodes() const { return nodes_; }

private:
  void build(std::uint32_t at, std::uint32_t begin, std::uint32_t end) {
    nodes_[at] = view_.search[0];
    const auto next = static_cast<std::uint32_t>(nodes_.size());
    if (end - begin > 1) {
      nodes_[at].set(next, 0);
      nodes_.resize(next + 2);
      const std::uint32_t middle = begin + (end - begin) / 2;
      build(next, begin, middle);
      build(next + 1, middle, end);
      return;
    }
    const std::uint32_t triangles = begin * view_.meta->triangle_count;
    // The copy's other nodes follow here: its node 1 becomes `next`.
    nodes_[at] = moved(nodes_[at], triangles, next - 1);
    for (std::uint32_t i = 1; i < view_.meta->search_nodes; ++i) {
      nodes_.push_back(moved(view_.search[i], triangles, next - 1));
    }
  }

  /// A node whose triangles or children have moved on by so many.
  static layout::SearchNode moved(layout::SearchNode node, std::uint32_t triangles, std::uint32_t children) {
    node.set(node.first() + (node.count() > 0 ? triangles : children), node.count());
    return node;
  }

  const runtime::View& view_;
  std::vector<layout::SearchNode> nodes_;
};

/// One a site, a point, a triangle or a patch of the body, or a response.
bool of_the_body(const layout::SectionEntry& e) {
  const auto id = static_cast<Section>(e.id);
  return (id >= Section::sites && id <= Section::surface_triangles) || id == Section::surface_patches ||
         (id >= Section::responses && id <= Section::bonded_torque);
}

/// The contact surface of one copy, its indices moved on among those of all copies.
class SurfaceCopy {
public:
  SurfaceCopy(const runtime::View& view, std::uint32_t copy, std::uint32_t copies)
      : view_(view), m_(*view.meta), copy_(copy), copies_(copies) {}

  /// The vertices of all sites come first.
  [[nodiscard]] std::uint32_t vertex(std::uint32_t index) const {
    const std::uint32_t sites = m_.site_count;
    return index < sites ? copy_ * sites + index : copies_ * sites + copy_ * (m_.vertex_count - sites) + index - sites;
  }

  void put_vertices(layout::Point* to) const {
    for (std::uint32_t i = 0; i < m_.vertex_count; ++i) to[vertex(i)] = view_.vertices[i];
  }

  template <class Index>
  void put_triangles(unsigned char* to) const {
    to += std::size_t{copy_} * m_.triangle_count * layout::triangle_size(sizeof(Index));
    for (std::uint32_t i = 0; i < m_.triangle_count; ++i, to += layout::triangle_size(sizeof(Index))) {
      layout::SurfaceTriangle t = view_.bare_triangle(i);
      for (std::uint32_t& v : t.vertex) v = vertex(v);
      for (std::uint32_t& neighbour : t.neighbour) neighbour += copy_ * m_.triangle_count;
      t.patch += copy_ * m_.patch_count;
      layout::pack_triangle<Index>(t, to);
    }
  }

  template <class Index>
  void put_patches(unsigned char* to) const {
    to += std::size_t{copy_} * m_.patch_count * layout::patch_size(sizeof(Index));
    for (std::uint32_t i = 0; i < m_.patch_count; ++i, to += layout::patch_size(sizeof(Index))) {
      std::uint32_t site[3];
      view_.patch_sites(i, site);
      for (std::uint32_t& s : site) s += copy_ * m_.site_count;
      layout::pack_patch<Index>(site, to);
    }
  }

private:
  const runtime::View& view_;
  const layout::Meta& m_;
  std::uint32_t copy_, copies_;
};

/// True where the section is one of the contact surface's, which it then writes.
bool put_surface(const runtime::View& view, Section id, const layout::Meta& meta, std::uint32_t copies,
                 std::byte* data) {
  auto* const to = reinterpret_cast<unsigned char*>(data);
  const bool small = meta.index_bytes == 2;
  for (std::uint32_t copy = 0; copy < copies; ++copy) {
    const SurfaceCopy surface(view, copy, copies);
    if (id == Section::surface_vertices) {
      surface.put_vertices(reinterpret_cast<layout::Point*>(data));
    } else if (id == Section::surface_triangles) {
      small ? surface.put_triangles<std::uint16_t>(to) : surface.put_triangles<std::uint32_t>(to);
    } else if (id == Section::surface_patches) {
      small ? surface.put_patches<std::uint16_t>(to) : surface.put_patches<std::uint32_t>(to);
    } else {
      return false;
    }
  }
  return true;
}

/// Processor time of this thread, the system's work for it included: other programs must not count.
double processor_seconds() {
  std::timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double median(std::vector<double>& list) {
  std::sort(list.begin(), list.end());
  return list[list.size() / 2];
}

}  // namespace

std::vector<std::byte> repeat_body(const runtime::View& view, const RepeatedSize& size) {
  const layout::Meta& m = *view.meta;
  const std::uint32_t sections = view.header().section_count;
  double once = 0, each = 0;
  for (std::uint32_t i = 0; i < sections; ++i) {
    const layout::SectionEntry& e = view.sections()[i];
    (of_the_body(e) || e.id == static_cast<std::uint32_t>(Section::search) ? each : once) +=
        static_cast<double>(e.size);
  }
  const double copies = std::max({1.0, (size.bytes - once) / each, size.sites / m.site_count});
  if (!(copies * std::max(m.response_count, m.triangle_count) < 2147483648.0)) {
    throw Error(ExitCode::bad_input, "a file of that size has more elements than the format counts");
  }
  const auto count = static_cast<std::uint32_t>(std::ceil(copies));
  std::vector<layout::SearchNode> nodes;
  if (view.search != nullptr) nodes = Forest(view, count).nodes();

  layout::Meta meta = m;
  for (std::uint32_t* n :
       {&meta.site_count, &meta.vertex_count, &meta.triangle_count, &meta.patch_count, &meta.response_count}) {
    *n *= count;
  }
  if (view.search != nullptr) meta.search_nodes = static_cast<std::uint32_t>(nodes.size());
  meta.index_bytes = layout::index_bytes(meta);

  std::vector<layout::SectionEntry> table(view.sections(), view.sections() + sections);
  std::uint64_t end = aligned(sizeof(layout::FileHeader) + sections * sizeof(layout::SectionEntry));
  for (layout::SectionEntry& e : table) {
    e.offset = end;
    if (of_the_body(e)) e.count *= count;
    if (e.id == static_cast<std::uint32_t>(Section::surface_triangles))
      e.element_size = layout::triangle_size(meta.index_bytes);
    if (e.id == static_cast<std::uint32_t>(Section::surface_patches))
      e.element_size = layout::patch_size(meta.index_bytes);
    if (e.id == static_cast<std::uint32_t>(Section::search)) e.count = nodes.size();
    e.size = e.count * e.element_size;
    end = aligned(end + e.size);
  }
  std::vector<std::byte> file(end);
  for (std::uint32_t i = 0; i < sections; ++i) {
    const layout::SectionEntry &from = view.sections()[i], &to = table[i];
    const auto id = static_cast<Section>(to.id);
    std::byte* data = file.data() + to.offset;
    if (id == Section::search) {
      std::memcpy(data, nodes.data(), to.size);
      continue;
    }
    if (put_surface(view, id, meta, count, data)) continue;
    for (std::uint64_t copy = 0; copy < to.count / from.count; ++copy) {
      std::memcpy(data + copy * from.size, view.bytes + from.offset, from.size);
    }
    if (id == Section::meta) std::memcpy(data, &meta, sizeof meta);
  }
  layout::FileHeader header = view.header();
  header.file_size = end;
  std::memcpy(file.data(), &header, sizeof header);
  std::memcpy(file.data() + sizeof header, table.data(), table.size() * sizeof table[0]);
  header.checksum = checksum::of_file(reinterpret_cast<const unsigned char*>(file.data()), file.size(),
                                      offsetof(layout::FileHeader, checksum));
  std::memcpy(file.data(), &header, sizeof header);
  return file;
}

OpenBench bench_open(const std::filesystem::path& path, int rounds) {
  OpenBench bench;
  const auto timed = [&](bool trusted) {
    const double begin = processor_seconds();
    const runtime::MappedFile file(path.c_str());
    if (!file.ok()) throw Error(ExitCode::io, path.string() + ": cannot map the file: " + file.error());
    const runtime::OpenResult opened =
        trusted ? runtime::View::open_trusted(file.data(), file.size()) : runtime::View::open(file.data(), file.size());
    const double taken = processor_seconds() - begin;
    if (!opened) throw Error(ExitCode::bad_input, path.string() + ": " + opened.error);
    bench.bytes = file.size();
    bench.sites = opened.view.meta->site_count;
    bench.responses = opened.view.meta->response_count;
    bench.parts.assign(opened.view.sections(), opened.view.sections() + opened.view.header().section_count);
    return taken;
  };
  timed(false);
  std::vector<double> validated, trusted;
  for (int i = 0; i < rounds; ++i) validated.push_back(timed(false));
  for (int i = 0; i < rounds; ++i) trusted.push_back(timed(true));
  bench.validated = median(validated);
  bench.validated_most = validated.back();
  bench.trusted = median(trusted);
  return bench;
}

}  // namespace palpate::cli
