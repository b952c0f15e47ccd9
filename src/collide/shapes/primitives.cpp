// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <morula/collide/primitives.hpp>
#include <morula/geometry/scale.hpp>
#include <morula/tree/walk.hpp>
#include <stdexcept>

#include "collide/facets/world_facets.hpp"
#include "collide/pairs/placed_spheres.hpp"
#include "collide/require.hpp"
#include "geometry/nearest_pair.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// What a facet is to a shape: its deepest point, and a bound below every point's signed distance.
struct Found {
  Barycentric barycentric{};
  Vec3 point{};
  double distance = infinity;
  double lower = infinity;
};

// A shape has: bound(sphere), below the signed distances of the sphere's points; look_at(triangle); normal_at(point,
// triangle).
class PlacedHalfSpace {
 public:
  static constexpr bool looks_at_spheres_first = false;
  explicit PlacedHalfSpace(const HalfSpace& shape)
      : normal_(shape.normal / length(shape.normal)), offset_(shape.offset / length(shape.normal)) {}

  // Unit normal and offset are off by 5 u of themselves, products and sums by 4 u of |x| <= 1.8 coordinates: allowed 32
  // u of each.
  double bound(const Sphere& s) const { return distance(s.center) - s.radius * (1 + 0x1p-50) - pad(s.center); }
  Found look_at(const Triangle& t) const {
    Found found;
    for (std::size_t k = 0; k < 3; ++k) {
      const double d = distance(t[k]);
      found.lower = std::min(found.lower, d - pad(t[k]));
      if (!(d < found.distance)) continue;
      found.distance = d;
      found.barycentric = {};
      found.barycentric[k] = 1;
      found.point = t[k];
    }
    return found;
  }
  Vec3 normal_at(const Vec3&, const Triangle&) const { return normal_; }

 private:
  double distance(const Vec3& x) const { return dot(normal_, x) - offset_; }
  double pad(const Vec3& x) const { return 0x1p-48 * (max_norm(x) + std::abs(offset_)); }

  Vec3 normal_;
  double offset_;
};

// A capsule, or with one end a sphere.
class PlacedCapsule {
 public:
  static constexpr bool looks_at_spheres_first = true;
  PlacedCapsule(const Vec3& p, const Vec3& q, double radius) : ends_{p, q}, count_(p == q ? 1 : 2), radius_(radius) {}

  // The foot on the axis is off by a few u of the largest coordinate, which can only lengthen the distance by as much.
  double bound(const Sphere& s) const {
    const double coordinate = max_norm(s.center) + std::max(max_norm(ends_[0]), max_norm(ends_[1]));
    return distance(axis_point(s.center), s.center) * (1 - 0x1p-49) - 0x1p-47 * coordinate -
           (s.radius + radius_) * (1 + 0x1p-51);
  }
  Found look_at(const Triangle& t) const {
    const NearestPair pair = nearest_pair(std::span(ends_).first(count_), t);
    Found found;
    found.barycentric = pair.b;
    found.point = pair.point_b;
    // Measured anew: the pair's upper bound is padded.
    found.distance = (pair.crossing ? 0.0 : scaled_length(pair.point_b - pair.point_a)) - radius_;
    found.lower = pair.lower - radius_ - 0x1p-52 * (pair.lower + radius_);
    return found;
  }
  // On the axis there is no such direction, and next to it only rounding's: the surface is pushed back through its own
  // inside.
  Vec3 normal_at(const Vec3& x, const Triangle& t) const {
    const Vec3 out = x - axis_point(x), inward = normalized(-area_vector(t));
    return max_norm(out) > 0x1p-40 * max_norm(x) ? normalized(out, inward) : inward;
  }

 private:
  Vec3 axis_point(const Vec3& x) const {
    return count_ == 1 ? ends_[0] : ends_[0] + (ends_[1] - ends_[0]) * nearest_parameter(ends_[0], ends_[1], x);
  }

  std::array<Vec3, 2> ends_;
  std::size_t count_;
  double radius_;
};

template <class Shape>
void search(const Collider& body, const Shape& shape, const TouchOptions& options, Touch& result) {
  const PlacedSpheres spheres(body);
  const double margin = options.margin;
  double limit = options.nearest ? infinity : margin;  // what is farther is not looked for
  double best = infinity;
  result.lower = infinity;

  const auto add = [&](std::uint32_t facet, const Triangle& corners, const Found& found) {
    const bool is_first = found.distance < best || (found.distance == best && facet < result.deepest->point.facet);
    const bool touches = found.distance <= margin;
    if (!(options.nearest || touches) || !(is_first || (options.list && touches))) return;
    const TouchingFacet touching{
        {facet, found.barycentric, found.point}, 0.0 - found.distance, shape.normal_at(found.point, corners)};
    if (options.list && touches) result.facets.push_back(touching);
    if (!is_first) return;
    best = found.distance;
    result.deepest = touching;
    result.touches = touches;
    // A list needs everything within the margin.
    limit = std::min(limit, options.list ? std::max(best, margin) : best);
  };

  const auto bound = [&](std::uint32_t node) {
    ++result.sphere_tests;
    return shape.bound(spheres(node));
  };
  const auto leave = [&](double b) { result.lower = std::min(result.lower, b); };
  walk_nearest_first(
      body.tree(), bound, [&] { return limit; }, leave,
      [&](std::uint32_t leaf, double leaf_bound) {
        bool touched = false;
        for (const std::uint32_t facet : body.facets(leaf)) {
          const Triangle corners = body.triangle(facet);
          if constexpr (Shape::looks_at_spheres_first) {
            const double facet_bound = shape.bound(sphere_about(corners));
            if (facet_bound > limit) {
              leave(facet_bound);
              continue;
            }
          }
          ++result.facet_tests;
          const Found found = shape.look_at(corners);
          leave(std::max(found.lower, leaf_bound));
          touched = touched || found.distance <= margin;
          add(facet, corners, found);
          if (options.any && result.touches) {
            leave(leaf_bound);
            return false;
          }
        }
        if (options.list && touched) result.leaves.push_back(leaf);
        return true;
      });
  result.clear = !result.touches && result.lower > margin;
  std::sort(result.leaves.begin(), result.leaves.end());
  std::sort(result.facets.begin(), result.facets.end(),
            [](const TouchingFacet& a, const TouchingFacet& b) { return a.point.facet < b.point.facet; });
  // A facet with parts in several leaves was looked at in each, with one answer.
  result.facets.erase(
      std::unique(result.facets.begin(), result.facets.end(),
                  [](const TouchingFacet& a, const TouchingFacet& b) { return a.point.facet == b.point.facet; }),
      result.facets.end());
}

bool is_near(const Vec3& p) {
  return max_norm(p) < 0x1p200 && is_finite(p);
}
bool is_good(double radius) {
  return radius >= 0 && radius < 0x1p200;
}

// Empties the result; true when the query may go on.
bool begin(const Collider& body, bool good_shape, const TouchOptions& options, Touch& result) {
  result.status = askable(body);
  if (result.status && !good_shape) result.status = {Status::Code::bad_shape};
  if (result.status && !std::isfinite(options.margin)) result.status = {Status::Code::bad_option};
  result.touches = result.clear = result.certified = false;
  result.lower = 0;
  result.deepest.reset();
  result.facets.clear();
  result.leaves.clear();
  result.sphere_tests = result.facet_tests = 0;
  if (!result.status) return false;
  result.certified = body.pose().covers;
  return true;
}

template <class Shape>
Touch touch_or_throw(const Collider& body, const Shape& shape, const TouchOptions& options) {
  TouchQuery query;
  require_good(query.run(body, shape, options).status);
  return query.result();
}

}  // namespace

const Touch& TouchQuery::run(const Collider& body, const HalfSpace& shape, const TouchOptions& options) {
  const StandardFloats standard;
  Touch& result = result_;
  const double size = length(shape.normal);
  const bool good = is_near(shape.normal) && size > 0x1p-200 && std::abs(shape.offset) / size < 0x1p200;
  if (!begin(body, good, options, result)) return result;
  search(body, PlacedHalfSpace(shape), options, result);
  return result;
}

const Touch& TouchQuery::run(const Collider& body, const Sphere& shape, const TouchOptions& options) {
  const StandardFloats standard;
  Touch& result = result_;
  if (!begin(body, is_near(shape.center) && is_good(shape.radius), options, result)) return result;
  search(body, PlacedCapsule(shape.center, shape.center, shape.radius), options, result);
  return result;
}

const Touch& TouchQuery::run(const Collider& body, const Capsule& shape, const TouchOptions& options) {
  const StandardFloats standard;
  Touch& result = result_;
  if (!begin(body, is_near(shape.p) && is_near(shape.q) && is_good(shape.radius), options, result)) return result;
  search(body, PlacedCapsule(shape.p, shape.q, shape.radius), options, result);
  return result;
}

Touch touch(const Collider& body, const HalfSpace& shape, const TouchOptions& options) {
  const StandardFloats standard;
  return touch_or_throw(body, shape, options);
}
Touch touch(const Collider& body, const Sphere& shape, const TouchOptions& options) {
  const StandardFloats standard;
  return touch_or_throw(body, shape, options);
}
Touch touch(const Collider& body, const Capsule& shape, const TouchOptions& options) {
  const StandardFloats standard;
  return touch_or_throw(body, shape, options);
}

}  // namespace morula
