// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Contact patches of the touching pairs of a scene.
#include <algorithm>
#include <stdexcept>
#include <utility>

#include "collide/pairs/meter.hpp"
#include "scene/scene_state.hpp"

namespace morula::detail {
namespace {

ContactPatchOptions patch_options(const SceneOptions& options) {
  return {.max_points = options.patch_points, .depths = options.patch_depths};
}

// A sleeping body may have been updated or moved since it was read. Then contacts do not bound its crossings.
bool is_as_read(const SceneBody& body) {
  // mutant scene-patches-unread: `stamp_of(*body.collider) == body.stamp` -> `true`
  return askable(*body.collider) && stamp_of(*body.collider) == body.stamp;
}

}  // namespace

bool PairPatches::is_settled(const Collider& a, const Collider& b, const ContactPatchOptions& options) const {
  return (is_there_ || is_rejected_) && a_ == Side::of(a) && b_ == Side::of(b) && max_points_ == options.max_points &&
         depths_ == options.depths;
}

bool PairPatches::find(PatchEngine& engine, const PatchBodies& bodies, std::span<const NodePair> nodes,
                       const ContactPatchOptions& options, Meter* meter) {
  const Side a = Side::of(*bodies.body[0]), b = Side::of(*bodies.body[1]);
  a_ = a, b_ = b;
  max_points_ = options.max_points, depths_ = options.depths;
  is_there_ = is_rejected_ = false;
  const PatchStatus status = engine.find(bodies, nodes, options, meter, known_, next_id_, next_);
  is_rejected_ = !status;
  if (!status || !status.finished) return false;
  std::swap(result_, next_);
  known_.assign(result_.known.begin(), result_.known.end());
  is_there_ = true;
  return true;
}

BodySurface SceneState::examined(const Collider& collider) const {
  if (!collider.has_surface()) return {true, nullptr};
  // Colliders borrow the arrays of their meshes, so two that live at the same time with one array have one mesh.
  const auto facets = collider.mesh_facets();
  for (const SceneBody& body : bodies) {
    if (body.collider == nullptr || body.surface.closed == nullptr) continue;
    const auto others = body.collider->mesh_facets();
    if (others.data() == facets.data() && others.size() == facets.size()) return body.surface;
  }
  try {
    return {true, std::make_shared<const ClosedSurface>(collider, "first")};
  } catch (const std::invalid_argument&) {
    return {true, nullptr};  // open, not oriented, or inside out
  }
}

// Contacts of a finished pair hold all crossings, so patches need no search of their own.
bool SceneState::may_have_patches(const NearPair& pair) {
  PairFront* const front = pair.front;
  if (front == nullptr || !front->roots_overlap()) return false;
  const SceneBody &a = bodies[pair.a], &b = bodies[pair.b];
  if (a.surface.closed == nullptr || b.surface.closed == nullptr || !is_as_read(a) || !is_as_read(b)) return false;
  if (!front->is_finished() || front->finished_count() == 0) return false;
  if (!front->patches) front->patches = std::make_unique<PairPatches>();
  return !front->patches->is_settled(*a.collider, *b.collider, patch_options(options));
}

// Under a budget of time, pairs that had patches come first, then those of the greatest importance: so the pairs with
// patches stay the same from update to update. Pairs that never had any have their turn.
void SceneState::add_patches(std::chrono::nanoseconds deadline, Workers& workers) {
  patches_due_.clear();
  patches_due_.reserve(near.pairs.size());
  for (SceneBody& body : bodies)
    if (body.collider != nullptr && !body.surface.is_examined) body.surface = examined(*body.collider);
  for (const NearPair& pair : near.pairs)
    if (may_have_patches(pair)) patches_due_.push_back(pair.front);
  const bool by_time = options.budget.is_time();
  if (by_time) {
    const auto rank = [&](const PairFront* front) {
      const bool had = !front->patches->patches().empty();
      const double weight = bodies[front->id_a().place].options.weight * bodies[front->id_b().place].options.weight;
      return std::pair(had, weight * std::max(least_share, front->overlap_share()) *
                                (had ? 1.0 : 1.0 + front->patches->updates_left_out));
    };
    std::sort(patches_due_.begin(), patches_due_.end(), [&](const PairFront* x, const PairFront* y) {
      const auto of_x = rank(x), of_y = rank(y);
      return of_x != of_y ? of_x > of_y : std::pair(x->id_a(), x->id_b()) < std::pair(y->id_a(), y->id_b());
    });
  }
  Workers& used_workers = by_time && options.clock ? serial_workers() : workers;
  used_workers.run(patches_due_.size(), [&](std::size_t i) { find_patches(*patches_due_[i], deadline); });
}

// A pair is not begun if its last computation took longer than there is time.
void SceneState::find_patches(PairFront& front, std::chrono::nanoseconds deadline) {
  const bool by_time = options.budget.is_time();
  const std::chrono::nanoseconds begun = by_time ? now() : std::chrono::nanoseconds(0);
  PairPatches& patches = *front.patches;
  ++patches.updates_left_out;
  if (by_time && begun + patches.cost >= deadline) {
    patches.cost = patches.cost * 7 / 8;
    return;
  }
  const ExtrasPool::Loan extras(extras_.pool);
  PairExtras& memory = *extras;
  if (!memory.patches) memory.patches = std::make_unique<PatchEngine>();
  memory.nodes.clear();
  CollideOptions limits;
  if (by_time) limits = {.budget = deadline - begun, .clock = options.clock};
  Meter meter(limits);
  for (const Contact& c : front.contacts()) memory.nodes.push_back({c.node_a, c.node_b});
  const PatchBodies pair{
      {&front.a(), &front.b()},
      {bodies[front.id_a().place].surface.closed.get(), bodies[front.id_b().place].surface.closed.get()}};
  const bool found =
      patches.find(*memory.patches, pair, memory.nodes, patch_options(options), by_time ? &meter : nullptr);
  if (found) patches.updates_left_out = 0;
  if (by_time) patches.cost = now() - begun;
}

const PairPatches* SceneState::patches_of(const NearPair& pair) const {
  if (!options.patches || pair.front->patches == nullptr) return nullptr;
  const PairPatches& patches = *pair.front->patches;
  const SceneBody &a = bodies[pair.a], &b = bodies[pair.b];
  const bool is_current = patches.is_there() && is_as_read(a) && is_as_read(b) &&
                          patches.is_settled(*a.collider, *b.collider, patch_options(options));
  return is_current ? &patches : nullptr;
}

}  // namespace morula::detail
