// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/pair_front.hpp"

#include <algorithm>
#include <functional>

#include "collide/facets/contact_geometry.hpp"
#include "collide/pairs/descent.hpp"
#include "collide/pairs/tree_pair.hpp"

namespace morula::detail {
namespace {

constexpr std::size_t least_for_a_try = 512;
// As many tests of a descent take as long as one of a front.
constexpr std::size_t descent_tests = 4;

}  // namespace

void PairFront::bind(BodyId id_a, const Collider& a, BodyId id_b, const Collider& b) {
  id_a_ = id_a, id_b_ = id_b;
  query_.clear();
  query_.add(a, b);
  a_ = &a, b_ = &b;
  has_front_ = is_current_ = roots_overlap_ = is_descended_ = false;
  tests_to_finish_.reset();
  in_vain_ = 0;
}

CollideOptions PairFront::options_for(const SceneOptions& options, const Budget& budget) const {
  CollideOptions result{.margin = options.margin, .budget = budget};
  // Where both trees end above the level, contacts are those of leaves.
  if (options.level && *options.level < std::max(a_->tree().level_count(), b_->tree().level_count()))
    result.level = options.level;
  return result;
}

void PairFront::look(const SceneOptions& options) {
  const TreePair trees(*a_, *b_, options.margin, options.level.value_or(leaf_level));
  is_current_ = false;
  roots_overlap_ = trees.overlaps(0, 0);
  if (!roots_overlap_) return;
  overlap_share_ = detail::overlap_share(trees.placed(), trees.sphere_a(0), trees.sphere_b(0));
  describe(trees.placed(), trees.sphere_a(0), trees.sphere_b(0), coarse_);
}

// A front is what a pair needs that takes more tests than it can have at a time. Most take few, and are done three to
// four times as soon depth-first, without one.
bool PairFront::is_worth_a_descent(const SceneOptions& options, std::size_t most_tests, bool by_time) const {
  if (options.surfaces || options.exact || is_current_ || (carries() && !(by_time && carrying_was_dear_))) return false;
  // Where nothing is known, as many as a round gives at least.
  const std::optional<std::size_t> expected = tests_expected();
  return expected ? *expected <= most_tests : most_tests >= least_for_a_try && most_tests > 2 * in_vain_;
}

std::optional<std::size_t> PairFront::tests_expected() const {
  if (!tests_to_finish_) return std::nullopt;
  return *tests_to_finish_ + *tests_to_finish_ / 4;
}

// To carry a front over, all nodes are looked at once: dear where there are more of them than tests.
bool PairFront::carries() const {
  return has_front_ && tests_of_front_ > a_->tree().node_count() + b_->tree().node_count();
}

Descent PairFront::descend(const SceneOptions& options, std::size_t most_tests) {
  const TreePair trees(*a_, *b_, options.margin, options.level.value_or(leaf_level));
  descended_.clear();
  const Descent done = each_overlapping(
      trees,
      [&](std::uint32_t node_a, std::uint32_t node_b) {
        Contact& contact = descended_.emplace_back();
        describe(trees.placed(), trees.sphere_a(node_a), trees.sphere_b(node_b), contact);
        contact.node_a = node_a;
        contact.node_b = node_b;
        contact.finished = true;
      },
      most_tests);
  if (done.finished) {
    is_current_ = is_descended_ = true;
    has_front_ = extras_are_due = false;
    tests_to_finish_ = done.tests;
    in_vain_ = 0;
  } else {
    tests_to_finish_.reset();
    in_vain_ = most_tests;
  }
  return done;
}

std::size_t PairFront::refine(const SceneOptions& options, std::optional<std::size_t> most_tests, bool by_time) {
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
  CollideOptions asked = options_for(options, most_tests ? Budget(*most_tests) : Budget());
  if (!most_tests) asked.surfaces = options.surfaces, asked.exact = options.exact;
  query_.set_options(std::move(asked));
  is_descended_ = false;
  ContactStatus status;
  if (is_current_ && has_front_) {
    status = query_.resume();
    if (status) tests_of_front_ += status.pair_tests;
  } else if (!most_tests) {
    status = query_.run();
    has_front_ = false;
  } else {
    const bool carried = carries();
    if (carried) {
      status = query_.carry();
      carrying_was_dear_ = descent_tests * status.pair_tests > tests_of_front_;
    }
    if (!carried || !status) {
      status = query_.start();
      tests_of_front_ = status.pair_tests;
    }
    has_front_ = static_cast<bool>(status);
  }
  if (status.finished) tests_to_finish_ = has_front_ ? tests_of_front_ : status.pair_tests;
  is_current_ = static_cast<bool>(status);
  extras_are_due = is_current_ && most_tests.has_value();
  return spent + status.pair_tests;
}

void PairFront::add_extras(const SceneOptions& options, const Budget& budget) {
  CollideOptions asked = options_for(options, has_front_ ? budget : Budget());
  asked.surfaces = options.surfaces, asked.exact = options.exact;
  if (options.clock) asked.clock = std::cref(options.clock);
  query_.set_options(std::move(asked));
  is_descended_ = false;
  if (has_front_) {
    query_.resume();
  } else {
    query_.run();
  }
  // A pair that rests goes on with its surfaces in the next update, where time ended them.
  extras_are_due = options.surfaces && query_.contacts().surfaces.size() < query_.contacts().finished_count;
}

std::span<const Contact> PairFront::contacts() const {
  if (!roots_overlap_) return {};
  if (!is_current_) return std::span(&coarse_, 1);
  return is_descended_ ? std::span<const Contact>(descended_) : query_.contacts().contacts;
}

std::span<const ContactSurface> PairFront::surfaces() const {
  if (!roots_overlap_ || !is_current_ || is_descended_) return {};
  return query_.contacts().surfaces;
}

std::span<const Crossing> PairFront::crossings() const {
  if (!roots_overlap_ || !is_current_ || is_descended_) return {};
  return query_.contacts().crossings;
}

}  // namespace morula::detail
