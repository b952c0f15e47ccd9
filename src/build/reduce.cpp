// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "build/reduce.hpp"

#include <algorithm>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/random.hpp>
#include <numeric>

#include "build/lattice.hpp"
#include "build/partition.hpp"
#include "build/refit.hpp"

namespace morula {
namespace {

// Enough to steer a search; cover never depends on samples.
constexpr std::size_t samples_by_area = 320;
constexpr std::size_t most_corner_samples = 128;
constexpr int fitting_rounds = 2;

Vec3 unit_normal(const Triangle& t, double orientation) {
  const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
  const double size = length(n);
  return size > 0 ? n * (orientation / size) : Vec3{};
}

// Corners of the region's patches, thinned, and points spread over it by area.
struct Samples {
  std::vector<Vec3> points, normals;
  void add(const Vec3& point, const Vec3& normal) {
    points.push_back(point);
    normals.push_back(normal);
  }
};
Samples region_samples(const Mesh& mesh, const Region& region, double orientation, std::uint64_t seed) {
  Samples samples;
  const std::size_t step = std::max<std::size_t>(1, region.corners.size() / most_corner_samples);
  std::vector<double> area_up_to(region.size());
  double total = 0;
  for (std::size_t k = 0; k < region.size(); ++k) {
    const Triangle t = mesh.corners(region.facet[k]);
    const Vec3 normal = unit_normal(t, orientation);
    const auto polygon = region.polygon(k);
    const Vec3 first = at_barycentric(t, polygon[0]);
    for (std::size_t c = 2; c < polygon.size(); ++c)
      total += area({first, at_barycentric(t, polygon[c - 1]), at_barycentric(t, polygon[c])});
    area_up_to[k] = total;
    for (std::size_t c = 0; c < polygon.size(); ++c)
      if ((region.corner_begin[k] + c) % step == 0) samples.add(at_barycentric(t, polygon[c]), normal);
  }
  if (!(total > 0)) return samples;
  Random random(seed);
  std::size_t k = 0;
  for (std::size_t i = 0; i < samples_by_area; ++i) {
    const double at = (static_cast<double>(i) + random.uniform()) / samples_by_area * total;
    while (k + 1 < region.size() && area_up_to[k] <= at) ++k;
    // A random convex combination: not uniform on a polygon, but patches are small beside the region.
    const Triangle t = mesh.corners(region.facet[k]);
    Vec3 point{};
    double sum = 0;
    for (const Barycentric& b : region.polygon(k)) {
      const double weight = random.uniform() + 1e-9;
      point += at_barycentric(t, b) * weight;
      sum += weight;
    }
    samples.add(point / sum, unit_normal(t, orientation));
  }
  return samples;
}

// An even choice of patches.
Region thinned(const Region& region) {
  constexpr std::size_t most_patches = 2000;
  const std::size_t step = (region.size() + most_patches - 1) / most_patches;
  if (step <= 1) return region;
  Region few;
  for (std::size_t k = 0; k < region.size(); k += step) few.add(region.facet[k], region.polygon(k));
  return few;
}

// Parts of a region with a sphere around each, without pad; no part is empty.
struct Fitted {
  std::vector<Region> parts;
  std::vector<Sphere> spheres;
  std::vector<double> protrusions;
  std::size_t leftover_patches = 0;
  double worst = std::numeric_limits<double>::infinity();
};

class ReducerDivider {
 public:
  ReducerDivider(const Mesh& mesh, const BuildOptions& options, const SignedDistance& shape, Reducer reducer)
      : mesh_(mesh),
        branching_(static_cast<std::size_t>(options.branching)),
        pad_(largest_coordinate(mesh)),
        shape_(shape),
        reducer_(std::move(reducer)) {}

  Division operator()(const BuildNode& node) const {
    const Samples samples = region_samples(mesh_, node.region, shape_.orientation(), node.seed);
    const Proposals proposals = reducer_({samples.points, samples.normals, node.sphere, branching_, node.seed, shape_});
    // Proposals are compared after a quick fit to some of the patches; only the best is worth a thorough one to all.
    Fitted best;
    const Region few = thinned(node.region);
    const Proposal* winner = nullptr;
    for (const Proposal& proposal : proposals) {
      Fitted fitted = fit(few, proposal.spheres, Effort::quick);
      if (fitted.worst < best.worst) best = std::move(fitted), winner = &proposal;
    }
    for (int round = 0; round < fitting_rounds && !best.parts.empty(); ++round) {
      Fitted fitted =
          fit(node.region, winner->fill_places ? with_free_places_filled(best) : best.spheres, Effort::thorough);
      if (fitted.worst < best.worst || round == 0) best = std::move(fitted);
    }
    Division division;
    if (winner) division.reducer = winner->reducer;
    division.leftover_patches = best.leftover_patches;
    for (std::size_t i = 0; i < best.parts.size(); ++i) {
      Sphere sphere = best.spheres[i];
      sphere.radius = rounded_up_radius(sphere.radius, std::max(pad_, largest_component(sphere.center)));
      division.children.push_back({std::move(best.parts[i]), sphere, {}, {}, {}, {}, {}});
    }
    return division;
  }

 private:
  enum class Effort { quick, thorough };

  // Divides the region by power and fits each sphere to its part.
  Fitted fit(const Region& region, const std::vector<Sphere>& spheres, Effort effort) const {
    Partition divided = partition(mesh_, region, spheres);
    Fitted fitted;
    fitted.leftover_patches = divided.leftover_patches;
    fitted.worst = 0;
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      if (divided.regions[i].empty()) continue;
      corner_positions(mesh_, divided.regions[i], points);
      const Sphere sphere = effort == Effort::quick ? better_of_two(points, spheres[i].center, shape_)
                                                    : refit(points, spheres[i].center, shape_);
      fitted.protrusions.push_back(shape_.protrusion_bound(sphere));
      fitted.worst = std::max(fitted.worst, fitted.protrusions.back());
      fitted.spheres.push_back(sphere);
      fitted.parts.push_back(std::move(divided.regions[i]));
    }
    return fitted;
  }

  // Children that the proposal did not use go to the spheres that stick out most: those are halved.
  std::vector<Sphere> with_free_places_filled(const Fitted& fitted) const {
    std::vector<Sphere> spheres = fitted.spheres;
    std::vector<std::size_t> order(spheres.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return fitted.protrusions[a] > fitted.protrusions[b]; });
    std::vector<Vec3> points;
    for (std::size_t k = 0; k < order.size() && spheres.size() < branching_; ++k) {
      corner_positions(mesh_, fitted.parts[order[k]], points);
      const auto [one, other] = halved(points, spheres[order[k]]);
      spheres[order[k]] = one;
      spheres.push_back(other);
    }
    return spheres;
  }

  // Two equal spheres side by side along the points' principal axis: by power they divide the points at their mean.
  static std::array<Sphere, 2> halved(std::span<const Vec3> points, const Sphere& sphere) {
    const Vec3 axis = principal_axes(points)[0];
    Vec3 mean{};
    for (const Vec3& p : points) mean += p;
    mean = mean / static_cast<double>(points.size());
    double squares = 0;
    for (const Vec3& p : points) squares += dot(p - mean, axis) * dot(p - mean, axis);
    const Vec3 step = axis * std::sqrt(squares / static_cast<double>(points.size()));
    return {Sphere{mean - step, sphere.radius}, Sphere{mean + step, sphere.radius}};
  }

  const Mesh& mesh_;
  std::size_t branching_;
  double pad_;
  const SignedDistance& shape_;
  Reducer reducer_;
};

}  // namespace

Divider divide_by(const Mesh& mesh, const BuildOptions& options, const SignedDistance& shape, Reducer reducer) {
  return ReducerDivider(mesh, options, shape, std::move(reducer));
}

}  // namespace morula
