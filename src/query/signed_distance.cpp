// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/trigonometry.hpp>
#include <morula/query/signed_distance.hpp>
#include <numbers>

#include "parallel/float_environment.hpp"

namespace morula {
namespace {

constexpr std::size_t grain = 4096;

// Values of neighbors_ that are no facet: the edge is the surface's border, or slivers or a third facet meet there.
constexpr std::uint32_t border = 0xffffffffu, undecided = 0xfffffffeu;

// A facet whose height is below this share of its longest edge has a normal that rounding has turned. Across it the
// surface goes on in a direction that its neighbours' normals do not show, so leaving it out of an average is no cure:
// what touches it is decided by the winding number.
constexpr double sliver_ratio = 1e-7;

bool repeats_an_index(const Facet& f) {
  return f[0] == f[1] || f[1] == f[2] || f[2] == f[0];
}

bool has_edge(const Facet& f, std::uint32_t a, std::uint32_t b) {
  return (f[0] == a || f[1] == a || f[2] == a) && (f[0] == b || f[1] == b || f[2] == b);
}

// Facets around each vertex, ascending. Those with a repeated index are left out: they are edges or points.
struct Fans {
  std::vector<std::uint32_t> begin, facets;

  explicit Fans(const Mesh& mesh) : begin(mesh.vertex_count() + 1, 0) {
    for (const Facet& f : mesh.facets)
      if (!repeats_an_index(f))
        for (const std::uint32_t v : f) ++begin[v + 1];
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) begin[v + 1] += begin[v];
    facets.resize(begin.back());
    std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
    for (std::uint32_t f = 0; f < mesh.facet_count(); ++f)
      if (!repeats_an_index(mesh.facets[f]))
        for (const std::uint32_t v : mesh.facets[f]) facets[next[v]++] = f;
  }
  std::uint32_t count(std::uint32_t vertex) const { return begin[vertex + 1] - begin[vertex]; }
};

}  // namespace

SignedDistance::SignedDistance(const Mesh& mesh, Workers& workers) : SignedDistance(mesh, nullptr, workers) {}

SignedDistance::SignedDistance(const Mesh& mesh, SignMethod method, Workers& workers)
    : SignedDistance(mesh, &method, workers) {}

SignedDistance::SignedDistance(const Mesh& mesh, const SignMethod* method, Workers& workers) : bvh_(mesh, workers) {
  const StandardFloats standard;
  const MeshReport report = inspect(mesh);
  has_volume_ = report.has_volume();
  if (has_volume_ && report.volume < 0) orientation_ = -1;
  if (method)
    method_ = *method;
  else if (has_volume_ && report.manifold && separates_sides())
    method_ = SignMethod::pseudo_normal;
  if (method_ == SignMethod::pseudo_normal) prepare_normals(mesh, workers);
}

// At a facet's middle the rest of the surface has winding number ½ if there is nothing on one side and one layer of
// body on the other.
bool SignedDistance::separates_sides() const {
  constexpr std::size_t probes = 1000;
  const std::size_t count = std::min(probes, bvh_.facet_count());
  for (std::size_t i = 0; i < count; ++i) {
    const Triangle& t = bvh_.triangle(static_cast<std::uint32_t>(i * bvh_.facet_count() / count));
    if (!(length(area_vector(t)) > 0)) continue;
    const Vec3 middle = at_barycentric(t, {1.0 / 3, 1.0 / 3, 1.0 / 3});
    // A facet counts fully where it is met, and rounding decides on which side of it its middle lies: without itself.
    const double rest = bvh_.winding_number(middle) - solid_angle(t, middle) / (4 * std::numbers::pi);
    if (std::abs(orientation_ * rest - 0.5) > 0.25) return false;
  }
  return true;
}

void SignedDistance::prepare_normals(const Mesh& mesh, Workers& workers) {
  facets_ = mesh.facets;
  facet_normals_.resize(mesh.facet_count());
  parallel_for(workers, mesh.facet_count(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const Triangle t = mesh.corners(f);
      const Vec3 normal = area_vector(t);
      const double twice_area = length(normal);
      const double longest =
          std::max({squared_distance(t[0], t[1]), squared_distance(t[1], t[2]), squared_distance(t[2], t[0])});
      if (twice_area > sliver_ratio * longest) facet_normals_[f] = normal / twice_area;
    }
  });

  const Fans fans(mesh);
  const auto is_sliver = [&](std::uint32_t f) { return facet_normals_[f] == Vec3{}; };
  vertex_normals_.resize(mesh.vertex_count());
  parallel_for(workers, mesh.vertex_count(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      Vec3 sum;
      double angles = 0;
      for (std::uint32_t i = fans.begin[v]; i < fans.begin[v + 1]; ++i) {
        const std::uint32_t f = fans.facets[i];
        if (is_sliver(f)) {
          angles = 0;
          break;
        }
        const Facet& corners = mesh.facets[f];
        const std::size_t k = corners[0] == v ? 0 : corners[1] == v ? 1 : 2;
        const Vec3 a = mesh.positions[corners[(k + 1) % 3]] - mesh.positions[v];
        const Vec3 b = mesh.positions[corners[(k + 2) % 3]] - mesh.positions[v];
        const double angle = angle_of(length(cross(a, b)), dot(a, b));
        sum += facet_normals_[f] * angle;
        angles += angle;
      }
      if (angles > 0) vertex_normals_[v] = sum / angles;
    }
  });

  neighbors_.resize(mesh.facet_count());
  parallel_for(workers, mesh.facet_count(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      for (std::size_t k = 0; k < 3; ++k) {
        std::uint32_t a = mesh.facets[f][(k + 1) % 3], b = mesh.facets[f][(k + 2) % 3];
        // Around the vertex of fewer facets: a fan of n facets then costs n steps, not n².
        if (fans.count(b) < fans.count(a)) std::swap(a, b);
        std::uint32_t found = border;
        for (std::uint32_t i = fans.begin[a]; i < fans.begin[a + 1]; ++i) {
          const std::uint32_t other = fans.facets[i];
          if (other == f || !has_edge(mesh.facets[other], a, b)) continue;
          found = found == border && !is_sliver(other) ? other : undecided;
        }
        neighbors_[f][k] = found;
      }
  });
}

SignedDistance::Result SignedDistance::at(const Vec3& p) const {
  const StandardFloats standard;
  const std::optional<ClosestFacetPoint> closest = bvh_.closest_point(p);
  if (!closest) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    return {nan, {0, {nan, nan, nan}, {nan, nan, nan}, nan}};
  }
  const double distance = std::sqrt(closest->squared_distance);
  return {distance > 0 && decide_inside(p, *closest, distance) ? -distance : distance, *closest};
}

bool SignedDistance::decide_inside(const Vec3& p, const ClosestFacetPoint& closest, double distance) const {
  // A body is inside its box. From far away rounding decides which facet is nearest, and it may be one behind.
  const Box& box = bvh_.bounding_box();
  if (has_volume_ && (max(p, box.upper) != box.upper || min(p, box.lower) != box.lower)) return false;
  if (method_ == SignMethod::pseudo_normal) {
    const std::array<double, 3>& b = closest.barycentric;
    const std::size_t corner = b[0] > 0 ? 0 : b[1] > 0 ? 1 : 2;
    const int zeros = (b[0] == 0) + (b[1] == 0) + (b[2] == 0);
    Vec3 normal = facet_normals_[closest.facet];
    if (zeros == 2) {
      normal = vertex_normals_[facets_[closest.facet][corner]];
    } else if (zeros == 1) {
      const std::uint32_t other = neighbors_[closest.facet][b[0] == 0 ? 0 : b[1] == 0 ? 1 : 2];
      if (other == undecided || normal == Vec3{}) {
        normal = {};
      } else if (other != border) {
        normal = (normal + facet_normals_[other]) * 0.5;
      }
    }
    // From a corner rather than from the nearest point: the normal is at right angles to the facet or edge between
    // them, and the corner has not been rounded. Slivers leave no normal, razor edges a short one, and within rounding
    // of the surface there is no direction to speak of: then this says nothing.
    constexpr double least_cosine = 1e-6;
    const double along = orientation_ * dot(p - bvh_.triangle(closest.facet)[corner], normal);
    if (std::abs(along) > least_cosine * distance) return along < 0;
  }
  double turns = orientation_ * bvh_.winding_number(p);
  // A closed surface goes around a point a whole number of times: anything else is the far field's error, or a point on
  // the surface, where either answer will do.
  if (has_volume_ && std::abs(turns - std::round(turns)) > 0.2) turns = orientation_ * bvh_.winding_number(p, 8.0);
  return turns > 0.5;
}

}  // namespace morula
