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
#include "collide/shapes/placed_shapes.hpp"
#include "geometry/infinity.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

void sort_lists(Touch& result) {
  std::sort(result.leaves.begin(), result.leaves.end());
  std::sort(result.facets.begin(), result.facets.end(),
            [](const TouchingFacet& a, const TouchingFacet& b) { return a.point.facet < b.point.facet; });
  // A facet with parts in several leaves was tested in each, with the same result.
  result.facets.erase(
      std::unique(result.facets.begin(), result.facets.end(),
                  [](const TouchingFacet& a, const TouchingFacet& b) { return a.point.facet == b.point.facet; }),
      result.facets.end());
}

template <class Shape>
void search(const Collider& body, const Shape& shape, const TouchOptions& options, Touch& result) {
  const PlacedSpheres spheres(body);
  const double margin = options.margin;
  double limit = options.nearest ? infinity : margin;  // distance up to which facets are sought
  double best = infinity;
  result.lower = infinity;

  const auto add = [&](std::uint32_t facet, const Triangle& corners, const FoundOnShape& found) {
    const bool is_first = found.distance < best || (found.distance == best && facet < result.deepest->point.facet);
    const bool touches = found.distance <= margin;
    if (!(options.nearest || touches) || !(is_first || (options.collect_all && touches))) return;
    const TouchingFacet touching{
        {facet, found.barycentric, found.point}, 0.0 - found.distance, shape.normal_at(found.point, corners)};
    if (options.collect_all && touches) result.facets.push_back(touching);
    if (!is_first) return;
    best = found.distance;
    result.deepest = touching;
    result.touches = touches;
    // A list needs everything within the margin.
    limit = std::min(limit, options.collect_all ? std::max(best, margin) : best);
  };

  const auto bound = [&](std::uint32_t node) {
    ++result.sphere_tests;
    return shape.bound(spheres(node));
  };
  const auto prune = [&](double b) { result.lower = std::min(result.lower, b); };
  walk_nearest_first(
      body.tree(), bound, [&] { return limit; }, prune,
      [&](std::uint32_t leaf, double leaf_bound) {
        bool touched = false;
        for (const std::uint32_t facet : body.facets(leaf)) {
          const Triangle corners = body.triangle(facet);
          if constexpr (Shape::looks_at_spheres_first) {
            const double facet_bound = shape.bound(sphere_about(corners));
            if (facet_bound > limit) {
              prune(facet_bound);
              continue;
            }
          }
          ++result.facet_tests;
          const FoundOnShape found = shape.look_at(corners);
          prune(std::max(found.lower, leaf_bound));
          touched = touched || found.distance <= margin;
          add(facet, corners, found);
          if (options.stop_at_first && result.touches) {
            prune(leaf_bound);
            return false;
          }
        }
        if (options.collect_all && touched) result.leaves.push_back(leaf);
        return true;
      });
  result.proven_clear = !result.touches && result.lower > margin;
  sort_lists(result);
  result.status = {};
}

// Empties the result; true when the query may go on.
bool begin(const Collider& body, bool good_shape, const TouchOptions& options, Touch& result) {
  result.status = askable(body);
  if (result.status && !good_shape) result.status = {Status::Code::bad_shape};
  if (result.status && !std::isfinite(options.margin)) result.status = {Status::Code::bad_option};
  result.touches = result.proven_clear = result.certified = false;
  result.lower = 0;
  result.deepest.reset();
  result.facets.clear();
  result.leaves.clear();
  result.sphere_tests = result.facet_tests = 0;
  if (!result.status) return false;
  result.certified = body.sphere_state().covers;
  // An exception leaves a result with status ended_by_exception; search() replaces the status at its end.
  result.status = {Status::Code::ended_by_exception};
  return true;
}

template <class Shape, class Place>
const Touch& touch_placed(const Collider& body, const Shape& shape, const TouchOptions& options, Touch& result,
                          const Place& placed) {
  const StandardFloats standard;
  if (begin(body, is_usable(shape), options, result)) search(body, placed(), options, result);
  return result;
}

template <class Shape>
Touch touch_or_throw(const Collider& body, const Shape& shape, const TouchOptions& options) {
  const StandardFloats standard;
  TouchQuery query;
  require_good(query.run(body, shape, options).status);
  return query.result();
}

}  // namespace

const Touch& TouchQuery::run(const Collider& body, const HalfSpace& shape, const TouchOptions& options) {
  return touch_placed(body, shape, options, result_, [&] { return PlacedHalfSpace(shape); });
}
const Touch& TouchQuery::run(const Collider& body, const Sphere& shape, const TouchOptions& options) {
  return touch_placed(body, shape, options, result_,
                      [&] { return PlacedCapsule(shape.center, shape.center, shape.radius); });
}
const Touch& TouchQuery::run(const Collider& body, const Capsule& shape, const TouchOptions& options) {
  return touch_placed(body, shape, options, result_, [&] { return PlacedCapsule(shape.p, shape.q, shape.radius); });
}
const Touch& TouchQuery::run(const Collider& body, const ConvexHull& shape, const TouchOptions& options) {
  return touch_placed(body, shape, options, result_, [&] { return PlacedHull(shape); });
}

Touch touch(const Collider& body, const HalfSpace& shape, const TouchOptions& options) {
  return touch_or_throw(body, shape, options);
}
Touch touch(const Collider& body, const Sphere& shape, const TouchOptions& options) {
  return touch_or_throw(body, shape, options);
}
Touch touch(const Collider& body, const Capsule& shape, const TouchOptions& options) {
  return touch_or_throw(body, shape, options);
}
Touch touch(const Collider& body, const ConvexHull& shape, const TouchOptions& options) {
  return touch_or_throw(body, shape, options);
}

}  // namespace morula
