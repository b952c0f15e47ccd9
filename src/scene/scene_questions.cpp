// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Rays and shapes against all bodies of a scene.
#include <algorithm>
#include <cmath>
#include <morula/geometry/scale.hpp>
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

/// Leaves the bodies out that the query does not look at.
void filter_bodies(const SceneState& s, const SceneFilter& filter) {
  std::erase_if(s.shapes.bodies, [&](std::uint32_t place) { return !s.looks_at(place, filter); });
}

/// Whether the spheres of all bodies that a query looks at cover. Bodies that it does not come near count too, because
/// they could stick out of their boxes.
bool all_cover(const SceneState& s, const SceneFilter& filter) {
  for (std::uint32_t place = 0; place < s.bodies.size(); ++place)
    if (s.bodies[place].collider != nullptr && s.looks_at(place, filter) &&
        !s.bodies[place].collider->sphere_state().covers)
      return false;
  return true;
}

/// The bodies that a ray comes near, in s.shapes.bodies. Rejects a bad ray, and bodies that have moved.
SceneStatus find_bodies_along(const SceneState& s, const Ray& ray, const SceneFilter& filter) {
  if (SceneStatus status = s.current(); !status) return status;
  if (!is_usable(ray)) return rejection({Status::Code::bad_shape});
  s.broad.find_along(ray.origin, ray.direction, ray.t_end, s.shapes.bodies);
  filter_bodies(s, filter);
  return {};
}

/// find(margin) writes the bodies within `margin` of the shape to s.shapes.bodies.
template <class Shape, class Find>
SceneStatus touch_all(SceneState& s, const Shape& shape, bool is_near, const TouchOptions& options,
                      const SceneFilter& filter, const Find& find) {
  const StandardFloats standard;
  if (SceneStatus status = s.current(); !status) return status;
  if (!std::isfinite(options.margin) || options.nearest) return rejection({Status::Code::bad_option});
  if (!is_usable(shape) || !is_near) return rejection({Status::Code::bad_shape});
  find(std::max(0.0, options.margin));
  filter_bodies(s, filter);
  for (const std::uint32_t place : s.shapes.bodies)
    if (const Collider& collider = *s.bodies[place].collider; collider.has_surface())
      if (const Status status = askable(collider); !status) return rejection(status, s.id_of(place));
  s.shapes.touches.clear();
  try {
    for (const std::uint32_t place : s.shapes.bodies) {
      const Collider& collider = *s.bodies[place].collider;
      if (!collider.has_surface()) continue;
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

SceneRayHit Scene::first_hit(const Ray& ray, const SceneFilter& filter) const {
  const StandardFloats standard;
  const SceneState& s = state_->idle("first_hit");
  SceneRayHit hit{.status = find_bodies_along(s, ray, filter)};
  if (!hit.status) return hit;
  hit.certified = all_cover(s, filter);
  Ray rest = ray;
  const RayQuery query;
  for (const std::uint32_t place : s.shapes.bodies) {
    const Collider& collider = *s.bodies[place].collider;
    if (!collider.has_surface()) continue;
    const RayHit here = query.run(collider, rest);
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
  all.certified = all_cover(s, filter);
  const RayQuery query;
  for (const std::uint32_t place : s.shapes.bodies) {
    const Collider& collider = *s.bodies[place].collider;
    if (!collider.has_surface()) continue;
    if (const RayHit here = query.run_all(collider, ray, s.shapes.of_body); !here.status)
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
  return touch_all(s, shape, true, options, filter, [&](double margin) {
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
  return touch_all(s, shape, options.margin < 0x1p200, options, filter, [&](double margin) {
    Box box;
    box.add(shape.p), box.add(shape.q);
    s.broad.find(grown(box, shape.radius + margin), s.shapes.bodies);
  });
}

SceneStatus Scene::touch(const ConvexHull& shape, const TouchOptions& options, const SceneFilter& filter) {
  SceneState& s = state_->idle("touch");
  return touch_all(s, shape, options.margin < 0x1p200, options, filter, [&](double margin) {
    Box box;
    for (const Vec3& p : shape.vertices()) box.add(p);
    s.broad.find(grown(box, margin), s.shapes.bodies);
  });
}

}  // namespace morula
