// SPDX-License-Identifier: GPL-3.0-or-later
// Packs a request for palpate-tetgen, runs it, and checks every byte of what comes back.
#include "precompute/mesh/volume/tetgen_client.hpp"

#include "formats/io/error.hpp"
#include "precompute/mesh/volume/child_process.hpp"
#include "precompute/mesh/volume/tetgen_protocol.hpp"

#include <cstring>

namespace palpate::mesh {
namespace {

void append(std::vector<char>& bytes, const void* data, std::size_t size) {
  const std::size_t at = bytes.size();
  bytes.resize(at + size);
  if (size > 0) std::memcpy(bytes.data() + at, data, size);
}

std::vector<char> pack(const TetgenInput& input) {
  const tetgen::RequestHeader header{tetgen::kRequestMagic, static_cast<std::uint32_t>(input.vertices.size()),
                                     static_cast<std::uint32_t>(input.facets.size()),
                                     static_cast<std::uint32_t>(input.switches.size())};
  std::vector<char> bytes;
  append(bytes, &header, sizeof header);
  for (const Eigen::Vector3d& v : input.vertices) append(bytes, v.data(), 3 * sizeof(double));
  append(bytes, input.sizes.data(), input.sizes.size() * sizeof(double));
  for (const auto& f : input.facets) append(bytes, f.data(), sizeof f);
  append(bytes, input.switches.data(), input.switches.size());
  return bytes;
}

// The last line that TetGen wrote, for the cause.
std::string last_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  const std::size_t at = text.find_last_of('\n');
  return at == std::string::npos ? text : text.substr(at + 1);
}

const char* failure_words(std::int32_t code) {
  switch (code) {
    case 1:
      return ", out of memory";
    case 3:
      return ", the surface crosses itself";
    case 4:
      return ", a feature too small for its arithmetic";
    case 5:
      return ", two facets too close together";
    case 10:
      return ", wrong input";
    default:
      return "";
  }
}

std::string unpack(const std::vector<char>& bytes, LinearTets& tets) {
  tetgen::ResponseHeader header{};
  if (bytes.size() < sizeof header) return "no answer";
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.magic != tetgen::kResponseMagic) return "answer has the wrong magic number";
  if (header.failure != 0) return "failure " + std::to_string(header.failure) + failure_words(header.failure);
  const std::size_t expected = sizeof header + std::size_t{header.points} * 24 + std::size_t{header.tets} * 16;
  if (bytes.size() != expected) {
    return "answer has " + std::to_string(bytes.size()) + " bytes instead of " + std::to_string(expected);
  }
  if (header.tets == 0) return "no tetrahedra: the surface is not closed";
  tets.points.resize(header.points);
  tets.tets.resize(header.tets);
  const char* at = bytes.data() + sizeof header;
  for (Eigen::Vector3d& p : tets.points) {
    std::memcpy(p.data(), at, 24);
    at += 24;
    if (!p.allFinite()) return "a point that is not finite";
  }
  for (auto& t : tets.tets) {
    std::memcpy(t.data(), at, 16);
    at += 16;
    for (const std::int32_t v : t) {
      if (v < 0 || static_cast<std::uint32_t>(v) >= header.points) return "a tetrahedron with a corner out of range";
    }
  }
  return {};
}

}  // namespace

MesherAnswer run_tetgen(const TetgenInput& input, double time_limit) {
  const std::filesystem::path worker = find_helper("palpate-tetgen");
  if (worker.empty()) {
    throw Error(ExitCode::io, "palpate-tetgen is neither beside this program nor in ../libexec/palpate");
  }
  ChildLimits limits;
  limits.cpu_time = time_limit;
#ifdef __SANITIZE_ADDRESS__
  limits.memory = 0;  // its shadow alone takes terabytes of addresses
#endif
  const ChildResult child = run_child(worker, pack(input), limits);
  MesherAnswer answer;
  answer.helper_seconds = child.cpu_time > 0 ? child.cpu_time : time_limit;  // a killed one has none
  std::string cause = child.finished ? unpack(child.output, answer.tets) : child.cause;
  if (!cause.empty()) {
    answer.tets = {};
    const std::string words = last_line(child.messages);
    answer.cause = "TetGen: " + cause + (words.empty() ? "" : " (" + words + ")");
  }
  return answer;
}

}  // namespace palpate::mesh
