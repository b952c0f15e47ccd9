// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/pair_front.hpp"

#include <algorithm>

#include "collide/facets/contact_geometry.hpp"
#include "collide/pairs/tree_pair.hpp"

namespace morula::detail {

void PairFront::bind(BodyId id_a, const Collider& a, BodyId id_b, const Collider& b) {
  id_a_ = id_a, id_b_ = id_b;
  query_.clear();
  query_.add(a, b);
  a_ = &a, b_ = &b;
  has_front_ = is_current_ = roots_overlap_ = false;
  tests_to_finish_.reset();
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

std::size_t PairFront::refine(const SceneOptions& options, std::optional<std::size_t> most_tests, bool may_exceed) {
  const bool is_extra = options.surfaces || options.exact;
  if (most_tests && may_exceed && !is_extra && !is_current_ && tests_to_finish_ && *tests_to_finish_ <= *most_tests)
    most_tests.reset();
  CollideOptions asked = options_for(options, most_tests ? Budget(*most_tests) : Budget());
  if (!most_tests) asked.surfaces = options.surfaces, asked.exact = options.exact;
  query_.set_options(std::move(asked));
  ContactStatus status;
  if (is_current_ && has_front_) {
    status = query_.resume();
    if (status) tests_of_front_ += status.pair_tests;
  } else if (!most_tests) {
    status = query_.run();
    has_front_ = false;
  } else {
    // To carry a front over, all nodes are looked at once: dear where there are more of them than tests.
    const bool carries = has_front_ && tests_of_front_ > a_->tree().node_count() + b_->tree().node_count();
    if (carries) status = query_.carry();
    if (!carries || !status) {
      status = query_.start();
      tests_of_front_ = status.pair_tests;
    }
    has_front_ = static_cast<bool>(status);
  }
  if (status.finished) tests_to_finish_ = has_front_ ? tests_of_front_ : status.pair_tests;
  is_current_ = static_cast<bool>(status);
  extras_are_due = is_current_ && most_tests.has_value();
  return status.pair_tests;
}

void PairFront::add_extras(const SceneOptions& options, const Budget& budget) {
  CollideOptions asked = options_for(options, has_front_ ? budget : Budget());
  asked.surfaces = options.surfaces, asked.exact = options.exact;
  query_.set_options(std::move(asked));
  if (has_front_) {
    query_.resume();
  } else {
    query_.run();
  }
  extras_are_due = false;
}

std::span<const Contact> PairFront::contacts() const {
  if (!roots_overlap_) return {};
  return is_current_ ? std::span<const Contact>(query_.contacts().contacts) : std::span(&coarse_, 1);
}

std::span<const ContactSurface> PairFront::surfaces() const {
  if (!roots_overlap_ || !is_current_) return {};
  return query_.contacts().surfaces;
}

std::span<const Crossing> PairFront::crossings() const {
  if (!roots_overlap_ || !is_current_) return {};
  return query_.contacts().crossings;
}

}  // namespace morula::detail
