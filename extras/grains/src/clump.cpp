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
#include <stdexcept>

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
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) extent = std::max(extent, max_norm(mesh.positions[v]));
  // mutant clump-allowance: `16 * 0x1p-24` -> `0`
  return 16 * 0x1p-24 * extent;
}

std::vector<Sphere> leaves(const CoveredTree& model) {
  return level_set_spheres(model.tree, model.tree.level_count() - 1);
}

bool none_larger(const CoveredTree& model, double radius) {
  const std::vector<Sphere> spheres = leaves(model);
  return std::all_of(spheres.begin(), spheres.end(), [&](const Sphere& s) { return s.radius <= radius; });
}

/// A cover by at most so many spheres, or by the number at which none is too large.
std::vector<Sphere> covering_spheres(const MeshView& mesh, const ClumpOptions& o, double allowance, Clump& clump,
                                     Workers& workers) {
  BuildOptions options{
      .method = o.method, .seed = o.seed, .quality = o.quality, .stop = o.stop, .progress = o.progress};
  if (o.spheres > 0) options.spheres = o.spheres;
  options.max_protrusion = o.max_protrusion;
  CoveredTree model = build(mesh, options, workers);
  const bool complete = model.report.complete;
  if (o.max_radius) {
    const double largest = *o.max_radius - allowance;
    std::size_t spheres = options.spheres.value_or(model.tree.leaf_count());
    while (!none_larger(model, largest) && spheres < most_spheres_for_radius) {
      options.spheres = spheres *= 2;
      model = build(mesh, options, workers);
    }
    // A thick body is covered best by spheres that fill it, for any number of them. The spheres of an octree are as
    // small as its cells.
    for (int depth = 1; !none_larger(model, largest) && depth <= max_depth; ++depth) {
      model = build(mesh, {.method = Method::octree, .depth = depth, .seed = o.seed, .stop = o.stop}, workers);
    }
    if (!none_larger(model, largest)) clump.notes.emplace_back("spheres exceed the largest radius; allow larger ones");
    if (o.spheres != 0 && model.tree.leaf_count() > o.spheres) {
      clump.notes.emplace_back("more spheres than requested: that many keep the radius below its limit");
    }
  } else if (!complete) {
    clump.notes.emplace_back("spheres exceed the largest protrusion; allow more of them");
  }
  std::vector<Sphere> spheres = leaves(model);
  for (Sphere& s : spheres) s.radius = std::max(s.radius + allowance, o.min_radius);
  return spheres;
}

void measure(const MeshView& mesh, const SignedDistance& object, Clump& clump, Workers& workers) {
  for (const Sphere& s : clump.spheres) {
    check_interrupt();
    clump.protrusion_max = std::max(clump.protrusion_max, object.protrusion_bound(s));
  }
  if (clump.kind == ClumpKind::cover) {
    const Coverage cover = coverage(mesh, clump.spheres, workers);
    clump.proven = cover.covered;
    clump.uncovered_distance = cover.uncovered_distance;
  } else {
    clump.proven = clump.protrusion_max == 0;
  }
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
  const double allowance = rounding_allowance(mesh);
  if (options.kind == ClumpKind::cover) {
    clump.spheres = covering_spheres(mesh, options, allowance, clump, workers);
    measure(mesh, SignedDistance(mesh, workers), clump, workers);
    return clump;
  }
  require_usable(mesh);
  require_usable_scale(mesh);
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
