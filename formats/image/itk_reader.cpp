// SPDX-License-Identifier: MIT
// ITK's readers of NRRD and MetaImage, used without its pipeline: header, then all voxels at once.
#include "formats/image/itk_reader.hpp"

#include "formats/image/gzip.hpp"
#include "formats/image/voxel_values.hpp"
#include "formats/io/error.hpp"

#include <itkMetaDataObject.h>
#include <itkMetaImageIO.h>
#include <itkNrrdImageIO.h>

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>
#include <sstream>

namespace palpate::detail {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
  throw Error(ExitCode::bad_input, file.string() + ": " + what);
}

itk::ImageIOBase::Pointer make_reader(ImageKind kind) {
  if (kind == ImageKind::nrrd) return itk::NrrdImageIO::New().GetPointer();
  return itk::MetaImageIO::New().GetPointer();
}

// The libraries below ITK write to standard error by themselves; the reason is in the exception as well.
class QuietErrors {
public:
  QuietErrors() : saved_(::dup(STDERR_FILENO)) {
    std::fflush(stderr);
    const int none = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (none >= 0) {
      ::dup2(none, STDERR_FILENO);
      ::close(none);
    }
    itk::Object::GlobalWarningDisplayOff();
  }
  ~QuietErrors() {
    std::fflush(stderr);
    if (saved_ >= 0) {
      ::dup2(saved_, STDERR_FILENO);
      ::close(saved_);
    }
  }
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;

private:
  int saved_;
};

// The last line of an ITK exception: the libraries below add theirs from the outside in.
std::string reason(const itk::ExceptionObject& error) {
  const char* description = error.GetDescription();
  std::string text = description != nullptr && *description != '\0' ? description : error.what();
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  if (const auto line = text.rfind('\n'); line != std::string::npos) text = text.substr(line + 1);
  constexpr std::size_t kLongest = 200;
  return text.substr(0, kLongest);
}

void to_values(const std::filesystem::path& file, itk::IOComponentEnum type, const unsigned char* bytes,
               std::vector<std::int32_t>& values) {
  switch (type) {
    case itk::IOComponentEnum::UCHAR:
      return to_labels<std::uint8_t>(file, bytes, values);
    case itk::IOComponentEnum::CHAR:
      return to_labels<std::int8_t>(file, bytes, values);
    case itk::IOComponentEnum::USHORT:
      return to_labels<std::uint16_t>(file, bytes, values);
    case itk::IOComponentEnum::SHORT:
      return to_labels<std::int16_t>(file, bytes, values);
    case itk::IOComponentEnum::INT:
      return to_labels<std::int32_t>(file, bytes, values);
    case itk::IOComponentEnum::UINT:
      return to_labels<std::uint32_t>(file, bytes, values);
    case itk::IOComponentEnum::LONG:
    case itk::IOComponentEnum::LONGLONG:
      return to_labels<std::int64_t>(file, bytes, values);
    case itk::IOComponentEnum::ULONG:
    case itk::IOComponentEnum::ULONGLONG:
      return to_labels<std::uint64_t>(file, bytes, values);
    case itk::IOComponentEnum::FLOAT:
      return to_labels<float>(file, bytes, values);
    case itk::IOComponentEnum::DOUBLE:
      return to_labels<double>(file, bytes, values);
    default:
      refuse(file, "voxels of an unknown type; allowed: numbers of 8 to 64 bits");
  }
}

void read_frame(const std::filesystem::path& file, const itk::ImageIOBase& reader, ImageFile& image) {
  const unsigned dimensions = reader.GetNumberOfDimensions();
  if (dimensions < 3) refuse(file, "has " + std::to_string(dimensions) + " dimensions; allowed: 3");
  for (unsigned k = 3; k < dimensions; ++k) {
    if (reader.GetDimensions(k) != 1) refuse(file, "has more than three dimensions; allowed: 3");
  }
  image.layers = int(std::min(reader.GetNumberOfComponents(), 65537U));
  std::size_t total = std::size_t(image.layers);
  if (total < 1 || total > 65536) refuse(file, "has no value a voxel, or more than 65536");
  for (unsigned k = 0; k < 3; ++k) {
    const auto n = reader.GetDimensions(k);
    if (n < 1 || n > 65536) refuse(file, "has " + std::to_string(n) + " voxels along an axis; allowed: 1 to 65536");
    image.size[k] = int(n);
    total *= n;
    if (total > largest_image) refuse(file, "has more than 2^29 values; allowed: at most so many");
    image.origin[k] = reader.GetOrigin(k);
    const std::vector<double> direction = reader.GetDirection(k);
    for (unsigned i = 0; i < 3; ++i) image.axes[k][i] = direction.at(i) * reader.GetSpacing(k);
  }
}

// ITK fills what is missing with zeros in MetaImage files, and does not look at the end of gzip data.
void require_whole(const std::filesystem::path& file, const itk::ImageIOBase& reader, ImageKind kind,
                   const VoxelPlace& voxels) {
  if (kind == ImageKind::nrrd && !voxels.gzip) return;  // ITK counts
  const auto needed = std::size_t(reader.GetImageSizeInBytes());
  const std::size_t there = whole_size(voxels.file, voxels.offset, voxels.zlib, needed);
  if (there >= needed) return;
  refuse(file,
         "is cut short: its voxels need " + std::to_string(needed) + " bytes, there are " + std::to_string(there));
}

}  // namespace

ImageFile read_by_itk(const std::filesystem::path& file, ImageKind kind, const VoxelPlace& voxels) {
  const QuietErrors quiet;
  ImageFile image;
  try {
    const itk::ImageIOBase::Pointer reader = make_reader(kind);
    reader->SetFileName(file.string());
    reader->ReadImageInformation();
    read_frame(file, *reader, image);
    const itk::MetaDataDictionary& dictionary = reader->GetMetaDataDictionary();
    for (const std::string& key : dictionary.GetKeys()) {
      std::string value;
      if (itk::ExposeMetaData(dictionary, key, value)) image.texts[key] = value;
    }
    require_whole(file, *reader, kind, voxels);
    itk::ImageIORegion region(reader->GetNumberOfDimensions());
    std::size_t total = std::size_t(image.layers);
    for (unsigned k = 0; k < region.GetImageDimension(); ++k) {
      region.SetSize(k, reader->GetDimensions(k));
      total *= reader->GetDimensions(k);
    }
    reader->SetIORegion(region);
    const auto bytes = std::size_t(reader->GetImageSizeInBytes());
    if (bytes / total != reader->GetComponentSize()) refuse(file, "voxels of an unknown type");
    // Not filled with zeros: a header may announce gigabytes that the file does not have.
    const std::unique_ptr<unsigned char[]> raw(new unsigned char[bytes]);
    reader->Read(raw.get());
    image.values.resize(total);
    to_values(file, reader->GetComponentType(), raw.get(), image.values);
  } catch (const itk::ExceptionObject& error) {
    refuse(file, "cannot be read: its data are damaged, cut short or in a form that is not known (ITK: " +
                     reason(error) + ")");
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    refuse(file, std::string("cannot be read: ") + error.what());
  }
  return image;
}

}  // namespace palpate::detail
