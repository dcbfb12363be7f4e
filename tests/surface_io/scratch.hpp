// SPDX-License-Identifier: GPL-3.0-or-later
// A folder that vanishes with the test, and reading of texts and bytes as surface files.
#pragma once

#include "formats/io/error.hpp"
#include "formats/surface/surface_io.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

namespace palpate::test {

class Scratch {
public:
  Scratch() {
    auto pattern = (std::filesystem::temp_directory_path() / "palpate-XXXXXX").string();
    if (!::mkdtemp(pattern.data())) throw std::runtime_error("no scratch folder");
    folder_ = pattern;
  }
  ~Scratch() {
    std::error_code ignored;  // a folder left behind fails no test
    std::filesystem::remove_all(folder_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }

private:
  std::filesystem::path folder_;
};

inline Surface read(const std::filesystem::path& file, std::vector<std::string> meshes = {}, double unit = 1.0) {
  return read_surface({file, std::move(meshes), unit});
}

/// Expects an Error with this code whose message holds every one of `pieces`.
inline void expect_error(const std::function<void()>& action, ExitCode code, const std::vector<std::string>& pieces) {
  try {
    action();
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    for (const auto& piece : pieces) {
      EXPECT_NE(std::string(error.what()).find(piece), std::string::npos) << "'" << piece << "' in: " << error.what();
    }
  }
}

}  // namespace palpate::test
