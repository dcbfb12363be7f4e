// SPDX-License-Identifier: MIT
// What the readers of label images share: fields of a header by name, and what they say of the voxels.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::detail {

inline constexpr std::size_t largest_image = std::size_t{1} << 31U;  ///< bytes, and voxels

enum class VoxelType { int8, uint8, int16, uint16, int32, uint32 };
std::size_t size_of(VoxelType type);

/// The voxels' frame, as of LabelMask, their type, and their bytes as they stand in the file.
struct VoxelData {
  std::array<int, 3> size{};
  Eigen::Vector3d origin{0, 0, 0};
  Eigen::Matrix3d axes;
  VoxelType type = VoxelType::uint8;
  bool text = false, big_endian = false;
  std::string bytes;
  [[nodiscard]] std::size_t count() const { return std::size_t(size[0]) * std::size_t(size[1]) * std::size_t(size[2]); }
};

/// The fields of one file's header, found by name in any case. Every complaint is an Error(bad_input) that names file
/// and field.
class LabelHeader {
public:
  explicit LabelHeader(std::filesystem::path file) : file_(std::move(file)) {}

  [[noreturn]] void fail(const std::string& field, const std::string& what) const;
  void set(const std::string& field, std::string value);
  /// The first of these names that the header has.
  [[nodiscard]] std::optional<std::string> get(std::initializer_list<const char*> names) const;
  [[nodiscard]] std::string need(std::initializer_list<const char*> names) const;

  /// Exactly `count` finite numbers; parentheses and commas of vectors count as blanks.
  [[nodiscard]] std::vector<double> numbers(const std::string& field, std::string value, std::size_t count) const;
  [[nodiscard]] std::array<int, 3> size(const std::string& field, const std::string& value) const;
  [[nodiscard]] VoxelType type(const std::string& field, const std::string& name,
                               const std::map<std::string, VoxelType>& known) const;
  /// `axes` holds the step of one index after that of the other, `unit` is the length (m) of the file's coordinates.
  void set_frame(VoxelData& data, const std::string& field, const std::vector<double>& axes,
                 const std::vector<double>& origin, double unit) const;
  /// A length unit that the header itself names has to be the scene's; names that are no lengths say nothing.
  void check_unit(const std::string& field, const std::string& name, double unit) const;
  /// Content of the one file beside this one that `field` names.
  [[nodiscard]] std::string data_beside(const std::string& field, const std::string& name) const;

private:
  std::filesystem::path file_;
  std::map<std::string, std::string> fields_;
};

std::string lower(std::string text);
std::string trimmed(std::string_view text);
/// The beginning of a line, in quotes, for messages.
std::string beginning(const std::string& line);

/// Readers of the two formats: the header's fields into `header`, and what they say of the voxels.
VoxelData read_nrrd(const std::string& bytes, LabelHeader& header, double unit);
VoxelData read_meta_image(const std::string& bytes, LabelHeader& header, double unit);

}  // namespace palpate::detail
