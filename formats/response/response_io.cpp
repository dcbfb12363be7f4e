// SPDX-License-Identifier: MIT
// Response files on disk.
#include <cstring>
#include <string>
#include <string_view>

#include "formats/io/file.hpp"
#include "formats/response/response.hpp"

namespace palpate {

void write_response_file(const std::filesystem::path& path, const std::vector<std::byte>& bytes) {
  write_file(path, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

std::vector<std::byte> read_bytes(const std::filesystem::path& path) {
  constexpr std::size_t kLargest = std::size_t{1} << 36;  // a file beyond 64 GiB is not one of ours
  const std::string text = read_file(path, "response file", kLargest);
  std::vector<std::byte> bytes(text.size());
  if (!text.empty()) std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

}  // namespace palpate
