// SPDX-License-Identifier: GPL-3.0-or-later
// Label images of every format hold the same voxels at the same places; damaged and hostile ones end with a message.
#include "formats/image/label_image.hpp"

#include "tests/image/label_files.hpp"
#include "tests/surface_io/scratch.hpp"

#include <gtest/gtest.h>

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
      {"huge.mha", with(mha, "DimSize = 5 4 3", "DimSize = 60000 60000 60000"), {"2^29"}},
      {"many.mha", with(mha, "NDims = 3", "NDims = 99"), {"NDims"}},
      {"pattern.mhd", with(mha, "LOCAL", "slice%03d.raw"), {"ElementDataFile"}},
      {"singular.mha",
       with(mha, "TransformMatrix =", "TransformMatrix = 1 0 0 1 0 0 0 0 1\nComment ="),
       {"singular.mha"}},
      {"huge.nii", huge, {"2^29"}},
      {"endless.nii", endless, {"endless.nii", "srow", "not finite"}},
      {"endless.nrrd", with(nrrd, "space origin: (10,", "space origin: (inf,"), {"space origin"}},
      {"nine.nii", dimensions, {"nine.nii"}},
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
