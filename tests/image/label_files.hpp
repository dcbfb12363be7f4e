// SPDX-License-Identifier: GPL-3.0-or-later
// Writes label images as NIfTI, NRRD (also as Slicer's .seg.nrrd) and MetaImage, compressed or not.
#pragma once

#include <zlib.h>
#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace palpate::test {

/// Voxel (i, j, k) has its centre at origin + axes (i, j, k), in mm and LPS.
struct Voxels {
  std::array<int, 3> size{};
  Eigen::Vector3d origin{0, 0, 0};
  Eigen::Matrix3d axes;
  std::vector<std::uint8_t> values;  ///< the first index runs fastest

  [[nodiscard]] Eigen::Vector3d centre(int i, int j, int k) const { return origin + axes * Eigen::Vector3d(i, j, k); }
  /// Sets every voxel to what `label` says of its centre.
  void fill(const std::function<int(const Eigen::Vector3d&)>& label) {
    values.clear();
    for (int k = 0; k < size[2]; ++k) {
      for (int j = 0; j < size[1]; ++j) {
        for (int i = 0; i < size[0]; ++i) values.push_back(std::uint8_t(label(centre(i, j, k))));
      }
    }
  }
};

/// zlib's stream (MetaImage), or with a gzip head (NIfTI, NRRD).
inline std::string deflated(const std::string& bytes, bool gzip) {
  z_stream stream{};
  if (deflateInit2(&stream, 6, Z_DEFLATED, gzip ? 31 : 15, 8, Z_DEFAULT_STRATEGY) != Z_OK) {
    throw std::runtime_error("zlib does not start");
  }
  std::string out(deflateBound(&stream, uLong(bytes.size())) + 64, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = uInt(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = uInt(out.size());
  if (deflate(&stream, Z_FINISH) != Z_STREAM_END) throw std::runtime_error("zlib does not end");
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

inline std::string voxel_bytes(const Voxels& v) { return {v.values.begin(), v.values.end()}; }

inline std::string numbers(const Eigen::Vector3d& v, const char* pattern) {
  char text[128];
  std::snprintf(text, sizeof text, pattern, v.x(), v.y(), v.z());
  return text;
}

/// NIfTI-1 with an sform, in RAS as the format wants it; the first four bytes of extension are zero.
inline std::string nifti(const Voxels& v, bool compressed) {
  std::string head(352, '\0');
  const auto put = [&](std::size_t at, auto value) { std::memcpy(head.data() + at, &value, sizeof value); };
  put(0, std::int32_t{348});
  put(40, std::int16_t{3});
  for (std::size_t k = 0; k < 3; ++k) put(42 + 2 * k, std::int16_t(v.size[k]));
  for (std::size_t k = 3; k < 7; ++k) put(42 + 2 * k, std::int16_t{1});
  put(70, std::int16_t{2});  // unsigned char
  put(72, std::int16_t{8});
  put(76, 1.0F);
  for (std::size_t k = 0; k < 3; ++k) put(80 + 4 * k, float(v.axes.col(int(k)).norm()));
  put(108, 352.0F);
  put(112, 1.0F);
  put(123, char{2});          // millimetres
  put(254, std::int16_t{1});  // sform: scanner
  Eigen::Matrix<double, 3, 4> ras;
  ras << v.axes, v.origin;
  ras.topRows<2>() *= -1;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) put(std::size_t(280 + 16 * row + 4 * column), float(ras(row, column)));
  }
  std::memcpy(head.data() + 344, "n+1", 4);
  const std::string bytes = head + voxel_bytes(v);
  return compressed ? deflated(bytes, true) : bytes;
}

/// `more`: further fields, each ended by a newline.
inline std::string nrrd_file(const Voxels& v, bool compressed, const std::string& space = "left-posterior-superior",
                             const std::string& more = {}) {
  std::string text = "NRRD0004\ntype: unsigned char\ndimension: 3\n";
  text += space.empty() ? "space dimension: 3\n" : "space: " + space + "\n";
  text += "sizes: " + std::to_string(v.size[0]) + " " + std::to_string(v.size[1]) + " " + std::to_string(v.size[2]) +
          "\nspace directions:";
  for (int k = 0; k < 3; ++k) text += " " + numbers(v.axes.col(k), "(%.17g,%.17g,%.17g)");
  text += "\nkinds: domain domain domain\nendian: little\nencoding: ";
  text += compressed ? "gzip" : "raw";
  text += "\nspace origin: " + numbers(v.origin, "(%.17g,%.17g,%.17g)") + "\n" + more + "\n";
  return text + (compressed ? deflated(voxel_bytes(v), true) : voxel_bytes(v));
}

inline std::string meta(const Voxels& v, bool compressed, const std::string& orientation = "RAI") {
  const std::string bytes = compressed ? deflated(voxel_bytes(v), false) : voxel_bytes(v);
  const Eigen::Vector3d spacing = v.axes.colwise().norm();
  std::string text = "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n";
  text += std::string("CompressedData = ") + (compressed ? "True" : "False") + "\n";
  if (compressed) text += "CompressedDataSize = " + std::to_string(bytes.size()) + "\n";
  text += "TransformMatrix =";
  for (int k = 0; k < 3; ++k) text += " " + numbers(v.axes.col(k) / spacing[k], "%.17g %.17g %.17g");
  text += "\nOffset = " + numbers(v.origin, "%.17g %.17g %.17g") + "\nCenterOfRotation = 0 0 0\n";
  if (!orientation.empty()) text += "AnatomicalOrientation = " + orientation + "\n";
  text += "ElementSpacing = " + numbers(spacing, "%.17g %.17g %.17g") + "\nDimSize = " + std::to_string(v.size[0]) +
          " " + std::to_string(v.size[1]) + " " + std::to_string(v.size[2]) +
          "\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n";
  return text + bytes;
}

/// Slicer's segmentation: `layers` share the frame of the first; `keys` are its segments ("Segment0_Name:=liver").
inline std::string seg_nrrd(const std::vector<Voxels>& layers, const std::string& keys, bool compressed) {
  const Voxels& v = layers.front();
  std::string text = "NRRD0004\ntype: unsigned char\ndimension: 4\nspace: left-posterior-superior\nsizes: " +
                     std::to_string(layers.size());
  for (const int n : v.size) text += " " + std::to_string(n);
  text += "\nspace directions: none";
  for (int k = 0; k < 3; ++k) text += " " + numbers(v.axes.col(k), "(%.17g,%.17g,%.17g)");
  text += "\nkinds: list domain domain domain\nencoding: ";
  text += compressed ? "gzip" : "raw";
  text += "\nspace origin: " + numbers(v.origin, "(%.17g,%.17g,%.17g)") + "\n" + keys + "\n";
  std::string bytes;
  for (std::size_t k = 0; k < v.values.size(); ++k) {
    for (const Voxels& layer : layers) bytes += char(layer.values[k]);
  }
  return text + (compressed ? deflated(bytes, true) : bytes);
}

/// An organ of 154 mL with a tumour of 4.19 mL and a vessel of 2.3 mL, voxels of 1.5 x 1.5 x 3 mm along turned axes.
/// Values: 1 organ, 2 tumour, 3 vessel.
struct Study {
  static constexpr double kTumour = 10, kVessel = 3.5;  // mm, radii
  static inline const Eigen::Vector3d radii{45, 34, 24}, organ{20, -130, 640}, tumour{36, -135, 638};
  static double organ_volume() { return 4.0 / 3 * 3.141592653589793 * radii.prod() * 1e-9; }
  static double tumour_volume() { return 4.0 / 3 * 3.141592653589793 * kTumour * kTumour * kTumour * 1e-9; }

  static int label(const Eigen::Vector3d& p) {
    if ((p - tumour).norm() < kTumour) return 2;
    const Eigen::Vector3d q = p - organ;
    if (std::hypot(q.y() - 8, q.z()) < kVessel && q.x() > -34 && q.x() < 4) return 3;
    return q.cwiseQuotient(radii).norm() < 1 ? 1 : 0;
  }

  static Voxels voxels(double scale = 1) {
    Voxels v;
    const double a = 0.21, b = 0.1;
    Eigen::Matrix3d turn, tilt;
    turn << std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a), 0, 0, 0, 1;
    tilt << 1, 0, 0, 0, std::cos(b), -std::sin(b), 0, std::sin(b), std::cos(b);
    v.axes = turn * tilt * (scale * Eigen::Vector3d(1.5, 1.5, 3)).asDiagonal();
    v.size = {int(76 / scale), int(64 / scale), int(24 / scale)};
    v.origin = organ - v.axes * Eigen::Vector3d(v.size[0] - 1, v.size[1] - 1, v.size[2] - 1) / 2;
    v.fill(label);
    return v;
  }
};

}  // namespace palpate::test
