// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What a scene keeps of two bodies that are near each other: a front, contacts, and how important they are.
#pragma once

#include <morula/collide/contact_query.hpp>
#include <morula/scene/scene.hpp>
#include <vector>

#include "collide/pairs/descent.hpp"

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
  /// A look at both roots, of bodies that have moved: contacts are coarse then. Cost: some 0.2 us.
  void look(const SceneOptions& options);
  /// Both roots are apart, as is known otherwise.
  void part() { roots_overlap_ = is_current_ = false; }
  /// No front of before fits any more.
  void forget_front() { has_front_ = false; }

  /// Goes on, with at most so many tests; without any number, to the end. by_time: time counts, not their number, so
  /// where tests take less time, there are more. Returns the tests done.
  std::size_t refine(const SceneOptions& options, std::optional<std::size_t> most_tests, bool by_time = false);
  /// Surfaces and crossings of what is finished, as options say. of_time: for surfaces.
  void add_extras(const SceneOptions& options, const Budget& budget);

  bool roots_overlap() const { return roots_overlap_; }
  bool is_finished() const { return !roots_overlap_ || (is_current_ && (is_descended_ || query_.contacts().finished)); }
  bool is_current() const { return is_current_; }
  /// What it took when it was finished last, and a quarter, for bodies that have moved; nothing where that is unknown.
  std::optional<std::size_t> tests_expected() const;
  double overlap_share() const { return overlap_share_; }
  std::span<const Contact> contacts() const;
  std::span<const ContactSurface> surfaces() const;
  std::span<const Crossing> crossings() const;

  // The scene's.
  double importance = 0;  ///< weights included
  std::uint32_t updates_left_out = 0;
  std::size_t tests = 0;  ///< in this update
  bool extras_are_due = false;

 private:
  bool is_worth_a_descent(const SceneOptions& options, std::size_t most_tests, bool by_time) const;
  bool carries() const;
  Descent descend(const SceneOptions& options, std::size_t most_tests);
  CollideOptions options_for(const SceneOptions& options, const Budget& budget) const;

  ContactQuery query_;
  BodyId id_a_{}, id_b_{};
  const Collider *a_ = nullptr, *b_ = nullptr;
  Contact coarse_{};
  double overlap_share_ = 0;
  std::size_t tests_of_front_ = 0;                ///< what a fresh front has cost
  bool carrying_was_dear_ = false;                ///< bodies had moved so far that it saved too few tests
  std::optional<std::size_t> tests_to_finish_{};  ///< when it last was
  std::vector<Contact> descended_;
  std::size_t in_vain_ = 0;  ///< tests of the last descent that was stopped; 0 since one was not
  bool roots_overlap_ = false;
  bool is_current_ = false;    ///< contacts are of the present poses
  bool is_descended_ = false;  ///< they are descended_, not the query's
  bool has_front_ = false;     ///< of these or earlier poses
};

}  // namespace morula::detail
