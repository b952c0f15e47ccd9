// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <morula/accuracy/measure.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sphere.hpp>
#include <morula/geometry/triangle.hpp>
#include <morula/query/power_diagram.hpp>
#include <span>
#include <vector>

#include "accuracy/usable_spheres.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

struct Vec2 {
  double x, y;
};

double cross(const Vec2& a, const Vec2& b) {
  return a.x * b.y - a.y * b.x;
}
double dot(const Vec2& a, const Vec2& b) {
  return a.x * b.x + a.y * b.y;
}

// Triangle (origin, a, b) less the disc's sector between the same rays, for a segment that lies outside the disc.
double triangle_less_sector(const Vec2& a, const Vec2& b, double radius) {
  const double twice_triangle = cross(a, b);
  return 0.5 * (twice_triangle - radius * radius * angle_of(twice_triangle, dot(a, b)));
}

/// Area of a convex polygon (counter-clockwise) outside the disc about the origin. Error: a few ulps of the triangles
/// between the origin and those parts of the border that lie outside the disc; what lies inside cancels exactly.
double area_outside_disc(std::span<const Vec2> polygon, double radius) {
  // Green's theorem about the disc's center: a part of the border inside the disc adds a triangle to the polygon's area
  // and the same triangle to the area covered, so only parts outside remain.
  double sum = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec2 a = polygon[k], b = polygon[(k + 1) % polygon.size()];
    const Vec2 along{b.x - a.x, b.y - a.y};
    const double length = std::sqrt(dot(along, along));
    if (length == 0) continue;
    const double height = std::abs(cross(a, along)) / length;
    if (height >= radius) {
      sum += triangle_less_sector(a, b, radius);
      continue;
    }
    const double half_chord = std::sqrt((radius - height) * (radius + height));
    const double foot = -dot(a, along) / length;
    const double enters = (foot - half_chord) / length, leaves = (foot + half_chord) / length;
    const auto at = [&](double t) { return Vec2{a.x + t * along.x, a.y + t * along.y}; };
    if (enters >= 1 || leaves <= 0) {
      sum += triangle_less_sector(a, b, radius);
      continue;
    }
    if (enters > 0) sum += triangle_less_sector(a, at(enters), radius);
    if (leaves < 1) sum += triangle_less_sector(at(leaves), b, radius);
  }
  return std::max(0.0, sum);
}

/// Axes in the plane of a facet that has an area.
struct FacetPlane {
  explicit FacetPlane(const Triangle& facet);

  Vec3 first, second, normal;
};

FacetPlane::FacetPlane(const Triangle& facet) {
  const std::array<Vec3, 3> edges{facet[1] - facet[0], facet[2] - facet[1], facet[0] - facet[2]};
  const auto longest = std::max_element(
      edges.begin(), edges.end(), [](const Vec3& a, const Vec3& b) { return squared_length(a) < squared_length(b); });
  first = normalized(*longest);
  normal = normalized(area_vector(facet));
  second = morula::cross(normal, first);
}

/// Area of the part of a convex polygon in that plane, counter-clockwise about its normal, that lies outside the
/// sphere. scratch: any content.
double area_outside_sphere(const FacetPlane& plane, std::span<const Vec3> polygon, const Sphere& sphere,
                           std::vector<Vec2>& scratch) {
  // Computed from the sphere's center, so that far from the origin nothing cancels. A corner's own height differs from
  // the plane's by rounding alone, so the first one suffices.
  const double height = morula::dot(polygon[0] - sphere.center, plane.normal);
  scratch.clear();
  for (const Vec3& p : polygon) {
    const Vec3 from_center = p - sphere.center;
    scratch.push_back({morula::dot(from_center, plane.first), morula::dot(from_center, plane.second)});
  }
  const double squared = (sphere.radius - height) * (sphere.radius + height);
  return area_outside_disc(scratch, squared > 0 ? std::sqrt(squared) : 0.0);
}

/// Collects convex parts of the surface and finds the largest gap(x) = min_i |x − c_i| − r_i on them.
///
/// Each |x − c_i| is convex, so on a triangle it is largest at a corner, and min_i max_corners |x − c_i| − r_i bounds
/// the gap from above: the bound is exact if one sphere is the nearest at all of the triangle. Triangles are halved
/// along their longest edge, the one with the highest bound first.
class LargestDistance {
 public:
  /// diagram: borrowed. tolerance: distances that differ by less count as equal.
  LargestDistance(const PowerDiagram& diagram, double tolerance) : diagram_(&diagram), tolerance_(tolerance) {}

  /// upper: the least growth that lets one sphere contain the polygon.
  void add(std::span<const Vec3> polygon, std::uint32_t facet, double upper);
  /// Adds the result of another search and the parts that it has not refined yet.
  void add(const LargestDistance& other);
  /// Refines until the bounds are within relative 5e-7 (or a quarter of the tolerance) of each other, or the budget of
  /// 2²⁰ halvings is spent; the bounds hold in either case.
  void refine();

  double lower() const { return best_; }  ///< attained; minus infinity before a part was added
  double upper() const;
  std::uint32_t facet() const { return best_facet_; }  ///< facet on which lower() is attained

 private:
  struct Part {
    Triangle corners;
    std::uint32_t facet;
    double upper;
  };
  double wanted() const;  // bound below which parts need no refinement
  void look_at(const Vec3& x, std::uint32_t facet);
  void push(const Part& part);

  const PowerDiagram* diagram_;
  double tolerance_;
  double best_ = -std::numeric_limits<double>::infinity();
  double dropped_ = -std::numeric_limits<double>::infinity();  // highest bound of a dropped part
  std::uint32_t best_facet_ = 0;
  std::vector<Part> parts_;  // heap, highest bound first
};

constexpr auto lower_bound_first = [](const auto& a, const auto& b) { return a.upper < b.upper; };

// The corner opposite to the longest edge; the first of equals.
int apex_over_longest_edge(const Triangle& t) {
  int apex = 0;
  double longest = -1;
  for (int k = 0; k < 3; ++k) {
    const double squared = squared_distance(t[(k + 1) % 3], t[(k + 2) % 3]);
    if (squared > longest) longest = squared, apex = k;
  }
  return apex;
}

double LargestDistance::wanted() const {
  constexpr double relative = 5e-7;
  return best_ + std::max(relative * best_, 0.25 * tolerance_);
}

void LargestDistance::look_at(const Vec3& x, std::uint32_t facet) {
  const double gap = diagram_->least_growth(std::span(&x, 1)).amount;
  if (gap > best_ || (gap == best_ && facet < best_facet_)) best_ = gap, best_facet_ = facet;
}

void LargestDistance::push(const Part& part) {
  if (part.upper <= wanted()) {
    dropped_ = std::max(dropped_, part.upper);
    return;
  }
  parts_.push_back(part);
  std::push_heap(parts_.begin(), parts_.end(), lower_bound_first);
}

void LargestDistance::add(std::span<const Vec3> polygon, std::uint32_t facet, double upper) {
  if (upper <= wanted()) {
    dropped_ = std::max(dropped_, upper);
    return;
  }
  for (const Vec3& x : polygon) look_at(x, facet);
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
    const Triangle corners{polygon[0], polygon[k], polygon[k + 1]};
    push({corners, facet, polygon.size() == 3 ? upper : std::min(upper, diagram_->least_growth(corners).amount)});
  }
}

void LargestDistance::add(const LargestDistance& other) {
  if (other.best_ > best_ || (other.best_ == best_ && other.best_facet_ < best_facet_))
    best_ = other.best_, best_facet_ = other.best_facet_;
  dropped_ = std::max(dropped_, other.dropped_);
  for (const Part& p : other.parts_) push(p);
}

void LargestDistance::refine() {
  constexpr int most_halvings = 1 << 20;
  for (int i = 0; i < most_halvings && !parts_.empty() && parts_.front().upper > wanted(); ++i) {
    std::pop_heap(parts_.begin(), parts_.end(), lower_bound_first);
    const Part part = parts_.back();
    parts_.pop_back();
    const int apex = apex_over_longest_edge(part.corners);
    const int from = (apex + 1) % 3, to = (apex + 2) % 3;
    const Vec3 middle = 0.5 * (part.corners[from] + part.corners[to]);
    look_at(middle, part.facet);
    for (const int replaced : {from, to}) {
      Part half = part;
      half.corners[replaced] = middle;
      half.upper = std::min(part.upper, diagram_->least_growth(half.corners).amount);
      push(half);
    }
  }
}

double LargestDistance::upper() const {
  const double waiting = parts_.empty() ? dropped_ : std::max(dropped_, parts_.front().upper);
  return std::max(best_, waiting);
}

double rounding_allowance(const MeshView& mesh, std::span<const Sphere> spheres) {
  double largest = largest_coordinate(mesh);
  for (const Sphere& s : spheres) largest = std::max({largest, max_norm(s.center), s.radius});
  // mutant coverage-tolerance: `0x1p-46` -> `0`
  return largest * 0x1p-46;
}

// A share of the facets, processed in order.
class FacetRange {
 public:
  FacetRange(const MeshView& mesh, std::span<const Sphere> spheres, const PowerDiagram& diagram, double tolerance)
      : largest(diagram, tolerance), mesh_(mesh), spheres_(spheres), diagram_(diagram), tolerance_(tolerance) {}

  void look_at(std::uint32_t facet) {
    const Triangle corners = mesh_.corners(facet);
    area += morula::area(corners);
    // Most facets lie in the sphere that contained the end of the last one; a ball is convex, so the test of the
    // corners proves without cuts that they are covered.
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
  LargestDistance largest;
  bool all_contained = true;

 private:
  bool contains(const Sphere& s, std::span<const Vec3> points) const {
    const double reach = s.radius + tolerance_;
    for (const Vec3& p : points)
      if (distance(p, s.center) > reach) return false;
    return true;
  }

  void look_at_uncovered(std::uint32_t facet, const Triangle& corners) {
    // If powers are equal up to rounding, a part may have gone to a sphere that does not contain it although another
    // does.
    const double upper = diagram_.least_growth(points_).amount;
    if (upper <= tolerance_) return;
    all_contained = false;
    largest.add(points_, facet, upper);
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

Coverage coverage(const MeshView& mesh, std::span<const Sphere> spheres, WorkersOrAll given) {
  Workers& workers = given;
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
  LargestDistance largest(diagram, result.tolerance);
  result.covered = true;
  for (const FacetRange& range : ranges) {
    area += range.area;
    uncovered_area += range.uncovered_area;
    result.covered = result.covered && range.all_contained;
    largest.add(range.largest);
  }
  if (result.covered) return result;

  largest.refine();
  // Cells whose corners are misplaced by rounding are covered after all, in smaller parts.
  if (largest.upper() <= result.tolerance) {
    result.covered = true;
    return result;
  }
  result.uncovered_area = area > 0 ? std::min(1.0, uncovered_area / area) : 0.0;
  result.uncovered_distance = std::max(0.0, largest.lower());
  result.uncovered_distance_upper = largest.upper() + result.tolerance;
  result.worst_facet = largest.facet();
  return result;
}

}  // namespace morula
