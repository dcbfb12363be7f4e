// SPDX-License-Identifier: GPL-3.0-or-later
// A study as hospitals have it (an organ, a tumour, a vessel; turned axes, thick slices, compressed): every format ends
// in the same body, and what scene --from proposes prepares without editing.
#include "formats/scene/scene.hpp"
#include "precompute/common/body.hpp"
#include "precompute/geometry/topology.hpp"
#include "precompute/surface/propose.hpp"
#include "precompute/surface/repair/report.hpp"
#include "tests/image/label_files.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>

namespace palpate::test {
namespace {

using Eigen::Vector3d;

struct Prepared {
  Scene scene;
  Body body;
};

Prepared prepared(const TemporaryFolder& scratch, const std::filesystem::path& file) {
  const surface::Proposal proposal = surface::propose_scene(file, scratch.path());
  const auto scene_file = scratch.write(file.filename().string() + ".toml", proposal.scene);
  Prepared result;
  result.scene = read_scene(scene_file);
  result.body = prepare_body(result.scene);
  return result;
}

Vector3d middle(const Surface& surface) {
  Vector3d sum(0, 0, 0);
  double six = 0;
  const Vector3d origin = surface.vertices.front();
  for (const auto& t : surface.triangles) {
    const Vector3d a = surface.vertices[std::size_t(t[0])] - origin, b = surface.vertices[std::size_t(t[1])] - origin,
                   c = surface.vertices[std::size_t(t[2])] - origin;
    const double v = a.dot(b.cross(c));
    six += v;
    sum += v * (a + b + c) / 4;
  }
  return origin + sum / six;
}

TEST(Study, EveryFormatEndsInTheSameBody) {
  const TemporaryFolder scratch;
  const Voxels v = Study::voxels();
  const std::vector<std::pair<std::string, std::string>> files{
      {"study.nii.gz", nifti(v, true)}, {"study.nrrd", nrrd_file(v, true)}, {"study.mha", meta(v, true)}};
  std::shared_ptr<const geometry::SurfaceQuery> first;
  for (const auto& [name, bytes] : files) {
    SCOPED_TRACE(name);
    const Prepared p = prepared(scratch, scratch.write(name, bytes));
    EXPECT_EQ(p.scene.frame, Frame::lps);
    EXPECT_NEAR(p.body.report.volume / Study::organ_volume(), 1, 0.01);
    ASSERT_EQ(p.body.inclusions.size(), 2U);
    EXPECT_NEAR(p.body.inclusions[0].report.volume / Study::tumour_volume(), 1, 0.01);
    EXPECT_LT((middle(p.body.inclusions[0].query->surface()) - 1e-3 * Study::tumour).norm(), 0.3e-3);
    EXPECT_LT((middle(p.body.query->surface()) - 1e-3 * Study::organ).norm(), 0.3e-3);
    if (!first) {
      first = p.body.query;
      continue;
    }
    // A tenth of the smallest voxel edge.
    EXPECT_LT(surface::distances(p.body.query->surface(), *first).first, 0.15e-3);
    EXPECT_LT(surface::distances(first->surface(), *p.body.query).first, 0.15e-3);
  }
}

// One organ a file, the tumour's voxels cut out of the organ's; and a segmentation of Slicer's with names.
TEST(Study, AFolderAndNamedSegmentsSayWhatIsWhat) {
  const TemporaryFolder scratch;
  const Voxels v = Study::voxels();
  const auto only = [&](int value) {
    Voxels one = v;
    for (auto& x : one.values) x = x == value ? 1 : 0;
    return one;
  };
  std::filesystem::create_directory(scratch.path() / "segmentations");
  scratch.write("segmentations/liver.nii.gz", nifti(only(1), true));
  scratch.write("segmentations/liver_tumor.nii.gz", nifti(only(2), true));
  scratch.write("segmentations/portal_vein.nii.gz", nifti(only(3), true));
  const std::string keys =
      "Segment0_Name:=liver\nSegment0_LabelValue:=1\nSegment0_Layer:=0\n"
      "Segment1_Name:=liver_tumor\nSegment1_LabelValue:=2\nSegment1_Layer:=0\n"
      "Segment2_Name:=portal_vein\nSegment2_LabelValue:=3\nSegment2_Layer:=0\n";
  const auto seg = scratch.write("study.seg.nrrd", nrrd_file(v, true, "left-posterior-superior", keys));
  for (const auto& from : {scratch.path() / "segmentations", seg}) {
    SCOPED_TRACE(from.string());
    const Prepared p = prepared(scratch, from);
    EXPECT_EQ(p.scene.material.tissue, "liver");
    ASSERT_EQ(p.body.inclusions.size(), 1U);
    EXPECT_EQ(p.body.inclusions[0].name, "liver_tumor");
    EXPECT_EQ(p.scene.regions[0].material.tissue, "liver-tumour");
    ASSERT_EQ(p.scene.cavities.size(), 1U);
    EXPECT_EQ(p.scene.cavities[0].name, "portal_vein");
    EXPECT_FALSE(p.body.cavity.empty());
    // The vessel is hollow now.
    EXPECT_NEAR(p.body.report.volume / (Study::organ_volume() - 1.46e-6), 1, 0.01);
  }
}

}  // namespace
}  // namespace palpate::test
