// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// One update of a scene: who has moved, who is near, and where the budget goes.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <utility>

#include "parallel/interruption.hpp"
#include "scene/scene_state.hpp"

namespace morula::detail {
namespace {

// A pair gets no fewer tests than this at a time, so that a large budget is dealt out in a few rounds.
constexpr std::size_t quantum = 512;
// And no more at once, however many it took.
constexpr std::size_t most_expected = 2048;
// With fewer tests than one block of eight by eight nodes a round is not worth it.
constexpr std::size_t least_budget = 64;
constexpr std::size_t fewest_parted_fronts = 64;
// After so many updates, parted pairs give back their memory, at most twice as many: those that come and go keep it.
constexpr std::uint32_t updates_kept = 32;
// Roots that only just overlap share nothing, or by rounding less than that, and would wait for ever.
constexpr double least_share = 0x1p-10;

bool is_earlier(const PairFront* x, const PairFront* y) {
  return std::pair(x->id_a(), x->id_b()) < std::pair(y->id_a(), y->id_b());
}

}  // namespace

std::chrono::nanoseconds SceneState::now() const {
  return options.clock ? options.clock() : std::chrono::steady_clock::now().time_since_epoch();
}

// Bodies are read side by side, since their memory is cold; then all is taken over, or nothing.
SceneStatus SceneState::read_bodies(Workers& workers) {
  read_.resize(bodies.size());
  const bool is_watched = has_callbacks(workers);
  if (is_watched) as_read_.resize(bodies.size());
  parallel_for(workers, bodies.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t place = begin; place < end; ++place) {
      const SceneBody& body = bodies[place];
      BodyRead& read = read_[place];
      read.status = {};
      read.has_moved = false;
      const bool is_looked_at = body.is_looked_at() || everything_anew;
      if (body.collider == nullptr) continue;
      if (is_watched) as_read_[place] = ColliderAsRead(*body.collider);
      if (!is_looked_at && !extras_anew) continue;
      read.status = usable(*body.collider);
      if (!read.status || !is_looked_at) continue;
      read.stamp = stamp_of(*body.collider);
      read.has_moved = body.is_to_be_read || everything_anew || read.stamp != body.stamp;
      if (read.has_moved) read.around = ball_around(*body.collider, options.margin);
    }
  });
  for (std::uint32_t place = 0; place < bodies.size(); ++place) {
    if (read_[place].status) continue;
    SceneStatus refused{read_[place].status};
    refused.offender = id_of(place);
    return refused;
  }
  for (std::uint32_t place = 0; place < bodies.size(); ++place) {
    SceneBody& body = bodies[place];
    const BodyRead& read = read_[place];
    body.has_moved = read.has_moved;
    if (body.collider != nullptr && (body.is_looked_at() || everything_anew))
      // mutant scene-read-once-for-all: `body.is_falling_asleep = false` -> `false`
      body.is_to_be_read = body.is_falling_asleep = false;
    if (!read.has_moved) continue;
    body.stamp = read.stamp;
    body.around = read.around;
    static_cast<void>(broad.move(place, box_around(body.around)));  // good: the box is finite where usable() says ok
  }
  return {};
}

bool SceneState::has_callbacks(const Workers& workers) const {
  return options.accepts || options.clock || workers.is_of_host() || asked_now() != nullptr;
}

SceneStatus SceneState::unmoved() const {
  for (std::uint32_t place = 0; place < bodies.size(); ++place) {
    if (bodies[place].collider == nullptr || !as_read_[place].has_moved()) continue;
    SceneStatus moved{{.code = Status::Code::changed_during_call}};
    moved.offender = id_of(place);
    return moved;
  }
  return {};
}

void SceneState::end(const Near& pair) {
  if (pair.front == nullptr) return;
  PairFront* const front = pair.front;
  front->has_rested = false;
  if (bodies[pair.a].collider == nullptr || bodies[pair.b].collider == nullptr) {
    spare_fronts.push_back(front);
  } else {
    parted_fronts.insert(std::upper_bound(parted_fronts.begin(), parted_fronts.end(), front, is_earlier), front);
  }
}

// The one that they had when they were near, or a spare one. So many are kept for later as are in use.
PairFront* SceneState::front_of(BodyId a, BodyId b) {
  const auto known = std::lower_bound(parted_fronts.begin(), parted_fronts.end(), std::pair(a, b),
                                      [](const PairFront* front, const std::pair<BodyId, BodyId>& ids) {
                                        return std::pair(front->id_a(), front->id_b()) < ids;
                                      });
  auto taken = parted_fronts.end();
  if (known != parted_fronts.end() && (*known)->is_of(a, b)) taken = known;
  if (taken == parted_fronts.end() && spare_fronts.empty()) {
    if (parted_fronts.size() <= std::max(fewest_parted_fronts, fronts.size() / 2)) {
      fronts.push_back(std::make_unique<PairFront>());
      spare_fronts.reserve(fronts.capacity());
      parted_fronts.reserve(fronts.capacity());
      return fronts.back().get();
    }
    next_to_forget_ = (next_to_forget_ + 1) % parted_fronts.size();
    taken = parted_fronts.begin() + static_cast<std::ptrdiff_t>(next_to_forget_);
  }
  if (taken == parted_fronts.end()) {
    PairFront* const front = spare_fronts.back();
    spare_fronts.pop_back();
    return front;
  }
  PairFront* const front = *taken;
  parted_fronts.erase(taken);
  return front;
}

// Old pairs go, new ones come; both lists are ascending.
void SceneState::list_near() {
  next_near.clear();
  auto old = near.begin();
  const auto comes_before = [](const Near& x, const BoxPair& y) { return BoxPair{x.a, x.b} < y; };
  for (const BoxPair& pair : broad.pairs()) {
    for (; old != near.end() && comes_before(*old, pair); ++old) end(*old);
    if (old != near.end() && old->a == pair.a && old->b == pair.b) {
      next_near.push_back(*old++);
    } else {
      next_near.push_back({.a = pair.a, .b = pair.b, .is_new = true});
    }
  }
  for (; old != near.end(); ++old) end(*old);
  near.swap(next_near);

  for (Near& pair : near) {
    const SceneBody &a = bodies[pair.a], &b = bodies[pair.b];
    if (pair.is_new || filter_anew) {
      const bool was_wanted = pair.is_wanted;
      // mutant scene-mask-of-one-side: `(a.options.category & b.options.mask) != 0` -> `true`
      // mutant scene-mask-of-other-side: `(b.options.category & a.options.mask) != 0` -> `true`
      pair.is_wanted = (a.options.category & b.options.mask) != 0 && (b.options.category & a.options.mask) != 0 &&
                       (!options.accepts || options.accepts(id_of(pair.a), id_of(pair.b)));
      if (was_wanted && !pair.is_wanted) end(std::exchange(pair, {.a = pair.a, .b = pair.b}));
      // Who is not wanted has been asked, and has no roots to look at.
      pair.is_new = pair.is_wanted && (pair.is_new || !was_wanted);
    }
    if (pair.is_wanted && pair.front == nullptr) {
      pair.front = front_of(id_of(pair.a), id_of(pair.b));
      pair.is_new = true;
      pair.is_bound = false;
    }
    // Asked of the pair alone: its front is elsewhere in memory.
    if (pair.front == nullptr) continue;
    if (pair.is_bound && pair.generation_a == a.generation && pair.generation_b == b.generation) continue;
    if (!pair.front->is_of(id_of(pair.a), id_of(pair.b))) {
      pair.front->bind(id_of(pair.a), *a.collider, id_of(pair.b), *b.collider);
      pair.is_new = true;
    }
    pair.is_bound = true;
    pair.generation_a = a.generation, pair.generation_b = b.generation;
  }
}

void SceneState::look_at_roots(Workers& workers) {
  looked_at_.clear();
  for (std::size_t i = 0; i < near.size(); ++i)
    if (near[i].front != nullptr && (near[i].is_new || bodies[near[i].a].has_moved || bodies[near[i].b].has_moved))
      looked_at_.push_back(i);
  parallel_for(workers, looked_at_.size(), 32, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      Near& pair = near[looked_at_[k]];
      if (everything_anew) pair.front->forget_front();
      // Balls that are apart in double, by more than its rounding, are so in the test of roots, which has more to do.
      const Sphere &a = bodies[pair.a].around, &b = bodies[pair.b].around;
      if (distance(a.center, b.center) * (1 - 0x1p-40) > a.radius + b.radius) {
        pair.front->part();
      } else {
        pair.front->visit(options);
      }
      pair.is_new = false;
    }
  });
  work_.clear();
  for (const Near& pair : near) {
    if (pair.front == nullptr) continue;
    PairFront& front = *pair.front;
    front.tests = 0;
    if (extras_anew && front.is_current()) front.extras_are_due = true;
    if (front.is_finished()) continue;
    front.importance = bodies[pair.a].options.weight * bodies[pair.b].options.weight *
                       // mutant scene-least-share: `std::max(least ... overlap_share())` -> `front.overlap_share()`
                       std::max(least_share, front.overlap_share()) * (1.0 + front.updates_left_out);
    ++front.updates_left_out;
    work_.push_back(&front);
  }
}

void SceneState::refine_all(Workers& workers) {
  used_.assign(work_.size(), 0);
  parallel_for(workers, work_.size(), 2, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) used_[i] = work_[i]->refine(options, std::nullopt);
  });
  for (const std::size_t used : used_) tests_done_ += used;
}

// In rounds. Each deals what is left to the pairs with the greatest importance per work already done, the lowest first
// among equals: to each what it took last time and somewhat more, or a quantum. What one of them does not need is there
// for the next round. Everything depends on counts alone, so the same pairs get the same tests for any number of
// workers.
void SceneState::refine_by_tests(std::size_t tests, Workers& workers) {
  std::size_t left = tests;
  while (left >= std::min(least_budget, tests) && left > 0 && !work_.empty()) {
    values_.clear();
    order_.clear();
    for (std::uint32_t i = 0; i < work_.size(); ++i) {
      const auto done = static_cast<double>(work_[i]->tests);
      values_.push_back(work_[i]->importance * static_cast<double>(quantum) / (static_cast<double>(quantum) + done));
      order_.push_back(i);
    }
    std::sort(order_.begin(), order_.end(), [&](std::uint32_t x, std::uint32_t y) {
      return values_[x] != values_[y] ? values_[x] > values_[y] : x < y;
    });
    shares_.assign(work_.size(), 0);
    std::size_t dealt = 0, count = 0;
    for (; count < order_.size() && dealt < left; ++count) {
      const PairFront& front = *work_[order_[count]];
      const std::size_t wanted = std::clamp(front.tests_expected().value_or(quantum), least_budget, most_expected);
      // The last one gets what is left; where that is too little to open anything, nobody does.
      const std::size_t share = std::min(wanted, left - dealt);
      if (count > 0 && share < std::min(wanted, least_budget)) break;
      shares_[order_[count]] = share;
      dealt += share;
    }
    // work_ is in the order of places, and stays so.
    used_.assign(work_.size(), 0);
    parallel_for(workers, work_.size(), 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        if (shares_[i] != 0) used_[i] = work_[i]->refine(options, shares_[i]);
    });
    for (std::size_t i = 0; i < work_.size(); ++i) {
      if (shares_[i] == 0) continue;
      PairFront*& front = work_[i];
      front->updates_left_out = 0;
      front->tests += used_[i];
      left -= used_[i];
      tests_done_ += used_[i];
      // What it got is too little to open anything, and there will not be more.
      if (front->is_finished() || used_[i] == 0) front = nullptr;
    }
    std::erase(work_, nullptr);
  }
}

// As many of the most important ones as there is time for, then the others by importance in steps of a factor of two.
// Each part in the order of places, as bodies and fronts lie in memory: in another order a test takes a fifth longer.
void SceneState::choose_by_importance(std::size_t count) {
  if (count >= work_.size()) return;
  constexpr int steps = 128;
  std::nth_element(values_.begin(), values_.begin() + static_cast<std::ptrdiff_t>(count), values_.end(),
                   std::greater<>());
  const double most_of_others = values_[count];
  const auto step_of = [&](const PairFront* front) -> std::size_t {
    if (front->importance > most_of_others) return 0;
    const int exponent = front->importance > 0 ? std::ilogb(front->importance) : -steps;
    return static_cast<std::size_t>(std::clamp(steps / 2 - exponent, 1, steps - 1));
  };
  std::array<std::size_t, steps + 1> begin{};
  for (const PairFront* front : work_) ++begin[step_of(front) + 1];
  for (std::size_t step = 0; step < steps; ++step) begin[step + 1] += begin[step];
  chosen_.resize(work_.size());
  for (PairFront* front : work_) chosen_[begin[step_of(front)]++] = front;
  work_.swap(chosen_);
}

// One long wait for the processor must not keep all pairs from being begun in later updates: what is noted grows by a
// factor of four at most, and falls by an eighth where no pair was begun for it.
void SceneState::note_first_round(std::int64_t spent, std::int64_t pairs) {
  if (pairs == 0) {
    // mutant scene-long-wait: `0.875` -> `1`
    first_round_of_pair_ *= 0.875;
    return;
  }
  const double of_pair = static_cast<double>(spent) / static_cast<double>(pairs);
  first_round_of_pair_ = first_round_of_pair_ > 0 ? std::min(of_pair, 4 * first_round_of_pair_) : of_pair;
}

// Each gets a quantum, then all of them again twice as much.
void SceneState::refine_by_time(std::chrono::nanoseconds deadline, Workers& workers) {
  // A clock of the caller's is read from this thread alone.
  Workers& used_workers = options.clock ? serial_workers() : workers;
  // Somewhat fewer than the last update says, so that the last of them are not always those that are left over.
  values_.clear();
  for (const PairFront* front : work_) values_.push_back(front->importance);
  const double time = 0.9 * static_cast<double>((deadline - now()).count()) * used_workers.thread_count();
  choose_by_importance(time < first_round_of_pair_ * static_cast<double>(work_.size())
                           ? static_cast<std::size_t>(std::max(1.0, time / first_round_of_pair_))
                           : work_.size());
  std::atomic<bool> is_late = false;
  // What a pair takes on average in this round, twice, is not begun after the deadline is that near. Of the first pair
  // of a round it is what the round before says, twice, and of the first round what the last update says.
  std::atomic<std::int64_t> spent = 0, pairs = 0;
  auto expected = static_cast<std::int64_t>(first_round_of_pair_);
  for (std::size_t share = quantum; !work_.empty() && !is_late; share *= 2) {
    used_.assign(work_.size(), 0);
    spent = 0, pairs = 0;
    // Of the first round, in which most are finished, the clock is read for some at a time, if they are quick.
    constexpr double at_once_for = 10000;  // ns
    const std::size_t at_once = share == quantum && first_round_of_pair_ > 0
                                    ? static_cast<std::size_t>(std::clamp(at_once_for / first_round_of_pair_, 1.0, 8.0))
                                    : 1;
    parallel_for(used_workers, work_.size(), at_once, [&](std::size_t first, std::size_t last) {
      if (is_late) return;
      const std::int64_t known = pairs, count = static_cast<std::int64_t>(last - first);
      const std::int64_t kept = count * (known > 0 ? 2 * spent / known : expected);
      const std::chrono::nanoseconds begin = now();
      // mutant scene-late: `begin + std::chrono::nanoseconds(kept) >= deadline` -> `false`
      if (begin + std::chrono::nanoseconds(kept) >= deadline) {
        is_late = true;
        return;
      }
      for (std::size_t i = first; i < last; ++i) {
        work_[i]->updates_left_out = 0;
        used_[i] = work_[i]->refine(options, share, true);
      }
      spent += (now() - begin).count();
      pairs += count;
    });
    if (pairs > 0) expected = 2 * spent / pairs;
    if (share == quantum) note_first_round(spent, pairs);
    for (const std::size_t used : used_) tests_done_ += used;
    // Where there was time and nothing was done, nothing can be.
    for (std::size_t i = 0; i < work_.size(); ++i)
      if (work_[i]->is_finished() || (used_[i] == 0 && !is_late)) work_[i] = nullptr;
    std::erase(work_, nullptr);
  }
}

// The shares of a body serve all of its pairs, so they are there before pairs are looked at side by side.
void SceneState::follow_shares(Workers& workers) {
  places_.clear();
  for (const PairFront* front : chosen_)
    for (const std::uint32_t place : {front->id_a().place, front->id_b().place})
      if (const SceneBody& body = bodies[place]; body.collider->has_surface() && !body.shares.is_of(*body.collider))
        places_.push_back(place);
  std::sort(places_.begin(), places_.end());
  places_.erase(std::unique(places_.begin(), places_.end()), places_.end());
  workers.run(places_.size(), [&](std::size_t i) {
    SceneBody& body = bodies[places_[i]];
    body.shares.follow(*body.collider);
  });
}

void SceneState::add_extras(std::chrono::nanoseconds deadline, Workers& workers) {
  chosen_.clear();
  for (const Near& pair : near)
    if (pair.front != nullptr && pair.front->extras_are_due && pair.front->finished_count() > 0)
      chosen_.push_back(pair.front);
  const bool by_time = options.budget.is_time();
  if (by_time)
    std::stable_sort(chosen_.begin(), chosen_.end(),
                     [](const PairFront* x, const PairFront* y) { return x->importance > y->importance; });
  Workers& used_workers = by_time && options.clock ? serial_workers() : workers;
  if (options.surfaces) follow_shares(used_workers);
  const auto is_late = [&] { return by_time && now() >= deadline; };
  used_workers.run(chosen_.size(), [&](std::size_t i) {
    // Crossings are on top of any budget.
    if (!options.find_crossings && is_late()) return;
    PairFront& front = *chosen_[i];
    const ExtrasPool::Loan extras(extras_);
    front.add_extras(options, bodies[front.id_a().place].shares, bodies[front.id_b().place].shares, *extras, is_late);
  });
}

void SceneState::refine(std::chrono::nanoseconds start, Workers& workers, SceneStatus& status) {
  tests_done_ = 0;
  const Budget& budget = options.budget;
  if (budget.is_unlimited()) {
    refine_all(workers);
  } else if (budget.is_tests()) {
    refine_by_tests(static_cast<std::size_t>(budget.tests()), workers);
  } else {
    const std::chrono::nanoseconds deadline = start + budget.time() - to_publish_;
    // Surfaces get half of what is left.
    const std::chrono::nanoseconds begun = now();
    refine_by_time(options.surfaces ? begun + (deadline - begun) / 2 : deadline, workers);
  }
  if (options.surfaces || options.find_crossings) add_extras(start + budget.time() - to_publish_, workers);
  status.pair_tests = tests_done_;
}

// Near pairs and touches are in the same order, so what began and what ended comes of one walk along both.
void SceneState::publish(SceneStatus& status) {
  const auto ids = [](const EndedPair& touch) { return std::pair(touch.a, touch.b); };
  next_touching.clear();
  auto before = touching.begin();
  for (const Near& pair : near) {
    if (pair.front == nullptr) continue;
    const PairFront& front = *pair.front;
    ++status.near_pairs;
    if (!front.is_finished()) ++status.open_pairs;
    if (front.contacts().empty()) continue;
    EndedPair touch{id_of(pair.a), id_of(pair.b), 0};
    while (before != touching.end() && ids(*before) < ids(touch)) ended.push_back(*before++);
    const bool stays = before != touching.end() && ids(*before) == ids(touch);
    touch.id = stays ? (before++)->id : next_touch++;
    next_touching.push_back(touch);
    published.push_back({.a = touch.a,
                         .b = touch.b,
                         .id = touch.id,
                         .began = !stays,
                         .finished = front.is_finished(),
                         .contacts = front.contacts(),
                         .surfaces = options.surfaces ? front.surfaces() : std::span<const ContactSurface>(),
                         .crossings = options.find_crossings ? front.crossings() : std::span<const Crossing>()});
  }
  ended.insert(ended.end(), before, touching.end());
  std::sort(ended.begin(), ended.end(), [](const EndedPair& x, const EndedPair& y) { return x.id < y.id; });
  status.finished = status.open_pairs == 0;
}

// Parted pairs may come back, so they keep what they have until they have been seen here twice.
void SceneState::give_back_parted() {
  // mutant scene-memory-kept: `if (++updates_to_give_back_ < updates_kept) return` -> `return`
  if (++updates_to_give_back_ < updates_kept) return;
  updates_to_give_back_ = 0;
  for (PairFront* const front : spare_fronts)
    if (std::exchange(front->has_rested, true)) front->give_back();
  std::erase_if(parted_fronts, [&](PairFront* front) {
    if (!std::exchange(front->has_rested, true)) return false;
    front->give_back();
    front->unbind();
    spare_fronts.push_back(front);
    return true;
  });
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

// As if all bodies had just been added. Only the touches that were told of remain, whose end is still to be told.
void SceneState::start_over() noexcept {
  published.clear(), ended.clear();
  // mutant scene-interrupted-lists: `near.clear(), next_near.clear(), work_.proven_clear` -> `work_.proven_clear`
  near.clear(), next_near.clear(), work_.clear(), chosen_.clear();
  parted_fronts.clear(), spare_fronts.clear(), fronts.clear();
  extras_.forget();
  for (SceneBody& body : bodies) body.shares = {};
  next_to_forget_ = updates_to_give_back_ = 0;
  first_round_of_pair_ = 0;
  to_publish_ = {};
  // mutant scene-interrupted-untold: `is_interrupted = true` -> `true`
  everything_anew = is_interrupted = true;
}

SceneStatus SceneState::update_once(Workers& workers) {
  const bool by_time = options.budget.is_time();
  const std::chrono::nanoseconds start = by_time ? now() : std::chrono::nanoseconds(0);
  SceneStatus status = read_bodies(workers);
  if (!status) return status;
  published.clear(), ended.clear();
  broad.update();
  list_near();
  give_back_parted();
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
  // The longest of late: it falls by an eighth an update.
  if (by_time) to_publish_ = std::min(std::max(now() - refined, to_publish_ * 7 / 8), options.budget.time() / 2);
  // Nothing below throws.
  touching.swap(next_touching);
  everything_anew = filter_anew = extras_anew = is_interrupted = false;
  return status;
}

}  // namespace morula::detail
