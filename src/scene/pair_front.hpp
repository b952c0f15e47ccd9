// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What a scene keeps of two bodies that are near each other: contacts, a front where there is one, and how important
// they are.
#pragma once

#include <memory>
#include <morula/collide/contact_query.hpp>
#include <morula/scene/scene.hpp>
#include <vector>

#include "collide/pairs/descent.hpp"
#include "scene/pair_extras.hpp"

namespace morula::detail {

class PairFront {
 public:
  /// Borrowed while they are a pair. Forgets whatever was known of others.
  void bind(BodyId id_a, const Collider& a, BodyId id_b, const Collider& b);
  bool is_of(BodyId id_a, BodyId id_b) const { return id_a == id_a_ && id_b == id_b_; }
  /// A collider is another one: bind() comes next.
  void unbind() { id_a_ = id_b_ = {}; }
  BodyId id_a() const { return id_a_; }
  BodyId id_b() const { return id_b_; }
  const Collider& a() const { return *a_; }
  const Collider& b() const { return *b_; }
  /// A look at both roots, of bodies that have moved: contacts are coarse then. Cost: some 0.2 us.
  void visit(const SceneOptions& options);
  /// Both roots are apart, as is known otherwise.
  void part();
  /// No front of before fits any more.
  void forget_front() { has_front_ = false; }

  /// Goes on, with at most so many tests; without any number, to the end. by_time: time counts, not their number, so
  /// where tests take less time, there are more. Returns the tests done.
  std::size_t refine(const SceneOptions& options, std::optional<std::size_t> most_tests, bool by_time = false);
  /// Surfaces and crossings of what is finished, as options say. is_late() ends surfaces.
  template <class IsLate>
  void add_extras(const SceneOptions& options, const FacetShares& shares_a, const FacetShares& shares_b,
                  PairExtras& extras, const IsLate& is_late);

  bool roots_overlap() const { return roots_overlap_; }
  bool is_finished() const { return !roots_overlap_ || (is_current_ && (!has_front_ || query_->contacts().finished)); }
  bool is_current() const { return is_current_; }
  /// What it took when it was finished last, and a quarter, for bodies that have moved; nothing where that is unknown.
  std::optional<std::size_t> tests_expected() const;
  double overlap_share() const { return overlap_share_; }
  std::span<const Contact> contacts() const;
  /// Of contacts, the first ones.
  std::size_t finished_count() const;
  std::span<const ContactSurface> surfaces() const { return surfaces_; }
  std::span<const Crossing> crossings() const { return crossings_; }

  /// All memory. bind() comes next.
  void give_back();

  // The scene's.
  double importance = 0;  ///< weights included
  std::uint32_t updates_left_out = 0;
  std::size_t tests = 0;        ///< in this update
  bool extras_are_due = false;  ///< if they are asked for
  bool has_rested = false;      ///< spare or parted when memory was given back last

 private:
  bool is_worth_a_descent(const SceneOptions& options, std::size_t most_tests, bool by_time) const;
  bool carries() const;
  Descent descend(const SceneOptions& options, std::size_t most_tests);
  ContactStatus refine_front(const SceneOptions& options, const Budget& budget);
  CollideOptions options_for(const SceneOptions& options, const Budget& budget) const;
  void forget_extras();

  BodyId id_a_{}, id_b_{};
  const Collider *a_ = nullptr, *b_ = nullptr;
  Contact coarse_{};
  double overlap_share_ = 0;
  std::unique_ptr<ContactQuery> query_{};         ///< once there was a front
  std::size_t tests_of_front_ = 0;                ///< what a fresh front has cost
  std::optional<std::size_t> tests_to_finish_{};  ///< when it last was
  std::vector<Contact> descended_;                ///< contacts without a front
  std::vector<ContactSurface> surfaces_;
  std::vector<Crossing> crossings_;
  std::size_t in_vain_ = 0;         ///< tests of the last descent that was stopped; 0 since one was not
  bool carrying_was_dear_ = false;  ///< bodies had moved so far that it saved too few tests
  bool roots_overlap_ = false;
  bool is_current_ = false;  ///< contacts are of the present poses: the query's, or else descended_ and all of them
  bool has_front_ = false;   ///< of these or earlier poses
};

template <class IsLate>
void PairFront::add_extras(const SceneOptions& options, const FacetShares& shares_a, const FacetShares& shares_b,
                           PairExtras& extras, const IsLate& is_late) {
  forget_extras();
  extras_are_due = false;
  // A sleeping body may have been refused an update since it was read.
  if (!askable(*a_) || !askable(*b_)) return;
  const std::span<const Contact> finished = contacts().first(finished_count());
  if (options.surfaces) {
    extras.surfaces.start(*a_, shares_a, *b_, shares_b);
    for (const Contact& c : finished) {
      // A pair that rests goes on with its surfaces in the next update, where time ended them.
      extras_are_due = is_late();
      if (extras_are_due) break;
      surfaces_.push_back(contact_surface(*a_, c.node_a, *b_, c.node_b, c.point, c.normal, c.depth, extras.surfaces));
    }
  }
  if (options.find_crossings) {
    extras.nodes.clear();
    for (const Contact& c : finished) extras.nodes.push_back({c.node_a, c.node_b});
    if (extras.nodes.empty() || !extras.crossings.run(*a_, *b_, extras.nodes)) return;
    crossings_.assign(extras.crossings.pairs().begin(), extras.crossings.pairs().end());
  }
}

}  // namespace morula::detail
