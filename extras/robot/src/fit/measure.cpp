// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "fit/measure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/accuracy/looseness.hpp>
#include <morula/query/signed_distance.hpp>
#include <numeric>

#include "fit/clip.hpp"
#include "fit/rounding.hpp"

namespace morula::robot {

namespace {

/// The spheres without what rounding to float may take. Kept spheres may come from any source; the radius of fitted
/// ones includes more than that.
std::vector<Sphere> certified_part(std::span<const Sphere> spheres) {
  std::vector<Sphere> certified(spheres.begin(), spheres.end());
  const double allowance = float_allowance(extent_of(spheres));
  // mutant robot-kept-as-floats: `allowance` -> `0 * allowance`
  for (Sphere& s : certified) s.radius = std::max(0.0, s.radius - allowance);
  return certified;
}

/// A distance from the spheres within which every point of the mesh is proven to lie. A bound that exceeds the
/// tolerance by less than it is loose by gives way to the proof of larger spheres.
double proven_distance(const Mesh& mesh, std::vector<Sphere> spheres, const Coverage& cover, double tolerance) {
  if (cover.covered) return 0;
  const double bound = cover.uncovered_distance_upper + cover.tolerance;
  if (bound <= tolerance || !(tolerance > 0)) return bound;
  // mutant robot-tolerance-not-certified: `s.radius += tolerance` -> `s.radius += 2 * tolerance`
  for (Sphere& s : spheres) s.radius += tolerance;
  return coverage(mesh, spheres, serial_workers()).covered ? tolerance : bound;
}

/// A sphere among the shapes is covered if one sphere contains it; otherwise no point of it is farther from the spheres
/// than it reaches out of any of them.
void measure_own_spheres(std::span<const Sphere> own_spheres, std::span<const Sphere> certified, LinkFigures& figures) {
  for (const Sphere& own : own_spheres) {
    double least = std::numeric_limits<double>::infinity();
    for (const Sphere& s : certified) least = std::min(least, distance(s.center, own.center) + own.radius - s.radius);
    if (!(least > 0)) continue;
    figures.covered = false;
    figures.within = std::max(figures.within, least);
    figures.uncovered_distance = std::max(figures.uncovered_distance, least);
  }
}

/// Sets what a link's mesh is covered by. After measure_own_spheres().
void measure_cover(const Mesh& mesh, std::span<const Sphere> certified, double tolerance, LinkFigures& figures) {
  const Coverage cover = coverage(mesh, certified, serial_workers());
  figures.covered = figures.covered && cover.covered;
  figures.uncovered_distance = std::max(figures.uncovered_distance, cover.uncovered_distance);
  figures.uncovered_share = cover.uncovered_area;
  const std::vector<Sphere> spheres(certified.begin(), certified.end());
  figures.within = std::max(figures.within, proven_distance(mesh, spheres, cover, tolerance));
}

/// Upper bounds of the spheres' protrusion out of the surface, ascending.
std::vector<double> protrusions_of(std::span<const Sphere> spheres, const LinkSurface& surface) {
  std::vector<double> protrusions;
  const auto beyond_own = [&](const Sphere& s) {
    double least = std::numeric_limits<double>::infinity();
    for (const Sphere& own : surface.spheres)
      least = std::min(least, s.radius + distance(s.center, own.center) - own.radius);
    return least;
  };
  if (surface.mesh.facets.empty()) {
    for (const Sphere& s : spheres) protrusions.push_back(std::max(0.0, beyond_own(s)));
  } else {
    const SignedDistance object(surface.mesh);
    for (const Sphere& s : spheres)
      protrusions.push_back(std::max(0.0, std::min(object.protrusion_bound(s), beyond_own(s))));
  }
  std::sort(protrusions.begin(), protrusions.end());
  return protrusions;
}

/// Sets the volumes of the shapes and outside of them, if they are all spheres or none is. After LinkFigures::solid.
void measure_volumes(const LinkSurface& surface, std::span<const Sphere> spheres, LinkFigures& figures) {
  if (surface.mesh.facets.empty()) {
    figures.object_volume = union_mass(surface.spheres).volume;
    figures.outside_volume = std::max(0.0, figures.solid.volume - *figures.object_volume);
  } else if (surface.spheres.empty()) {
    const Looseness loose = looseness(surface.mesh, spheres, {.resolution = 128}, serial_workers());
    if (!loose.looseness) return;
    figures.object_volume = loose.object_volume;
    figures.outside_volume = loose.outside_volume;
  }
}

}  // namespace

void measure_link(LinkSpheres& link, std::span<const ClipPlane> planes, double tolerance) {
  LinkFigures& figures = link.figures;
  const LinkSurface& surface = link.surface;
  figures.facets = surface.mesh.facet_count();
  figures.covered = true;
  const std::vector<Sphere> certified = certified_part(link.spheres);
  measure_own_spheres(surface.spheres, certified, figures);
  if (!surface.mesh.facets.empty()) measure_cover(surface.mesh, certified, tolerance, figures);
  figures.solid = union_mass(link.spheres);
  if (!planes.empty()) figures.beyond_clip = reach_beyond(link.spheres, planes);
  measure_volumes(surface, link.spheres, figures);
  const std::vector<double> protrusions = protrusions_of(link.spheres, surface);
  if (protrusions.empty()) return;
  const auto count = static_cast<double>(protrusions.size());
  figures.protrusion_mean = std::accumulate(protrusions.begin(), protrusions.end(), 0.0) / count;
  figures.protrusion_p95 = protrusions[static_cast<std::size_t>(std::ceil(0.95 * count)) - 1];
  figures.protrusion_max = protrusions.back();
}

}  // namespace morula::robot
