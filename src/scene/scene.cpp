// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <morula/scene/scene.hpp>
#include <stdexcept>
#include <utility>

#include "collide/pairs/placed_spheres.hpp"
#include "collide/require.hpp"
#include "parallel/float_environment.hpp"
#include "scene/scene_state.hpp"

namespace morula {
using namespace detail;
namespace {

std::string words(BodyId body) {
  return "body " + std::to_string(body.place) + " of generation " + std::to_string(body.generation);
}

void require_good_options(const SceneOptions& options) {
  require_usable(CollideOptions{.margin = options.margin, .budget = options.budget});
  if (options.patch_points > 16)
    throw std::invalid_argument("patch_points is " + std::to_string(options.patch_points) + ": it must be at most 16");
}

void require_masks(std::uint32_t category) {
  if (category == 0)
    throw std::invalid_argument("category is 0: a body without a group forms no pair; give it a group");
}

}  // namespace

BodyStamp detail::stamp_of(const Collider& collider) {
  const SphereState& pose = collider.sphere_state();
  return {&pose, pose.cover_id, pose.frame, pose.origin, collider.transform()};
}

// A pair test counts r_a as (1 + 2^-20) r_a, r_b as (1 + 2^-19) r_b, and adds 2^-20 (|c_b|_1 + U) + 2^-46 A + 2^-60 and
// the margin (placed_pair.hpp). U, the distance of both origins along an axis, is at most |c_a| + |c_b| + r_a + r_b and
// the margin if the test returns that they overlap. So each side's share is below 2^-18 (|c|_1 + r) + 2^-46 A + 2^-60
// and half the margin with 2^-19 of it; the pad here is twice that, which pays for rounding, the kernel's included. All
// bodies are nearer to each other than the greatest margin that counts in full, so boxes of larger ones stay finite.
Sphere detail::ball_around(const Collider& collider, double margin) {
  const Sphere root = PlacedSpheres(collider)(0);
  const Spheref& local = collider.sphere_state().spheres[0];
  const double size = static_cast<double>(std::abs(local.center.x) + std::abs(local.center.y) +
                                          std::abs(local.center.z) + local.radius);
  const double far = max_norm(collider.sphere_state().origin) + max_norm(collider.transform().translation);
  const double half = root.radius + 0x1p-17 * size + 0x1p-45 * far + 0x1p-59 +
                      // mutant scene-margin-overflows: `std::min(0.5 * margin, 0x1p300)` -> `0.5 * margin`
                      std::min(0.5 * margin, 0x1p300) * (1 + 0x1p-18);
  return {root.center, half};
}

Box detail::box_around(const Sphere& ball) {
  const Vec3 half{ball.radius, ball.radius, ball.radius};
  return {ball.center - half, ball.center + half};
}

std::string message(const SceneStatus& status) {
  if (status.code == Status::Code::other_frame && status.offender)
    return words(*status.offender) + " has moved since the scene was brought up to date: call Scene::update() first";
  const Status& plain = status;
  std::string text = message(plain);
  constexpr std::string_view first = "the first body";
  if (status.offender && text.starts_with(first)) text.replace(0, first.size(), words(*status.offender));
  return text;
}

Scene::Scene(SceneOptions options) {
  require_good_options(options);
  state_ = std::make_unique<SceneState>();
  state_->options = std::move(options);
}
Scene::~Scene() = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;

void Scene::set_options(SceneOptions options) {
  SceneState& s = state_->idle("set_options");
  require_good_options(options);
  s.renewal.everything = s.renewal.everything || options.level != s.options.level || options.margin != s.options.margin;
  s.renewal.filter = s.renewal.filter || options.accepts || s.options.accepts;
  s.renewal.extras =
      s.renewal.extras || options.surfaces != s.options.surfaces || options.find_crossings != s.options.find_crossings;
  s.options = std::move(options);
}

const SceneOptions& Scene::options() const {
  return state_->options;
}

void Scene::reserve(const SceneReserve& sizes) {
  state_->idle("reserve").reserve(sizes);
}

BodyId Scene::add(const Collider& collider, const SceneBodyOptions& options) {
  const StandardFloats standard;
  SceneState& s = state_->idle("add");
  require_masks(options.category);
  if (!(std::isfinite(options.weight) && options.weight >= 0))
    throw std::invalid_argument("the weight of a body is " + std::to_string(options.weight) +
                                ": it must be finite and not negative");
  require_good(s.usable(collider));
  // Memory is allocated first: if that fails, nothing has changed.
  BodySurface surface = s.options.patches ? s.examined(collider) : BodySurface{};
  if (s.bodies.size() == s.bodies.capacity()) s.bodies.reserve(2 * s.bodies.size() + 1);
  const std::uint32_t place = s.broad.add(box_around(ball_around(collider, s.options.margin)), options.is_static);
  if (place >= s.bodies.size()) s.bodies.resize(place + 1);
  SceneBody& body = s.bodies[place];
  body = {.collider = hold(collider),
          .generation = body.generation + 1,
          .options = options,
          .is_to_be_read = true,
          .stamp = stamp_of(collider),
          .surface = std::move(surface)};
  return {place, body.generation};
}

void Scene::remove(BodyId id) {
  SceneState& s = state_->idle("remove");
  SceneBody& body = s.known(id);
  s.broad.remove(id.place);
  body.collider = nullptr;
}

void Scene::replace(BodyId id, const Collider& collider) {
  const StandardFloats standard;
  SceneState& s = state_->idle("replace");
  SceneBody& body = s.known(id);
  require_good(s.usable(collider));
  body.surface = {};
  if (s.options.patches) body.surface = s.examined(collider);
  body.collider = hold(collider);
  body.is_to_be_read = true;
  body.stamp = stamp_of(collider);
  s.unbind(id.place);
}

void Scene::sleep(BodyId id) {
  SceneBody& body = state_->idle("sleep").known(id);
  // mutant scene-asleep-unread: `body.is_falling_asleep = true` -> `true`
  body.is_asleep = body.is_falling_asleep = true;
}

void Scene::wake(BodyId id) {
  SceneBody& body = state_->idle("wake").known(id);
  body.is_asleep = false;
  body.is_to_be_read = true;
}

void Scene::set_masks(BodyId id, std::uint32_t category, std::uint32_t mask) {
  SceneState& s = state_->idle("set_masks");
  SceneBody& body = s.known(id);
  require_masks(category);
  body.options.category = category, body.options.mask = mask;
  s.renewal.filter = true;
}

bool Scene::has(BodyId id) const {
  return state_->has(id);
}
bool Scene::is_asleep(BodyId id) const {
  return state_->known(id).is_asleep;
}
std::uint64_t Scene::user_data(BodyId id) const {
  return state_->known(id).options.user_data;
}
const Collider& Scene::collider(BodyId id) const {
  return *state_->known(id).collider;
}
std::size_t Scene::size() const {
  return state_->broad.size();
}

SceneStatus Scene::update(Workers& workers) {
  const StandardFloats standard;
  return state_->idle("update").update(workers);
}

std::span<const ScenePair> Scene::pairs() const {
  return state_->idle("pairs").published.pairs();
}
std::span<const EndedPair> Scene::ended() const {
  return state_->idle("ended").published.ended();
}

const ScenePair* Scene::find(BodyId a, BodyId b) const {
  if (b.place < a.place) std::swap(a, b);
  const auto& list = state_->idle("find").published.pairs();
  const auto found = std::lower_bound(list.begin(), list.end(), std::pair(a.place, b.place),
                                      [](const ScenePair& pair, const std::pair<std::uint32_t, std::uint32_t>& key) {
                                        return std::pair(pair.a.place, pair.b.place) < key;
                                      });
  return found != list.end() && found->a == a && found->b == b ? &*found : nullptr;
}

SceneState& detail::SceneState::idle(std::string_view method) {
  // mutant scene-called-from-inside: `is_updating` -> `false`
  if (is_updating)
    throw std::logic_error("Scene::" + std::string(method) +
                           "() was called from inside a callback of this scene: call it after update() has returned");
  return *this;
}

SceneBody& detail::SceneState::known(BodyId id) {
  if (!has(id)) throw std::invalid_argument("the scene has no " + words(id) + ": was it removed before?");
  return bodies[id.place];
}

Status detail::SceneState::usable(const Collider& collider) const {
  if (const Status status =
          status_of(collider, 0, {.all_spheres = true, .positions = options.surfaces || options.find_crossings});
      !status)
    return status;
  if (!(max_norm(collider.transform().translation) < 0x1p200)) return {Status::Code::transform_too_far};
  return {};
}

std::span<const SceneTouch> Scene::touches() const {
  return state_->idle("touches").shapes.touches;
}

}  // namespace morula
