// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Moving shapes against all bodies of a scene.
#include <algorithm>
#include <utility>

#include "collide/shapes/placed_shapes.hpp"
#include "parallel/float_environment.hpp"
#include "scene/scene_state.hpp"

namespace morula {
using namespace detail;
namespace {

Box box_of(const Sphere& shape) {
  return box_around(shape);
}
Box box_of(const Capsule& shape) {
  Box box = box_around({shape.p, shape.radius});
  box.add(box_around({shape.q, shape.radius}));
  return box;
}
Box box_of(const ConvexHull& shape) {
  Box box;
  for (const Vec3& p : shape.vertices()) box.add(p);
  return box;
}

/// Pays for rounding, and for the distance that counts as a touch in a sweep.
Box padded(Box box, const Vec3& motion) {
  const double most = std::max({max_norm(box.lower), max_norm(box.upper), max_norm(motion)}) * 0x1p-38;
  box.lower = box.lower - Vec3{most, most, most}, box.upper = box.upper + Vec3{most, most, most};
  return box;
}

/// The bodies that a moving shape comes near, in s.shapes.bodies. Rejects a bad shape, and bodies that have moved.
template <class Shape>
SceneStatus find_bodies(const SceneState& s, const Shape& shape, const Vec3& motion, const SceneFilter& filter) {
  if (SceneStatus status = s.current(); !status) return status;
  if (!is_usable(shape) || !is_finite(motion) || !(max_norm(motion) < 0x1p200))
    return rejection({Status::Code::bad_shape});
  s.broad.find_along(padded(box_of(shape), motion), motion, s.shapes.bodies);
  s.filter_bodies(filter);
  return {};
}

template <class Shape>
SceneSweepHit first_of_all(const SceneState& s, const Shape& shape, const Vec3& motion, const SceneFilter& filter) {
  const StandardFloats standard;
  SceneSweepHit hit{.status = find_bodies(s, shape, motion, filter)};
  if (!hit.status) return hit;
  hit.certified = s.all_cover(filter);
  const SweepQuery query;
  for (const std::uint32_t place : s.shapes.bodies) {
    const SweepHit here = query.run(*s.bodies[place].collider, shape, motion, hit.first ? hit.first->t : 1);
    if (!here.status) return {.status = rejection(here.status, s.id_of(place))};
    if (!here.first || (hit.first && !(here.first->t < hit.first->t))) continue;
    hit.first = here.first;
    hit.body = s.id_of(place);
  }
  return hit;
}

template <class Shape>
SceneSweepHits first_of_each(SceneState& s, const Shape& shape, const Vec3& motion, const SceneFilter& filter) {
  const StandardFloats standard;
  s.shapes.sweeps.clear();
  SceneSweepHits all{.status = find_bodies(s, shape, motion, filter)};
  if (!all.status) return all;
  all.certified = s.all_cover(filter);
  const SweepQuery query;
  for (const std::uint32_t place : s.shapes.bodies) {
    const SweepHit here = query.run(*s.bodies[place].collider, shape, motion);
    if (!here.status) return {.status = rejection(here.status, s.id_of(place))};
    if (here.first) s.shapes.sweeps.push_back({s.id_of(place), *here.first});
  }
  std::sort(s.shapes.sweeps.begin(), s.shapes.sweeps.end(), [](const SceneSweep& x, const SceneSweep& y) {
    return std::pair(x.first.t, x.body) < std::pair(y.first.t, y.body);
  });
  all.hits = s.shapes.sweeps;
  return all;
}

}  // namespace

SceneSweepHit Scene::sweep(const Sphere& shape, const Vec3& motion, const SceneFilter& filter) const {
  return first_of_all(state_->idle("sweep"), shape, motion, filter);
}
SceneSweepHit Scene::sweep(const Capsule& shape, const Vec3& motion, const SceneFilter& filter) const {
  return first_of_all(state_->idle("sweep"), shape, motion, filter);
}
SceneSweepHit Scene::sweep(const ConvexHull& shape, const Vec3& motion, const SceneFilter& filter) const {
  return first_of_all(state_->idle("sweep"), shape, motion, filter);
}

SceneSweepHits Scene::sweep_all(const Sphere& shape, const Vec3& motion, const SceneFilter& filter) {
  return first_of_each(state_->idle("sweep_all"), shape, motion, filter);
}
SceneSweepHits Scene::sweep_all(const Capsule& shape, const Vec3& motion, const SceneFilter& filter) {
  return first_of_each(state_->idle("sweep_all"), shape, motion, filter);
}
SceneSweepHits Scene::sweep_all(const ConvexHull& shape, const Vec3& motion, const SceneFilter& filter) {
  return first_of_each(state_->idle("sweep_all"), shape, motion, filter);
}

}  // namespace morula
