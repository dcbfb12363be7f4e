// SPDX-License-Identifier: MIT
#include "formats/image/nifti_reader.hpp"

#include "formats/image/gzip.hpp"
#include "formats/image/voxel_values.hpp"
#include "formats/io/error.hpp"

#include <nifti1_io.h>

#include <memory>

namespace palpate::detail {
namespace {

using NiftiImage = std::unique_ptr<nifti_image, void (*)(nifti_image*)>;

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
  throw Error(ExitCode::bad_input, file.string() + ": " + what);
}

double millimetres(int unit) {
  switch (unit) {
    case NIFTI_UNITS_METER:
      return 1e3;
    case NIFTI_UNITS_MICRON:
      return 1e-3;
    default:  // a file that states none has millimetres
      return 1;
  }
}

void read_frame(const nifti_image& nifti, ImageFile& image) {
  const bool sform = nifti.sform_code > 0, qform = nifti.qform_code > 0;
  // A template's space stretches the organ.
  const bool stretched = nifti.sform_code == NIFTI_XFORM_TALAIRACH || nifti.sform_code == NIFTI_XFORM_MNI_152;
  const mat44& place = sform && !(qform && stretched) ? nifti.sto_xyz : nifti.qto_xyz;
  image.states_frame = sform || qform;
  const double unit = millimetres(nifti.xyz_units);
  for (std::size_t row = 0; row < 3; ++row) {
    const double sign = image.states_frame && row < 2 ? -unit : unit;  // RAS to LPS
    for (std::size_t k = 0; k < 3; ++k) image.axes[k][row] = sign * double(place.m[row][k]);
    image.origin[row] = sign * double(place.m[row][3]);
  }
}

void read_size(const std::filesystem::path& file, const nifti_image& nifti, ImageFile& image) {
  for (int k = 4; k <= nifti.dim[0] && k < 8; ++k) {
    if (nifti.dim[k] != 1) refuse(file, "has more than three dimensions; allowed: 3");
  }
  std::size_t total = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    image.size[k] = nifti.dim[k + 1];
    total *= std::size_t(image.size[k]);
    if (total > largest_image) refuse(file, "has more than 2^29 values; allowed: at most so many");
  }
  image.values.resize(total);
}

void read_values(const std::filesystem::path& file, const nifti_image& nifti, std::vector<std::int32_t>& values) {
  const bool scaled = nifti.scl_slope != 0 && !(nifti.scl_slope == 1 && nifti.scl_inter == 0);
  const auto convert = [&](auto number) {
    using Number = decltype(number);
    if (scaled) {
      to_scaled_labels<Number>(file, nifti.data, nifti.scl_slope, nifti.scl_inter, values);
    } else {
      to_labels<Number>(file, nifti.data, values);
    }
  };
  switch (nifti.datatype) {
    case DT_UINT8:
      return convert(std::uint8_t{});
    case DT_INT8:
      return convert(std::int8_t{});
    case DT_UINT16:
      return convert(std::uint16_t{});
    case DT_INT16:
      return convert(std::int16_t{});
    case DT_UINT32:
      return convert(std::uint32_t{});
    case DT_INT32:
      return convert(std::int32_t{});
    case DT_UINT64:
      return convert(std::uint64_t{});
    case DT_INT64:
      return convert(std::int64_t{});
    case DT_FLOAT32:
      return convert(float{});
    case DT_FLOAT64:
      return convert(double{});
    default:
      refuse(file, "voxels of type " + std::to_string(nifti.datatype) + "; allowed: numbers of 8 to 64 bits");
  }
}

}  // namespace

ImageFile read_nifti(const std::filesystem::path& file) {
  nifti_set_debug_level(0);  // nothing on standard error
  const NiftiImage nifti(nifti_image_read(file.c_str(), 0), nifti_image_free);
  if (!nifti) refuse(file, "is no NIfTI file, or its header is damaged");
  ImageFile image;
  read_size(file, *nifti, image);
  read_frame(*nifti, image);
  const std::size_t needed = std::size_t(std::max(nifti->iname_offset, 0)) + nifti->nvox * std::size_t(nifti->nbyper);
  const std::size_t there = whole_size(file, 0, false, needed);
  if (there < needed || nifti->nvox != image.values.size()) {
    refuse(file,
           "is cut short: its voxels need " + std::to_string(needed) + " bytes, there are " + std::to_string(there));
  }
  if (nifti_image_load(nifti.get()) != 0 || nifti->data == nullptr) refuse(file, "its voxels cannot be read");
  read_values(file, *nifti, image.values);
  return image;
}

}  // namespace palpate::detail
