// SPDX-License-Identifier: MIT
// Label images: units and segments of a file, and masks of labels with their islands and holes.
#include "formats/image/label_image.hpp"

#include "formats/image/image_header.hpp"
#include "formats/image/itk_reader.hpp"
#include "formats/image/nifti_reader.hpp"
#include "formats/io/error.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <set>

namespace palpate {
namespace {

constexpr double kSmallestVoxel = 5e-6;  // m: a finer label image of an organ does not exist; its unit is wrong
constexpr double kIslandShare = 0.01;    // of the largest island: smaller ones are specks of a segmentation
constexpr double kHoleShare = 0.001;     // of a label's voxels: smaller holes are specks as well
constexpr std::size_t kListed = 20;      // labels in a message
constexpr std::size_t kMostLabels = 65536;

[[noreturn]] void fail(const LabelImage& image, const std::string& what) {
  throw Error(ExitCode::bad_input, image.file.string() + ": " + what);
}

std::string format(const char* pattern, double a) {
  char text[64];
  std::snprintf(text, sizeof text, pattern, a);
  return text;
}

std::optional<int> whole(const std::map<std::string, std::string>& texts, const std::string& key) {
  const auto at = texts.find(key);
  if (at == texts.end()) return std::nullopt;
  int value = 0;
  const char* end = at->second.data() + at->second.size();
  const auto [stop, code] = std::from_chars(at->second.data(), end, value);
  if (code != std::errc() || stop != end) return std::nullopt;
  return value;
}

// Slicer's keys. Before it had layers, each segment was one layer of zeros and ones.
std::vector<LabelSegment> segments_of(const std::map<std::string, std::string>& texts) {
  std::vector<LabelSegment> segments;
  for (int n = 0;; ++n) {
    const std::string key = "Segment" + std::to_string(n) + "_";
    const auto name = texts.find(key + "Name");
    if (name == texts.end() && !texts.contains(key + "ID")) break;
    LabelSegment segment;
    segment.name = name == texts.end() ? texts.at(key + "ID") : name->second;
    segment.layer = whole(texts, key + "Layer").value_or(n);
    segment.value = whole(texts, key + "LabelValue").value_or(1);
    segments.push_back(std::move(segment));
  }
  return segments;
}

std::string place(const Eigen::Vector3d& p) {
  char text[96];
  std::snprintf(text, sizeof text, "(%.4g, %.4g, %.4g) m", p.x(), p.y(), p.z());
  return text;
}

double voxel_volume(const Eigen::Matrix3d& axes) { return std::abs(axes.determinant()); }

std::string millilitres(double volume) { return format("%.3g mL", volume * 1e6); }

// A value of a layer.
using Label = std::pair<int, std::int32_t>;

std::set<Label> wanted_labels(const LabelImage& image, const LabelSource& source) {
  std::set<Label> wanted;
  for (const int value : source.values) {
    if (image.layers > 1) {
      fail(image, "has " + std::to_string(image.layers) +
                      " layers, in which a value alone says little; name the segment: segment = \"NAME\"");
    }
    wanted.emplace(0, value);
  }
  for (const std::string& name : source.segments) {
    const auto found = std::find_if(image.segments.begin(), image.segments.end(),
                                    [&](const LabelSegment& segment) { return segment.name == name; });
    if (found != image.segments.end()) {
      wanted.emplace(found->layer, found->value);
      continue;
    }
    std::string list;
    for (const LabelSegment& segment : image.segments) list += (list.empty() ? "" : ", ") + segment.name;
    fail(image, "has no segment '" + name + "'; there are: " + (list.empty() ? "none (choose by value)" : list));
  }
  return wanted;
}

[[noreturn]] void nothing_there(const LabelImage& image, const Label& label, const LabelSource& source) {
  std::string list;
  std::size_t listed = 0;
  for (const LabelExtent& extent : label_extents(image)) {
    if (++listed > kListed) break;
    list += (list.empty() ? "" : ", ") + (extent.name.empty() ? std::to_string(extent.value) : extent.name);
  }
  std::string what = "no voxel has the label " + std::to_string(label.second);
  for (const LabelSegment& segment : image.segments) {
    if (segment.layer == label.first && segment.value == label.second && !source.segments.empty()) {
      what = "the segment '" + segment.name + "' has no voxels";
    }
  }
  fail(image, what + "; there are: " + (list.empty() ? "none" : list));
}

// Connected sets, over faces, of the voxels where `inside` is `kind`. Numbers from 1, 0 elsewhere.
struct Pieces {
  std::vector<std::uint32_t> number;
  std::vector<std::size_t> sizes{0};
  std::vector<Eigen::Vector3d> sums{Eigen::Vector3d::Zero()};  // of indices
  std::vector<char> at_border{0};                              // of the box
};

Pieces pieces_of(const LabelMask& mask, std::uint8_t kind) {
  Pieces pieces;
  pieces.number.assign(mask.inside.size(), 0);
  const std::size_t nx = std::size_t(mask.size[0]), ny = std::size_t(mask.size[1]), nz = std::size_t(mask.size[2]);
  std::vector<std::size_t> open;
  for (std::size_t seed = 0; seed < mask.inside.size(); ++seed) {
    if (mask.inside[seed] != kind || pieces.number[seed] != 0) continue;
    const auto number = std::uint32_t(pieces.sizes.size());
    pieces.sizes.push_back(0);
    pieces.sums.emplace_back(0, 0, 0);
    pieces.at_border.push_back(0);
    pieces.number[seed] = number;
    open.push_back(seed);
    while (!open.empty()) {
      const std::size_t at = open.back();
      open.pop_back();
      const std::size_t i = at % nx, j = at / nx % ny, k = at / nx / ny;
      ++pieces.sizes[number];
      pieces.sums[number] += Eigen::Vector3d(double(i), double(j), double(k));
      const auto visit = [&](bool there, std::size_t next) {
        if (!there) {
          pieces.at_border[number] = 1;
        } else if (mask.inside[next] == kind && pieces.number[next] == 0) {
          pieces.number[next] = number;
          open.push_back(next);
        }
      };
      visit(i > 0, at - 1);
      visit(i + 1 < nx, at + 1);
      visit(j > 0, at - nx);
      visit(j + 1 < ny, at + nx);
      visit(k > 0, at - nx * ny);
      visit(k + 1 < nz, at + nx * ny);
    }
  }
  return pieces;
}

std::string described(const LabelMask& mask, const Pieces& pieces, std::size_t n) {
  const Eigen::Vector3d middle = mask.origin + mask.axes * (pieces.sums[n] / double(pieces.sizes[n]));
  return millilitres(double(pieces.sizes[n]) * voxel_volume(mask.axes)) + " round " + place(middle);
}

void choose_islands(const LabelImage& image, LabelMask& mask, Islands rule, MaskUse use) {
  const Pieces pieces = pieces_of(mask, 1);
  const std::size_t count = pieces.sizes.size() - 1;
  if (count < 2) return;
  const auto largest = std::size_t(std::max_element(pieces.sizes.begin(), pieces.sizes.end()) - pieces.sizes.begin());
  std::vector<char> keep(count + 1, 0);
  std::size_t dropped = 0, voxels = 0, most = 0, kept = 0;
  std::string list;
  for (std::size_t n = 1; n <= count; ++n) {
    const bool large = double(pieces.sizes[n]) >= kIslandShare * double(pieces.sizes[largest]);
    keep[n] = rule == Islands::largest ? n == largest : rule == Islands::all || large;
    if (keep[n] != 0) {
      ++kept;
      if (kept <= kListed) list += (list.empty() ? "" : "; ") + described(mask, pieces, n);
    } else {
      ++dropped;
      voxels += pieces.sizes[n];
      most = std::max(most, pieces.sizes[n]);
    }
  }
  if (use == MaskUse::body && rule == Islands::automatic && kept > 1) {
    fail(image, "the body's label has " + std::to_string(kept) + " islands: " + list +
                    "; add islands = \"largest\" to its labels to keep the largest alone, or \"all\"");
  }
  if (dropped == 0) return;
  for (std::size_t v = 0; v < mask.inside.size(); ++v) {
    if (keep[pieces.number[v]] == 0) mask.inside[v] = 0;
  }
  mask.count -= voxels;
  const double volume = voxel_volume(mask.axes);
  mask.notes.push_back("dropped " + std::to_string(dropped) + " islands of " + millilitres(double(voxels) * volume) +
                       " in all, the largest of " + millilitres(double(most) * volume) +
                       (rule == Islands::largest ? " (islands = \"largest\")" : " (below 1 % of the largest)"));
}

void fill_holes(LabelMask& mask) {
  const Pieces pieces = pieces_of(mask, 0);
  std::vector<char> fill(pieces.sizes.size(), 0);
  std::size_t filled = 0, voxels = 0;
  for (std::size_t n = 1; n < pieces.sizes.size(); ++n) {
    if (pieces.at_border[n] != 0) continue;
    if (double(pieces.sizes[n]) < kHoleShare * double(mask.count)) {
      fill[n] = 1;
      ++filled;
      voxels += pieces.sizes[n];
    } else {
      mask.notes.push_back("a hole inside is a cavity: " + described(mask, pieces, n));
    }
  }
  if (filled == 0) return;
  for (std::size_t v = 0; v < mask.inside.size(); ++v) {
    if (fill[pieces.number[v]] != 0) mask.inside[v] = 1;
  }
  mask.count += voxels;
  mask.notes.push_back("filled " + std::to_string(filled) + " holes of " +
                       millilitres(double(voxels) * voxel_volume(mask.axes)) +
                       " in all (each below 0.1 % of the label)");
}

// Faces on which the label has voxels in the image's first or last layer along an axis.
void note_border(const LabelImage& image, LabelMask& mask, const std::array<int, 3>& low) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const bool end : {false, true}) {
      const int border = end ? image.size[axis] - 1 : 0;
      const int layer = border - low[axis];
      if (layer < 0 || layer >= mask.size[axis]) continue;
      const std::size_t step = axis == 0   ? 1
                               : axis == 1 ? std::size_t(mask.size[0])
                                           : std::size_t(mask.size[0]) * std::size_t(mask.size[1]);
      std::size_t voxels = 0;
      for (std::size_t v = 0; v < mask.inside.size(); ++v) {
        if (v / step % std::size_t(mask.size[axis]) == std::size_t(layer)) voxels += mask.inside[v];
      }
      if (voxels == 0) continue;
      const double area = voxel_volume(mask.axes) / mask.axes.col(int(axis)).norm();
      mask.notes.push_back(std::string("cut by the image's border (") + (end ? "last" : "first") + " voxels along " +
                           "ijk"[axis] + ", about " + format("%.3g", double(voxels) * area * 1e4) +
                           " cm2): closed there");
    }
  }
}

// Adds the voxels of a mask of the same grid; the box grows as far as they reach.
void add_mask(const LabelImage& image, LabelMask& mask, std::array<int, 3>& low, const LabelMask& other) {
  const double voxel = image.axes.colwise().norm().minCoeff();
  const Eigen::Vector3d shift = mask.axes.inverse() * (other.origin - mask.origin);
  const Eigen::Vector3d whole = shift.array().round();
  if ((mask.axes - other.axes).norm() > 1e-3 * voxel || (shift - whole).norm() > 0.05) {
    fail(image, "and the image of what lies inside have different voxels; allowed: one grid for both");
  }
  LabelMask joined = mask;
  std::array<int, 3> first{}, start{};
  for (std::size_t a = 0; a < 3; ++a) {
    start[a] = int(whole[int(a)]);
    first[a] = std::min(0, start[a]);
    joined.size[a] = std::max(mask.size[a], start[a] + other.size[a]) - first[a];
    low[a] += first[a];
  }
  joined.origin = mask.origin + mask.axes * Eigen::Vector3d(first[0], first[1], first[2]);
  joined.inside.assign(std::size_t(joined.size[0]) * std::size_t(joined.size[1]) * std::size_t(joined.size[2]), 0);
  const auto add = [&](const LabelMask& from, const std::array<int, 3>& at) {
    std::size_t v = 0;
    for (int k = 0; k < from.size[2]; ++k) {
      for (int j = 0; j < from.size[1]; ++j) {
        for (int i = 0; i < from.size[0]; ++i, ++v) {
          if (from.inside[v] == 0) continue;
          const std::size_t row =
              std::size_t(k + at[2] - first[2]) * std::size_t(joined.size[1]) + std::size_t(j + at[1] - first[1]);
          joined.inside[row * std::size_t(joined.size[0]) + std::size_t(i + at[0] - first[0])] = 1;
        }
      }
    }
  };
  add(mask, {0, 0, 0});
  add(other, start);
  joined.count = std::size_t(std::count(joined.inside.begin(), joined.inside.end(), 1));
  mask = std::move(joined);
}

}  // namespace

LabelImage read_label_image(const std::filesystem::path& file, double unit) {
  const detail::ImageKind kind = detail::image_kind(file);
  const detail::StatedSpace stated = detail::check_header(file, kind);
  detail::ImageFile read =
      kind == detail::ImageKind::nifti ? detail::read_nifti(file) : detail::read_by_itk(file, kind, stated.voxels);
  LabelImage image;
  image.file = file;
  image.size = read.size;
  image.layers = read.layers;
  image.frame = read.states_frame ? Frame::lps : stated.frame;
  image.states_unit = stated.unit > 0;
  if (unit > 0 && stated.unit > 0 && unit != stated.unit) {
    fail(image, "its header states a unit of " + format("%g", stated.unit) + " m, the scene says " +
                    format("%g", unit) + " m; leave out 'units', or correct it");
  }
  if (unit <= 0 && stated.unit <= 0 && !stated.unknown_unit.empty()) {
    fail(image, "its header states the unit '" + stated.unknown_unit.substr(0, 40) +
                    "', which is not known; state it in the scene, for example units = \"mm\"");
  }
  const double length = unit > 0 ? unit : stated.unit > 0 ? stated.unit : 1e-3;
  for (int k = 0; k < 3; ++k) {
    image.origin[k] = length * read.origin[std::size_t(k)];
    for (int i = 0; i < 3; ++i) image.axes(i, k) = length * read.axes[std::size_t(k)][std::size_t(i)];
  }
  const double lengths = image.axes.colwise().norm().prod();
  if (!image.origin.allFinite() || !std::isfinite(lengths) || !(voxel_volume(image.axes) > 1e-6 * lengths)) {
    fail(image, "the axes of its voxels span no space");
  }
  const double shortest = image.axes.colwise().norm().minCoeff();
  if (shortest < kSmallestVoxel) {
    fail(image, "its voxels are " + format("%.3g", shortest * 1e3) +
                    " mm wide, too small for an organ; say its unit, for example units = \"m\"");
  }
  image.segments = segments_of(read.texts);
  for (const LabelSegment& segment : image.segments) {
    if (segment.layer < 0 || segment.layer >= image.layers) {
      fail(image, "segment '" + segment.name + "' is in layer " + std::to_string(segment.layer) + "; allowed: 0 to " +
                      std::to_string(image.layers - 1));
    }
  }
  image.values = std::move(read.values);
  return image;
}

std::vector<LabelExtent> label_extents(const LabelImage& image) {
  std::map<Label, LabelExtent> found;
  const auto layers = std::size_t(image.layers);
  std::size_t at = 0;
  std::array<int, 3> index{};
  std::vector<LabelExtent*> last(layers, nullptr);  // labels come in runs
  for (index[2] = 0; index[2] < image.size[2]; ++index[2]) {
    for (index[1] = 0; index[1] < image.size[1]; ++index[1]) {
      for (index[0] = 0; index[0] < image.size[0]; ++index[0]) {
        for (std::size_t layer = 0; layer < layers; ++layer, ++at) {
          const std::int32_t value = image.values[at];
          if (value == 0) continue;
          LabelExtent*& extent = last[layer];
          if (extent == nullptr || extent->value != value) {
            extent = &found[{int(layer), value}];
            if (found.size() > kMostLabels) fail(image, "has more than 65536 different values; allowed: labels");
            if (extent->voxels == 0) {
              extent->layer = int(layer);
              extent->value = value;
              extent->low = image.size;
              extent->high = {-1, -1, -1};
            }
          }
          ++extent->voxels;
          for (std::size_t a = 0; a < 3; ++a) {
            extent->low[a] = std::min(extent->low[a], index[a]);
            extent->high[a] = std::max(extent->high[a], index[a]);
          }
        }
      }
    }
  }
  std::vector<LabelExtent> extents;
  for (auto& [label, extent] : found) {
    for (const LabelSegment& segment : image.segments) {
      if (segment.layer == label.first && segment.value == label.second) extent.name = segment.name;
    }
    extents.push_back(std::move(extent));
  }
  return extents;
}

LabelMask label_mask(const LabelImage& image, const LabelSource& source, MaskUse use,
                     const std::vector<LabelMask>& also) {
  const std::set<Label> wanted = wanted_labels(image, source);
  const auto layers = std::size_t(image.layers);
  std::map<Label, std::size_t> counts;
  for (const Label& label : wanted) counts[label] = 0;
  const auto is_wanted = [&](std::size_t voxel) {
    bool in = false;
    for (auto& [label, count] : counts) {
      if (image.values[voxel * layers + std::size_t(label.first)] != label.second) continue;
      ++count;
      in = true;
    }
    return in;
  };
  std::array<int, 3> low = image.size, high{-1, -1, -1}, at{};
  std::size_t voxel = 0;
  for (at[2] = 0; at[2] < image.size[2]; ++at[2]) {
    for (at[1] = 0; at[1] < image.size[1]; ++at[1]) {
      for (at[0] = 0; at[0] < image.size[0]; ++at[0], ++voxel) {
        if (!is_wanted(voxel)) continue;
        for (std::size_t a = 0; a < 3; ++a) low[a] = std::min(low[a], at[a]), high[a] = std::max(high[a], at[a]);
      }
    }
  }
  for (const auto& [label, count] : counts) {
    if (count == 0) nothing_there(image, label, source);
  }
  LabelMask mask;
  mask.axes = image.axes;
  mask.origin = image.origin + image.axes * Eigen::Vector3d(low[0], low[1], low[2]);
  for (std::size_t a = 0; a < 3; ++a) mask.size[a] = high[a] - low[a] + 1;
  mask.inside.reserve(std::size_t(mask.size[0]) * std::size_t(mask.size[1]) * std::size_t(mask.size[2]));
  for (int k = low[2]; k <= high[2]; ++k) {
    for (int j = low[1]; j <= high[1]; ++j) {
      std::size_t v = (std::size_t(k) * std::size_t(image.size[1]) + std::size_t(j)) * std::size_t(image.size[0]) +
                      std::size_t(low[0]);
      for (int i = low[0]; i <= high[0]; ++i, ++v) {
        const bool in = is_wanted(v);
        mask.inside.push_back(in ? 1 : 0);
        mask.count += in ? 1 : 0;
      }
    }
  }
  for (const LabelMask& other : also) add_mask(image, mask, low, other);
  choose_islands(image, mask, source.islands, use);
  fill_holes(mask);
  note_border(image, mask, low);
  return mask;
}

}  // namespace palpate
