// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Sweeps by conservative advancement over separating directions.
//
// In the frame of the shape, facets move by −motion. Along a fixed direction n the gap between the shape and a facet is
// linear in time: it shrinks by n · motion. A gap that is positive at a time so proves that both stay apart until it is
// used up. The distance of two convex sets that translate is a convex function of time, and the step along the
// direction of the nearest points is the step of Newton's method, which approaches the first zero from below.
#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/collide/sweep.hpp>
#include <morula/tree/walk.hpp>

#include "collide/facets/world_facets.hpp"
#include "collide/pairs/placed_spheres.hpp"
#include "collide/require.hpp"
#include "collide/shapes/placed_shapes.hpp"
#include "geometry/nearest_pair.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

constexpr double never = std::numeric_limits<double>::infinity();
/// The most steps for one facet; hardly any needs twenty. The time reached is then the result.
constexpr int most_steps = 400;
/// Steps of a bound of a sphere: each only raises the bound.
constexpr int most_bound_steps = 4;

/// A shape that moves, and the pads that pay for rounding. `reach`: the largest |coordinate| of shape, body and motion.
///
/// Heights are sums of three products, positions at a time are off by 2^-51 of the reach, and supports by as much: in
/// all below 2^-48 |direction|_1 reach, with |direction|_1 <= 2.
class Sweep {
 public:
  Sweep(const Vec3& motion, double reach) : motion_(motion), pad_(0x1p-45 * reach + 0x1p-400) {}

  Vec3 at(const Vec3& p, double t) const { return p - motion_ * t; }
  Triangle at(const Triangle& corners, double t) const {
    return {at(corners[0], t), at(corners[1], t), at(corners[2], t)};
  }
  /// The time up to which a gap along a direction holds, from t on; t if it is not positive.
  double last_apart(const Vec3& direction, double gap, double t) const {
    // mutant sweep-rounding: `gap - pad_` -> `gap + pad_`
    const double left = gap - pad_;
    if (!(left > 0)) return t;
    const double rate = dot(direction, motion_) * (1 + 0x1p-50) + 0x1p-50 * max_norm(motion_);
    // mutant sweep-lasts: `left / rate` -> `1.5 * left / rate`
    return rate > 0 ? t + left / rate * (1 - 0x1p-40) : never;
  }
  /// Nearer than this counts as a touch.
  double touch() const { return 16 * pad_; }
  double pad() const { return pad_; }
  const Vec3& motion() const { return motion_; }

 private:
  Vec3 motion_;
  double pad_;
};

double lowest(const Vec3& direction, const Triangle& t) {
  return std::min({dot(direction, t[0]), dot(direction, t[1]), dot(direction, t[2])});
}

/// Calls visit(n) for the directions perpendicular to an edge and to one of a facet.
template <class Visit>
void each_across(const Vec3& edge, const Triangle& facet, const Visit& visit) {
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 n = normalized(cross(edge, facet[(k + 1) % 3] - facet[k]), Vec3{});
    visit(n), visit(-n);
  }
}

/// A sphere or a capsule.
class SweptCapsule {
 public:
  explicit SweptCapsule(const Capsule& shape) : shape_(shape), placed_(shape.p, shape.q, shape.radius) {}
  const PlacedCapsule& placed() const { return placed_; }

  /// A time before which the shape does not reach a sphere.
  double bound(const Sphere& s, const Sweep& sweep) const {
    double t = 0;
    for (int step = 0; step < most_bound_steps; ++step) {
      const Vec3 x = sweep.at(s.center, t);
      const Vec3 foot = shape_.p + (shape_.q - shape_.p) * nearest_parameter(shape_.p, shape_.q, x);
      const double apart = scaled_length(x - foot);
      if (!(apart > 0)) return t;
      const Vec3 n = (x - foot) / apart;
      const double last = sweep.last_apart(n, gap(n, x, s.radius), t);
      if (!(last > t)) return t;
      if (last > 1) return never;
      t = last;
    }
    return t;
  }
  /// Calls visit(n) for directions across an edge of the shape and one of a facet, and along normals of the shape.
  template <class Visit>
  void each_direction(const Triangle& facet, const Vec3&, const Visit& visit) const {
    if (shape_.p == shape_.q) return;
    each_across(shape_.q - shape_.p, facet, visit);
  }

 private:
  double gap(const Vec3& n, const Vec3& center, double radius) const {
    return dot(n, center) - radius * (1 + 0x1p-50) - placed_.support(n);
  }
  Capsule shape_;
  PlacedCapsule placed_;
};

class SweptHull {
 public:
  explicit SweptHull(const ConvexHull& shape) : hull_(&shape), placed_(shape) {}
  const PlacedHull& placed() const { return placed_; }

  /// The time in which the center is behind all planes, moved out by the radius.
  double bound(const Sphere& s, const Sweep& sweep) const {
    double enter = 0, leave = 1;
    const double pad = s.radius * (1 + 0x1p-50) + sweep.pad();
    for (const ConvexHull::Plane& plane : hull_->planes()) {
      const double height = dot(plane.normal, s.center) - plane.offset - pad;
      const double rate = dot(plane.normal, sweep.motion()), error = 0x1p-49 * max_norm(sweep.motion());
      if (height > 0) {
        if (!(rate + error > 0)) return never;
        enter = std::max(enter, height / (rate + error) * (1 - 0x1p-50));
      } else if (rate < -error) {
        leave = std::min(leave, height / (rate + error) * (1 + 0x1p-50));
      }
    }
    // mutant sweep-hull-leaves: `enter > leave` -> `enter > 0.5 * leave`
    return enter > leave ? never : enter;
  }
  // Next to an edge the planes of its sides are the highest. Coplanar facets have the same plane, up to rounding.
  template <class Visit>
  void each_direction(const Triangle& facet, const Vec3& point, const Visit& visit) const {
    const Vec3 highest = highest_normal(point, Vec3{});
    visit(highest);
    each_across(cross(highest, highest_normal(point, highest)), facet, visit);
  }

 private:
  /// The normal of the plane that is highest at a point, among those with another normal than this.
  Vec3 highest_normal(const Vec3& point, const Vec3& other) const {
    double most = -never;
    Vec3 highest;
    for (const ConvexHull::Plane& plane : hull_->planes())
      if (const double h = dot(plane.normal, point) - plane.offset;
          h > most && !(max_norm(plane.normal - other) < 0x1p-30))
        most = h, highest = plane.normal;
    return highest;
  }
  const ConvexHull* hull_;
  PlacedHull placed_;
};

/// The first time at which a facet is not proven to be apart from the shape; no value: it is apart to the end.
template <class Shape>
std::optional<SweepPoint> first_touch(const Shape& shape, const Triangle& corners, const Sweep& sweep, double t_end) {
  const auto& placed = shape.placed();
  SweepPoint result;
  for (int step = 0;; ++step) {
    const Triangle here = sweep.at(corners, result.t);
    const FoundOnShape found = placed.look_at(here);
    const Vec3 out = placed.normal_at(found.point, here);
    double last = result.t;
    if (found.distance > sweep.touch() && step < most_steps) {
      const auto visit = [&](const Vec3& n) {
        const double gap = lowest(n, here) - placed.support(n);
        last = std::max(last, sweep.last_apart(n, gap, result.t));
        return gap;
      };
      // If both are so near that the direction between nearest points is mostly rounding, directions of their sides and
      // edges separate them.
      if (visit(out) < 0.5 * found.distance) {
        const Vec3 normal = normalized(area_vector(here), Vec3{});
        visit(normal), visit(-normal);
        // Next to an edge, rounding turns the direction along it.
        for (std::size_t k = 0; k < 3; ++k) {
          const Vec3 along = normalized(here[(k + 1) % 3] - here[k], Vec3{});
          visit(normalized(out - along * dot(out, along), Vec3{}));
          const Vec3 across = cross(along, normal);
          visit(across), visit(-across);
        }
        shape.each_direction(here, found.point, visit);
      }
      if (last > t_end) return {};
    }
    if (!(last > result.t)) {
      result.point.barycentric = found.barycentric;
      result.point.point = at_barycentric(corners, found.barycentric);
      result.normal = out;
      return result;
    }
    result.t = last;
  }
}

template <class Shape>
void search(const Collider& body, const Shape& shape, const Vec3& motion, double t_end, SweepHit& result) {
  const PlacedSpheres spheres(body);
  const Sphere root = spheres(0);
  const Sweep sweep(motion, max_norm(root.center) + root.radius + shape.placed().size() + max_norm(motion));
  double limit = t_end;
  walk_nearest_first(
      body.tree(),
      [&](std::uint32_t node) {
        ++result.sphere_tests;
        return shape.bound(spheres(node), sweep);
      },
      [&] { return limit; }, [](double) {},
      [&](std::uint32_t leaf, double) {
        for (const std::uint32_t facet : body.facets(leaf)) {
          const Triangle corners = body.triangle(facet);
          if (shape.bound(sphere_about(corners), sweep) > limit) continue;
          ++result.facet_tests;
          std::optional<SweepPoint> touch = first_touch(shape, corners, sweep, limit);
          if (!touch || (result.first && touch->t == result.first->t && facet > result.first->point.facet)) continue;
          result.first = *touch;
          result.first->point.facet = facet;
          limit = touch->t;
        }
        return true;
      });
}

template <class Shape, class Place>
SweepHit sweep_placed(const Collider& body, const Shape& shape, const Vec3& motion, double t_end, const Place& place) {
  const StandardFloats standard;
  SweepHit result;
  result.status = askable(body);
  if (result.status && !(is_usable(shape) && is_finite(motion) && max_norm(motion) < 0x1p200))
    result.status = {Status::Code::bad_shape};
  if (result.status && !(t_end >= 0 && t_end <= 1)) result.status = {Status::Code::bad_option};
  if (!result.status) return result;
  result.certified = body.sphere_state().covers;
  search(body, place(), motion, t_end, result);
  return result;
}

template <class Shape>
SweepHit sweep_or_throw(const Collider& body, const Shape& shape, const Vec3& motion) {
  const SweepHit result = SweepQuery().run(body, shape, motion);
  require_good(result.status);
  return result;
}

}  // namespace

SweepHit SweepQuery::run(const Collider& body, const Sphere& shape, const Vec3& motion, double t_end) const {
  return sweep_placed(body, shape, motion, t_end, [&] {
    return SweptCapsule({shape.center, shape.center, shape.radius});
  });
}
SweepHit SweepQuery::run(const Collider& body, const Capsule& shape, const Vec3& motion, double t_end) const {
  return sweep_placed(body, shape, motion, t_end, [&] { return SweptCapsule(shape); });
}
SweepHit SweepQuery::run(const Collider& body, const ConvexHull& shape, const Vec3& motion, double t_end) const {
  return sweep_placed(body, shape, motion, t_end, [&] { return SweptHull(shape); });
}

SweepHit sweep(const Collider& body, const Sphere& shape, const Vec3& motion) {
  return sweep_or_throw(body, shape, motion);
}
SweepHit sweep(const Collider& body, const Capsule& shape, const Vec3& motion) {
  return sweep_or_throw(body, shape, motion);
}
SweepHit sweep(const Collider& body, const ConvexHull& shape, const Vec3& motion) {
  return sweep_or_throw(body, shape, motion);
}

}  // namespace morula
