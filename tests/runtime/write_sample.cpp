// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the ball of the tests as a response file: write_sample FILE.palp
#include <cstdio>
#include <exception>

#include "tests/support/response_samples.hpp"

int main(int argc, char** argv) {
  if (argc != 2) return 1;
  try {
    palpate::test::ResponseSampleOptions options;
    options.subdivision = 4;
    options.search = true;
    palpate::write_response_file(argv[1], palpate::encode(palpate::test::ball_content(options)));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 4;
  }
}
