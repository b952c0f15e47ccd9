// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Rays and shapes against all bodies of a scene.
#include <algorithm>
#include <cmath>
#include <morula/geometry/scale.hpp>

#include "scene/scene_state.hpp"

namespace morula::detail {
namespace {

SceneStatus refusal(const Status& status, std::optional<BodyId> offender = {}) {
  SceneStatus refused{status};
  refused.offender = offender;
  return refused;
}

bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

Box grown(Box box, double by) {
  // What rounding takes from it, and what the tests of shapes allow.
  const double pad = by * (1 + 0x1p-40) + 0x1p-40 * (max_norm(box.lower) + max_norm(box.upper));
  box.lower = box.lower - Vec3{pad, pad, pad}, box.upper = box.upper + Vec3{pad, pad, pad};
  return box;
}

}  // namespace

SceneStatus SceneState::current() const {
  for (std::uint32_t place = 0; place < bodies.size(); ++place) {
    const SceneBody& body = bodies[place];
    if (body.collider == nullptr) continue;
    if (is_interrupted || (body.is_looked_at() && (body.is_to_be_read || stamp_of(*body.collider) != body.stamp)))
      return refusal({Status::Code::other_frame}, id_of(place));
  }
  return {};
}

SceneRayHit SceneState::first_hit(const Ray& ray) const {
  SceneRayHit hit{.status = current()};
  if (!hit.status) return hit;
  if (!is_finite(ray.origin) || !is_finite(ray.direction) || ray.direction == Vec3{} || !(ray.t_end >= 0)) {
    hit.status.code = Status::Code::bad_shape;
    return hit;
  }
  broad.find_along(ray.origin, ray.direction, ray.t_end, found);
  hit.certified = true;
  Ray rest = ray;
  const RayQuery query;
  for (const std::uint32_t place : found) {
    const Collider& collider = *bodies[place].collider;
    if (!collider.has_surface()) continue;
    const RayHit here = query.run(collider, rest);
    if (!here.status) return {.status = refusal(here.status, id_of(place))};
    hit.certified = hit.certified && here.certified;
    if (!here.first || (hit.first && !(here.first->t < hit.first->t))) continue;
    hit.first = here.first;
    hit.body = id_of(place);
    rest.t_end = here.first->t;
  }
  // Bodies that the ray does not come near could stick out of their boxes.
  for (const SceneBody& body : bodies)
    hit.certified = hit.certified && (body.collider == nullptr || body.collider->sphere_state().covers);
  return hit;
}

template <class Shape>
SceneStatus SceneState::touch_found(const Shape& shape, const TouchOptions& touch_options) {
  for (const std::uint32_t place : found)
    if (const Collider& collider = *bodies[place].collider; collider.has_surface())
      if (const Status status = askable(collider); !status) return refusal(status, id_of(place));
  touches.clear();
  try {
    for (const std::uint32_t place : found) {
      const Collider& collider = *bodies[place].collider;
      if (!collider.has_surface()) continue;
      if (touches.size() == touch_queries.size()) touch_queries.push_back(std::make_unique<TouchQuery>());
      const Touch& touch = touch_queries[touches.size()]->run(collider, shape, touch_options);
      if (!touch.status) return refusal(touch.status, id_of(place));
      if (!touch.proven_clear) touches.push_back({id_of(place), &touch});
    }
  } catch (...) {
    // Some of them would look like all, and a query may be half made.
    touches.clear(), touch_queries.clear();
    throw;
  }
  return {};
}

SceneStatus SceneState::touch(const HalfSpace& shape, const TouchOptions& touch_options) {
  if (SceneStatus status = current(); !status) return status;
  if (!std::isfinite(touch_options.margin) || touch_options.nearest) return refusal({Status::Code::bad_option});
  if (!is_finite(shape.normal) || !std::isfinite(shape.offset) || shape.normal == Vec3{} ||
      !(max_norm(shape.normal) < 0x1p200 && std::abs(shape.offset) < 0x1p400))
    return refusal({Status::Code::bad_shape});
  const double offset = shape.offset + std::max(0.0, touch_options.margin) * scaled_length(shape.normal);
  broad.find_behind(shape.normal, offset + 0x1p-40 * std::abs(offset), found);
  return touch_found(shape, touch_options);
}

SceneStatus SceneState::touch(const Sphere& shape, const TouchOptions& touch_options) {
  return touch(Capsule{shape.center, shape.center, shape.radius}, touch_options);
}

SceneStatus SceneState::touch(const Capsule& shape, const TouchOptions& touch_options) {
  if (SceneStatus status = current(); !status) return status;
  if (!std::isfinite(touch_options.margin) || touch_options.nearest) return refusal({Status::Code::bad_option});
  if (!is_finite(shape.p) || !is_finite(shape.q) || !std::isfinite(shape.radius) || shape.radius < 0 ||
      !(std::max({max_norm(shape.p), max_norm(shape.q), shape.radius, touch_options.margin}) < 0x1p200))
    return refusal({Status::Code::bad_shape});
  Box box;
  box.add(shape.p), box.add(shape.q);
  broad.find(grown(box, shape.radius + std::max(0.0, touch_options.margin)), found);
  return touch_found(shape, touch_options);
}

SceneStatus SceneState::touch(const ConvexHull& shape, const TouchOptions& touch_options) {
  if (SceneStatus status = current(); !status) return status;
  if (!std::isfinite(touch_options.margin) || touch_options.nearest) return refusal({Status::Code::bad_option});
  if (shape.vertices().empty() || !(touch_options.margin < 0x1p200)) return refusal({Status::Code::bad_shape});
  Box box;
  for (const Vec3& p : shape.vertices()) box.add(p);
  broad.find(grown(box, std::max(0.0, touch_options.margin)), found);
  return touch_found(shape, touch_options);
}

}  // namespace morula::detail
