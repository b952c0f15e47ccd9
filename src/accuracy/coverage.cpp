// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <morula/accuracy/coverage.hpp>
#include <morula/query/power_diagram.hpp>

#include "accuracy/bare_polygon.hpp"
#include "accuracy/largest_gap.hpp"
#include "accuracy/usable_spheres.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

double rounding_allowance(const MeshView& mesh, std::span<const Sphere> spheres) {
  double largest = largest_coordinate(mesh);
  for (const Sphere& s : spheres) largest = std::max({largest, max_norm(s.center), s.radius});
  // mutant coverage-tolerance: `0x1p-46` -> `0`
  return largest * 0x1p-46;
}

// A share of the facets, gone through in order.
class FacetRange {
 public:
  FacetRange(const MeshView& mesh, std::span<const Sphere> spheres, const PowerDiagram& diagram, double tolerance)
      : gap(diagram, tolerance), mesh_(mesh), spheres_(spheres), diagram_(diagram), tolerance_(tolerance) {}

  void look_at(std::uint32_t facet) {
    const Triangle corners = mesh_.corners(facet);
    area += morula::area(corners);
    // Most facets lie in the sphere that the one before them ended in; a ball is convex, so no cutting is needed to
    // know that they are covered.
    if (contains(spheres_[recent_], corners)) return;
    const PowerDiagram::Growth growth = diagram_.least_growth(corners);
    if (growth.amount <= tolerance_) {
      recent_ = growth.sphere;
      return;
    }
    cut_.clear();
    diagram_.cut({corners, mesh_.facets[facet]}, scratch_, cut_);
    for (std::size_t k = 0; k < cut_.size(); ++k) {
      points_.clear();
      for (const Barycentric& b : cut_.polygon(k)) points_.push_back(at_barycentric(corners, b));
      recent_ = cut_.owner[k];
      if (!contains(spheres_[recent_], points_)) look_at_uncovered(facet, corners);
    }
  }

  double area = 0;
  double uncovered_area = 0;
  LargestGap gap;
  bool all_contained = true;

 private:
  bool contains(const Sphere& s, std::span<const Vec3> points) const {
    const double reach = s.radius + tolerance_;
    for (const Vec3& p : points)
      if (distance(p, s.center) > reach) return false;
    return true;
  }

  void look_at_uncovered(std::uint32_t facet, const Triangle& corners) {
    // Where powers are equal up to rounding, a piece may have gone to a sphere that does not contain it although
    // another does.
    const double upper = diagram_.least_growth(points_).amount;
    if (upper <= tolerance_) return;
    all_contained = false;
    gap.add(points_, facet, upper);
    if (morula::area(corners) > 0)
      uncovered_area += area_outside_sphere(FacetPlane(corners), points_, spheres_[recent_], flat_);
  }

  MeshView mesh_;
  std::span<const Sphere> spheres_;
  const PowerDiagram& diagram_;
  double tolerance_;
  std::uint32_t recent_ = 0;
  CutFacet cut_;
  std::vector<std::uint32_t> scratch_;
  std::vector<Vec3> points_;
  std::vector<Vec2> flat_;
};

}  // namespace

Coverage coverage(const MeshView& mesh, std::span<const Sphere> spheres, Workers& workers) {
  const StandardFloats standard;
  require_some_usable(spheres, "coverage");
  require_usable_scale(mesh);
  Coverage result;
  result.tolerance = rounding_allowance(mesh, spheres);
  const PowerDiagram diagram(spheres);

  constexpr std::size_t grain = 512;
  std::vector<FacetRange> ranges((mesh.facet_count() + grain - 1) / grain,
                                 FacetRange(mesh, spheres, diagram, result.tolerance));
  parallel_for(workers, mesh.facet_count(), grain, [&](std::size_t begin, std::size_t end) {
    FacetRange& range = ranges[begin / grain];
    for (std::size_t f = begin; f < end; ++f) range.look_at(static_cast<std::uint32_t>(f));
  });

  double area = 0, uncovered_area = 0;
  LargestGap gap(diagram, result.tolerance);
  result.covered = true;
  for (const FacetRange& range : ranges) {
    area += range.area;
    uncovered_area += range.uncovered_area;
    result.covered = result.covered && range.all_contained;
    gap.add(range.gap);
  }
  if (result.covered) return result;

  gap.refine();
  // Cells whose corners rounding misplaced are covered after all, in smaller pieces.
  if (gap.upper() <= result.tolerance) {
    result.covered = true;
    return result;
  }
  result.uncovered_area = area > 0 ? std::min(1.0, uncovered_area / area) : 0.0;
  result.uncovered_distance = std::max(0.0, gap.lower());
  result.uncovered_distance_upper = gap.upper() + result.tolerance;
  result.worst_facet = gap.facet();
  return result;
}

}  // namespace morula
