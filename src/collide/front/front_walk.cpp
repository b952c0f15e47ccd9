// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/front/front_walk.hpp"

#include <algorithm>
#include <utility>

#include "collide/facets/contact_geometry.hpp"
#include "parallel/interruption.hpp"

namespace morula::detail {
namespace {

constexpr std::uint32_t none = Front::none;
// The number of pairs that are popped together. It is the same for any number of workers, so that they open the same
// pairs.
constexpr std::size_t round_size = 16;
constexpr std::size_t slots_per_chunk = 4;
// The most tests between two readings of the clock.
constexpr std::uint32_t tests_per_look = 64;

bool comes_later(const Front::Waiting& x, const Front::Waiting& y) {
  return x.priority != y.priority ? x.priority < y.priority : x.order > y.order;
}

}  // namespace

void FrontWalk::place(const CollideOptions& options) {
  trees_.clear();
  for (const ColliderPair& pair : pairs)
    trees_.emplace_back(*pair.a, *pair.b, options.margin, options.level.value_or(none));
}

void FrontWalk::start(const CollideOptions& options, bool accepts, Workers& workers, Contacts& result) {
  place(options);
  records_paths_ = accepts;
  front.level = options.level.value_or(none);
  front.margin = options.margin;
  front.pairs.resize(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    Front::Pair& bodies = front.pairs[i];
    begin_travel(bodies, *pairs[i].a, *pairs[i].b, trees_[i].placed(), accepts);
    bodies.roots = Front::Verdict::untested;
    bodies.opened_roots = none;
  }
  front.opened.clear();
  front.masks.clear();
  front.waiting.clear();
  front.next_order = 0;
  opened_before_.clear();
  roots_before_.assign(pairs.size(), none);
  result.finished_count = 0;
  Run run{options, workers, result, Meter(options)};
  refine(run);
}

void FrontWalk::resume(const CollideOptions& options, Workers& workers, Contacts& result) {
  place(options);
  Run run{options, workers, result, Meter(options)};
  run.meter.allow_step();
  refine(run);
}

void FrontWalk::carry(const CollideOptions& options, Workers& workers, Contacts& result) {
  place(options);
  records_paths_ = true;
  roots_before_.assign(pairs.size(), none);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    Front::Pair& bodies = front.pairs[i];
    follow_travel(bodies, *pairs[i].a, *pairs[i].b, trees_[i].placed(), ways_);
    bodies.roots = Front::Verdict::untested;
    roots_before_[i] = std::exchange(bodies.opened_roots, none);
  }
  front.opened.swap(opened_before_);
  front.masks.swap(masks_before_);
  front.opened.clear();
  front.masks.clear();
  front.waiting.clear();
  front.next_order = 0;
  result.finished_count = 0;
  Run run{options, workers, result, Meter(options)};
  refine(run);
}

bool FrontWalk::reachable(const CollideOptions& options, const Front::Waiting& pair) const {
  if (!options.refresh_children) return true;
  const TreePair& trees = trees_[pair.pair];
  const ColliderPair& colliders = pairs[pair.pair];
  return (!trees.opens_a(pair.a, pair.depth) || options.refresh_children(*colliders.a, pair.a)) &&
         (!trees.opens_b(pair.b, pair.depth) || options.refresh_children(*colliders.b, pair.b));
}

// Each side is subtracted by itself, so that a short path of one is not lost next to a long path of the other. The
// rounding error of a difference, and of the sum of both, is below 2^-51 of it; the clearance was made smaller by
// 2^-10.
double FrontWalk::traveled_since(const Front::Opened& before) const {
  const Front::Pair& bodies = front.pairs[before.pair];
  return (bodies.a.path_length[before.a] - before.path_length_a) +
         (bodies.b.path_length[before.b] - before.path_length_b);
}

bool FrontWalk::still_holds(const CollideOptions& options, const Front::Waiting& pair) const {
  if (pair.before == none || options.refresh_children) return false;
  const Front::Opened& before = opened_before_[pair.before];
  if (before.clearance < 0) return false;
  const double since = traveled_since(before);
  // mutant front-rounding: `+ front.pairs[pair.pair].rounding <` -> `<`
  return since == 0 || since + front.pairs[pair.pair].rounding < before.clearance;
}

void FrontWalk::report(const Front::Waiting& pair, bool finished, Contacts& result) const {
  make_room(result.contacts);
  Contact& contact = result.contacts.emplace_back();
  describe(trees_[pair.pair], pair.a, pair.b, contact);
  contact.pair = pair.pair;
  contact.finished = finished;
}

void FrontWalk::admit(const Front::Waiting& found, Run& run) {
  const TreePair& trees = trees_[found.pair];
  if (trees.is_final(found.a, found.b, found.depth)) {
    report(found, true, run.result);
    return;
  }
  make_room(front.waiting);
  Front::Waiting& pair = front.waiting.emplace_back(found);
  pair.order = front.next_order++;
  if (run.options.priority == Priority::level) {
    pair.priority = -static_cast<float>(found.depth);
  } else {
    pair.priority = overlap_share(trees.placed(), trees.sphere_a(found.a), trees.sphere_b(found.b));
    if (run.options.priority == Priority::importance) pair.priority *= static_cast<float>(pairs[found.pair].weight);
  }
  std::push_heap(front.waiting.begin(), front.waiting.end(), comes_later);
}

void FrontWalk::take_in(const Slot& slot, const std::uint64_t* masks, Run& run) {
  const Front::Waiting& pair = slot.pair;
  const auto opened = static_cast<std::uint32_t>(front.opened.size());
  const auto first_mask = static_cast<std::uint32_t>(front.masks.size());
  make_room(front.masks, slot.below_b.count);
  make_room(front.opened);
  front.masks.insert(front.masks.end(), masks, masks + slot.below_b.count);
  Front::Opened& entry = front.opened.emplace_back(
      Front::Opened{pair.pair, pair.a, pair.b, pair.depth, first_mask, none, none, slot.clearance, 0, 0});
  if (slot.has_verdicts) {
    const Front::Opened& before = opened_before_[pair.before];
    // mutant front-forgets-the-way: `before.path_length_a, entry.path_length_b = before.path_length_b` -> `front.pairs[pair.pair].a.path_length[before.a], entry.path_length_b = front.pairs[pair.pair].b.path_length[before.b]`
    entry.path_length_a = before.path_length_a, entry.path_length_b = before.path_length_b;
  } else if (records_paths_) {
    const Front::Pair& bodies = front.pairs[pair.pair];
    entry.path_length_a = bodies.a.path_length[pair.a], entry.path_length_b = bodies.b.path_length[pair.b];
  }
  std::uint32_t& head = pair.above == none ? front.pairs[pair.pair].opened_roots : front.opened[pair.above].first_below;
  entry.next_beside = std::exchange(head, opened);

  // The place at which a pair below was opened in the previous frame.
  const auto place_of = [&](std::uint32_t a, std::uint32_t b) {
    return (b - slot.below_b.first) * slot.below_a.count + (a - slot.below_a.first);
  };
  const auto each_before = [&](const auto& f) {
    if (pair.before == none) return;
    for (std::uint32_t i = opened_before_[pair.before].first_below; i != none; i = opened_before_[i].next_beside)
      f(i, before_of_child_[place_of(opened_before_[i].a, opened_before_[i].b)]);
  };
  // The table is as large as the largest block: a table for any branching would be most of the memory of a query of
  // small bodies.
  const std::size_t block = std::size_t{slot.below_a.count} * slot.below_b.count;
  if (before_of_child_.size() < block) before_of_child_.resize(block, none);
  each_before([](std::uint32_t i, std::uint32_t& place) { place = i; });
  any_overlapping(slot.below_a, slot.below_b, masks, [&](std::uint32_t a, std::uint32_t b) {
    admit({0, 0, pair.pair, a, b, pair.depth + 1, opened, before_of_child_[place_of(a, b)]}, run);
    return false;
  });
  each_before([](std::uint32_t, std::uint32_t& place) { place = none; });
}

void FrontWalk::test_roots(Run& run) {
  for (std::uint32_t i = 0; i < pairs.size(); ++i) {
    Front::Pair& bodies = front.pairs[i];
    if (bodies.roots != Front::Verdict::untested || run.meter.out_of_time() || !run.meter.try_spend(1)) continue;
    ++run.meter.done;
    const bool overlap = trees_[i].overlaps(0, 0);
    bodies.roots = overlap ? Front::Verdict::overlapping : Front::Verdict::separated;
    if (overlap) admit({0, 0, i, 0, 0, 0, none, roots_before_[i]}, run);
    run.meter.done_step();
  }
}

void FrontWalk::fill_round(Run& run) {
  round_.clear();
  const std::size_t size = run.meter.by_time() ? 1 : round_size;
  while (round_.size() < size && !front.waiting.empty()) {
    std::pop_heap(front.waiting.begin(), front.waiting.end(), comes_later);
    const Front::Waiting pair = front.waiting.back();
    front.waiting.pop_back();
    const TreePair& trees = trees_[pair.pair];
    const Slot slot{pair, trees.below_a(pair.a, pair.depth), trees.below_b(pair.b, pair.depth),
                    still_holds(run.options, pair), std::numeric_limits<double>::infinity()};
    if (!run.meter.try_spend(slot.tests())) {
      aside_.push_back(pair);
    } else if (!reachable(run.options, pair)) {
      run.meter.give_back(slot.tests());
      aside_.push_back(pair);
    } else {
      round_.push_back(slot);
    }
  }
}

void FrontWalk::test(const CollideOptions& options, Slot& slot, NodeRange below_b, std::uint64_t* masks) const {
  const TreePair& trees = trees_[slot.pair.pair];
  if (records_paths_ && !options.refresh_children) {
    // The pads of this frame decided, and the pads of a later frame may be smaller, when a vertex that was far away has
    // come back. So the allowance for rounding is subtracted at both ends.
    const double measured = trees.test_and_measure(slot.below_a, below_b, masks);
    slot.clearance = std::min(slot.clearance, std::max(0.0, measured - front.pairs[slot.pair.pair].rounding));
  } else {
    trees.test(slot.below_a, below_b, masks);
    slot.clearance = -1;
  }
}

void FrontWalk::test_round(Run& run) {
  std::size_t to_test = 0, tests = 0;
  for (const Slot& slot : round_) to_test += !slot.has_verdicts, tests += slot.tests();
  run.meter.done += tests;
  const auto test_slots = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (!round_[i].has_verdicts)
        test(run.options, round_[i], round_[i].below_b, round_masks_.data() + round_[i].first_mask);
  };
  if (to_test > slots_per_chunk && run.workers.thread_count() > 1) {
    parallel_for(run.workers, round_.size(), slots_per_chunk, test_slots);
  } else {
    test_slots(0, round_.size());
  }
}

bool FrontWalk::test_in_time(Run& run) {
  for (Slot& slot : round_) {
    if (slot.has_verdicts) continue;
    const std::uint32_t step = std::max(1u, tests_per_look / slot.below_a.count);
    for (std::uint32_t j = 0; j < slot.below_b.count; j += step) {
      if (j > 0 && run.meter.out_of_time()) {
        aside_.push_back(slot.pair);
        return false;
      }
      const NodeRange rows{slot.below_b.first + j, std::min(step, slot.below_b.count - j)};
      test(run.options, slot, rows, round_masks_.data() + j);
      run.meter.done += std::size_t{slot.below_a.count} * rows.count;
    }
  }
  return true;
}

void FrontWalk::refine(Run& run) {
  Contacts& result = run.result;
  // Finished contacts stay, with their surfaces. After a start or a carry there are none.
  const std::size_t kept = result.finished_count;
  result.contacts.resize(kept);
  if (result.surfaces.size() > kept)
    result.surfaces.erase(result.surfaces.begin() + static_cast<std::ptrdiff_t>(kept), result.surfaces.end());
  aside_.clear();
  std::make_heap(front.waiting.begin(), front.waiting.end(), comes_later);
  test_roots(run);
  while (!front.waiting.empty() && !run.meter.out_of_time()) {
    check_interrupt();
    fill_round(run);
    std::size_t mask_count = 0;
    for (Slot& slot : round_) slot.first_mask = std::exchange(mask_count, mask_count + slot.below_b.count);
    if (round_masks_.size() < mask_count) round_masks_.resize(mask_count);
    if (!run.meter.by_time()) {
      test_round(run);
    } else if (!test_in_time(run)) {
      break;
    }
    for (std::size_t i = 0; i < round_.size(); ++i) {
      Slot& slot = round_[i];
      const std::uint64_t* masks = round_masks_.data() + slot.first_mask;
      if (slot.has_verdicts) {
        const Front::Opened& before = opened_before_[slot.pair.before];
        slot.clearance = before.clearance;
        masks = masks_before_.data() + before.first_mask;
      }
      take_in(slot, masks, run);
    }
    if (!round_.empty()) run.meter.done_step();
  }
  front.waiting.insert(front.waiting.end(), aside_.begin(), aside_.end());
  result.pair_tests = run.meter.done;
  finish(run.options, run.meter, result);
}

void FrontWalk::finish(const CollideOptions& options, Meter& meter, Contacts& result) {
  std::sort(front.waiting.begin(), front.waiting.end(),
            [](const Front::Waiting& x, const Front::Waiting& y) { return x.order < y.order; });
  result.finished_count = result.contacts.size();
  result.finished = front.waiting.empty();
  result.achieved_level.resize(pairs.size());
  for (std::uint32_t i = 0; i < pairs.size(); ++i) {
    result.achieved_level[i] = trees_[i].depth();
    if (front.pairs[i].roots != Front::Verdict::untested) continue;
    result.finished = false;
    result.achieved_level[i] = 0;
    report({0, 0, i, 0, 0, 0, none, none}, false, result);
  }
  for (const Front::Waiting& pair : front.waiting) {
    report(pair, false, result);
    result.achieved_level[pair.pair] = std::min(result.achieved_level[pair.pair], pair.depth);
  }
  extras.add(pairs, options, &meter, result);
}

void FrontWalk::end_front() noexcept {
  front.pairs.clear();
  front.opened.clear();
  front.masks.clear();
  front.waiting.clear();
  front.next_order = 0;
}

void FrontWalk::forget() noexcept {
  front = Front{};
  extras.forget();
  records_paths_ = false;
  trees_.clear();
  opened_before_.clear(), masks_before_.clear(), roots_before_.clear();
  round_.clear(), round_masks_.clear(), aside_.clear();
  before_of_child_.clear();
  ways_.clear();
}

}  // namespace morula::detail
