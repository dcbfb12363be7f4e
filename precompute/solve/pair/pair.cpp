// SPDX-License-Identifier: GPL-3.0-or-later
// One pair from mesh to samples: the ladder of refinements and contacts, and the order of the pushes.
#include "precompute/solve/pair/pair.hpp"

#include "formats/io/error.hpp"
#include "precompute/common/processor_time.hpp"
#include "precompute/solve/contact/gates.hpp"
#include "precompute/solve/pair/contact_size.hpp"
#include "precompute/solve/pair/error_estimate.hpp"
#include "precompute/solve/pair/pair_run.hpp"
#include "precompute/solve/pair/sample_difference.hpp"
#include "precompute/solve/push/contact_method.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

namespace palpate::solve {
namespace {

// Meshes are made of the body free of stress, also where it has a prestress.
const Body& stress_free(const Body& body) { return body.stress_free ? *body.stress_free : body; }

struct Attempt {
  PairResult result;
  std::vector<Sample> normal;    // of the normal indentation, as far as it passed, whatever came after it
  double reached = 0.0;          // m, its depth
  bool contact_failed = false;   // see PairRun
  double lost = 0.0;             // see PairOptions
};

Attempt attempt(const ContactCase& contact, const PairPath& path, const PairOptions& options, const mesh::TetMesh& mesh,
                const SolveLimits& limits) {
  const auto& [body, tool, vertex, frame] = contact;
  Attempt made;
  PairResult& result = made.result;
  result.outcome.nodes = static_cast<std::uint32_t>(mesh.nodes.size());
  try {
    Push push(stress_free(body), mesh, *tool.shape, tool::touching_pose(vertex, frame),
              {body.material.young, normal_penalty(options.method, options.penalty), options.tolerance, limits},
              options.materials);
    PairRun run{contact, path, options, mesh, push, result};
    if (!push.held_anywhere()) {
      run.refuse("support: no node of the mesh is held");
    } else if (approach(run)) {
      const bool pushed = normal_indentation(run);
      made.normal = result.samples;
      if (!made.normal.empty()) made.reached = run.curve.back().depth;
      if (pushed && sticking_pushes(run) && grasped_pulls(run)) {
        slipping_pushes(run);
        side_paths(run);
        result.outcome.accepted = true;
      }
    }
    if (!result.outcome.accepted) result.samples.clear();
    made.contact_failed = run.contact_failed;
    result.outcome.factorisations = push.factorisations();
    made.lost = static_cast<double>(mesh.nodes.size()) * push.lost_factorisations();
  } catch (const Error& e) {
    result.samples.clear();
    result.outcome.cause = e.what();
  }
  return made;
}

// Elements of a check, in those checked.
constexpr double kFiner = 0.75;

// One way of solving a pair after another did not.
struct Rung {
  const char* name;  // what its cause stands after
  ContactMethod method;
  double penalty;  // factor of the option's
};
constexpr Rung kLastRungs[] = {{"stiffer contact", ContactMethod::penalty, 4.0},
                               {"augmented Lagrange", ContactMethod::augmented, 1.0},
                               {"log barrier", ContactMethod::barrier, 1.0}};

// The normal indentation on a mesh finer than the one with `scale`.
PairCheck check_of(const PairResult& result, const ContactCase& contact, const PairPath& path,
                   const PairOptions& options) {
  PairPath normal = path;
  normal.tangential_depths.clear();
  normal.side_paths.clear();
  normal.tangential_directions = normal.slip_points = 0;
  normal.grasp_depth = 0.0;
  PairOptions finer = finer_options(options, contact.body, kFiner);
  finer.check = finer.mesh_errors = false;
  const PairResult fine = solve_pair(contact, normal, finer);
  PairCheck check;
  check.nodes = fine.outcome.nodes;
  check.cause = fine.outcome.cause;
  if (!fine.outcome.accepted) return check;
  PairResult pushed = result;
  std::erase_if(pushed.samples, [](const Sample& s) { return s.kind != SampleKind::normal; });
  const SampleDifference d = sample_difference(pushed.samples, fine.samples);
  check.compared = static_cast<std::uint32_t>(d.compared);
  check.within_estimate = static_cast<std::uint32_t>(d.within_estimate);
  check.difference = d.normal;
  return check;
}

// Growth of edges goes with this power of their size (finer_options).
constexpr double kGrowthPower = 0.7;

// The other mesh of an error estimate: its elements, and the share of the difference of the forces that counts. Forces
// of random contacts differ from a mesh 1.5 times as coarse by 1.5 to 5 times their error (palpate verify --battery
// random): with 0.6 of the difference 94 % of the errors are covered, with 0.7 96 %, at four times the error in the
// median. A finer mesh stands in where no coarser one is solved.
struct OtherMesh {
  double scale, share;
};
constexpr OtherMesh kCoarser{1.5, 0.7}, kFinerInstead{0.67, 1.5};

// The ways of solving one pair, and what they led to.
class PairSolve {
public:
  PairSolve(const ContactCase& contact, const PairPath& path, const PairOptions& options)
      : contact_(contact), path_(path), options_(options), deadline_(options.time_limit) {}

  PairResult solve() {
    mesh::VolumeMeshResult mesh;
    for (const double scale : {1.0, 0.8, 0.6}) {
      PairOptions with = options_;
      if (rough_) with.growth *= std::pow(scale, kGrowthPower);
      mesh = mesh_of(with, scale);
      if (mesh.usable) {
        attempt(mesh.mesh, with, scale);
      } else {
        failed("mesh: " + mesh.cause);
      }
      if (accepted_) return std::move(result_);
      add_cause("finer");
      if (ends()) break;
    }
    for (const Rung& rung : kLastRungs) {
      if (rough_ || !contact_failed_ || options_.method != ContactMethod::penalty || ends()) break;
      PairOptions with = options_;
      with.method = rung.method;
      with.penalty *= rung.penalty;
      attempt(mesh.mesh, with, 0.6);
      if (accepted_) return std::move(result_);
      add_cause(rung.name);
    }
    return what_is_left();
  }

private:
  // A normal indentation that passed, of a pair that was not accepted.
  struct Partial {
    PairResult result;
    double reached = 0.0;  // m
    PairOptions with;
    double scale = 1.0;
  };

  [[nodiscard]] bool ends() const { return no_deeper_ || deadline_.passed() || lost_ > options_.most_lost; }

  mesh::VolumeMeshResult mesh_of(const PairOptions& with, double scale) {
    const mesh::SizeField size = contact_size(contact_, path_.normal_depths.back(), with.refine * scale, with);
    mesh::VolumeMeshOptions options = with.mesh;
    options.deadline = &deadline_;
    return mesh::mesh_volume(stress_free(contact_.body), size,
                             {contact_.body.material_point(contact_.frame.origin).point}, options);
  }

  void failed(const std::string& cause) {
    result_ = {};
    contact_failed_ = accepted_ = false;
    result_.outcome.cause = cause;
  }

  void attempt(const mesh::TetMesh& mesh, const PairOptions& with, double scale) {
    Attempt made = solve::attempt(contact_, path_, with, mesh, limits());
    result_ = std::move(made.result);
    accepted_ = result_.outcome.accepted;
    contact_failed_ = made.contact_failed;
    lost_ += made.lost;
    if (!accepted_ && !made.normal.empty()) {
      no_deeper_ = normal_ && made.reached <= normal_->reached;
      if (!normal_ || made.reached >= normal_->reached) {
        normal_ = {{result_.outcome, std::move(made.normal), {}}, made.reached, with, scale};
      }
    }
    if (accepted_) judge_mesh(with, scale);
    if (accepted_ && with.check) check(with, scale);
  }

  // Adds the mesh's errors; a pair that is too far off by them is kept for want of a better one.
  void judge_mesh(const PairOptions& with, double scale) {
    if (!with.mesh_errors || !add_errors(result_.samples, with, scale)) return;
    const double error = error_at_depth(result_.samples);
    if (error <= GateLimits{}.mesh_error) return;
    char text[96];
    std::snprintf(text, sizeof text, "mesh error: the force is off by %.3g by estimate, allowed %.3g", error,
                  GateLimits{}.mesh_error);
    accepted_ = false;
    if (!rough_ || error < error_at_depth(rough_->samples)) rough_ = std::move(result_);
    failed(text);
  }

  // False where no other mesh gives an estimate: the limit stands for it.
  bool add_errors(std::vector<Sample>& samples, const PairOptions& with, double scale) {
    for (const OtherMesh& other : {kCoarser, kFinerInstead}) {
      PairOptions options = with;
      options.growth = std::min(1.0, with.growth * std::pow(other.scale, kGrowthPower));
      options.watch = {};
      const mesh::VolumeMeshResult mesh = mesh_of(options, scale * other.scale);
      if (!mesh.usable) continue;
      const Attempt made = solve::attempt(contact_, compared_path(path_), options, mesh.mesh, limits());
      if (add_mesh_errors(samples, made.result.outcome.accepted ? made.result.samples : made.normal, other.share)) {
        return true;
      }
    }
    for (Sample& s : samples) s.error_estimate += GateLimits{}.mesh_error;
    return false;
  }

  static double error_at_depth(const std::vector<Sample>& samples) {
    double error = 0;
    for (const Sample& s : samples) {
      if (s.kind == SampleKind::normal) error = s.error_estimate;  // the deepest is the last
    }
    return error;
  }

  void check(const PairOptions& with, double scale) {
    PairOptions here = with;
    here.refine *= scale;
    result_.check = check_of(result_, contact_, path_, here);
    const auto cause = failed_check(*result_.check, GateLimits{});
    if (!cause) return;
    std::optional<PairCheck> kept = result_.check;
    normal_.reset();  // the check refuses all of it
    rough_.reset();
    failed(*cause);
    result_.check = std::move(kept);
  }

  void add_cause(const char* name) {
    if (!causes_.empty()) causes_ += std::string("; ") + name + ": ";
    causes_ += result_.outcome.cause;
  }

  PairResult what_is_left() {
    char text[80] = "";
    if (deadline_.passed()) {
      std::snprintf(text, sizeof text, "; given up: after %.3g s of processor time", options_.time_limit);
    } else if (lost_ > options_.most_lost) {
      std::snprintf(text, sizeof text, "; given up: %.3g nodes times factorisations without an equilibrium", lost_);
    }
    causes_ += text;
    if (rough_ && error_at_depth(rough_->samples) <= GateLimits{}.finer_mesh) {
      rough_->outcome.cause = causes_;
      return std::move(*rough_);
    }
    if (!rough_ && normal_) {
      result_ = std::move(normal_->result);
      result_.outcome.accepted = true;
      causes_ = "stopped short: " + causes_;
      if (options_.mesh_errors) add_errors(result_.samples, normal_->with, normal_->scale);
    }
    result_.outcome.cause = causes_;
    return std::move(result_);
  }

  [[nodiscard]] SolveLimits limits() { return {&deadline_, options_.memory_limit}; }

  const ContactCase& contact_;
  const PairPath& path_;
  const PairOptions& options_;
  Deadline deadline_;
  PairResult result_;                // of the last attempt
  std::optional<PairResult> rough_;  // the best whose mesh is too far off
  std::optional<Partial> normal_;    // the deepest and last
  bool accepted_ = false, contact_failed_ = false, no_deeper_ = false;
  double lost_ = 0.0;
  std::string causes_;
};

}  // namespace

PairResult solve_on_mesh(const ContactCase& contact, const PairPath& path, const PairOptions& options,
                         const mesh::TetMesh& mesh) {
  return attempt(contact, path, options, mesh, {}).result;
}

PairResult solve_pair(const ContactCase& contact, const PairPath& path, const PairOptions& options,
                      const SampleSink& sink) {
  PairResult result = PairSolve(contact, path, options).solve();
  // Samples leave only with a pair that passed: a journal never holds points of an abandoned attempt.
  if (sink) {
    for (const Sample& s : result.samples) sink(s);
  }
  return result;
}

}  // namespace palpate::solve
