// SPDX-License-Identifier: GPL-3.0-or-later
// libFuzzer's entry: any bytes as a label image. The first byte chooses the format.
#include "formats/image/label_image.hpp"
#include "formats/io/error.hpp"
#include "tests/fuzz/invariant.hpp"

#include <unistd.h>
#include <cstdint>

#include <filesystem>
#include <fstream>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  if (size < 1) return 0;
  static const char* const kinds[] = {".nii", ".nii.gz", ".nrrd", ".mha"};
  // ITK reads files alone.
  static const std::string stem =
      (std::filesystem::temp_directory_path() / "palpate-fuzz-image").string() + std::to_string(::getpid());
  const std::string file = stem + kinds[data[0] % 4];
  std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(data) + 1, std::streamsize(size) - 1);
  try {
    const LabelImage image = read_label_image(file, 0);
    std::size_t total = std::size_t(image.layers);
    for (const int n : image.size) total *= std::size_t(n);
    test::expect(image.values.size() == total, "as many values as voxels and layers");
    test::expect(image.axes.allFinite() && image.origin.allFinite(), "a finite frame");
    for (const LabelExtent& extent : label_extents(image)) {
      LabelSource source;
      source.values = {extent.value};
      if (image.layers == 1) test::expect(label_mask(image, source, MaskUse::region).count > 0, "a mask has voxels");
    }
  } catch (const Error& error) {
    test::expect(*error.what() != '\0', "an error has a message");
  }
  return 0;
}
