// SPDX-License-Identifier: AGPL-3.0-or-later
// palpate-tetgen: reads one surface from standard input, meshes it with TetGen, writes tetrahedra to standard
// output (tetgen_protocol.hpp). A process of its own, because TetGen crashes, hangs and asserts on bad surfaces.
#include "precompute/mesh/volume/tetgen_protocol.hpp"

#include <sys/prctl.h>
#include <sys/resource.h>
#include <tetgen.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

namespace {

namespace protocol = palpate::mesh::tetgen;

bool read_all(int fd, void* data, std::size_t size) {
  auto* at = static_cast<char*>(data);
  while (size > 0) {
    const ssize_t got = ::read(fd, at, size);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    at += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

bool write_all(int fd, const void* data, std::size_t size) {
  const auto* at = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t put = ::write(fd, at, size);
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    at += put;
    size -= static_cast<std::size_t>(put);
  }
  return true;
}

template <class T>
bool read_vector(int fd, std::vector<T>& v) {
  return read_all(fd, v.data(), v.size() * sizeof(T));
}

struct Request {
  std::vector<double> vertices, sizes;
  std::vector<std::int32_t> facets;
  std::string switches;
};

const char* read_request(int fd, Request& request) {
  protocol::RequestHeader header{};
  if (!read_all(fd, &header, sizeof header)) return "request ends in its header";
  if (header.magic != protocol::kRequestMagic) return "request has the wrong magic number";
  if (header.vertices > protocol::kMostItems || header.facets > protocol::kMostItems || header.switches > 256) {
    return "request is too big";
  }
  if (header.vertices < 4 || header.facets < 4) return "request has fewer than 4 vertices or facets";
  request.vertices.resize(std::size_t{3} * header.vertices);
  request.sizes.resize(header.vertices);
  request.facets.resize(std::size_t{3} * header.facets);
  request.switches.resize(header.switches);
  if (!read_vector(fd, request.vertices) || !read_vector(fd, request.sizes) || !read_vector(fd, request.facets) ||
      !read_all(fd, request.switches.data(), request.switches.size())) {
    return "request ends early";
  }
  for (const std::int32_t v : request.facets) {
    if (v < 0 || static_cast<std::uint32_t>(v) >= header.vertices) return "facet has a vertex out of range";
  }
  return nullptr;
}

// tetgenio deletes its arrays with delete[], so they are allocated with new[].
template <class From>
auto* copy_of(const std::vector<From>& from) {
  auto* to = new From[from.size()];
  std::copy(from.begin(), from.end(), to);
  return to;
}

void fill(const Request& request, tetgenio& in) {
  in.firstnumber = 0;
  in.numberofpoints = static_cast<int>(request.sizes.size());
  in.pointlist = copy_of(request.vertices);
  in.numberofpointmtrs = 1;
  in.pointmtrlist = copy_of(request.sizes);
  in.numberoffacets = static_cast<int>(request.facets.size() / 3);
  in.facetlist = new tetgenio::facet[static_cast<std::size_t>(in.numberoffacets)];
  in.facetmarkerlist = new int[static_cast<std::size_t>(in.numberoffacets)];
  for (int f = 0; f < in.numberoffacets; ++f) {
    in.facetmarkerlist[f] = 1;
    tetgenio::facet& facet = in.facetlist[f];
    tetgenio::init(&facet);
    facet.numberofpolygons = 1;
    facet.polygonlist = new tetgenio::polygon[1];
    tetgenio::polygon& polygon = facet.polygonlist[0];
    tetgenio::init(&polygon);
    polygon.numberofvertices = 3;
    polygon.vertexlist = new int[3];
    for (int k = 0; k < 3; ++k) polygon.vertexlist[k] = request.facets[std::size_t(3 * f + k)];
  }
}

int answer(int fd, const tetgenio& out, int failure) {
  protocol::ResponseHeader header{protocol::kResponseMagic, 0, 0, failure};
  if (failure == 0) {
    header.points = static_cast<std::uint32_t>(out.numberofpoints);
    header.tets = static_cast<std::uint32_t>(out.numberoftetrahedra);
  }
  const bool done = write_all(fd, &header, sizeof header) &&
                    write_all(fd, out.pointlist, std::size_t{header.points} * 3 * sizeof(double)) &&
                    write_all(fd, out.tetrahedronlist, std::size_t{header.tets} * 4 * sizeof(int));
  return done ? 0 : 4;
}

}  // namespace

int main() {
  // Nobody waits for the answer once the parent is gone; a crash is expected and wants no core file.
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  // TetGen prints to standard output: keep that for the answer and send its words to standard error.
  const int out_fd = ::dup(STDOUT_FILENO);
  if (out_fd < 0 || ::dup2(STDERR_FILENO, STDOUT_FILENO) < 0) {
    std::fprintf(stderr, "palpate-tetgen: no standard output\n");
    return 4;
  }
  Request request;
  if (const char* wrong = read_request(STDIN_FILENO, request)) {
    std::fprintf(stderr, "palpate-tetgen: %s\n", wrong);
    return 2;
  }
  tetgenio in, out;
  int failure = 0;
  try {
    fill(request, in);
    tetrahedralize(request.switches.data(), &in, &out);
  } catch (int code) {
    failure = code == 0 ? 1 : code;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "palpate-tetgen: %s\n", error.what());
    return 3;
  }
  std::fflush(stdout);
  return answer(out_fd, out, failure);
}
