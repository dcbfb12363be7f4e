// SPDX-License-Identifier: GPL-3.0-or-later
// Contents of a file: which of it is the body, what lies inside, and the text of a scene.
#include "precompute/surface/propose.hpp"

#include "formats/image/label_image.hpp"
#include "formats/io/error.hpp"
#include "formats/scene/tissues.hpp"
#include "formats/surface/surface_io.hpp"
#include "precompute/geometry/intersections.hpp"
#include "precompute/geometry/label_surface.hpp"
#include "precompute/geometry/query.hpp"
#include "precompute/geometry/topology.hpp"
#include "precompute/surface/repair/clean.hpp"
#include "precompute/surface/repair/weld.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <memory>
#include <optional>

namespace palpate::surface {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

constexpr std::size_t kMostRegions = 16;  // tried, the largest first
constexpr double kSmallestShare = 1e-4;   // of the body's volume: smaller things are not felt
constexpr double kDepthShare = 0.03;      // of the diagonal
constexpr double kHeldShare = 0.1;        // of the extent

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool is_image(const std::filesystem::path& file) {
  const std::string name = lower(file.filename().string());
  for (const char* end : {".nii", ".nii.gz", ".nrrd", ".nhdr", ".mha", ".mhd"}) {
    if (name.ends_with(end)) return true;
  }
  return false;
}

bool is_surface(const std::filesystem::path& file) {
  const std::string extension = lower(file.extension().string());
  for (const char* known : {".glb", ".gltf", ".obj", ".stl", ".ply", ".off", ".vtp", ".vtk"}) {
    if (extension == known) return true;
  }
  return false;
}

// "liver" of "liver.nii.gz".
std::string stem(const std::filesystem::path& file) {
  std::string name = file.filename().string();
  for (int k = 0; k < 2; ++k) {
    const auto dot = name.rfind('.');
    if (dot == std::string::npos || dot == 0) break;
    const std::string end = lower(name.substr(dot));
    if (k == 1 && end != ".nii" && end != ".seg") break;
    name = name.substr(0, dot);
  }
  return name;
}

// As a TOML text.
std::string toml_text(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) >= 0x20) out += c;
  }
  return out + "\"";
}

// A region's name becomes a file's.
std::string plain(const std::string& name) {
  std::string out;
  for (const char c : name) {
    out += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' || c == ' ' ? c : '-';
  }
  return out.empty() || out.front() == '.' ? "part" : out;
}

bool has_word(const std::string& name, std::initializer_list<const char*> words) {
  const std::string text = lower(name);
  return std::any_of(words.begin(), words.end(),
                     [&](const char* word) { return text.find(word) != std::string::npos; });
}

bool is_hollow(const std::string& name) {
  return has_word(name, {"vessel", "vein", "vena", "artery", "arteri", "aorta", "duct", "lumen", "cavity", "cyst"}) &&
         !has_word(name, {"wall"});
}

// Empty: none is published for it.
std::string tissue_of(const std::string& name) {
  if (has_word(name, {"tumo", "lesion", "metasta", "cancer", "carcinoma", "mass"})) return "liver-tumour";
  for (const Tissue& tissue : tissues()) {
    if (has_word(name, {tissue.name})) return tissue.name;
  }
  return {};
}

std::string material_text(const std::string& name, bool body) {
  const std::string tissue = tissue_of(name);
  if (!tissue.empty()) {
    return fmt::format("tissue = \"{}\"  # from the name; palpate scene --tissues has the sources\n", tissue);
  }
  return fmt::format("young = {}  # Pa; no published stiffness for '{}': this is a guess, set it\n",
                     body ? "5e3" : "1e4", plain(name));
}

// Something with a volume.
struct Thing {
  std::string name;
  std::string source;  ///< TOML: surface and meshes and units, or labels
  std::filesystem::path file;
  LabelSource labels;  ///< without values: a mesh
  Surface surface;     ///< m; labels: empty until it is needed
  AlignedBox3d box;
  double volume = 0;
  bool closed = true;
};

AlignedBox3d box_of(const Surface& surface) {
  AlignedBox3d box;
  for (const auto& t : surface.triangles) {
    for (const auto v : t) box.extend(surface.vertices[std::size_t(v)]);
  }
  return box;
}

struct Unit {
  const char* name;
  double length;
};

// An organ measures some centimetres to some decimetres.
Unit guessed_unit(double diagonal) {
  if (diagonal < 1.5) return {"m", 1};
  if (diagonal < 15) return {"cm", 0.01};
  return {"mm", 0.001};
}

class Proposer {
public:
  Proposer(const std::filesystem::path& from, const std::filesystem::path& folder) : folder_(folder) {
    std::error_code error;
    if (std::filesystem::is_directory(from, error)) {
      std::vector<std::filesystem::path> files;
      for (const auto& entry : std::filesystem::directory_iterator(from)) {
        if (entry.is_regular_file() && (is_image(entry.path()) || is_surface(entry.path()))) {
          files.push_back(entry.path());
        }
      }
      std::sort(files.begin(), files.end());
      if (files.empty()) throw Error(ExitCode::bad_input, from.string() + ": no surface and no label image is in it");
      many_files_ = files.size() > 1;
      for (const auto& file : files) add(file);
    } else {
      add(from);
    }
    std::stable_sort(things_.begin(), things_.end(),
                     [](const Thing& a, const Thing& b) { return a.volume > b.volume; });
    const bool any = std::any_of(things_.begin(), things_.end(), [](const Thing& t) { return t.closed; });
    if (!any && things_.empty()) {
      throw Error(ExitCode::bad_input, from.string() + ": holds no mesh and no label that could be a body");
    }
  }

  Proposal run() {
    choose();
    Proposal proposal;
    proposal.scene = text();
    for (std::size_t k = 0; k < things_.size(); ++k) {
      const Vector3d e = things_[k].box.sizes();
      proposal.found.push_back({things_[k].name, roles_[k], reasons_[k], things_[k].volume, {e.x(), e.y(), e.z()}});
    }
    return proposal;
  }

private:
  std::string path_text(const std::filesystem::path& file) const {
    if (folder_.empty()) return toml_text(file.generic_string());
    const auto relative = std::filesystem::proximate(file, folder_);
    return toml_text(relative.generic_string());
  }

  void add(const std::filesystem::path& file) {
    if (is_image(file)) {
      add_image(file);
    } else {
      add_surface(file);
    }
  }

  void add_image(const std::filesystem::path& file) {
    auto image = std::make_shared<const LabelImage>(read_label_image(file, 0));
    const auto extents = label_extents(*image);
    if (image->frame != Frame::unstated) frame_ = image->frame;
    for (const LabelExtent& extent : extents) {
      Thing thing;
      thing.file = file;
      thing.labels.file = file;
      std::string choice;
      if (extent.name.empty()) {
        if (image->layers > 1) continue;
        thing.labels.values = {extent.value};
        choice = fmt::format("value = {}", extent.value);
        thing.name = extents.size() == 1 ? stem(file) : fmt::format("label {}", extent.value);
      } else {
        thing.labels.segments = {extent.name};
        choice = "segment = " + toml_text(extent.name);
        thing.name = extent.name;
      }
      thing.source = fmt::format("labels = {{image = {}, {}{}}}\n", path_text(file), choice,
                                 image->states_unit ? "" : ", units = \"mm\"");
      thing.volume = double(extent.voxels) * std::abs(image->axes.determinant());
      for (int c = 0; c < 8; ++c) {
        Vector3d index;
        for (std::size_t a = 0; a < 3; ++a) {
          index[int(a)] = (c >> a & 1) != 0 ? extent.high[a] + 0.5 : extent.low[a] - 0.5;
        }
        thing.box.extend(image->origin + image->axes * index);
      }
      things_.push_back(std::move(thing));
    }
    if (!many_files_) image_ = std::move(image);  // of a folder, one at a time
  }

  void add_surface(const std::filesystem::path& file) {
    SurfaceSource source;
    source.file = file;
    const Surface all = read_surface(source);
    if (all.frame != Frame::unstated) frame_ = all.frame;
    const Unit unit = guessed_unit(geometry::diagonal(all));
    const bool named = all.part_names.size() > 1;
    for (std::size_t part = 0; part < all.part_names.size(); ++part) {
      std::vector<bool> keep(all.triangles.size());
      for (std::size_t t = 0; t < keep.size(); ++t) keep[t] = all.parts[t] == std::int32_t(part);
      Thing thing;
      thing.file = file;
      thing.name = named ? all.part_names[part] : stem(file);
      thing.surface = weld(keep_triangles(all, keep), 1e-6 * geometry::diagonal(all));
      if (thing.surface.empty()) continue;
      for (auto& v : thing.surface.vertices) v *= unit.length;
      thing.closed = geometry::topology(thing.surface).boundary_edges == 0;
      thing.volume = thing.closed ? std::abs(geometry::signed_volume(thing.surface)) : 0;
      thing.box = box_of(thing.surface);
      thing.source = "surface = " + path_text(file) + "\n";
      if (named) thing.source += "meshes = [" + toml_text(thing.name) + "]\n";
      thing.source += fmt::format("units = \"{}\"  # guessed: the file measures {:.4g} across\n", unit.name,
                                  geometry::diagonal(all));
      things_.push_back(std::move(thing));
    }
  }

  const Surface& surface_of(Thing& thing, MaskUse use) {
    if (!thing.surface.empty()) return thing.surface;
    std::shared_ptr<const LabelImage> image = image_;
    if (!image) image = std::make_shared<const LabelImage>(read_label_image(thing.file, 0));
    LabelSource labels = thing.labels;
    if (use == MaskUse::body) labels.islands = Islands::largest;
    if (use == MaskUse::body && image_) {
      // With all that may lie inside: their voxels are no holes.
      for (const Thing& other : things_) {
        if (&other == &thing || !thing.box.contains(other.box)) continue;
        labels.values.insert(labels.values.end(), other.labels.values.begin(), other.labels.values.end());
        labels.segments.insert(labels.segments.end(), other.labels.segments.begin(), other.labels.segments.end());
      }
    }
    std::vector<LabelMask> also;
    if (use == MaskUse::body && !image_) {
      for (const Thing& other : things_) {
        if (&other == &thing || other.labels.file.empty() || !thing.box.contains(other.box)) continue;
        try {
          also.push_back(label_mask(read_label_image(other.file, 0), other.labels, MaskUse::region));
          static_cast<void>(label_mask(*image, labels, use, {also.back()}));
        } catch (const Error&) {
          if (!also.empty()) also.pop_back();  // of another grid
        }
      }
    }
    thing.surface = geometry::label_surface(label_mask(*image, labels, use, also), thing.name);
    return thing.surface;
  }

  // Why a thing cannot be a part inside the body; empty: it can.
  std::string unfit(Thing& thing, const geometry::SurfaceQuery& body) {
    if (!thing.closed) return "an open surface";
    if (!things_.front().box.contains(thing.box)) return "not inside the body";
    if (thing.volume < kSmallestShare * things_.front().volume) return "less than 0.01 % of the body";
    try {
      const Surface& surface = surface_of(thing, MaskUse::region);
      const double margin = 2e-3 * geometry::diagonal(body.surface());
      for (const Vector3d& v : surface.vertices) {
        if (!(body.signed_distance(v) < -margin)) return "reaches the body's surface, or outside";
      }
      for (const std::size_t k : inside_) {
        const Surface& other = things_[k].surface;
        const geometry::SurfaceQuery query(other);
        if (geometry::surfaces_intersect(surface, other) || query.signed_distance(surface.vertices.front()) < 0 ||
            geometry::SurfaceQuery(surface).signed_distance(other.vertices.front()) < 0) {
          return "overlaps '" + things_[k].name + "'";
        }
      }
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  }

  // Anatomists' meshes are often sheets: a capsule whose opening is another mesh, or all of them round one solid.
  void close_body() {
    std::stable_sort(things_.begin(), things_.end(),
                     [](const Thing& a, const Thing& b) { return a.box.diagonal().norm() > b.box.diagonal().norm(); });
    Thing& body = things_.front();
    const auto take = [&](const std::vector<Surface>& parts, RepairMode mode) {
      try {
        CleanOptions options;
        options.mode = mode;
        const CleanSurface cleaned = clean_surface(join(parts), options, body.file.string());
        if (cleaned.report.thin_bag) return false;
        body.surface = cleaned.query->surface();
        body.volume = cleaned.report.volume;
        body.box = box_of(body.surface);
        body.closed = true;
        return true;
      } catch (const Error&) {
        return false;
      }
    };
    const auto rim_of = [](const Surface& s) { return geometry::topology(s).boundary_edges; };
    const std::size_t rim = rim_of(body.surface);
    for (std::size_t k = 1; k < things_.size(); ++k) {
      const Thing& other = things_[k];
      if (other.closed || other.file != body.file || !body.box.intersects(other.box)) continue;
      const Surface both = join({body.surface, other.surface});
      const double size = geometry::diagonal(both);
      if (rim_of(join_borders(weld(both, 1e-6 * size), 2e-3 * size)) > rim / 4) continue;
      if (!take({body.surface, other.surface}, RepairMode::repair)) continue;
      const auto meshes = body.source.find("]");
      body.source.insert(meshes, ", " + toml_text(other.name));
      closing_ = k;
      return;
    }
    std::vector<Surface> all;
    for (const Thing& thing : things_) {
      if (thing.file == body.file) all.push_back(thing.surface);
    }
    if (all.size() < 2 || !take(all, RepairMode::wrap)) return;
    const auto meshes = body.source.find("meshes");
    body.source.replace(meshes, body.source.find('\n', meshes) - meshes, "repair = \"wrap\"  # of all meshes together");
    body.name = stem(body.file);
    wrapped_ = true;
  }

  void choose() {
    if (!things_.front().closed && !things_.front().surface.empty()) close_body();
    roles_.assign(things_.size(), "left out");
    reasons_.assign(things_.size(), "");
    roles_[0] = "body";
    const bool closed = things_.front().closed;
    std::unique_ptr<const geometry::SurfaceQuery> body;
    if (closed) body = std::make_unique<const geometry::SurfaceQuery>(surface_of(things_.front(), MaskUse::body));
    for (std::size_t k = 1; k < things_.size(); ++k) {
      if (k == closing_) {
        roles_[k] = "body";
        continue;
      }
      if (!closed) {
        reasons_[k] = "the body is open";
      } else if (wrapped_) {
        reasons_[k] = "wrapped into the body";
      } else if (inside_.size() >= kMostRegions) {
        reasons_[k] = "there are larger ones";
      } else {
        reasons_[k] = unfit(things_[k], *body);
      }
      if (!reasons_[k].empty()) continue;
      inside_.push_back(k);
      roles_[k] = is_hollow(things_[k].name) ? "cavity" : "region";
    }
    if (closed) things_.front().box = box_of(things_.front().surface);
  }

  static std::string facts(const Thing& thing) {
    const Vector3d e = 1e3 * thing.box.sizes();
    return fmt::format("{:.4g} mL, {:.3g} x {:.3g} x {:.3g} mm", thing.volume * 1e6, e.x(), e.y(), e.z());
  }

  std::string support_text(const AlignedBox3d& box) const {
    // A patient lies on the back.
    const bool lying = frame_ != Frame::unstated;
    const int axis = lying ? 1 : 2;
    const bool high = frame_ == Frame::lps;
    Vector3d point = box.center(), normal = Vector3d::Zero();
    point[axis] =
        high ? box.max()[axis] - kHeldShare * box.sizes()[axis] : box.min()[axis] + kHeldShare * box.sizes()[axis];
    normal[axis] = high ? -1 : 1;
    return fmt::format(
        "\n[[support]]\n# Proposed: the {} tenth is held. Say what holds the organ in truth.\n"
        "half_space = {{point = [{:.5g}, {:.5g}, {:.5g}], normal = [{:g}, {:g}, {:g}]}}\n",
        lying ? "hindmost (the patient lies on the back)" : "lowest", point.x(), point.y(), point.z(), normal.x(),
        normal.y(), normal.z());
  }

  std::string text() const {
    const Thing& body = things_.front();
    std::string out = "# Proposed by palpate scene --from. Check units, supports and stiffnesses.\n";
    if (frame_ != Frame::unstated) {
      out += fmt::format("frame = \"{}\"\n", frame_ == Frame::lps ? "LPS" : "RAS");
    }
    std::string source = body.source;
    if (!body.labels.file.empty()) source.insert(source.size() - 2, ", islands = \"largest\"");
    out += fmt::format("\n[body]\n# {}: {}{}\n{}", plain(body.name), facts(body),
                       body.closed ? "" : "; open, so its volume is not known yet", source);
    out += "\n[material]\n" + material_text(body.name, true);
    for (const std::size_t k : inside_) {
      const Thing& thing = things_[k];
      const bool hollow = roles_[k] == "cavity";
      out += fmt::format("\n[[{}]]\n# {}\nname = {}\n{}", hollow ? "cavity" : "region", facts(thing),
                         toml_text(plain(thing.name)), thing.source);
      if (!hollow) out += material_text(thing.name, false);
    }
    out += support_text(body.box);
    const double size = body.box.diagonal().norm();
    out += fmt::format("\n[[tool]]\nshape = \"sphere\"\nradius = {:.2g}  # m\n", std::min(0.005, size / 15));
    out += fmt::format("\n[sampling]\ndepth = {:.2g}  # m\n", std::min(0.005, kDepthShare * size));
    out += "\n[response]\ntolerance = 0.05  # of normal forces; sites are added until it is met\n";
    std::string rest;
    for (std::size_t k = 0; k < things_.size(); ++k) {
      if (roles_[k] != "left out") continue;
      rest += fmt::format("# {}: {} ({})\n", plain(things_[k].name), facts(things_[k]), reasons_[k]);
    }
    if (!rest.empty()) out += "\n# Left out:\n" + rest;
    return out;
  }

  std::filesystem::path folder_;
  bool many_files_ = false;
  Frame frame_ = Frame::unstated;
  std::shared_ptr<const LabelImage> image_;
  std::vector<Thing> things_;
  std::vector<std::size_t> inside_;
  std::size_t closing_ = 0;  ///< the mesh that closes the body; 0: none
  bool wrapped_ = false;     ///< the body is a wrap of all meshes
  std::vector<std::string> roles_, reasons_;
};

}  // namespace

Proposal propose_scene(const std::filesystem::path& from, const std::filesystem::path& folder) {
  std::error_code error;
  if (!std::filesystem::exists(from, error)) throw Error(ExitCode::io, from.string() + ": there is no such file");
  return Proposer(from, folder).run();
}

}  // namespace palpate::surface
