// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What a scene keeps of two bodies that are near each other: contacts, a front where there is one, and how important
// they are.
#pragma once

#include <memory>
#include <morula/collide/contact_query.hpp>
#include <morula/collide/crossings.hpp>
#include <morula/scene/scene.hpp>
#include <mutex>
#include <utility>
#include <vector>

#include "collide/facets/contact_surface.hpp"
#include "collide/pairs/descent.hpp"

namespace morula::detail {

/// Memory to look at the facets of one pair at a time. It is shared by all pairs of a scene: a pair keeps what was
/// found.
struct PairExtras {
  SurfaceScratch surfaces;
  CrossingQuery crossings;
  std::vector<NodePair> nodes;
};

/// One for each thread that is at work.
class ExtrasPool {
 public:
  /// Taken out of the pool as long as it lives.
  class Loan {
   public:
    explicit Loan(ExtrasPool& pool) : pool_(pool), extras_(pool.take()) {}
    ~Loan() { pool_.give_back(std::move(extras_)); }
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;
    PairExtras& operator*() const { return *extras_; }

   private:
    ExtrasPool& pool_;
    std::unique_ptr<PairExtras> extras_;
  };

  /// None is on loan. What was interrupted may be half made.
  void forget() noexcept { free_.clear(); }

 private:
  std::unique_ptr<PairExtras> take() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) {
      ++count_;
      // So that giving back allocates nothing.
      free_.reserve(count_);
      return std::make_unique<PairExtras>();
    }
    std::unique_ptr<PairExtras> extras = std::move(free_.back());
    free_.pop_back();
    return extras;
  }
  void give_back(std::unique_ptr<PairExtras> extras) noexcept {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(extras));
  }

  std::mutex mutex_;
  std::vector<std::unique_ptr<PairExtras>> free_;
  std::size_t count_ = 0;
};

/// What a pair gets of the budget of one update: SceneState::look_at_roots() fills it, PairRefinement goes by it.
struct PairPriority {
  double importance = 0;  ///< weights included
  std::uint32_t updates_left_out = 0;
  std::size_t tests = 0;  ///< in this update
};

/// Of two bodies, from one update to the next. Each update fills it in this order: bind() if it was of others, visit()
/// or part() if a body has moved, refine(), add_extras().
class PairFront {
 public:
  /// Borrowed while they are a pair. Forgets whatever was known of others.
  void bind(BodyId id_a, const Collider& a, BodyId id_b, const Collider& b);
  bool is_of(BodyId id_a, BodyId id_b) const { return id_a == bodies_.id_a && id_b == bodies_.id_b; }
  /// A collider is another one: bind() comes next.
  void unbind() { bodies_.id_a = bodies_.id_b = {}; }
  BodyId id_a() const { return bodies_.id_a; }
  BodyId id_b() const { return bodies_.id_b; }
  const Collider& a() const { return *bodies_.a; }
  const Collider& b() const { return *bodies_.b; }
  /// A look at both roots, of bodies that have moved: contacts are coarse then. Cost: some 0.2 us.
  void visit(const SceneOptions& options);
  /// Both roots are apart, as is known otherwise.
  void part();
  /// No front of before fits any more.
  void forget_front() { front_.is_there = false; }

  /// Goes on, with at most so many tests; without any number, to the end. by_time: time counts, not their number, so
  /// where tests take less time, there are more. Returns the tests done.
  std::size_t refine(const SceneOptions& options, std::optional<std::size_t> most_tests, bool by_time = false);
  /// Surfaces and crossings of what is finished, as options say. is_late() ends surfaces.
  template <class IsLate>
  void add_extras(const SceneOptions& options, const FacetShares& shares_a, const FacetShares& shares_b,
                  PairExtras& extras, const IsLate& is_late);

  bool roots_overlap() const { return roots_.overlap; }
  bool is_finished() const {
    return !roots_.overlap || (is_current_ && (!front_.is_there || front_.query->contacts().finished));
  }
  bool is_current() const { return is_current_; }
  /// What it took when it was finished last, and a quarter, for bodies that have moved; nothing where that is unknown.
  std::optional<std::size_t> tests_expected() const;
  double overlap_share() const { return roots_.overlap_share; }
  std::span<const Contact> contacts() const;
  /// Of contacts, the first ones.
  std::size_t finished_count() const;
  bool extras_are_due() const { return extras_.are_due; }
  /// Other ones are asked for: what is current gets them anew.
  void renew_extras() { extras_.are_due = extras_.are_due || is_current_; }
  std::span<const ContactSurface> surfaces() const { return extras_.surfaces; }
  std::span<const Crossing> crossings() const { return extras_.crossings; }

  /// All memory. bind() comes next.
  void give_back();

  PairPriority priority;
  bool has_rested = false;  ///< FrontStore's: spare or parted when memory was given back last

 private:
  bool is_worth_a_descent(const SceneOptions& options, std::size_t most_tests, bool by_time) const;
  bool carries() const;
  Descent descend(const SceneOptions& options, std::size_t most_tests);
  ContactStatus refine_front(const SceneOptions& options, const Budget& budget);
  CollideOptions options_for(const SceneOptions& options, const Budget& budget) const;

  /// Whose front it is. bind() fills it, before anything else; unbind() takes the ids.
  struct Bodies {
    BodyId id_a{}, id_b{};
    const Collider *a = nullptr, *b = nullptr;
  };
  /// What visit() or part() has found of the roots in the present poses.
  struct Roots {
    bool overlap = false;
    double overlap_share = 0;
    Contact coarse{};
  };
  /// refine_front() makes it and goes on with it; descend() and forget_front() end it.
  struct Front {
    std::unique_ptr<ContactQuery> query{};  ///< once there was a front
    std::size_t tests = 0;                  ///< what a fresh front has cost
    bool is_there = false;                  ///< of these or earlier poses
    bool carrying_was_dear = false;         ///< bodies had moved so far that it saved too few tests
  };
  /// What refine() has taken in these and earlier poses.
  struct Cost {
    std::optional<std::size_t> to_finish{};  ///< tests, when it last was
    std::size_t in_vain = 0;                 ///< tests of the last descent that was stopped; 0 since one was not
  };
  /// Of finished contacts: add_extras() fills it, and whatever changes contacts empties it.
  struct Extras {
    bool are_due = false;  ///< if they are asked for
    std::vector<ContactSurface> surfaces;
    std::vector<Crossing> crossings;
    void forget() { surfaces.clear(), crossings.clear(); }
  };

  Bodies bodies_;
  Roots roots_;
  Front front_;
  Cost cost_;
  std::vector<Contact> descended_;  ///< contacts without a front
  bool is_current_ = false;  ///< contacts are of the present poses: the query's, or else descended_ and all of them
  Extras extras_;
};

template <class IsLate>
void PairFront::add_extras(const SceneOptions& options, const FacetShares& shares_a, const FacetShares& shares_b,
                           PairExtras& extras, const IsLate& is_late) {
  extras_.forget();
  extras_.are_due = false;
  // A sleeping body may have been refused an update since it was read.
  if (!askable(a()) || !askable(b())) return;
  const std::span<const Contact> finished = contacts().first(finished_count());
  if (options.surfaces) {
    extras.surfaces.start(a(), shares_a, b(), shares_b);
    for (const Contact& c : finished) {
      // A pair that rests goes on with its surfaces in the next update, where time ended them.
      extras_.are_due = is_late();
      if (extras_.are_due) break;
      extras_.surfaces.push_back(
          contact_surface(a(), c.node_a, b(), c.node_b, c.point, c.normal, c.depth, extras.surfaces));
    }
  }
  if (options.find_crossings) {
    extras.nodes.clear();
    for (const Contact& c : finished) extras.nodes.push_back({c.node_a, c.node_b});
    if (extras.nodes.empty() || !extras.crossings.run(a(), b(), extras.nodes)) return;
    extras_.crossings.assign(extras.crossings.pairs().begin(), extras.crossings.pairs().end());
  }
}

}  // namespace morula::detail
