// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/shapes/placed_shapes.hpp"

#include <cmath>

#include "collide/facets/world_facets.hpp"

namespace morula::detail {
namespace {

bool is_near(const Vec3& p) {
  return max_norm(p) < 0x1p200 && is_finite(p);
}
bool is_good(double radius) {
  return radius >= 0 && radius < 0x1p200;
}

/// Heights of the three corners of a triangle above a plane: heights of its other points are means of these.
using Heights = std::array<double, 3>;

double at(const Heights& h, const Barycentric& b) {
  return h[0] * b[0] + h[1] * b[1] + h[2] * b[2];
}
double greatest(std::span<const Heights> planes, const Barycentric& b) {
  double most = -std::numeric_limits<double>::infinity();
  for (const Heights& h : planes) most = std::max(most, at(h, b));
  return most;
}

/// The point at which the greatest of up to four heights is least: a corner, a point of an edge where two are equal, or
/// an inner point where three are equal. Rounding may miss that point a little, but the result is always a point of the
/// triangle.
Barycentric where_greatest_is_least(std::span<const Heights> planes) {
  Barycentric best{1, 0, 0};
  double least = greatest(planes, best);
  const auto visit = [&](const Barycentric& b) {
    if (const double value = greatest(planes, b); value < least) least = value, best = b;
  };
  visit({0, 1, 0}), visit({0, 0, 1});
  for (std::size_t i = 0; i < planes.size(); ++i)
    for (std::size_t j = i + 1; j < planes.size(); ++j) {
      const Heights d{planes[i][0] - planes[j][0], planes[i][1] - planes[j][1], planes[i][2] - planes[j][2]};
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t l = (k + 1) % 3;
        const double s = d[k] / (d[k] - d[l]);
        if (!(s > 0 && s < 1)) continue;
        Barycentric b{};
        b[k] = 1 - s, b[l] = s;
        visit(b);
      }
      for (std::size_t m = j + 1; m < planes.size(); ++m) {
        const Heights e{planes[i][0] - planes[m][0], planes[i][1] - planes[m][1], planes[i][2] - planes[m][2]};
        const Vec3 c = cross(Vec3{d[0], d[1], d[2]}, Vec3{e[0], e[1], e[2]});
        const double sum = c.x + c.y + c.z;
        const Barycentric b{c.x / sum, c.y / sum, c.z / sum};
        if (b[0] >= 0 && b[1] >= 0 && b[2] >= 0 && b[0] <= 1 && b[1] <= 1 && b[2] <= 1) visit(b);
      }
    }
  return best;
}

}  // namespace

HalfSpace scaled(const HalfSpace& shape) {
  const int exponent = std::ilogb(max_norm(shape.normal));
  const auto scale = [&](double x) { return std::ldexp(x, -exponent); };
  return {{scale(shape.normal.x), scale(shape.normal.y), scale(shape.normal.z)}, scale(shape.offset)};
}

bool is_usable(const HalfSpace& shape) {
  if (!is_finite(shape.normal) || shape.normal == Vec3{}) return false;
  const HalfSpace unit = scaled(shape);
  return std::abs(unit.offset) / length(unit.normal) < 0x1p200;
}
bool is_usable(const Ray& ray) {
  const double longest = max_norm(ray.direction);
  return is_near(ray.origin) && is_finite(ray.direction) && longest > 0x1p-200 && longest < 0x1p200 && ray.t_end >= 0;
}
bool is_usable(const Sphere& shape) {
  return is_near(shape.center) && is_good(shape.radius);
}
bool is_usable(const Capsule& shape) {
  return is_near(shape.p) && is_near(shape.q) && is_good(shape.radius);
}
bool is_usable(const ConvexHull& shape) {
  return !shape.facets().empty();
}

std::size_t PlacedHull::highest_plane(const Vec3& x) const {
  const auto planes = hull_->planes();
  std::size_t highest = 0;
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < planes.size(); ++i)
    if (const double h = dot(planes[i].normal, x) - planes[i].offset; h > most) most = h, highest = i;
  return highest;
}

// A linear program of three unknowns, two for a point and one for its height: a plane is added when it is found to be
// higher than the known ones, and then all except three are dropped. The height over known planes only rises.
//
// Lower bound: a mean of planes, with any weights, is nowhere above the highest of them, and least at a corner of the
// triangle. The best weights are computed like the point, with planes and corners exchanged.
FoundOnShape PlacedHull::lowest(const Triangle& t) const {
  const auto heights = [&](std::size_t plane) {
    const ConvexHull::Plane& p = hull_->planes()[plane];
    return Heights{dot(p.normal, t[0]) - p.offset, dot(p.normal, t[1]) - p.offset, dot(p.normal, t[2]) - p.offset};
  };
  const double coordinate = std::max({max_norm(t[0]), max_norm(t[1]), max_norm(t[2])});
  constexpr int most_rounds = 200;
  std::array<Heights, 4> known;
  std::size_t count = 0;
  FoundOnShape found;
  found.lower = -std::numeric_limits<double>::infinity();
  Barycentric b{1.0 / 3, 1.0 / 3, 1.0 / 3};
  for (int round = 0; round < most_rounds; ++round) {
    const Vec3 x = at_barycentric(t, b);
    const std::size_t highest = highest_plane(x);
    const double height = dot(hull_->planes()[highest].normal, x) - hull_->planes()[highest].offset;
    if (height < found.distance) {
      found.distance = height;
      found.barycentric = b;
      found.point = x;
    }
    if (found.distance - found.lower <= pad(coordinate)) break;
    if (count == 4) {
      // Drops the plane without which the others are highest.
      std::array<Heights, 3> kept{};
      double most = -std::numeric_limits<double>::infinity();
      for (std::size_t out = 0; out < 4; ++out) {
        std::array<Heights, 3> others;
        for (std::size_t i = 0, k = 0; i < 4; ++i)
          if (i != out) others[k++] = known[i];
        const double value = greatest(others, where_greatest_is_least(others));
        if (value > most) most = value, kept = others;
      }
      std::copy(kept.begin(), kept.end(), known.begin());
      count = 3;
    }
    known[count++] = heights(highest);
    b = where_greatest_is_least(std::span(known).first(count));
    for (std::size_t out = 0; out < (count == 4 ? 4u : 1u); ++out) {
      std::array<Heights, 3> corners{};  // minus the heights of one corner above up to three planes
      for (std::size_t i = 0, k = 0; k < 3; i = (i + 1) % count) {
        if (count == 4 && i == out) continue;
        for (std::size_t corner = 0; corner < 3; ++corner) corners[corner][k] = -known[i][corner];
        ++k;
      }
      found.lower = std::max(found.lower, -greatest(corners, where_greatest_is_least(corners)));
    }
  }
  found.lower -= 2 * pad(coordinate);
  return found;
}

FoundOnShape PlacedHull::look_at(const Triangle& t) const {
  FoundOnShape found = lowest(t);
  if (!(found.distance > 0)) return found;
  const Sphere about = sphere_about(t);
  NearestPair nearest;
  nearest.upper = std::numeric_limits<double>::infinity();
  double lower = std::numeric_limits<double>::infinity();
  for (std::size_t f = 0; f < hull_->facets().size(); ++f) {
    const Triangle side = facet(f);
    const Sphere around = sphere_about(side);
    const double apart = scaled_length(around.center - about.center) * (1 - 0x1p-49) -
                         (around.radius + about.radius) * (1 + 0x1p-51) - pad(max_norm(about.center));
    if (apart > nearest.upper) continue;
    const NearestPair pair = nearest_pair(side, t);
    lower = std::min(lower, pair.lower);
    if (pair.upper < nearest.upper) nearest = pair;
  }
  // Planes and facets may disagree about points that only touch, by rounding.
  found.barycentric = nearest.b;
  found.point = nearest.point_b;
  found.distance = nearest.crossing ? 0.0 : scaled_length(nearest.point_b - nearest.point_a);
  found.lower = std::max(lower, found.lower);
  return found;
}

Vec3 PlacedHull::normal_at(const Vec3& x, const Triangle&) const {
  const Vec3 plane = hull_->planes()[highest_plane(x)].normal;
  if (!(height(x) > 0)) return plane;
  const Vec3* nearest = nullptr;
  Vec3 foot;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t f = 0; f < hull_->facets().size(); ++f)
    if (const TrianglePoint p = closest_point(facet(f), x); p.squared_distance < least)
      least = p.squared_distance, foot = p.point, nearest = &foot;
  const Vec3 out = nearest != nullptr ? x - foot : Vec3{};
  return max_norm(out) > 0x1p-40 * max_norm(x) ? normalized(out, plane) : plane;
}

double PlacedHull::distance_at(const Vec3& x) const {
  const double above = height(x);
  if (!(above > 0)) return above;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t f = 0; f < hull_->facets().size(); ++f)
    least = std::min(least, scaled_length(x - closest_point(facet(f), x).point));
  return least;
}

}  // namespace morula::detail
