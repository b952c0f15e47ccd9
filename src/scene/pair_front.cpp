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
// As many tests of a descent take as long as one of a front.
constexpr std::size_t descent_tests = 4;

}  // namespace

void PairFront::bind(BodyId id_a, const Collider& a, BodyId id_b, const Collider& b) {
  if (query_) {
    query_->clear();
    query_->add(a, b);
  }
  id_a_ = id_a, id_b_ = id_b;
  a_ = &a, b_ = &b;
  has_front_ = is_current_ = roots_overlap_ = carrying_was_dear_ = false;
  forget_extras();
  tests_to_finish_.reset();
  in_vain_ = 0;
}

void PairFront::forget_extras() {
  surfaces_.clear();
  crossings_.clear();
}

CollideOptions PairFront::options_for(const SceneOptions& options, const Budget& budget) const {
  CollideOptions result{.margin = options.margin, .budget = budget};
  // Where both trees end above the level, contacts are those of leaves.
  if (options.level && *options.level < std::max(a_->tree().level_count(), b_->tree().level_count()))
    result.level = options.level;
  return result;
}

void PairFront::visit(const SceneOptions& options) {
  const TreePair trees(*a_, *b_, options.margin, options.level.value_or(leaf_level));
  part();
  roots_overlap_ = trees.overlaps(0, 0);
  if (!roots_overlap_) return;
  overlap_share_ = detail::overlap_share(trees.placed(), trees.sphere_a(0), trees.sphere_b(0));
  describe(trees.placed(), trees.sphere_a(0), trees.sphere_b(0), coarse_);
}

void PairFront::part() {
  roots_overlap_ = is_current_ = extras_are_due = false;
  forget_extras();
}

// A front is what a pair needs that takes more tests than it can have at a time. Most take few, and are done three to
// four times as soon depth-first, without one.
bool PairFront::is_worth_a_descent(const SceneOptions& options, std::size_t most_tests, bool by_time) const {
  if (is_current_ || (carries() && !(by_time && carrying_was_dear_))) return false;
  if (const std::optional<std::size_t> expected = tests_expected()) return *expected <= most_tests;
  // Where nothing is known: with surfaces or crossings, which are those of finished contacts alone, only what cannot be
  // stopped; else as many as a round gives at least.
  if (options.surfaces || options.find_crossings)
    return a_->tree().node_count() * b_->tree().node_count() <= most_tests;
  return most_tests >= least_for_a_try && most_tests > 2 * in_vain_;
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
    is_current_ = extras_are_due = true;
    has_front_ = false;
    tests_to_finish_ = done.tests;
    in_vain_ = 0;
  } else {
    tests_to_finish_.reset();
    in_vain_ = most_tests;
  }
  return done;
}

std::size_t PairFront::refine(const SceneOptions& options, std::optional<std::size_t> most_tests, bool by_time) {
  const bool goes_on = is_current_ && has_front_;
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
  if (status.finished) tests_to_finish_ = tests_of_front_;
  has_front_ = is_current_ = extras_are_due = static_cast<bool>(status);
  forget_extras();
  return spent + status.pair_tests;
}

ContactStatus PairFront::refine_front(const SceneOptions& options, const Budget& budget) {
  if (!query_) {
    query_ = std::make_unique<ContactQuery>();
    query_->add(*a_, *b_);
  }
  query_->set_options(options_for(options, budget));
  if (is_current_ && has_front_) {
    const ContactStatus status = query_->resume();
    if (status) tests_of_front_ += status.pair_tests;
    return status;
  }
  if (carries()) {
    const ContactStatus status = query_->carry();
    carrying_was_dear_ = descent_tests * status.pair_tests > tests_of_front_;
    if (status) return status;
  }
  const ContactStatus status = query_->start();
  tests_of_front_ = status.pair_tests;
  return status;
}

std::span<const Contact> PairFront::contacts() const {
  if (!roots_overlap_) return {};
  if (!is_current_) return std::span(&coarse_, 1);
  return has_front_ ? std::span<const Contact>(query_->contacts().contacts) : descended_;
}

std::size_t PairFront::finished_count() const {
  if (!roots_overlap_ || !is_current_) return 0;
  return has_front_ ? query_->contacts().finished_count : descended_.size();
}

void PairFront::give_back() {
  part();
  has_front_ = false;
  query_.reset();
  std::vector<Contact>().swap(descended_);
  std::vector<ContactSurface>().swap(surfaces_);
  std::vector<Crossing>().swap(crossings_);
}

}  // namespace morula::detail
