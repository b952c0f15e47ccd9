// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <morula/scene/scene.hpp>
#include <stdexcept>
#include <utility>

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
}

void require_masks(std::uint32_t of) {
  if (of == 0) throw std::invalid_argument("the mask `of` is 0: a body of no group meets nobody; give it a group");
}

}  // namespace

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
  s.everything_anew = s.everything_anew || options.level != s.options.level || options.margin != s.options.margin;
  s.filter_anew = s.filter_anew || options.accepts || s.options.accepts;
  s.extras_anew =
      s.extras_anew || options.surfaces != s.options.surfaces || options.find_crossings != s.options.find_crossings;
  s.options = std::move(options);
}

const SceneOptions& Scene::options() const {
  return state_->options;
}

BodyId Scene::add(const Collider& collider, const SceneBodyOptions& options) {
  const StandardFloats standard;
  SceneState& s = state_->idle("add");
  require_masks(options.category);
  if (!(std::isfinite(options.weight) && options.weight >= 0))
    throw std::invalid_argument("the weight of a body is " + std::to_string(options.weight) +
                                ": it must be finite and not negative");
  require_good(s.usable(collider));
  // Memory comes first: where there is none, nothing has changed.
  if (s.bodies.size() == s.bodies.capacity()) s.bodies.reserve(2 * s.bodies.size() + 1);
  const std::uint32_t place = s.broad.add(box_around(ball_around(collider, s.options.margin)), options.is_static);
  if (place >= s.bodies.size()) s.bodies.resize(place + 1);
  SceneBody& body = s.bodies[place];
  body = {.collider = &collider,
          .generation = body.generation + 1,
          .options = options,
          .is_to_be_read = true,
          .stamp = stamp_of(collider)};
  return {place, body.generation};
}

void Scene::remove(BodyId id) {
  SceneState& s = state_->idle("remove");
  SceneBody& body = s.known(id);
  s.broad.remove(id.place);
  body.collider = nullptr;
  body.shares = {};
}

void Scene::replace(BodyId id, const Collider& collider) {
  const StandardFloats standard;
  SceneState& s = state_->idle("replace");
  SceneBody& body = s.known(id);
  require_good(s.usable(collider));
  body.collider = &collider;
  body.shares = {};
  body.is_to_be_read = true;
  for (SceneState::Near& pair : s.near)
    if (pair.front != nullptr && (pair.a == id.place || pair.b == id.place)) {
      pair.front->unbind();
      pair.is_bound = false;
    }
  std::erase_if(s.parted_fronts, [&](PairFront* front) {
    // mutant scene-parted-fronts-of-replaced: `if (front->id_a() != id && front->id_b() != id) return` -> `return`
    if (front->id_a() != id && front->id_b() != id) return false;
    front->unbind();
    s.spare_fronts.push_back(front);
    return true;
  });
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
  s.filter_anew = true;
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
  return state_->idle("pairs").published;
}
std::span<const EndedPair> Scene::ended() const {
  return state_->idle("ended").ended;
}

const ScenePair* Scene::find(BodyId a, BodyId b) const {
  if (b.place < a.place) std::swap(a, b);
  const auto& list = state_->idle("find").published;
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

SceneRayHit Scene::first_hit(const Ray& ray) const {
  const StandardFloats standard;
  return state_->idle("first_hit").first_hit(ray);
}

SceneStatus Scene::touch(const HalfSpace& shape, const TouchOptions& options) {
  const StandardFloats standard;
  return state_->idle("touch").touch(shape, options);
}
SceneStatus Scene::touch(const Sphere& shape, const TouchOptions& options) {
  const StandardFloats standard;
  return state_->idle("touch").touch(shape, options);
}
SceneStatus Scene::touch(const Capsule& shape, const TouchOptions& options) {
  const StandardFloats standard;
  return state_->idle("touch").touch(shape, options);
}
SceneStatus Scene::touch(const ConvexHull& shape, const TouchOptions& options) {
  const StandardFloats standard;
  return state_->idle("touch").touch(shape, options);
}
std::span<const SceneTouch> Scene::touches() const {
  return state_->idle("touches").touches;
}

}  // namespace morula
