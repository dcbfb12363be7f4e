// SPDX-License-Identifier: MIT
// Expands gzip data without keeping them.
#include "formats/image/gzip.hpp"

#include "formats/io/error.hpp"

#include <zlib.h>

#include <fstream>
#include <memory>
#include <string>
#include <vector>

namespace palpate::detail {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 18;  // bytes read, and expanded, at once

}  // namespace

std::size_t whole_size(const std::filesystem::path& file, std::size_t offset, bool zlib, std::size_t enough) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Error(ExitCode::io, file.string() + ": cannot be read");
  stream.seekg(std::streamoff(offset));
  std::vector<char> in(kBlock), out(kBlock);
  const auto fill = [&] {
    stream.read(in.data(), std::streamsize(in.size()));
    return std::size_t(stream.gcount());
  };
  std::size_t length = fill();
  if (!zlib && (length < 2 || in[0] != '\x1f' || in[1] != '\x8b')) {
    const auto size = std::filesystem::file_size(file);
    return size > offset ? std::size_t(size) - offset : 0;
  }
  z_stream state{};
  if (inflateInit2(&state, zlib ? 15 : 31) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&state, inflateEnd);
  std::size_t total = 0;
  bool ended = false;
  for (; length > 0; length = fill()) {
    state.next_in = reinterpret_cast<Bytef*>(in.data());
    state.avail_in = uInt(length);
    while (state.avail_in > 0) {
      if (ended && inflateReset(&state) != Z_OK) break;  // the next member
      ended = false;
      state.next_out = reinterpret_cast<Bytef*>(out.data());
      state.avail_out = uInt(out.size());
      const int code = inflate(&state, Z_NO_FLUSH);
      if (code != Z_OK && code != Z_STREAM_END && code != Z_BUF_ERROR) {
        throw Error(ExitCode::bad_input, file.string() + ": its compressed data are damaged after " +
                                             std::to_string(total) + " bytes" +
                                             (state.msg != nullptr ? std::string(": ") + state.msg : ""));
      }
      total += out.size() - state.avail_out;
      ended = code == Z_STREAM_END;
      if (total > enough) return total;
    }
  }
  if (!ended) {
    throw Error(ExitCode::bad_input,
                file.string() + ": its compressed data are cut short after " + std::to_string(total) + " bytes");
  }
  return total;
}

}  // namespace palpate::detail
