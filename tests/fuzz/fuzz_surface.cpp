// SPDX-License-Identifier: GPL-3.0-or-later
// libFuzzer's entry: any bytes as a surface file. The first byte chooses the format.
#include "formats/io/error.hpp"
#include "formats/surface/surface_plain.hpp"
#include "tests/fuzz/invariant.hpp"

#include <cmath>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  if (size < 1) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  using Reader = PolygonSoup (*)(std::string_view, const std::filesystem::path&);
  static const Reader readers[] = {read_obj, read_off, read_stl, read_ply, read_vtk, read_vtp};
  try {
    const PolygonSoup soup = readers[data[0] % 6](bytes, "file");
    test::expect(soup.first.back() == soup.corners.size(), "the last polygon ends where the corners do");
    for (const auto& v : soup.vertices) test::expect(v.allFinite(), "finite coordinates");
    for (const auto c : soup.corners) test::expect(c >= 0 && std::size_t(c) < soup.vertices.size(), "indices in range");
    for (std::size_t p = 0; p < soup.polygons(); ++p) {
      const auto count = soup.first[p + 1] - soup.first[p];
      test::expect(triangles_of(soup.vertices, soup.corners.data() + soup.first[p], count).size() == count - 2,
                   "two triangles less than corners");
    }
  } catch (const Error& error) {
    test::expect(*error.what() != '\0', "an error has a message");
  }
  return 0;
}
