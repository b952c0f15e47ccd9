// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/scale.hpp>
#include <morula/query/signed_distance.hpp>
#include <numbers>
#include <utility>

#include "geometry/inspect_sides.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

constexpr std::size_t grain = 4096;

// A value of neighbors that is no facet: slivers or a third facet meet at the edge. no_facet: the surface's border.
constexpr std::uint32_t undecided = several_facets;

// A facet whose height is below this share of its longest edge has a normal that rounding has turned. Across it the
// surface goes on in a direction that its neighbors' normals do not show, so an average without it would also be wrong:
// the winding number decides for points whose nearest feature touches it.
// mutant signed-slivers: `1e-7` -> `0`
constexpr double sliver_ratio = 1e-7;

// The unit normal; zero if it would be meaningless.
Vec3 normal_of(const Triangle& t) {
  const Vec3 normal = area_vector(t);
  const double twice_area = length(normal);
  const double longest =
      std::max({squared_distance(t[0], t[1]), squared_distance(t[1], t[2]), squared_distance(t[2], t[0])});
  return twice_area > sliver_ratio * longest ? normal / twice_area : Vec3{};
}

}  // namespace

// The data computed before the index is made, so that the connectivity is freed before the index needs memory.
struct SignedDistance::Sides {
  bool has_volume;
  double orientation;
  Normals normals;  // normals; empty unless pseudo_normal is possible and may be requested

  Sides(const MeshView& mesh, const SignMethod* method, Workers& workers) {
    const StandardFloats standard;
    require_usable_scale(mesh);
    const Connectivity sides = connectivity(mesh);
    const MeshReport report = inspect_sides(mesh, sides);
    has_volume = report.has_volume();
    orientation = detail::orientation(report);
    if (method ? *method == SignMethod::pseudo_normal : has_volume && report.manifold)
      normals = Normals(mesh, sides, workers);
  }
};

SignedDistance::SignedDistance(const MeshView& mesh, Workers& workers)
    : SignedDistance(mesh, nullptr, Sides(mesh, nullptr, workers), workers) {}

SignedDistance::SignedDistance(const MeshView& mesh, SignMethod method, Workers& workers)
    : SignedDistance(mesh, &method, Sides(mesh, &method, workers), workers) {}

SignedDistance::SignedDistance(const MeshView& mesh, const SignMethod* method, Sides sides, Workers& workers)
    : normals_(std::move(sides.normals)),
      bvh_(mesh, workers),
      has_volume_(sides.has_volume),
      orientation_(sides.orientation) {
  const StandardFloats standard;
  if (method)
    method_ = *method;
  else if (!normals_.neighbors.empty() && separates_sides())
    method_ = SignMethod::pseudo_normal;
  if (method_ != SignMethod::pseudo_normal) normals_ = {};
}

// At a facet's middle the rest of the surface has winding number ½ if there is nothing on one side and one layer of
// body on the other.
bool SignedDistance::separates_sides() const {
  constexpr std::size_t probes = 1000;
  const std::size_t count = std::min(probes, bvh_.facet_count());
  std::vector<std::uint32_t> touching;
  for (std::size_t i = 0; i < count; ++i) {
    const Triangle t = bvh_.triangle(static_cast<std::uint32_t>(i * bvh_.facet_count() / count));
    if (!(length(area_vector(t)) > 0)) continue;
    const Vec3 middle = at_barycentric(t, {1.0 / 3, 1.0 / 3, 1.0 / 3});
    // Where another facet lies on this one, rounding would decide the sign of its part.
    const double longest = std::max({distance(t[0], t[1]), distance(t[1], t[2]), distance(t[2], t[0])});
    if (normal_of(t) != Vec3{}) bvh_.facets_touching({middle, 1e-9 * longest}, touching);
    // mutant signed-coincident: `touching.size() > 1` -> `false`
    if (touching.size() > 1) return false;
    // The facet itself is subtracted: it counts fully at a point on it, and rounding decides on which side of it its
    // middle lies.
    const double rest = bvh_.winding_number(middle) - solid_angle(t, middle) / (4 * std::numbers::pi);
    if (std::abs(orientation_ * rest - 0.5) > 0.25) return false;
  }
  return true;
}

SignedDistance::Normals::Normals(const MeshView& mesh, const Connectivity& connectivity, Workers& workers)
    : of_vertex(mesh.vertex_count()), neighbors(mesh.facet_count()) {
  std::vector<Vec3> of_facet(mesh.facet_count());
  parallel_for(workers, mesh.facet_count(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) of_facet[f] = normal_of(mesh.corners(f));
  });

  const auto is_sliver = [&](std::uint32_t f) { return of_facet[f] == Vec3{}; };
  parallel_for(workers, mesh.vertex_count(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      Vec3 sum;
      double angles = 0;
      for (const std::uint32_t f : connectivity.vertex_facets(static_cast<std::uint32_t>(v))) {
        if (is_sliver(f)) {
          angles = 0;
          break;
        }
        const Facet& corners = mesh.facets[f];
        const std::size_t k = corners[0] == v ? 0 : corners[1] == v ? 1 : 2;
        const Vec3 a = mesh.positions[corners[(k + 1) % 3]] - mesh.positions[v];
        const Vec3 b = mesh.positions[corners[(k + 2) % 3]] - mesh.positions[v];
        const double angle = angle_of(length(cross(a, b)), dot(a, b));
        sum += of_facet[f] * angle;
        angles += angle;
      }
      if (angles > 0) of_vertex[v] = sum / angles;
    }
  });

  parallel_for(workers, mesh.facet_count(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t other = connectivity.facet_across(static_cast<std::uint32_t>(f), (k + 1) % 3);
        const bool is_facet = other != no_facet && other != several_facets;
        neighbors[f][k] = is_facet && is_sliver(other) ? undecided : other;
      }
  });
}

SignedDistance::Result SignedDistance::at(const Vec3& p, double known) const {
  const StandardFloats standard;
  constexpr double rounding = 1 + 1e-9;
  // A facet that is nearest within a reach is the nearest of all, and the lowest of equally near facets is found either
  // way.
  std::optional<ClosestFacetPoint> closest = bvh_.closest_point(p, known * rounding);
  // mutant known-reach-believed: `!closest` -> `false`
  if (!closest) closest = bvh_.closest_point(p);
  if (!closest) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    return {nan, {{0, {nan, nan, nan}, {nan, nan, nan}}, nan}};
  }
  const double distance = std::sqrt(closest->squared_distance);
  return {distance > 0 && decide_inside(p, *closest, distance) ? -distance : distance, *closest};
}

bool SignedDistance::decide_inside(const Vec3& p, const ClosestFacetPoint& closest, double distance) const {
  // A body is inside its box. From far away rounding decides which facet is nearest, and that may be a facet on the far
  // side.
  const Box& box = bvh_.bounding_box();
  if (has_volume_ && (max(p, box.upper) != box.upper || min(p, box.lower) != box.lower)) return false;
  if (method_ == SignMethod::pseudo_normal) {
    const std::array<double, 3>& b = closest.barycentric;
    const std::size_t corner = b[0] > 0 ? 0 : b[1] > 0 ? 1 : 2;
    const int zeros = (b[0] == 0) + (b[1] == 0) + (b[2] == 0);
    Vec3 normal = normal_of(bvh_.triangle(closest.facet));
    if (zeros == 2) {
      normal = normals_.of_vertex[bvh_.corners(closest.facet)[corner]];
    } else if (zeros == 1) {
      const std::uint32_t other = normals_.neighbors[closest.facet][b[0] == 0 ? 0 : b[1] == 0 ? 1 : 2];
      if (other == undecided || normal == Vec3{}) {
        normal = {};
      } else if (other != no_facet) {
        normal = (normal + normal_of(bvh_.triangle(other))) * 0.5;
      }
    }
    // The vector starts at a corner rather than at the nearest point: the normal is perpendicular to the facet or edge
    // between them, and the corner has no rounding error. Slivers leave no normal, razor edges a short one, and within
    // rounding of the surface the direction is meaningless: the normal decides nothing then.
    // mutant signed-short-normals: `1e-6` -> `0`
    constexpr double least_cosine = 1e-6;
    const double along = orientation_ * dot(p - bvh_.triangle(closest.facet)[corner], normal);
    if (std::abs(along) > least_cosine * distance) return along < 0;
  }
  double turns = orientation_ * bvh_.winding_number(p);
  // A closed surface goes around a point a whole number of times: anything else is the far field's error, or a point on
  // the surface, for which either answer is valid.
  if (has_volume_ && std::abs(turns - std::round(turns)) > 0.2) turns = orientation_ * bvh_.winding_number(p, 8.0);
  return turns > 0.5;
}

}  // namespace morula
