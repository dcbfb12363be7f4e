// SPDX-License-Identifier: GPL-3.0-or-later
// Label images in every layout that is read, and a table of what is refused.
#include "formats/label_image.hpp"
#include "tests/surface_io/scratch.hpp"

namespace palpate::test {
namespace {

using Eigen::Vector3d;

// 3 x 2 x 2 voxels; the label 300 stands at (1, 0, 0) and (2, 1, 1).
const std::vector<int> voxels = {0, 300, 0, 7, 0, 0, 0, 0, 0, 0, -1, 300};

std::string raw16(bool big) {
  std::string bytes;
  for (const int v : voxels) {
    const char low = static_cast<char>(v & 0xff), high = static_cast<char>((v >> 8) & 0xff);
    bytes += big ? high : low;
    bytes += big ? low : high;
  }
  return bytes;
}

std::string text() {
  std::string all;
  for (const int v : voxels) all += std::to_string(v) + " ";
  return all + "\n";
}

const std::string nrrd_head =
    "NRRD0004\n# made by hand\ntype: short\ndimension: 3\nsizes: 3 2 2\nspace: left-posterior-superior\n"
    "space directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (10,20,30)\nkey:=value\n";
const std::string meta_head =
    "ObjectType = Image\nNDims = 3\nDimSize = 3 2 2\nElementSpacing = 2 3 4\nOffset = 10 20 30\n"
    "TransformMatrix = 1 0 0 0 1 0 0 0 1\nElementType = MET_SHORT\n";

void expect_the_image(const std::filesystem::path& file) {
  const LabelMask mask = read_label_mask({file, {}, 0.001}, 300);
  EXPECT_EQ(mask.count, 2U);
  EXPECT_EQ(mask.size, (std::array<int, 3>{3, 2, 2}));
  ASSERT_EQ(mask.inside.size(), 12U);
  EXPECT_EQ(mask.inside[1] + mask.inside[11], 2);
  EXPECT_LT((mask.origin + mask.axes * Vector3d(2, 1, 1) - Vector3d(0.014, 0.023, 0.034)).norm(), 1e-15);
  EXPECT_EQ(read_label_mask({file, {}, 0.001}, -1).count, 1U);
}

TEST(LabelImages, EveryLayoutGivesTheSameVoxels) {
  const Scratch scratch;
  expect_the_image(scratch.write("a.nrrd", nrrd_head + "encoding: raw\nendian: little\n\n" + raw16(false)));
  expect_the_image(scratch.write("b.nrrd", nrrd_head + "encoding: raw\nendian: big\n\n" + raw16(true)));
  expect_the_image(scratch.write("c.nrrd", nrrd_head + "encoding: ascii\n\n" + text()));
  scratch.write("voxels.raw", raw16(false));
  expect_the_image(scratch.write("d.nhdr", nrrd_head + "encoding: raw\nendian: little\ndata file: voxels.raw\n"));
  expect_the_image(scratch.write("e.mha", meta_head + "ElementDataFile = LOCAL\n" + raw16(false)));
  expect_the_image(scratch.write("f.mhd", meta_head + "ElementDataFile = voxels.raw\n"));
  expect_the_image(
      scratch.write("g.mha", meta_head + "BinaryDataByteOrderMSB = True\nElementDataFile = LOCAL\n" + raw16(true)));
  expect_the_image(scratch.write("h.mha", meta_head + "BinaryData = False\nElementDataFile = LOCAL\n" + text()));
  std::string crlf;
  for (const char c : nrrd_head + "encoding: ascii\n\n") crlf += c == '\n' ? "\r\n" : std::string(1, c);
  expect_the_image(scratch.write("i.nrrd", crlf + text()));
}

TEST(LabelImages, TurnedAxesAndBareSpacings) {
  const Scratch scratch;
  std::string head = meta_head;
  head.replace(head.find("1 0 0 0 1 0 0 0 1"), 17, "0 1 0 -1 0 0 0 0 1");
  const LabelMask turned =
      read_label_mask({scratch.write("a.mha", head + "ElementDataFile = LOCAL\n" + raw16(false)), {}, 1}, 7);
  EXPECT_EQ(turned.axes.col(0), Vector3d(0, 2, 0));
  EXPECT_EQ(turned.axes.col(1), Vector3d(-3, 0, 0));
  const LabelMask plain = read_label_mask(
      {scratch.write("b.nrrd",
                     "NRRD0001\ntype: uchar\ndimension: 3\nsizes: 2 1 1\nspacings: 1 2 3\nencoding: text\n\n0 4\n"),
       {},
       1},
      4);
  EXPECT_EQ(plain.axes.diagonal(), Vector3d(1, 2, 3));
  EXPECT_EQ(plain.origin, Vector3d(0, 0, 0));
  // A unit that the file names itself is the scene's.
  std::string in_mm = nrrd_head;
  in_mm.replace(in_mm.find("key:=value"), 10, "space units: \"mm\" \"mm\" \"mm\"");
  expect_the_image(scratch.write("c.nrrd", in_mm + "encoding: ascii\n\n" + text()));
}

TEST(LabelImages, BadOnesNameFieldAndCause) {
  const Scratch scratch;
  const auto nrrd = [](const std::string& from, const std::string& to, const std::string& tail) {
    std::string head = nrrd_head;
    if (!from.empty()) head.replace(head.find(from), from.size(), to);
    return head + tail;
  };
  const std::string ascii = "encoding: ascii\n\n" + text(), raw = "encoding: raw\nendian: little\n\n";
  const auto meta = [](const std::string& extra, const std::string& tail) {
    return meta_head + extra + "ElementDataFile = " + tail;
  };
  const struct {
    const char* name;
    std::string bytes;
    std::vector<std::string> expected;
  } bad[] = {
      {"a.nii", "x", {"unknown image format '.nii'", ".nrrd"}},
      {"b.nrrd", "", {"does not begin with NRRD"}},
      {"c.nrrd", nrrd("dimension: 3", "dimension: 4", ascii), {"dimension: got 4; allowed 3"}},
      {"d.nrrd", nrrd("sizes: 3 2 2", "sizes: 3 2", ascii), {"sizes: got 2 numbers; allowed 3"}},
      {"e.nrrd", nrrd("sizes: 3 2 2", "sizes: 3 2.5 2", ascii), {"sizes: allowed: whole numbers"}},
      {"f.nrrd", nrrd("sizes: 3 2 2", "sizes: 65536 65536 65536", ascii), {"more than 2^31 voxels"}},
      {"g.nrrd", nrrd("sizes: 3 2 2\n", "", ascii), {"sizes: missing"}},
      {"h.nrrd", nrrd("type: short", "type: float", ascii), {"type: got 'float'", "8, 16 or 32 bits"}},
      {"i.nrrd", nrrd("", "", "encoding: gzip\n\nxx"), {"encoding: got 'gzip'; allowed: raw, ascii"}},
      {"j.nrrd", nrrd("", "", "encoding: raw\n\n" + raw16(false)), {"endian: missing"}},
      {"k.nrrd", nrrd("", "", raw + raw16(false).substr(1)), {"take 24 bytes, there are 23"}},
      {"l.nrrd", nrrd("", "", raw + raw16(false) + "x"), {"take 24 bytes, there are 25"}},
      {"m.nrrd", nrrd("", "", "encoding: raw\nendian: little\n"), {"no end"}},
      {"n.nrrd", nrrd("", "", "encoding: ascii\n\n1 2 3\n"), {"3 voxels are there, 12"}},
      {"o.nrrd", nrrd("", "", "encoding: ascii\n\n1 2 x 4\n"), {"voxel 2 is not a whole number"}},
      {"p.nrrd", nrrd("(0,3,0)", "(4,0,0)", ascii), {"space directions", "span no space"}},
      {"q.nrrd", nrrd("(0,3,0)", "none", ascii), {"space directions", "allowed: numbers"}},
      {"r.nrrd", nrrd("key:=value", "nonsense", ascii), {"'nonsense' is not a field"}},
      {"s.nrrd", nrrd("key:=value", "type: int", ascii), {"type: stands twice"}},
      {"t.nrrd", nrrd("", "", "encoding: raw\nendian: little\nbyte skip: 4\n\n"), {"byte skip: allowed: 0"}},
      {"u.nrrd", nrrd("", "", "encoding: raw\nendian: middle\n\n"), {"endian: got 'middle'"}},
      {"3.nrrd", nrrd("key:=value", "axis mins: 0 0 0", ascii), {"axis mins: not allowed", "'space origin'"}},
      {"4.nrrd",
       nrrd("key:=value", "space units: \"mm\" \"mm\" \"mm\"", ascii),
       {"space units: the file is in mm", "units = \"mm\""}},
      {"5.nrrd", nrrd("sizes: 3 2 2", "sizes: 65536 32768 1", raw + "x"), {"take 4294967296 bytes, there are 1"}},
      {"6.nrrd", nrrd("sizes: 3 2 2", "sizes: 65536 32768 1", ascii), {"12 voxels are there, 2147483648"}},
      {"7.nrrd", nrrd("(10,20,30)", "(10,nan,30)", ascii), {"space origin", "allowed: numbers"}},
      {"8.mha", meta("DistanceUnits = um\n", "LOCAL\n"), {"DistanceUnits: the file is in um"}},
      {"v.mha", "", {"ElementDataFile: missing"}},
      {"w.mha", "nonsense\n", {"'nonsense' is not a field"}},
      {"x.mha", meta("CompressedData = True\n", "LOCAL\n"), {"CompressedData: allowed: False"}},
      {"y.mha", meta("ElementNumberOfChannels = 3\n", "LOCAL\n"), {"ElementNumberOfChannels: allowed: 1"}},
      {"z.mha", meta("", "LIST 2D\n"), {"ElementDataFile: allowed: one file"}},
      {"1.mha", meta("", "LOCAL\nxx"), {"take 24 bytes, there are 2"}},
      {"2.mha", "NDims = 3\nDimSize = 1 1 1\nElementDataFile = LOCAL\nx", {"elementtype: missing"}},
  };
  for (const auto& b : bad) {
    SCOPED_TRACE(b.name);
    std::vector<std::string> expected = b.expected;
    expected.emplace_back(b.name);
    expect_error([&] { read_label_mask({scratch.write(b.name, b.bytes), {}, 1}, 300); }, ExitCode::bad_input, expected);
  }
  const auto good = scratch.write("good.nrrd", nrrd_head + ascii);
  expect_error(
      [&] {
        read_label_mask({good, {}, 1}, 2);
      },
      ExitCode::bad_input, {"no voxel has the label 2", "there are: -1, 0, 7, 300"});
  const auto lost = scratch.write("lost.mhd", meta_head + "ElementDataFile = none.raw\n");
  expect_error([&] { read_label_mask({lost, {}, 1}, 300); }, ExitCode::io, {"none.raw"});
}

TEST(LabelImages, EveryTruncationIsRefused) {
  const Scratch scratch;
  for (const std::string& whole : {nrrd_head + "encoding: raw\nendian: little\n\n" + raw16(false),
                                   meta_head + "ElementDataFile = LOCAL\n" + raw16(false)}) {
    for (std::size_t length = 0; length < whole.size(); ++length) {
      const auto file = scratch.write(whole[0] == 'N' ? "t.nrrd" : "t.mha", whole.substr(0, length));
      EXPECT_THROW(read_label_mask({file, {}, 1}, 300), Error) << length;
    }
  }
}

}  // namespace
}  // namespace palpate::test
