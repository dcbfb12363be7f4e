// SPDX-License-Identifier: GPL-3.0-or-later
// libFuzzer's entry: see fuzz.cmake, which compiles and runs it where clang is.
#include "tests/fuzz/try_device.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  palpate::test::try_device(data, size);
  return 0;
}
