// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <morula/accuracy/looseness.hpp>
#include <morula/accuracy/measure.hpp>
#include <morula/geometry/scale.hpp>
#include <morula/grains/clump.hpp>
#include <morula/medial/medial_balls.hpp>
#include <morula/query/signed_distance.hpp>
#include <morula/tree/cover.hpp>
#include <stdexcept>
#include <string>

#include "geometry/principal_axes.hpp"
#include "parallel/interruption.hpp"

namespace morula {

using namespace detail;

namespace {

constexpr std::size_t most_spheres_for_radius = 256, most_spheres = 100'000;

void require_sense(const ClumpOptions& o) {
  const auto is_length = [](const std::optional<double>& value) { return !value || (*value > 0 && *value < 1e30); };
  if (!is_length(o.max_protrusion) || !is_length(o.max_radius) || !(o.min_radius >= 0 && o.min_radius < 1e30)) {
    throw std::invalid_argument("clump: the largest radius and protrusion are numbers above 0, the least not below 0");
  }
  if (!(o.tolerance >= 0 && o.tolerance < 1e30)) {
    throw std::invalid_argument("clump: the tolerance is not a number from 0 on");
  }
  if (o.tolerance > 0 && (o.kind == ClumpKind::inner || o.method != Method::optimized)) {
    throw std::invalid_argument("clump: a tolerance is for covers of the method optimized");
  }
  if (!(o.density > 0 && o.density < 1e30)) throw std::invalid_argument("clump: the density is a number above 0");
  if (o.max_radius && *o.max_radius < o.min_radius) {
    throw std::invalid_argument("clump: the largest radius is below the smallest");
  }
  if (o.spheres > most_spheres) throw std::invalid_argument("clump: more than 100000 spheres");
  if (o.kind == ClumpKind::inner) {
    if (o.max_protrusion) throw std::invalid_argument("clump: inner spheres stick out nowhere: no max_protrusion");
    if (o.spheres == 0) throw std::invalid_argument("clump: say how many inner spheres");
  } else if (o.spheres == 0 && !o.max_protrusion) {
    throw std::invalid_argument("clump: say how many spheres, or how far they may stick out");
  }
}

/// The largest motion of a sphere's surface when its numbers are rotated and rounded to float: three coordinates and a
/// radius, each off by 2⁻²⁴ of a number, twice. Numbers grow at most by the distance to the center of mass.
double rounding_allowance(const MeshView& mesh) {
  double extent = 0;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f)
    for (const Vec3& p : mesh.corners(f)) extent = std::max(extent, max_norm(p));
  // mutant clump-allowance: `16 * 0x1p-24` -> `0`
  return 16 * 0x1p-24 * extent;
}

/// The leaves, which cover within the tolerance.
std::vector<Sphere> leaves(const CoveredTree& model, double tolerance) {
  std::vector<Sphere> spheres = level_set_spheres(model.tree, model.tree.level_count() - 1);
  for (Sphere& s : spheres) s = reduced(s, tolerance);
  return spheres;
}

bool none_larger(const std::vector<Sphere>& spheres, double radius) {
  return std::all_of(spheres.begin(), spheres.end(), [&](const Sphere& s) { return s.radius <= radius; });
}

/// A cover by at most so many spheres, or by the number at which none is too large.
std::vector<Sphere> covering_spheres(const MeshView& mesh, const ClumpOptions& o, double allowance, Clump& clump,
                                     Workers& workers) {
  BuildOptions options{
      .method = o.method, .seed = o.seed, .quality = o.quality, .stop = o.stop, .progress = o.progress};
  if (o.spheres > 0) options.spheres = o.spheres;
  options.max_protrusion = o.max_protrusion;
  options.tolerance = o.tolerance;
  CoveredTree model = build(mesh, options, workers);
  const bool complete = model.report.complete;
  if (o.max_radius) {
    const auto fits = [&](const CoveredTree& tree) {
      return none_larger(leaves(tree, o.tolerance), *o.max_radius - allowance);
    };
    std::size_t spheres = options.spheres.value_or(model.tree.leaf_count());
    while (!fits(model) && spheres < most_spheres_for_radius) {
      options.spheres = spheres *= 2;
      model = build(mesh, options, workers);
    }
    // A thick body is covered best by spheres that fill it, for any number of them. The spheres of an octree are as
    // small as its cells.
    for (int depth = 1; !fits(model) && depth <= max_depth; ++depth) {
      model = build(mesh, {.method = Method::octree, .depth = depth, .seed = o.seed, .stop = o.stop}, workers);
    }
    if (!fits(model)) clump.notes.emplace_back("spheres exceed the largest radius; allow larger ones");
    if (o.spheres != 0 && model.tree.leaf_count() > o.spheres) {
      clump.notes.emplace_back("more spheres than requested: that many keep the radius below its limit");
    }
  } else if (!complete) {
    clump.notes.emplace_back("spheres exceed the largest protrusion; allow more of them");
  }
  std::vector<Sphere> spheres = leaves(model, o.tolerance);
  if (const auto points = std::count_if(spheres.begin(), spheres.end(), [](const Sphere& s) { return s.radius == 0; });
      points > 0 && o.tolerance > 0 && o.min_radius == 0) {
    clump.notes.push_back(
        std::to_string(points) +
        (points == 1 ? " sphere is hardly more than a point" : " spheres are hardly more than points") +
        ": the tolerance exceeds the radius that covers; lower it, or set a smallest radius");
  }
  for (Sphere& s : spheres) s.radius = std::max(s.radius + allowance, o.min_radius);
  return spheres;
}

/// Proves what the spheres cover when rounding reduces every radius by the allowance.
void certify_cover(const MeshView& mesh, double tolerance, double allowance, Clump& clump, Workers& workers) {
  std::vector<Sphere> certified = clump.spheres;
  for (Sphere& s : certified) s.radius = std::max(0.0, s.radius - allowance);
  const Coverage cover = coverage(mesh, certified, workers);
  clump.uncovered_distance = cover.uncovered_distance;
  clump.proven = cover.covered;
  if (cover.covered) return;
  clump.within = cover.uncovered_distance_upper + cover.tolerance;
  clump.proven = clump.within <= tolerance;
  if (clump.proven || tolerance == 0) return;
  // The bound is a little too large. Spheres that are larger by the tolerance decide.
  for (Sphere& s : certified) s.radius += tolerance;
  clump.proven = coverage(mesh, certified, workers).covered;
  if (clump.proven) clump.within = tolerance;
}

void measure(const MeshView& mesh, const SignedDistance& object, Clump& clump, Workers& workers) {
  for (const Sphere& s : clump.spheres) {
    check_interrupt();
    clump.protrusion_max = std::max(clump.protrusion_max, object.protrusion_bound(s));
  }
  if (clump.kind == ClumpKind::inner) clump.proven = clump.protrusion_max == 0;
  const Looseness loose = looseness(mesh, clump.spheres, {.resolution = 128}, workers);
  if (loose.looseness) {
    clump.object_volume = loose.object_volume;
    clump.outside_volume = loose.outside_volume;
    clump.missed_volume = *loose.missed_volume * loose.object_volume;
  }
  const ConvergedMass mass = converged_union_mass(clump.spheres);
  clump.solid = mass.solid;
  clump.solid_change = mass.change;
  const PrincipalAxes axes = principal_axes(mass.solid.inertia, std::max(mass.change, 1e-9));
  clump.principal.rows = axes.axes;
  clump.principal.translation = -clump.principal.rotate(mass.solid.center);
  clump.principal_inertia = axes.moments;
}

}  // namespace

std::string_view name(ClumpKind kind) {
  return kind == ClumpKind::cover ? "cover" : "inner";
}

Clump fit_clump(const MeshView& mesh, const ClumpOptions& options, WorkersOrAll given) {
  Workers& workers = given;
  require_sense(options);
  Clump clump;
  clump.kind = options.kind;
  clump.density = options.density;
  require_usable(mesh);
  require_usable_scale(mesh);
  const double allowance = rounding_allowance(mesh);
  if (options.kind == ClumpKind::cover) {
    clump.spheres = covering_spheres(mesh, options, allowance, clump, workers);
    certify_cover(mesh, options.tolerance, allowance, clump, workers);
    measure(mesh, SignedDistance(mesh, workers), clump, workers);
    return clump;
  }
  const SignedDistance object(mesh, workers);
  if (!object.has_volume()) {
    throw std::invalid_argument(
        "inner spheres need a closed surface that faces one way: morula repair may mend it, or take a cover");
  }
  const std::vector<Sphere> balls = inner_ball_candidates(mesh, object,
                                                          {.candidates = options.candidates,
                                                           .margin = allowance,
                                                           .min_radius = options.min_radius,
                                                           .max_radius = options.max_radius,
                                                           .seed = options.seed},
                                                          workers);
  clump.spheres = fullest_balls(balls, options.spheres, options.stop);
  if (options.stop.stop_requested()) throw BuildStopped();
  if (clump.spheres.empty()) {
    throw std::invalid_argument("no inner sphere is that large: lower the smallest radius, or take a cover");
  }
  if (clump.spheres.size() < options.spheres) {
    clump.notes.emplace_back("fewer spheres than requested: others would add nothing");
  }
  measure(mesh, object, clump, workers);
  return clump;
}

}  // namespace morula
