// SPDX-License-Identifier: GPL-3.0-or-later
// Label images of every format hold the same voxels at the same places; damaged and hostile ones end with a message.
#include "formats/image/label_image.hpp"
#include "formats/image/gzip.hpp"

#include "tests/image/label_files.hpp"
#include "tests/surface_io/scratch.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <random>

namespace palpate {
namespace {

using Eigen::Vector3d;
using test::expect_error;
using test::Scratch;
using test::Voxels;

Voxels small_image() {
  Voxels v;
  v.size = {5, 4, 3};
  v.origin = {10, -20, 30};
  v.axes << 0, -2, 0, 1.5, 0, 0, 0, 0, 4;
  v.fill([](const Vector3d& p) { return p.z() > 33 ? 7 : p.x() > 8 ? 2 : 0; });
  return v;
}

struct Written {
  std::string name, bytes;
};

std::vector<Written> all_formats(const Voxels& v) {
  return {{"a.nii", test::nifti(v, false)},      {"b.nii.gz", test::nifti(v, true)},
          {"c.nrrd", test::nrrd_file(v, false)}, {"d.nrrd", test::nrrd_file(v, true)},
          {"e.mha", test::meta(v, false)},       {"f.mha", test::meta(v, true)}};
}

TEST(LabelImage, EveryFormatHoldsTheSameVoxels) {
  const Scratch scratch;
  const Voxels v = small_image();
  for (const auto& [name, bytes] : all_formats(v)) {
    SCOPED_TRACE(name);
    const LabelImage image = read_label_image(scratch.write(name, bytes), 0);
    EXPECT_EQ(image.frame, Frame::lps);
    EXPECT_EQ(image.size, v.size);
    EXPECT_LT((image.origin - 1e-3 * v.origin).norm(), 1e-8);
    EXPECT_LT((image.axes - 1e-3 * v.axes).norm(), 1e-8);
    ASSERT_EQ(image.values.size(), v.values.size());
    for (std::size_t k = 0; k < v.values.size(); ++k) ASSERT_EQ(image.values[k], v.values[k]) << k;
    const auto extents = label_extents(image);
    ASSERT_EQ(extents.size(), 2U);
    EXPECT_EQ(extents[1].value, 7);
    EXPECT_EQ(extents[1].voxels, 40U);
    EXPECT_EQ(extents[1].low, (std::array<int, 3>{0, 0, 1}));
  }
}

/// A header of NIfTI-1 with other fields: bytes at these places.
class NiftiHeader {
public:
  explicit NiftiHeader(std::string file) : file_(std::move(file)) {}
  template <class Number>
  NiftiHeader& set(std::size_t at, Number value) {
    std::memcpy(file_.data() + at, &value, sizeof value);
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return file_; }

private:
  std::string file_;
};

constexpr std::size_t kDim = 40, kType = 70, kBits = 72, kPixdim = 76, kVoxels = 108, kSlope = 112, kIntercept = 116,
                      kUnits = 123, kQformCode = 252, kSformCode = 254, kQuatern = 256, kOffset = 268, kSrow = 280;

// nibabel, and with it TotalSegmentator, writes an sform alone. Its numbers have single precision.
TEST(LabelImage, NiftiIsReadAtEveryTurnPlaceAndSpacing) {
  const Scratch scratch;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> angle(-1, 1), place(-900, 900), spacing(0.3, 5);
  for (int n = 0; n < 100; ++n) {
    SCOPED_TRACE(n);
    Voxels v = small_image();
    v.axes = (Eigen::AngleAxisd(angle(random), Vector3d::UnitZ()) *
              Eigen::AngleAxisd(angle(random), Vector3d::UnitX()) * Eigen::AngleAxisd(angle(random), Vector3d::UnitY()))
                 .toRotationMatrix() *
             Vector3d(spacing(random), spacing(random), n % 2 == 0 ? spacing(random) : -spacing(random)).asDiagonal();
    v.origin = {place(random), place(random), place(random)};
    const LabelImage image = read_label_image(scratch.write("a.nii", test::nifti(v, false)), 0);
    EXPECT_EQ(image.frame, Frame::lps);
    EXPECT_LT((image.origin - 1e-3 * v.origin).norm(), 1e-7);
    EXPECT_LT((image.axes - 1e-3 * v.axes).norm(), 1e-8);
  }
}

TEST(LabelImage, NiftiTakesTheUnitAndTheShearOfItsHeader) {
  const Scratch scratch;
  Voxels v = small_image();
  v.axes(0, 1) += 0.4;
  for (const auto& [unit, length] : {std::pair{1, 1e-3}, {2, 1.0}, {3, 1e3}, {0, 1.0}}) {
    SCOPED_TRACE(unit);
    Voxels scaled = v;
    scaled.axes *= length;
    scaled.origin *= length;
    const auto file = scratch.write("a.nii", NiftiHeader(test::nifti(scaled, false)).set(kUnits, char(unit)).bytes());
    const LabelImage image = read_label_image(file, 0);
    EXPECT_LT((image.origin - 1e-3 * v.origin).norm(), 1e-8);
    EXPECT_LT((image.axes - 1e-3 * v.axes).norm(), 1e-9);
  }
}

TEST(LabelImage, NiftiPrefersThePlaceInTheScanner) {
  const Scratch scratch;
  const Voxels v = small_image();
  // A half turn about z, spacing 2, 1.5, 4.
  const auto with_qform = [&](int sform) {
    return NiftiHeader(test::nifti(v, false))
        .set(kQformCode, std::int16_t{1})
        .set(kSformCode, std::int16_t(sform))
        .set(kPixdim, 1.0F)
        .set(kQuatern, 0.0F)
        .set(kQuatern + 4, 0.0F)
        .set(kQuatern + 8, 1.0F)
        .set(kOffset, 5.0F)
        .set(kOffset + 4, 6.0F)
        .set(kOffset + 8, 7.0F)
        .bytes();
  };
  for (const int template_or_none : {0, 3, 4}) {
    SCOPED_TRACE(template_or_none);
    const LabelImage image = read_label_image(scratch.write("a.nii", with_qform(template_or_none)), 0);
    EXPECT_EQ(image.frame, Frame::lps);
    EXPECT_LT((image.origin - 1e-3 * Vector3d(-5, -6, 7)).norm(), 1e-8);
    EXPECT_LT((image.axes - 1e-3 * Eigen::Matrix3d(Vector3d(1.5, 2, 4).asDiagonal())).norm(), 1e-8);
  }
  for (const int scanner : {1, 2}) {
    const LabelImage image = read_label_image(scratch.write("a.nii", with_qform(scanner)), 0);
    EXPECT_LT((image.origin - 1e-3 * v.origin).norm(), 1e-8);
  }
  // Neither: the voxels' size in no frame.
  const auto bare = NiftiHeader(test::nifti(v, false)).set(kSformCode, std::int16_t{0}).bytes();
  const LabelImage image = read_label_image(scratch.write("a.nii", bare), 0);
  EXPECT_EQ(image.frame, Frame::unstated);
  EXPECT_LT((image.axes - 1e-3 * Eigen::Matrix3d(Vector3d(1.5, 2, 4).asDiagonal())).norm(), 1e-8);
}

TEST(LabelImage, NiftiLabelsOfEveryTypeAreScaled) {
  const Scratch scratch;
  const Voxels v = small_image();
  const std::string plain = test::nifti(v, false);
  const auto of_type = [&](auto number, int type, float slope, float intercept) {
    using Number = decltype(number);
    std::string bytes = NiftiHeader(plain.substr(0, 352))
                            .set(kType, std::int16_t(type))
                            .set(kBits, std::int16_t(8 * sizeof(Number)))
                            .set(kSlope, slope)
                            .set(kIntercept, intercept)
                            .bytes();
    for (const auto value : v.values) {
      const auto stored = Number(slope != 0 ? (float(value) - intercept) / slope : float(value));
      bytes.append(reinterpret_cast<const char*>(&stored), sizeof stored);
    }
    return bytes;
  };
  const std::vector<std::int32_t> expected(v.values.begin(), v.values.end());
  for (const auto& bytes :
       {of_type(std::int8_t{}, 256, 0, 0), of_type(std::int16_t{}, 4, 1, 0), of_type(std::int16_t{}, 4, 0.5F, 0),
        of_type(std::uint16_t{}, 512, 0.1F, 0), of_type(std::int32_t{}, 8, 1, -3), of_type(std::uint32_t{}, 768, 0, 0),
        of_type(std::int64_t{}, 1024, 0, 0), of_type(float{}, 16, 0, 0), of_type(double{}, 64, 2, 1)}) {
    EXPECT_EQ(read_label_image(scratch.write("a.nii", bytes), 0).values, expected);
  }
  const auto half = of_type(std::int16_t{}, 4, 1, 0);
  expect_error([&] { read_label_image(scratch.write("a.nii", NiftiHeader(half).set(kSlope, 0.25F).bytes()), 0); },
               ExitCode::bad_input, {"a.nii", "not a scan"});
  expect_error(
      [&] { read_label_image(scratch.write("a.nii", NiftiHeader(plain).set(kType, std::int16_t{128}).bytes()), 0); },
      ExitCode::bad_input, {"a.nii"});
}

TEST(LabelImage, RasNrrdIsTurnedAndOneWithoutASpaceIsNot) {
  const Scratch scratch;
  Voxels v = small_image();
  const LabelImage plain = read_label_image(scratch.write("plain.nrrd", test::nrrd_file(v, false, "")), 0.01);
  EXPECT_EQ(plain.frame, Frame::unstated);
  EXPECT_LT((plain.origin - 1e-2 * v.origin).norm(), 1e-12);
  const LabelImage ras =
      read_label_image(scratch.write("ras.nrrd", test::nrrd_file(v, false, "right-anterior-superior")), 0);
  EXPECT_EQ(ras.frame, Frame::lps);
  EXPECT_LT((ras.origin - 1e-3 * Vector3d(-10, 20, 30)).norm(), 1e-12);
  const LabelImage mha = read_label_image(scratch.write("a.mha", test::meta(v, false, "")), 0);
  EXPECT_EQ(mha.frame, Frame::unstated);
}

TEST(LabelImage, UnitOfTheFileIsTakenAndAContradictionIsRefused) {
  const Scratch scratch;
  const Voxels v = small_image();
  const auto cm = scratch.write(
      "cm.nrrd", test::nrrd_file(v, false, "left-posterior-superior", "space units: \"cm\" \"cm\" \"cm\"\n"));
  EXPECT_NEAR(read_label_image(cm, 0).origin.x(), 0.1, 1e-12);
  expect_error([&] { read_label_image(cm, 1e-3); }, ExitCode::bad_input, {"cm.nrrd", "states a unit of 0.01 m"});
  Voxels tiny = v;
  tiny.axes *= 1e-3;
  const auto metres = scratch.write("metres.nrrd", test::nrrd_file(tiny, false));
  expect_error([&] { read_label_image(metres, 0); }, ExitCode::bad_input, {"too small for an organ", "units = \"m\""});
  EXPECT_NEAR(read_label_image(metres, 1).axes(2, 2), 4e-3, 1e-12);
}

TEST(LabelImage, UnitsOfEverySpellingAreTakenAndUnknownOnesAreAQuestion) {
  const Scratch scratch;
  const auto in = [&](const std::string& unit, double length) {
    Voxels v = small_image();
    v.axes *= 1e-3 / length;
    const std::string three = "space units: \"" + unit + "\" \"" + unit + "\" \"" + unit + "\"\n";
    return scratch.write("a.nrrd", test::nrrd_file(v, false, "left-posterior-superior", three));
  };
  for (const auto& [unit, length] : {std::pair{"mm", 1e-3},
                                     {"Millimeters", 1e-3},
                                     {"cm", 1e-2},
                                     {"m", 1.0},
                                     {"micrometre", 1e-6},
                                     {"\u00b5m", 1e-6},
                                     {"???", 1e-3}}) {
    SCOPED_TRACE(unit);
    EXPECT_NEAR(read_label_image(in(unit, length), 0).axes(2, 2), 4e-3, 1e-9);
  }
  EXPECT_NEAR(read_label_image(in("furlong", 1e-3), 1e-3).axes(2, 2), 4e-3, 1e-9);
  expect_error([&] { read_label_image(in("furlong", 1), 0); }, ExitCode::bad_input, {"a.nrrd", "'furlong'", "units ="});
}

TEST(LabelImage, SegmentsOfSlicerGoByNameAndLayer) {
  const Scratch scratch;
  Voxels first = small_image(), second = first;
  second.fill([](const Vector3d& p) { return p.z() < 31 ? 1 : 0; });
  const std::string keys =
      "Segment0_ID:=Segment_1\nSegment0_LabelValue:=7\nSegment0_Layer:=0\nSegment0_Name:=liver\n"
      "Segment1_ID:=Segment_2\nSegment1_LabelValue:=1\nSegment1_Layer:=1\nSegment1_Name:=portal vein\n";
  const auto file = scratch.write("a.seg.nrrd", test::seg_nrrd({first, second}, keys, true));
  const LabelImage image = read_label_image(file, 0);
  ASSERT_EQ(image.segments.size(), 2U);
  EXPECT_EQ(image.segments[1].name, "portal vein");
  LabelSource source;
  source.segments = {"portal vein"};
  EXPECT_EQ(label_mask(image, source, MaskUse::region).count, 20U);
  source.segments = {"liver"};
  EXPECT_EQ(label_mask(image, source, MaskUse::region).count, 40U);
  source.segments = {"spleen"};
  expect_error([&] { label_mask(image, source, MaskUse::region); }, ExitCode::bad_input,
               {"no segment 'spleen'", "liver, portal vein"});
  source = {};
  source.values = {7};
  expect_error([&] { label_mask(image, source, MaskUse::region); }, ExitCode::bad_input, {"2 layers", "segment ="});
}

TEST(LabelImage, AMissingValueListsThoseThatAreThere) {
  const Scratch scratch;
  const LabelImage image = read_label_image(scratch.write("a.nrrd", test::nrrd_file(small_image(), false)), 0);
  LabelSource source;
  source.values = {3};
  expect_error([&] { label_mask(image, source, MaskUse::region); }, ExitCode::bad_input,
               {"no voxel has the label 3", "there are: 2, 7"});
}

LabelImage image_of(const std::vector<std::int32_t>& values, std::array<int, 3> size) {
  LabelImage image;
  image.file = "made";
  image.size = size;
  image.axes = 1e-3 * Eigen::Matrix3d::Identity();
  image.values = values;
  return image;
}

TEST(LabelMask, SpecksAreDroppedHolesFilledAndLargeIslandsAreAQuestion) {
  std::vector<std::int32_t> values(30 * 20 * 20, 0);
  const auto at = [&](int i, int j, int k) -> std::int32_t& { return values[std::size_t((k * 20 + j) * 30 + i)]; };
  for (int k = 2; k < 18; ++k) {
    for (int j = 2; j < 18; ++j) {
      for (int i = 2; i < 18; ++i) at(i, j, k) = 1;
    }
  }
  at(9, 9, 9) = 0;   // a hole of one voxel
  at(25, 5, 5) = 1;  // a speck
  LabelSource source;
  source.values = {1};
  const LabelMask mask = label_mask(image_of(values, {30, 20, 20}), source, MaskUse::body);
  EXPECT_EQ(mask.count, 16U * 16U * 16U);
  ASSERT_EQ(mask.notes.size(), 2U);
  EXPECT_NE(mask.notes[0].find("dropped 1 islands"), std::string::npos) << mask.notes[0];
  EXPECT_NE(mask.notes[1].find("filled 1 holes"), std::string::npos) << mask.notes[1];
  for (int k = 2; k < 10; ++k) {
    for (int j = 2; j < 10; ++j) {
      for (int i = 20; i < 30; ++i) at(i, j, k) = 1;
    }
  }
  const LabelImage two = image_of(values, {30, 20, 20});
  expect_error([&] { label_mask(two, source, MaskUse::body); }, ExitCode::bad_input,
               {"2 islands: 4.1 mL", "0.64 mL", "islands = \"largest\""});
  EXPECT_EQ(label_mask(two, source, MaskUse::region).count, 4096U + 640U);
  source.islands = Islands::largest;
  EXPECT_EQ(label_mask(two, source, MaskUse::body).count, 4096U);
  source.islands = Islands::all;
  const LabelMask all = label_mask(two, source, MaskUse::body);
  EXPECT_EQ(all.count, 4096U + 640U);
  ASSERT_FALSE(all.notes.empty());
  EXPECT_NE(all.notes.back().find("cut by the image's border (last voxels along i"), std::string::npos);
}

TEST(LabelImage, EveryTruncationIsRefused) {
  const Scratch scratch;
  const Voxels v = test::Study::voxels(3);
  for (const auto& [name, bytes] : all_formats(v)) {
    for (const double share : {0.0, 0.01, 0.3, 0.6, 0.97}) {
      SCOPED_TRACE(name + " " + std::to_string(share));
      const auto file = scratch.write(name, bytes.substr(0, std::size_t(share * double(bytes.size()))));
      expect_error([&] { read_label_image(file, 0); }, ExitCode::bad_input, {name});
    }
    const auto file = scratch.write(name, bytes.substr(0, bytes.size() - 9));
    SCOPED_TRACE(name + " less nine bytes");
    expect_error([&] { read_label_image(file, 0); }, ExitCode::bad_input, {name});
  }
}

TEST(Gzip, NoMoreThanEnoughIsExpanded) {
  const Scratch scratch;
  constexpr std::size_t kWhole = std::size_t{64} << 20U;
  for (const bool gzip : {false, true}) {
    const auto file = scratch.write("zeros", test::deflated(std::string(kWhole, '\0'), gzip));
    EXPECT_EQ(detail::whole_size(file, 0, !gzip, kWhole), kWhole);
    const std::size_t some = detail::whole_size(file, 0, !gzip, 1000);
    EXPECT_GT(some, 1000U);
    EXPECT_LT(some, std::size_t{1} << 20U);
  }
}

TEST(LabelImage, HostileHeadersAreRefused) {
  const Scratch scratch;
  const std::string nrrd = test::nrrd_file(small_image(), false), mha = test::meta(small_image(), false);
  const auto with = [](std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  };
  std::string nifti = test::nifti(small_image(), false), huge = nifti, dimensions = nifti;
  const std::int16_t most = 32767, nine = 9;
  for (std::size_t k = 0; k < 3; ++k) std::memcpy(huge.data() + 42 + 2 * k, &most, 2);
  std::memcpy(dimensions.data() + 40, &nine, 2);
  std::string endless = nifti;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(endless.data() + 284, &nan, 4);
  struct Bad {
    const char* name;
    std::string bytes;
    std::vector<std::string> pieces;
  };
  const std::vector<Bad> all{
      {"huge.nrrd", with(nrrd, "sizes: 5 4 3", "sizes: 60000 60000 60000"), {"2^29"}},
      {"negative.nrrd", with(nrrd, "sizes: 5 4 3", "sizes: -5 4 3"), {"sizes"}},
      {"flat.nrrd", with(nrrd, "dimension: 3", "dimension: 2"), {"dimension"}},
      {"more.nrrd", with(nrrd, "dimension: 3", "dimension: 17"), {"dimension"}},
      {"list.nrrd", with(nrrd, "endian: little", "endian: little\ndata file: LIST"), {"data file"}},
      {"left-handed.nrrd", with(nrrd, "left-posterior-superior", "left-anterior-superior"), {"space", "LPS, RAS"}},
      {"huge.mha", with(mha, "DimSize = 5 4 3", "DimSize = 60000 60000 60000"), {"2^29"}},
      {"many.mha", with(mha, "NDims = 3", "NDims = 99"), {"NDims"}},
      {"pattern.mhd", with(mha, "LOCAL", "slice%03d.raw"), {"ElementDataFile"}},
      {"singular.mha",
       with(mha, "TransformMatrix =", "TransformMatrix = 1 0 0 1 0 0 0 0 1\nComment ="),
       {"singular.mha"}},
      {"huge.nii", huge, {"2^29"}},
      {"endless.nii", endless, {"endless.nii", "srow", "not finite"}},
      {"endless.nrrd", with(nrrd, "space origin: (10,", "space origin: (inf,"), {"space origin"}},
      {"nine.nii", dimensions, {"nine.nii", "has 9 dimensions"}},
      {"flat.nii", NiftiHeader(nifti).set(kDim + 4, std::int16_t{0}).bytes(), {"dim[2]: got 0"}},
      {"many.nii",
       NiftiHeader(nifti).set(kDim, std::int16_t{4}).set(kDim + 8, std::int16_t{2}).bytes(),
       {"three dimensions"}},
      {"before.nii", NiftiHeader(nifti).set(kVoxels, 0.0F).bytes(), {"vox_offset: got 0"}},
      {"far.nii", NiftiHeader(nifti).set(kVoxels, 1e9F).bytes(), {"far.nii", "cut short"}},
      {"farther.nii", NiftiHeader(nifti).set(kVoxels, 3e9F).bytes(), {"vox_offset: got 3e+09"}},
      {"mixed.Nii", nifti, {"mixed.Nii", "one case"}},
      {"packed.nii", test::nifti(small_image(), true), {"packed.nii", "end in .nii.gz"}},
      {"text.nii", "this is no image", {"text.nii"}},
      {"image.png", "x", {"unknown image format '.png'", ".nii.gz"}},
  };
  for (const Bad& bad : all) {
    SCOPED_TRACE(bad.name);
    expect_error([&] { read_label_image(scratch.write(bad.name, bad.bytes), 0); }, ExitCode::bad_input, bad.pieces);
  }
  expect_error([&] { read_label_image(scratch / "none.nii", 0); }, ExitCode::io, {"none.nii"});
  const auto lost = scratch.write("lost.mhd", with(mha, "LOCAL", "none.raw"));
  expect_error([&] { read_label_image(lost, 0); }, ExitCode::io, {"none.raw"});
}

TEST(LabelImage, AScanIsNoLabelImage) {
  const Scratch scratch;
  const std::string head = "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 1 1\nspacings: 1 1 1\nencoding: ascii\n\n";
  const auto labels = scratch.write("labels.nrrd", head + "0 3\n");
  EXPECT_EQ(read_label_image(labels, 0).values, (std::vector<std::int32_t>{0, 3}));
  const auto scan = scratch.write("scan.nrrd", head + "0 3.25\n");
  expect_error([&] { read_label_image(scan, 0); }, ExitCode::bad_input, {"voxel 1 has the value 3.25", "not a scan"});
}

}  // namespace
}  // namespace palpate
