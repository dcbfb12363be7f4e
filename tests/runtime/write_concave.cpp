// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the concave and sharp shapes of the tests as response files, with friction and without: write_concave FOLDER
#include <cstdio>
#include <exception>

#include "tests/support/concave_samples.hpp"

int main(int argc, char** argv) {
  using namespace palpate::test;
  if (argc != 2) return 1;
  try {
    for (const ConcaveShape& shape : concave_shapes()) {
      for (const bool friction : {true, false}) {
        ResponseSampleOptions options;
        options.friction = friction;
        options.search = true;
        options.tools = ResponseSampleOptions::Tools::all;
        const std::string name = shape.name + (friction ? ".palp" : "_frictionless.palp");
        palpate::write_response_file(std::filesystem::path(argv[1]) / name,
                                     palpate::encode(concave_content(shape, options)));
      }
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 4;
  }
}
