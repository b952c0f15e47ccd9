// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Grid [bradshaw2002]: per node, the finest oriented lattice whose occupied cells, or fewer circumspheres of them that
// still contain all samples, number at most the branching.
//
// Departures: a lattice repeats, so shifts within one cell are all there are and a coordinate search over them replaces
// the simplex search, whose objective is piecewise constant; orientations are the principal axes, the coordinate axes
// and their 45° turns; cells need not be cubes.

#include <algorithm>

#include "generators/fit/lattice.hpp"
#include "generators/reduce/reducers.hpp"

namespace morula::detail {
namespace {

struct Candidate {
  std::vector<Vec3> centers;  // centers in the coordinates of the axes
  double radius = std::numeric_limits<double>::infinity();
};

class LatticeSearch {
 public:
  LatticeSearch(std::span<const Vec3> points, std::size_t branching)
      : points_(points), some_points_(some_of(points)), branching_(branching) {}

  // The box of the points divided evenly, cells of any proportion: the smallest cells of which at most `branching` are
  // occupied.
  Candidate even_division() const {
    const Vec3 extent = points_.box().extent(), lower = points_.box().lower;
    const double least_edge = 1e-9 * max_norm(extent);
    const int most = static_cast<int>(std::min<std::size_t>(2 * branching_, 32));
    std::vector<Vec3> edges;
    std::vector<std::pair<double, std::size_t>> order;  // smallest first, in the order of the loops among equals
    for (int nx = 1; nx <= most; ++nx)
      for (int ny = 1; ny <= most; ++ny)
        for (int nz = 1; nz <= most; ++nz) {
          if (static_cast<std::size_t>(nx) * ny * nz > 8 * branching_) break;
          // A hair larger than the box, so that points on its upper faces stay in the last cells.
          edges.push_back({std::max(extent.x, least_edge) * (1 + 1e-9) / nx,
                           std::max(extent.y, least_edge) * (1 + 1e-9) / ny,
                           std::max(extent.z, least_edge) * (1 + 1e-9) / nz});
          order.emplace_back(Lattice{lower, edges.back()}.cell_radius(), order.size());
        }
    std::sort(order.begin(), order.end());
    std::vector<Vec3> centers;
    for (const auto& [radius, i] : order)
      if (occupied({lower, edges[i]}, branching_, centers)) return {std::move(centers), radius};
    return {};
  }

  // Cubic cells, smaller and smaller by a twentieth of the first size, until no shift works.
  Candidate shifted_cubes(double first_edge) const {
    Candidate best;
    Vec3 shift{0, 0, 0};  // shares of a cell
    constexpr int steps = 19;
    int failures = 0;
    for (int step = 0; step < steps && failures < 2; ++step) {
      const double edge = first_edge * (1 - 0.05 * step);
      if (try_size(edge, shift, best))
        failures = 0;
      else
        ++failures;
    }
    return best;
  }

 private:
  struct Count {
    std::size_t cells;
    std::size_t spheres;  // after greedy cover; computed only if near enough to matter
    std::vector<Vec3> centers;
  };
  // Like occupied_cells, for all points. A few of the points, spread over all, mostly show that cells are too many.
  bool occupied(const Lattice& lattice, std::size_t most, std::vector<Vec3>& centers) const {
    return some_points_.occupied_cells(lattice, most, centers) && points_.occupied_cells(lattice, most, centers);
  }
  // most_cells, most_spheres: limits of the count.
  Count count(double edge, const Vec3& shift, std::size_t most_cells, std::size_t most_spheres) const {
    const Lattice lattice{points_.box().lower - shift * edge, {edge, edge, edge}};
    Count result{};
    if (!occupied(lattice, most_cells, result.centers)) {
      result.cells = result.spheres = most_cells + 1;
      return result;
    }
    result.cells = result.spheres = result.centers.size();
    if (result.cells > branching_) {
      const std::vector<std::uint32_t> chosen =
          points_.greedy_cover(result.centers, lattice.cell_radius(), most_spheres);
      std::vector<Vec3> kept;
      for (const std::uint32_t c : chosen) kept.push_back(result.centers[c]);
      result.centers = std::move(kept);
      result.spheres = result.centers.size();
    }
    return result;
  }

  // Coordinate search over the shift, from the shift that worked last.
  bool try_size(double edge, Vec3& shift, Candidate& best) const {
    Count least = count(edge, shift, 2 * branching_, 2 * branching_);
    constexpr int shifts_per_axis = 6;
    for (int sweep = 0; sweep < 2 && least.spheres > branching_; ++sweep) {
      const std::size_t before = least.spheres + least.cells;
      for (int axis = 0; axis < 3 && least.spheres > branching_; ++axis)
        for (int k = 1; k < shifts_per_axis && least.spheres > branching_; ++k) {
          Vec3 trial_shift = shift;
          trial_shift[axis] += static_cast<double>(k) / shifts_per_axis;
          trial_shift[axis] -= std::floor(trial_shift[axis]);
          Count trial = count(edge, trial_shift, std::min(least.cells, 2 * branching_), least.spheres);
          if (trial.spheres < least.spheres || (trial.spheres == least.spheres && trial.cells < least.cells)) {
            least = std::move(trial);
            shift = trial_shift;
          }
        }
      if (least.spheres + least.cells == before) break;
    }
    if (least.spheres > branching_) return false;
    best = {std::move(least.centers), 0.5 * edge * std::sqrt(3.0)};
    return true;
  }

  static std::vector<Vec3> some_of(std::span<const Vec3> points) {
    constexpr std::size_t some = 64;
    std::vector<Vec3> result;
    for (std::size_t i = 0; i < points.size(); i += 1 + points.size() / some) result.push_back(points[i]);
    return result;
  }

  LatticePoints points_, some_points_;
  std::size_t branching_;
};

}  // namespace

Proposals propose_grid(const ReducerInput& node) {
  if (node.samples.empty()) return {};
  const Axes principal = principal_axes(node.samples);
  const Axes coordinate{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  std::vector<Axes> all_axes{principal, coordinate};
  for (int axis = 0; axis < 3; ++axis) all_axes.push_back(turned_by_45_degrees(principal, axis));

  struct Placed {
    Candidate candidate;
    std::size_t axes;
  };
  std::vector<Placed> found;
  for (std::size_t f = 0; f < all_axes.size(); ++f) {
    const std::vector<Vec3> local = in_axes(all_axes[f], node.samples);
    const LatticeSearch search(local, node.branching);
    found.push_back({search.even_division(), f});
    found.push_back({search.shifted_cubes(node.sphere.radius), f});
  }
  std::erase_if(found, [](const Placed& p) { return p.candidate.centers.empty(); });
  std::stable_sort(found.begin(), found.end(),
                   [](const Placed& a, const Placed& b) { return a.candidate.radius < b.candidate.radius; });
  constexpr std::size_t most_proposals = 3;
  Proposals proposals;
  for (std::size_t i = 0; i < found.size() && i < most_proposals; ++i) {
    std::vector<Sphere> spheres;
    for (const Vec3& c : found[i].candidate.centers)
      spheres.push_back({out_of_axes(all_axes[found[i].axes], c), found[i].candidate.radius});
    proposals.push_back({"grid", std::move(spheres)});
  }
  return proposals;
}

}  // namespace morula::detail
