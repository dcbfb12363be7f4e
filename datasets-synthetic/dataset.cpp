// SPDX-License-Identifier: GPL-3.0-or-later
// Puts a data set together: organ, inclusion and tool surfaces, the scene that names them, a motion that fits.
#include "datasets-synthetic/dataset.hpp"

#include "datasets-synthetic/bladder.hpp"
#include "datasets-synthetic/kidney.hpp"
#include "datasets-synthetic/liver.hpp"
#include "datasets-synthetic/motion.hpp"
#include "datasets-synthetic/random.hpp"
#include "datasets-synthetic/scene_text.hpp"
#include "datasets-synthetic/shapes.hpp"
#include "formats/io/error.hpp"
#include "formats/io/file.hpp"
#include "formats/surface/surface_io.hpp"

#include <algorithm>
#include <functional>

namespace palpate::synth {

namespace {

/// An organ with what the rest of the data set is laid out by. Lengths in m.
struct MadeOrgan {
  Surface surface;
  std::string file;
  std::vector<HalfSpace> held;
  double spacing = 0.015;
  double clear_radius = 0.0;  ///< probing stays within this distance of the centre, seen from above
  double inclusion_radius = 0.008;
  Eigen::Vector2d centre{0, 0};
  std::optional<std::pair<Eigen::Vector3d, Eigen::Vector3d>> sampled_box;
  std::function<double(const Eigen::Vector3d&)> depth_inside;  ///< at most the distance to the surface; < 0 outside
  std::string tissue;                                          ///< empty: young
  double young = 5e3;                                          ///< Pa
  std::vector<EllipsoidFacts> regions;
  double risen = 0.0;  ///< by prestress, where it is probed, about
};

HalfSpace below(double z) { return {{0, 0, z}, {0, 0, 1}}; }

MadeOrgan make_slab(const DatasetOptions& options) {
  const Eigen::Vector3d size = options.scale * Eigen::Vector3d(0.12, 0.12, 0.05);
  MadeOrgan organ;
  organ.surface = box(size, options.edge.value_or(0.01 * options.scale), "slab");
  organ.file = "slab.ply";
  organ.held = {below(-0.999 * size.z())};
  organ.spacing = 0.02 * options.scale;
  organ.clear_radius = 0.25 * size.x();
  organ.inclusion_radius = 0.008 * options.scale;
  // The middle of the top: away from the rim the answer is that of a layer without end.
  const double half = 0.3 * size.x(), thin = 0.001 * options.scale;
  organ.sampled_box = {Eigen::Vector3d(-half, -half, -thin), Eigen::Vector3d(half, half, thin)};
  organ.depth_inside = [size](const Eigen::Vector3d& p) {
    return std::min({size.x() / 2 - std::abs(p.x()), size.y() / 2 - std::abs(p.y()), -p.z(), p.z() + size.z()});
  };
  return organ;
}

MadeOrgan make_ball(const DatasetOptions& options) {
  const double radius = 0.04 * options.scale;
  MadeOrgan organ;
  organ.surface = geometry::ellipsoid({0, 0, 0}, Eigen::Vector3d::Constant(radius),
                                      options.edge.value_or(0.004 * options.scale), "ball");
  organ.file = "ball.ply";
  organ.held = {below(-0.6 * radius)};
  organ.spacing = 0.015 * options.scale;
  organ.clear_radius = 0.4 * radius;
  organ.inclusion_radius = 0.25 * radius;
  organ.depth_inside = [radius](const Eigen::Vector3d& p) { return radius - p.norm(); };
  return organ;
}

MadeOrgan make_liver(const DatasetOptions& options) {
  const LiverShape shape(options.seed, options.scale);
  MadeOrgan organ;
  organ.surface = liver_surface(shape, options.edge.value_or(0.005 * options.scale));
  organ.file = "liver.ply";
  organ.held = {below(0.85 * shape.underside())};
  organ.spacing = 0.015 * options.scale;
  organ.clear_radius = 0.02 * options.scale;
  organ.inclusion_radius = 0.009 * options.scale;
  organ.centre = options.scale * Eigen::Vector2d(-0.025, 0);  // the right lobe's dome
  organ.depth_inside = [shape](const Eigen::Vector3d& p) {
    return p.norm() > 0 ? shape.radius(p.normalized()) - p.norm() : shape.radius(Eigen::Vector3d::UnitZ());
  };
  return organ;
}

constexpr double kKidneyYoung = 14.6e3;  // Pa, of formats/scene/tissues.cpp at nu = 0.49

MadeOrgan make_kidney(const DatasetOptions& options) {
  const KidneyShape shape(options.scale);
  MadeOrgan organ;
  organ.surface = shape.surface(options.edge.value_or(0.003 * options.scale));
  organ.file = "kidney.ply";
  organ.held = {below(shape.underside())};
  organ.spacing = 0.012 * options.scale;
  organ.clear_radius = 0.012 * options.scale;
  organ.inclusion_radius = 0.004 * options.scale;
  organ.tissue = "kidney";
  for (const KidneyShape::Pyramid& pyramid : shape.pyramids()) {
    // Collecting ducts and vessels run along them; twice the cortex is a choice, not a measurement.
    organ.regions.push_back(
        {"pyramid-" + std::to_string(organ.regions.size() + 1), pyramid.centre, pyramid.radii, "", 2 * kKidneyYoung});
  }
  return organ;
}

MadeOrgan make_bladder(const DatasetOptions& options) {
  const BladderShape shape(options.scale);
  MadeOrgan organ;
  organ.surface = shape.surface(options.edge.value_or(0.003 * options.scale));
  organ.file = "bladder.ply";
  organ.held = {below(shape.neck())};
  organ.spacing = 0.015 * options.scale;
  organ.clear_radius = 0.008 * options.scale;
  organ.young = 3e4;
  organ.risen = shape.rise(options.young.value_or(organ.young), options.pressure);
  return organ;
}

/// A strip of 60 x 40 x 2 mm, held at both ends.
MadeOrgan make_sheet(const DatasetOptions& options) {
  const Eigen::Vector3d size = options.scale * Eigen::Vector3d(0.06, 0.04, 0.002);
  MadeOrgan organ;
  organ.surface = box(size, options.edge.value_or(0.005 * options.scale), "sheet");
  organ.file = "sheet.ply";
  const Eigen::Vector3d end = 0.4 * size.x() * Eigen::Vector3d::UnitX();
  organ.held = {{end, -Eigen::Vector3d::UnitX()}, {-end, Eigen::Vector3d::UnitX()}};
  organ.spacing = 0.01 * options.scale;
  organ.clear_radius = 0.2 * size.x();
  organ.young = 3e4;
  const double thin = 0.1 * size.z();
  organ.sampled_box = {Eigen::Vector3d(-0.3 * size.x(), -0.35 * size.y(), -thin),
                       Eigen::Vector3d(0.3 * size.x(), 0.35 * size.y(), thin)};
  return organ;
}

MadeOrgan make_organ(const DatasetOptions& options) {
  const double finest = 0.0005 * options.scale;  // about half a million triangles
  if (options.edge && *options.edge < finest) {
    throw Error(ExitCode::usage, "edge: got " + std::to_string(*options.edge) + " m; allowed at least " +
                                     std::to_string(finest) + " m at this scale");
  }
  switch (options.organ) {
    case Organ::slab:
      return make_slab(options);
    case Organ::ball:
      return make_ball(options);
    case Organ::liver:
      return make_liver(options);
    case Organ::kidney:
      return make_kidney(options);
    case Organ::bladder:
      return make_bladder(options);
    case Organ::sheet:
      return make_sheet(options);
  }
  throw Error(ExitCode::usage, "unknown organ");
}

Site site_at(const View& view, double x, double y) {
  const std::optional<Site> site = view.highest(x, y);
  if (!site) throw Error(ExitCode::usage, "the motion leaves the organ; allowed: a larger scale");
  return *site;
}

/// A ball under the middle of where the organ is probed.
EllipsoidFacts place_inclusion(const MadeOrgan& organ, const View& view, const DatasetOptions& options) {
  const double radius = options.inclusion_radius.value_or(organ.inclusion_radius);
  const double gap = options.inclusion_gap.value_or(0.008 * options.scale);
  const Site above = site_at(view, organ.centre.x(), organ.centre.y());
  const Eigen::Vector3d centre = above.point - (gap + radius) * Eigen::Vector3d::UnitZ();
  const Surface inclusion = geometry::ellipsoid(centre, Eigen::Vector3d::Constant(radius), radius / 4, "inclusion");
  double least = organ.depth_inside(centre);
  for (const Eigen::Vector3d& v : inclusion.vertices) least = std::min(least, organ.depth_inside(v));
  const double wanted = 0.1 * radius;
  if (least < wanted) {
    throw Error(ExitCode::usage, "the inclusion of radius " + std::to_string(radius) + " m under " +
                                     std::to_string(gap) + " m of tissue comes within " + std::to_string(least) +
                                     " m of the organ's surface; allowed: at least " + std::to_string(wanted) +
                                     " m (a tenth of its radius)");
  }
  return {"inclusion", centre, Eigen::Vector3d::Constant(radius), "", options.inclusion_young};
}

void check_options(const DatasetOptions& options) {
  const auto refuse = [](const char* what) { throw Error(ExitCode::usage, what); };
  const bool solid = options.organ == Organ::slab || options.organ == Organ::ball || options.organ == Organ::liver;
  if (options.inclusion && !solid) refuse("an inclusion is put into a slab, a ball or a liver");
  if (options.tumour && !(options.organ == Organ::liver && options.inclusion))
    refuse("a tumour is the inclusion of a liver");
  if (options.tumour && options.young) refuse("a liver with a tumour has its tissue's stiffness");
  if (options.pressure > 0 && options.organ != Organ::bladder) refuse("only a bladder has a cavity to be filled");
}

/// The tool's mesh; nothing where the scene can name the shape.
std::optional<Surface> make_tool_mesh(const DatasetOptions& options) {
  if (options.instrument == Instrument::stylus) {
    const double shaft = 2.5 * options.tool_radius;
    if (options.tool_length < 8 * options.tool_radius) {
      throw Error(ExitCode::usage, "a stylus of tip radius " + std::to_string(options.tool_radius) +
                                       " m needs a length of at least " + std::to_string(8 * options.tool_radius) +
                                       " m");
    }
    return stylus_tool(options.tool_radius, shaft, options.tool_length);
  }
  if (!options.instrument_as_mesh) return std::nullopt;
  if (options.instrument == Instrument::sphere) return sphere_tool(options.tool_radius);
  if (options.instrument == Instrument::capsule) return capsule_tool(options.tool_radius, options.tool_length);
  throw Error(ExitCode::usage, "a punch is not written as a mesh; allowed: sphere, capsule, stylus");
}

std::string make_motion(const MadeOrgan& organ, const View& view, const DatasetOptions& options) {
  MotionOptions motion;
  motion.rate = options.motion_rate;
  motion.depth = 0.8 * options.depth;
  motion.tangential = options.friction > 0 ? 0.3 * options.depth : 0.0;
  motion.clearance = 2 * options.depth;
  motion.tip_offset = options.instrument == Instrument::punch ? 0.0 : options.tool_radius;
  Random random(options.seed ^ 0x70616c70617465ULL);  // a stream apart from the organ's
  const double x = organ.centre.x() + 0.5 * organ.clear_radius * random.uniform(-1, 1);
  const double y = organ.centre.y() + 0.5 * organ.clear_radius * random.uniform(-1, 1);
  const auto risen = [&](Site site) {
    site.point.z() += organ.risen;
    return site;
  };
  if (options.motion == MotionKind::probe) return probe_motion(risen(site_at(view, x, y)), motion);
  std::vector<Site> sites;
  constexpr int count = 60;
  for (int i = 0; i <= count; ++i) {
    sites.push_back(risen(site_at(view, organ.centre.x() + organ.clear_radius * (2.0 * i / count - 1), y)));
  }
  return scan_motion(sites, motion);
}

}  // namespace

std::vector<std::filesystem::path> write_dataset(const DatasetOptions& options, const std::filesystem::path& folder) {
  // Everything is made before anything is written: a refusal leaves no half data set.
  check_options(options);
  const MadeOrgan organ = make_organ(options);
  const View view(organ.surface);
  SceneFacts facts;
  facts.organ_file = organ.file;
  facts.held = organ.held;
  facts.spacing = options.spacing.value_or(organ.spacing);
  facts.sampled_box = organ.sampled_box;
  // The margins of slab and sheet lie outside the sampled box; a bladder is thin all over.
  facts.uniform = organ.sampled_box || options.organ == Organ::bladder;
  facts.regions = organ.regions;
  facts.young = options.young.value_or(organ.young);
  if (!options.young) facts.tissue = organ.tissue;
  facts.pressure = options.pressure;
  std::optional<Surface> inclusion;
  if (options.inclusion) {
    EllipsoidFacts ball = place_inclusion(organ, view, options);
    if (options.tumour) {
      facts.tissue = "liver";
      ball.name = "tumour";
      ball.tissue = "liver-tumour";
      facts.regions.push_back(ball);
    } else {
      inclusion = geometry::ellipsoid(ball.centre, ball.radii, ball.radii.x() / 4, "inclusion");
      facts.inclusion_file = "inclusion.ply";
    }
  }
  const std::optional<Surface> tool = make_tool_mesh(options);
  if (tool) facts.tool_file = "tool.ply";
  const std::string motion = make_motion(organ, view, options);

  make_folder(folder);
  std::vector<std::filesystem::path> files{folder / "scene.toml", folder / "motion.csv", folder / organ.file};
  write_surface(organ.surface, files[2]);
  if (inclusion) write_surface(*inclusion, files.emplace_back(folder / facts.inclusion_file));
  if (tool) write_surface(*tool, files.emplace_back(folder / facts.tool_file));
  write_file(files[1], motion);
  write_file(files[0], scene_text(options, facts));
  return files;
}

}  // namespace palpate::synth
