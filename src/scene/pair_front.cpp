// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/pair_front.hpp"

#include <algorithm>
#include <limits>

#include "collide/facets/contact_geometry.hpp"
#include "collide/pairs/descent.hpp"
#include "collide/pairs/tree_pair.hpp"

namespace morula::detail {
namespace {

constexpr std::size_t least_for_a_try = 512;
// The number of a descent's tests that take as long as one test of a front.
constexpr std::size_t descent_tests = 4;
// The most memory of a front per node of both trees. With it a pair holds less than 16 kB, contacts aside, and begins
// in a time that does not depend on the sizes of the trees.
constexpr std::size_t most_bytes_to_carry = 8192;

}  // namespace

void PairFront::bind(BodyId id_a, const Collider& a, BodyId id_b, const Collider& b) {
  if (front_.query) {
    front_.query->clear();
    front_.query->add(a, b);
  }
  bodies_.id_a = id_a, bodies_.id_b = id_b;
  bodies_.a = &a, bodies_.b = &b;
  // mutant scene-patches-of-others: `patches.reset()` -> ``
  patches.reset();
  front_.is_there = is_current_ = touch_found_ = roots_.overlap = front_.carrying_was_dear = false;
  extras_.forget();
  cost_.to_finish.reset();
  cost_.in_vain = 0;
}

CollideOptions PairFront::options_for(const SceneOptions& options, const Budget& budget) const {
  CollideOptions result{.margin = options.margin, .budget = budget};
  // If both trees end above the level, contacts are pairs of leaves.
  if (options.level && *options.level < std::max(a().tree().level_count(), b().tree().level_count()))
    result.level = options.level;
  return result;
}

void PairFront::visit(const SceneOptions& options) {
  const TreePair trees(a(), b(), options.margin, options.level.value_or(leaf_level));
  part();
  roots_.overlap = trees.overlaps(0, 0);
  if (!roots_.overlap) return;
  roots_.overlap_share = detail::overlap_share(trees.placed(), trees.sphere_a(0), trees.sphere_b(0));
  describe(trees, 0, 0, roots_.coarse);
}

void PairFront::part() {
  roots_.overlap = is_current_ = touch_found_ = extras_.are_due = false;
  extras_.forget();
}

// A pair needs a front only if it takes more tests than it may have at a time. Most pairs take few, and finish three to
// four times sooner by a depth-first descent without a front.
bool PairFront::is_worth_a_descent(const SceneOptions& options, std::size_t most_tests, bool by_time) const {
  if (is_current_ || (carries() && !(by_time && front_.carrying_was_dear))) return false;
  if (const std::optional<std::size_t> expected = tests_expected()) return *expected <= most_tests;
  // If the cost is unknown: with surfaces or crossings, which only finished contacts have, descend only if the descent
  // cannot be stopped; otherwise with as many tests as a round gives at least.
  if (options.surfaces || options.find_crossings)
    return a().tree().node_count() * b().tree().node_count() <= most_tests;
  return most_tests >= least_for_a_try && most_tests > 2 * cost_.in_vain;
}

std::optional<std::size_t> PairFront::tests_expected() const {
  if (!cost_.to_finish) return std::nullopt;
  return *cost_.to_finish + *cost_.to_finish / 4;
}

// A front that can be carried holds a sphere and a path per node.
bool PairFront::may_carry() const {
  constexpr std::size_t of_node = sizeof(Spheref) + sizeof(double);
  return a().tree().node_count() + b().tree().node_count() <= most_bytes_to_carry / of_node;
}

// Carrying a front into the next frame reads all nodes once: that is expensive if there are more nodes than tests.
bool PairFront::carries() const {
  return front_.is_there && may_carry() && front_.tests > a().tree().node_count() + b().tree().node_count();
}

Descent PairFront::descend(const SceneOptions& options, std::size_t most_tests) {
  const TreePair trees(a(), b(), options.margin, options.level.value_or(leaf_level));
  descended_.clear();
  const Descent done = each_overlapping(
      trees,
      [&](std::uint32_t node_a, std::uint32_t node_b) {
        Contact& contact = descended_.emplace_back();
        describe(trees, node_a, node_b, contact);
        contact.finished = true;
      },
      most_tests);
  if (done.finished) {
    is_current_ = extras_.are_due = true;
    front_.is_there = false;
    cost_.to_finish = done.tests;
    cost_.in_vain = 0;
  } else {
    cost_.to_finish.reset();
    cost_.in_vain = most_tests;
    touch_found_ = !descended_.empty();
  }
  return done;
}

std::size_t PairFront::refine(const SceneOptions& options, std::optional<std::size_t> most_tests, bool by_time) {
  const bool goes_on = is_current_ && front_.is_there;
  if (!most_tests && !goes_on) return descend(options, std::numeric_limits<std::size_t>::max()).tests;
  std::size_t spent = 0;
  if (most_tests) {
    const std::size_t most = *most_tests * (by_time ? descent_tests : 1);
    if (is_worth_a_descent(options, most, by_time)) {
      const Descent done = descend(options, most);
      if (done.finished || done.tests >= *most_tests) return done.tests;
      spent = done.tests;
      *most_tests -= spent;
    }
  }
  const ContactStatus status = refine_front(options, most_tests ? Budget(*most_tests) : Budget());
  if (status.finished) cost_.to_finish = front_.tests;
  front_.is_there = is_current_ = extras_.are_due = static_cast<bool>(status);
  extras_.forget();
  return spent + status.pair_tests;
}

ContactStatus PairFront::refine_front(const SceneOptions& options, const Budget& budget) {
  if (!front_.query) {
    front_.query = std::make_unique<ContactQuery>();
    front_.query->add(a(), b());
  }
  front_.query->set_options(options_for(options, budget));
  if (is_current_ && front_.is_there) {
    const ContactStatus status = front_.query->resume();
    if (status) front_.tests += status.pair_tests;
    return status;
  }
  if (carries()) {
    const ContactStatus status = front_.query->carry();
    front_.carrying_was_dear = descent_tests * status.pair_tests > front_.tests;
    if (status) return status;
  }
  const ContactStatus status = may_carry() ? front_.query->start() : start_for_resume(*front_.query);
  front_.tests = status.pair_tests;
  return status;
}

std::span<const Contact> PairFront::contacts() const {
  if (!roots_.overlap) return {};
  if (!is_current_) return std::span(&roots_.coarse, 1);
  return front_.is_there ? std::span<const Contact>(front_.query->contacts().contacts) : descended_;
}

std::size_t PairFront::finished_count() const {
  if (!roots_.overlap || !is_current_) return 0;
  return front_.is_there ? front_.query->contacts().finished_count : descended_.size();
}

void PairFront::give_back() {
  part();
  front_.is_there = false;
  front_.query.reset();
  patches.reset();
  std::vector<Crossing>().swap(extras_.crossings);
  // mutant scene-reserve-kept: `if (is_reserved_) return` -> ``
  if (is_reserved_) return;
  std::vector<Contact>().swap(descended_);
  std::vector<ContactSurface>().swap(extras_.surfaces);
}

void PairFront::reserve(std::size_t contacts, std::size_t surfaces) {
  descended_.reserve(contacts);
  extras_.surfaces.reserve(surfaces);
  is_reserved_ = is_reserved_ || contacts > 0;
}

}  // namespace morula::detail
