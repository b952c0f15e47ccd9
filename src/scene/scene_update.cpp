// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// One update of a scene: it finds moved bodies and near pairs, and assigns the budget.
#include <algorithm>
#include <utility>

#include "collide/pairs/meter.hpp"
#include "parallel/interruption.hpp"
#include "scene/box_tree.hpp"
#include "scene/scene_state.hpp"

namespace morula::detail {
namespace {

using Stage = NearPair::Stage;

}  // namespace

std::chrono::nanoseconds SceneState::now() const {
  return detail::now(options.clock);
}

// Bodies are read in parallel, since their memory is cold; then either all or none of the data are stored.
SceneStatus SceneState::read_bodies(Workers& workers) {
  reads_.found.resize(bodies.size());
  const bool is_watched = has_callbacks(workers);
  if (is_watched) reads_.as_read.resize(bodies.size());
  parallel_for(workers, bodies.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t place = begin; place < end; ++place) {
      const SceneBody& body = bodies[place];
      BodyRead& read = reads_.found[place];
      read.status = {};
      read.has_moved = false;
      const bool is_looked_at = body.is_looked_at() || renewal.everything;
      if (body.collider == nullptr) continue;
      if (is_watched) reads_.as_read[place] = ColliderAsRead(*body.collider);
      if (!is_looked_at && !renewal.extras) continue;
      read.status = usable(*body.collider);
      if (!read.status || !is_looked_at) continue;
      read.stamp = stamp_of(*body.collider);
      read.has_moved = body.is_to_be_read || renewal.everything || read.stamp != body.stamp;
      if (read.has_moved) read.around = ball_around(*body.collider, options.margin);
    }
  });
  for (std::uint32_t place = 0; place < bodies.size(); ++place)
    if (!reads_.found[place].status) return rejection(reads_.found[place].status, id_of(place));
  for (std::uint32_t place = 0; place < bodies.size(); ++place) {
    SceneBody& body = bodies[place];
    const BodyRead& read = reads_.found[place];
    body.has_moved = read.has_moved;
    if (body.collider != nullptr && (body.is_looked_at() || renewal.everything))
      // mutant scene-read-once-for-all: `body.is_falling_asleep = false` -> `false`
      body.is_to_be_read = body.is_falling_asleep = false;
    if (!read.has_moved) continue;
    // Another collider was assigned to that of the body: as after replace().
    if (read.stamp.pose != body.stamp.pose) {
      body.surface = {};
      unbind(place);
    }
    body.stamp = read.stamp;
    body.around = read.around;
    static_cast<void>(broad.move(place, box_around(body.around)));  // ok: the box is finite where usable() says ok
  }
  return {};
}

void SceneState::unbind(std::uint32_t place) {
  for (NearPair& pair : near.pairs)
    if (pair.front != nullptr && (pair.a == place || pair.b == place)) {
      pair.front->unbind();
      pair.generation_a = 0;
    }
  fronts.unbind(id_of(place));
}

bool SceneState::has_callbacks(const Workers& workers) const {
  return options.accepts || options.clock || workers.is_of_host() || active_interruption() != nullptr;
}

SceneStatus SceneState::unmoved() const {
  for (std::uint32_t place = 0; place < bodies.size(); ++place)
    if (bodies[place].collider != nullptr && reads_.as_read[place].has_moved())
      return rejection({.code = Status::Code::changed_during_call}, id_of(place));
  return {};
}

void SceneState::reserve(const SceneReserve& sizes) {
  require_reservable({sizes.bodies, sizes.near_pairs, sizes.contacts});
  bodies.reserve(sizes.bodies);
  reads_.found.reserve(sizes.bodies), reads_.as_read.reserve(sizes.bodies);
  // The boxes that the tree stores are larger, and so more of them overlap.
  constexpr std::size_t stored_pairs = 4;
  broad.reserve(sizes.bodies, stored_pairs * sizes.near_pairs);
  near.pairs.reserve(sizes.near_pairs), near.next.reserve(sizes.near_pairs), near.looked_at.reserve(sizes.near_pairs);
  refinement_.reserve(sizes.near_pairs);
  extras_.due.reserve(sizes.near_pairs);
  published.reserve(sizes.near_pairs);
  try {
    fronts.reserve(sizes.near_pairs, sizes.contacts, options.surfaces ? sizes.contacts : 0);
  } catch (...) {
    follow_lists();
    throw;
  }
  follow_lists();
}

// Published pairs are those with contacts, in the order of near pairs.
void SceneState::follow_lists() noexcept {
  std::size_t next = 0;
  for (const NearPair& pair : near.pairs)
    if (pair.front != nullptr && !pair.front->contacts().empty())
      published.follow(next++, pair.front->contacts(), pair.front->surfaces());
}

void SceneState::end(const NearPair& pair) {
  if (pair.front == nullptr) return;
  if (bodies[pair.a].collider == nullptr || bodies[pair.b].collider == nullptr) {
    fronts.discard(pair.front);
  } else {
    fronts.part(pair.front);
  }
}

// Drops pairs that are gone and adds new ones; both lists are ascending.
void SceneState::list_near() {
  near.next.clear();
  auto old = near.pairs.begin();
  const auto comes_before = [](const NearPair& x, const BoxPair& y) { return BoxPair{x.a, x.b} < y; };
  for (const BoxPair& pair : broad.pairs()) {
    for (; old != near.pairs.end() && comes_before(*old, pair); ++old) end(*old);
    if (old != near.pairs.end() && old->a == pair.a && old->b == pair.b) {
      near.next.push_back(*old++);
    } else {
      near.next.push_back({.a = pair.a, .b = pair.b});
    }
  }
  for (; old != near.pairs.end(); ++old) end(*old);
  near.pairs.swap(near.next);

  for (NearPair& pair : near.pairs) {
    const SceneBody &a = bodies[pair.a], &b = bodies[pair.b];
    if (pair.stage == Stage::unasked || renewal.filter) {
      // mutant scene-mask-of-one-side: `(a.options.category & b.options.mask) != 0` -> `true`
      // mutant scene-mask-of-other-side: `(b.options.category & a.options.mask) != 0` -> `true`
      const bool is_wanted = (a.options.category & b.options.mask) != 0 && (b.options.category & a.options.mask) != 0 &&
                             (!options.accepts || options.accepts(id_of(pair.a), id_of(pair.b)));
      if (!is_wanted)
        end(std::exchange(pair, {.a = pair.a, .b = pair.b, .stage = Stage::unwanted}));
      else if (pair.front == nullptr)
        pair.stage = Stage::roots_due;
    }
    if (pair.stage == Stage::unwanted) continue;
    if (pair.front == nullptr) pair.front = fronts.take(id_of(pair.a), id_of(pair.b));
    // The test reads only the pair: its front is elsewhere in memory.
    if (pair.generation_a == a.generation && pair.generation_b == b.generation) continue;
    if (!pair.front->is_of(id_of(pair.a), id_of(pair.b))) {
      pair.front->bind(id_of(pair.a), *a.collider, id_of(pair.b), *b.collider);
      pair.stage = Stage::roots_due;
    }
    pair.generation_a = a.generation, pair.generation_b = b.generation;
  }
}

void SceneState::look_at_roots(Workers& workers) {
  near.looked_at.clear();
  for (std::size_t i = 0; i < near.pairs.size(); ++i)
    if (near.pairs[i].front != nullptr && (near.pairs[i].stage == Stage::roots_due ||
                                           bodies[near.pairs[i].a].has_moved || bodies[near.pairs[i].b].has_moved))
      near.looked_at.push_back(i);
  parallel_for(workers, near.looked_at.size(), 32, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      NearPair& pair = near.pairs[near.looked_at[k]];
      if (renewal.everything) pair.front->forget_front();
      // Balls that are apart in double, by more than its rounding, are also apart in the test of roots, which takes
      // longer.
      const Sphere &a = bodies[pair.a].around, &b = bodies[pair.b].around;
      if (distance(a.center, b.center) * (1 - 0x1p-40) > a.radius + b.radius) {
        pair.front->part();
      } else {
        pair.front->visit(options);
      }
      pair.stage = Stage::looked_at;
    }
  });
  refinement_.start();
  for (const NearPair& pair : near.pairs) {
    if (pair.front == nullptr) continue;
    PairFront& front = *pair.front;
    front.priority.tests = 0;
    if (renewal.extras) front.renew_extras();
    if (front.is_finished()) continue;
    front.priority.importance =
        bodies[pair.a].options.weight * bodies[pair.b].options.weight *
        // mutant scene-least-share: `std::max(least ... overlap_share())` -> `front.overlap_share()`
        std::max(least_share, front.overlap_share()) * (1.0 + front.priority.updates_left_out);
    ++front.priority.updates_left_out;
    refinement_.add(front);
  }
}

void SceneState::add_extras(std::chrono::nanoseconds deadline, Workers& workers) {
  extras_.due.clear();
  // Reserves for the most that so many pairs can have.
  extras_.due.reserve(near.pairs.size());
  for (const NearPair& pair : near.pairs)
    if (pair.front != nullptr && pair.front->extras_are_due() && pair.front->finished_count() > 0)
      extras_.due.push_back(pair.front);
  const bool by_time = options.budget.is_time();
  if (by_time)
    std::sort(extras_.due.begin(), extras_.due.end(), [](const PairFront* x, const PairFront* y) {
      return x->priority.importance != y->priority.importance
                 ? x->priority.importance > y->priority.importance
                 : std::pair(x->id_a(), x->id_b()) < std::pair(y->id_a(), y->id_b());
    });
  Workers& used_workers = by_time && options.clock ? serial_workers() : workers;
  const auto is_late = [&] { return by_time && now() >= deadline; };
  used_workers.run(extras_.due.size(), [&](std::size_t i) {
    // Crossings are computed outside any budget.
    if (!options.find_crossings && is_late()) return;
    PairFront& front = *extras_.due[i];
    const ExtrasPool::Loan extras(extras_.pool);
    front.add_extras(options, *extras, is_late);
  });
}

void SceneState::refine(std::chrono::nanoseconds start, Workers& workers, SceneStatus& status) {
  const std::chrono::nanoseconds deadline = start + options.budget.time() - to_publish_;
  status.pair_tests = refinement_.run(options, deadline, workers);
  if (options.patches) add_patches(deadline, workers);
  if (options.surfaces || options.find_crossings) add_extras(deadline, workers);
}

void PublishedPairs::start() {
  next_reported_.clear();
  walked_ = 0;
}

// Pairs and touches are in the same order, so one walk along both finds the touches that began and ended.
void PublishedPairs::add(ScenePair pair) {
  const auto ids = [](const EndedPair& touch) { return std::pair(touch.a, touch.b); };
  const std::pair bodies(pair.a, pair.b);
  while (walked_ < reported_.size() && ids(reported_[walked_]) < bodies) ended_.push_back(reported_[walked_++]);
  const bool stays = walked_ < reported_.size() && ids(reported_[walked_]) == bodies;
  // mutant scene-began-unconfirmed: `stays || pair.confirmed` -> `true`
  // mutant scene-ended-unrefuted: `stays || pair.confirmed` -> `pair.confirmed`
  pair.touches = stays || pair.confirmed;
  pair.began = pair.touches && !stays;
  if (stays) {
    pair.id = reported_[walked_++].id;
  } else if (pair.touches) {
    pair.id = next_touch_++;
  }
  if (pair.touches) next_reported_.push_back({pair.a, pair.b, pair.id});
  pairs_.push_back(pair);
}

void PublishedPairs::finish() {
  ended_.insert(ended_.end(), reported_.begin() + static_cast<std::ptrdiff_t>(walked_), reported_.end());
  std::sort(ended_.begin(), ended_.end(), [](const EndedPair& x, const EndedPair& y) { return x.id < y.id; });
}

void SceneState::publish(SceneStatus& status) {
  published.start();
  for (const NearPair& pair : near.pairs) {
    if (pair.front == nullptr) continue;
    const PairFront& front = *pair.front;
    ++status.near_pairs;
    if (!front.is_finished()) {
      ++status.open_pairs;
      status.tests_to_open = std::max(status.tests_to_open, front.tests_to_open());
    }
    const bool confirmed = front.touch_is_confirmed();
    if (!front.is_finished() && !confirmed) ++status.undecided_pairs;
    if (front.contacts().empty()) continue;
    const PairPatches* const patches = patches_of(pair);
    published.add({.a = id_of(pair.a),
                   .b = id_of(pair.b),
                   .confirmed = confirmed,
                   .finished = front.is_finished(),
                   .contacts = front.contacts(),
                   .surfaces = options.surfaces ? front.surfaces() : std::span<const ContactSurface>(),
                   .crossings = options.find_crossings ? front.crossings() : std::span<const Crossing>(),
                   .has_patches = patches != nullptr,
                   .patches = patches ? patches->patches() : std::span<const ContactPatch>()});
  }
  published.finish();
  status.finished = status.open_pairs == 0;
}

SceneStatus SceneState::update(Workers& workers) {
  is_updating = true;
  try {
    const SceneStatus status = update_once(workers);
    is_updating = false;
    return status;
  } catch (...) {
    is_updating = false;
    start_over();
    throw;
  }
}

// Resets the scene to one whose bodies have just been added. Only the published touches remain; their ends are still to
// be published.
void SceneState::start_over() noexcept {
  published.clear();
  // mutant scene-interrupted-lists: `near.pairs.clear(), near.next.clear(), refinement_.forget` -> `refinement_.forget`
  near.pairs.clear(), near.next.clear(), refinement_.forget(), extras_.due.clear();
  patches_due_.clear();
  fronts.forget();
  extras_.pool.forget();
  to_publish_ = {};
  // mutant scene-interrupted-untold: `is_interrupted = true` -> `true`
  renewal.everything = is_interrupted = true;
}

SceneStatus SceneState::update_once(Workers& workers) {
  const bool by_time = options.budget.is_time();
  const std::chrono::nanoseconds start = by_time ? now() : std::chrono::nanoseconds(0);
  SceneStatus status = read_bodies(workers);
  if (!status) return status;
  published.clear();
  broad.update();
  list_near();
  fronts.give_back_rested();
  look_at_roots(workers);
  refine(start, workers, status);
  // No body is read below.
  if (has_callbacks(workers))
    // mutant scene-moved-in-update: `!moved` -> `false`
    if (const SceneStatus moved = unmoved(); !moved) {
      start_over();
      return moved;
    }
  const std::chrono::nanoseconds refined = by_time ? now() : std::chrono::nanoseconds(0);
  publish(status);
  // The longest recent time; it falls by an eighth per update.
  if (by_time) to_publish_ = std::min(std::max(now() - refined, to_publish_ * 7 / 8), options.budget.time() / 2);
  // Nothing below throws.
  published.commit();
  renewal = {}, is_interrupted = false;
  return status;
}

}  // namespace morula::detail
