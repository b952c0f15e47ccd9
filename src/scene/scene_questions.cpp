// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Rays and shapes against all bodies of a scene.
#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/geometry/scale.hpp>
#include <numeric>
#include <utility>

#include "collide/shapes/placed_shapes.hpp"
#include "parallel/float_environment.hpp"
#include "scene/scene_state.hpp"

namespace morula {
using namespace detail;
namespace {

Box grown(Box box, double by) {
  // Pays for rounding, and for the allowances in the tests of shapes.
  const double pad = by * (1 + 0x1p-40) + 0x1p-40 * (max_norm(box.lower) + max_norm(box.upper));
  box.lower = box.lower - Vec3{pad, pad, pad}, box.upper = box.upper + Vec3{pad, pad, pad};
  return box;
}

/// The bodies that a ray comes near, in s.shapes.bodies. Rejects a bad ray, and bodies that have moved.
SceneStatus find_bodies_along(const SceneState& s, const Ray& ray, const SceneFilter& filter) {
  if (SceneStatus status = s.current(); !status) return status;
  if (!is_usable(ray)) return rejection({Status::Code::bad_shape});
  s.broad.find_along(ray.origin, ray.direction, ray.t_end, s.shapes.bodies);
  s.filter_bodies(filter);
  return {};
}

/// ok, or the first of the bodies to look at that queries on facets reject.
SceneStatus askable_bodies(const SceneState& s) {
  for (const std::uint32_t place : s.shapes.bodies)
    if (const Status status = askable(*s.bodies[place].collider); !status) return rejection(status, s.id_of(place));
  return {};
}

/// Looks at all bodies in the order of lower bounds of their distances, until the bounds exceed the margin and the
/// distance of the nearest body. Lists the bodies within the margin, or the nearest one.
template <class Shape, class Placed>
SceneStatus touch_nearest(SceneState& s, const Shape& shape, const Placed& placed, const TouchOptions& options) {
  s.shapes.nearest.clear();
  for (const std::uint32_t place : s.shapes.bodies)
    s.shapes.nearest.push_back({placed.bound(s.bodies[place].around), place});
  std::sort(s.shapes.nearest.begin(), s.shapes.nearest.end());
  double least = std::numeric_limits<double>::infinity();
  BodyId nearest{};
  for (const auto& [bound, place] : s.shapes.nearest) {
    if (bound > std::max(least, options.margin)) break;
    const std::size_t i = s.shapes.touches.size();
    if (i == s.shapes.queries.size()) s.shapes.queries.push_back(std::make_unique<TouchQuery>());
    const Touch& touch = s.shapes.queries[i]->run(*s.bodies[place].collider, shape, options);
    if (!touch.status) return rejection(touch.status, s.id_of(place));
    s.shapes.touches.push_back({s.id_of(place), &touch});
    const double distance = touch.deepest ? -touch.deepest->depth : std::numeric_limits<double>::infinity();
    // mutant scene-nearest-tie: `s.id_of(place) < nearest` -> `true`
    if (distance < least || (distance == least && s.id_of(place) < nearest)) least = distance, nearest = s.id_of(place);
  }
  std::erase_if(s.shapes.touches,
                [&](const SceneTouch& touch) { return touch.touch->proven_clear && touch.body != nearest; });
  std::sort(s.shapes.touches.begin(), s.shapes.touches.end(),
            [](const SceneTouch& x, const SceneTouch& y) { return x.body < y.body; });
  return {};
}

/// find(margin) writes the bodies within `margin` of the shape to s.shapes.bodies.
template <class Shape, class Place, class Find>
SceneStatus touch_all(SceneState& s, const Shape& shape, bool is_near, const TouchOptions& options,
                      const SceneFilter& filter, const Place& placed, const Find& find) {
  const StandardFloats standard;
  if (SceneStatus status = s.current(); !status) return status;
  if (!std::isfinite(options.margin)) return rejection({Status::Code::bad_option});
  if (!is_usable(shape) || !is_near) return rejection({Status::Code::bad_shape});
  if (options.nearest) {
    s.shapes.bodies.resize(s.bodies.size());
    std::iota(s.shapes.bodies.begin(), s.shapes.bodies.end(), 0u);
  } else {
    find(std::max(0.0, options.margin));
  }
  s.filter_bodies(filter);
  if (const SceneStatus status = askable_bodies(s); !status) return status;
  s.shapes.touches.clear();
  try {
    if (options.nearest) return touch_nearest(s, shape, placed(), options);
    for (const std::uint32_t place : s.shapes.bodies) {
      const Collider& collider = *s.bodies[place].collider;
      if (s.shapes.touches.size() == s.shapes.queries.size())
        s.shapes.queries.push_back(std::make_unique<TouchQuery>());
      const Touch& touch = s.shapes.queries[s.shapes.touches.size()]->run(collider, shape, options);
      if (!touch.status) return rejection(touch.status, s.id_of(place));
      if (!touch.proven_clear) s.shapes.touches.push_back({s.id_of(place), &touch});
    }
  } catch (...) {
    // A part of the results would look like all of them, and a query may be inconsistent.
    s.shapes.touches.clear(), s.shapes.queries.clear();
    throw;
  }
  return {};
}

}  // namespace

SceneStatus detail::SceneState::current() const {
  for (std::uint32_t place = 0; place < bodies.size(); ++place) {
    const SceneBody& body = bodies[place];
    if (body.collider == nullptr) continue;
    if (is_interrupted || (body.is_looked_at() && (body.is_to_be_read || stamp_of(*body.collider) != body.stamp)))
      return rejection({Status::Code::other_frame}, id_of(place));
  }
  return {};
}

void detail::SceneState::filter_bodies(const SceneFilter& filter) const {
  std::erase_if(shapes.bodies, [&](std::uint32_t place) {
    return bodies[place].collider == nullptr || !looks_at(place, filter) || !bodies[place].collider->has_surface();
  });
}

bool detail::SceneState::all_cover(const SceneFilter& filter) const {
  for (std::uint32_t place = 0; place < bodies.size(); ++place)
    if (bodies[place].collider != nullptr && looks_at(place, filter) && !bodies[place].collider->sphere_state().covers)
      return false;
  return true;
}

SceneRayHit Scene::first_hit(const Ray& ray, const SceneFilter& filter) const {
  const StandardFloats standard;
  const SceneState& s = state_->idle("first_hit");
  SceneRayHit hit{.status = find_bodies_along(s, ray, filter)};
  if (!hit.status) return hit;
  hit.certified = s.all_cover(filter);
  Ray rest = ray;
  const RayQuery query;
  for (const std::uint32_t place : s.shapes.bodies) {
    const RayHit here = query.run(*s.bodies[place].collider, rest);
    if (!here.status) return {.status = rejection(here.status, s.id_of(place))};
    if (!here.first || (hit.first && !(here.first->t < hit.first->t))) continue;
    hit.first = here.first;
    hit.body = s.id_of(place);
    rest.t_end = here.first->t;
  }
  return hit;
}

SceneRayHits Scene::all_hits(const Ray& ray, const SceneFilter& filter) {
  const StandardFloats standard;
  SceneState& s = state_->idle("all_hits");
  s.shapes.hits.clear();
  SceneRayHits all{.status = find_bodies_along(s, ray, filter)};
  if (!all.status) return all;
  all.certified = s.all_cover(filter);
  const RayQuery query;
  for (const std::uint32_t place : s.shapes.bodies) {
    if (const RayHit here = query.run_all(*s.bodies[place].collider, ray, s.shapes.of_body); !here.status)
      return {.status = rejection(here.status, s.id_of(place))};
    for (const RayPoint& point : s.shapes.of_body) s.shapes.hits.push_back({s.id_of(place), point});
  }
  std::sort(s.shapes.hits.begin(), s.shapes.hits.end(), [](const SceneHit& x, const SceneHit& y) {
    if (x.hit.t != y.hit.t) return x.hit.t < y.hit.t;
    return std::pair(x.body, x.hit.point.facet) < std::pair(y.body, y.hit.point.facet);
  });
  all.hits = s.shapes.hits;
  return all;
}

SceneStatus Scene::touch(const HalfSpace& shape, const TouchOptions& options, const SceneFilter& filter) {
  SceneState& s = state_->idle("touch");
  const auto placed = [&] { return PlacedHalfSpace(shape); };
  return touch_all(s, shape, true, options, filter, placed, [&](double margin) {
    const HalfSpace unit = scaled(shape);
    const double offset = unit.offset + margin * length(unit.normal);
    s.broad.find_behind(unit.normal, offset + 0x1p-40 * std::abs(offset), s.shapes.bodies);
  });
}

SceneStatus Scene::touch(const Sphere& shape, const TouchOptions& options, const SceneFilter& filter) {
  return touch(Capsule{shape.center, shape.center, shape.radius}, options, filter);
}

SceneStatus Scene::touch(const Capsule& shape, const TouchOptions& options, const SceneFilter& filter) {
  SceneState& s = state_->idle("touch");
  const auto placed = [&] { return PlacedCapsule(shape.p, shape.q, shape.radius); };
  return touch_all(s, shape, options.margin < 0x1p200, options, filter, placed, [&](double margin) {
    Box box;
    box.add(shape.p), box.add(shape.q);
    s.broad.find(grown(box, shape.radius + margin), s.shapes.bodies);
  });
}

SceneStatus Scene::touch(const ConvexHull& shape, const TouchOptions& options, const SceneFilter& filter) {
  SceneState& s = state_->idle("touch");
  const auto placed = [&] { return PlacedHull(shape); };
  return touch_all(s, shape, options.margin < 0x1p200, options, filter, placed, [&](double margin) {
    Box box;
    for (const Vec3& p : shape.vertices()) box.add(p);
    s.broad.find(grown(box, margin), s.shapes.bodies);
  });
}

}  // namespace morula
