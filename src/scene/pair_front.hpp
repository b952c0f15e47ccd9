// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The data that a scene keeps for two bodies near each other: contacts, a front if there is one, and their importance.
#pragma once

#include <memory>
#include <morula/collide/contact_query.hpp>
#include <morula/collide/crossings.hpp>
#include <morula/parallel/threads.hpp>
#include <morula/scene/scene.hpp>
#include <mutex>
#include <utility>
#include <vector>

#include "collide/facets/contact_surface.hpp"
#include "collide/pairs/descent.hpp"
#include "scene/pair_patches.hpp"

namespace morula::detail {

/// Memory to examine the facets of one pair at a time. All pairs of a scene share it; a pair keeps only the results.
struct PairExtras {
  SurfaceScratch surfaces;
  CrossingQuery crossings;
  std::vector<NodePair> nodes;
  std::unique_ptr<PatchEngine> patches;  ///< null until it is used
};

/// A pool of such memories, one for each working thread.
class ExtrasPool {
 public:
  /// A memory taken from the pool, and returned at the end of its life.
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

  /// Discards all memories, which an interruption may have left inconsistent. None may be on loan.
  void forget() noexcept { free_.clear(); }

 private:
  std::unique_ptr<PairExtras> take() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) {
      ++count_;
      // Reserves room, so that a return allocates nothing.
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

  Mutex mutex_;
  std::vector<std::unique_ptr<PairExtras>> free_;
  std::size_t count_ = 0;
};

/// The priority of a pair in the budget of one update: SceneState::look_at_roots() fills it, PairRefinement reads it.
struct PairPriority {
  double importance = 0;  ///< importance, weights included
  std::uint32_t updates_left_out = 0;
  std::size_t tests = 0;  ///< tests in this update
};

/// The front of two bodies, from one update to the next. Each update fills it in this order: bind() if it belonged to
/// others, visit() or part() if a body has moved, refine(), add_extras().
class PairFront {
 public:
  /// Binds the front to two bodies, which have to live while they are a pair. Forgets all data of others.
  void bind(BodyId id_a, const Collider& a, BodyId id_b, const Collider& b);
  bool is_of(BodyId id_a, BodyId id_b) const { return id_a == bodies_.id_a && id_b == bodies_.id_b; }
  /// Unbinds the front, because a collider has changed; bind() has to follow.
  void unbind() { bodies_.id_a = bodies_.id_b = {}; }
  BodyId id_a() const { return bodies_.id_a; }
  BodyId id_b() const { return bodies_.id_b; }
  const Collider& a() const { return *bodies_.a; }
  const Collider& b() const { return *bodies_.b; }
  /// Tests both roots, after bodies have moved; contacts are coarse then. Cost: about 0.2 µs.
  void visit(const SceneOptions& options);
  /// Notes that both roots are apart, without a test.
  void part();
  /// Discards the front of earlier poses.
  void forget_front() { front_.is_there = false; }

  /// Continues with at most so many tests; without a number, to the end. by_time: the budget is one of time, so there
  /// are more tests where tests take less time. Returns the number of tests done. Neither number includes the test of
  /// both roots, which visit() does in any case. An unfinished pair progresses if it gets tests_to_open() tests.
  std::size_t refine(const SceneOptions& options, std::optional<std::size_t> most_tests, bool by_time = false);
  /// Adds surfaces and crossings of finished contacts, by the options. is_late() ends surfaces.
  template <class IsLate>
  void add_extras(const SceneOptions& options, PairExtras& extras, const IsLate& is_late);

  bool roots_overlap() const { return roots_.overlap; }
  /// The most tests that one pair of nodes takes to open.
  std::size_t tests_to_open() const { return bodies_.tests_to_open; }
  bool is_finished() const {
    return !roots_.overlap || (is_current_ && (!front_.is_there || front_.query->contacts().finished));
  }
  bool is_current() const { return is_current_; }
  /// Whether a pair of final nodes is known to overlap in the present poses. A descent that was stopped may have found
  /// one, though it has listed no contact.
  bool touch_is_confirmed() const { return roots_.overlap && (touch_found_ || finished_count() > 0); }
  /// The tests to expect: those that the last finished refinement took, and a quarter more if bodies have moved; none
  /// if that is unknown.
  std::optional<std::size_t> tests_expected() const;
  double overlap_share() const { return roots_.overlap_share; }
  std::span<const Contact> contacts() const;
  /// Number of finished contacts, which are the first ones.
  std::size_t finished_count() const;
  bool extras_are_due() const { return extras_.are_due; }
  /// Notes that other extras are requested: current contacts get them again.
  void renew_extras() { extras_.are_due = extras_.are_due || is_current_; }
  std::span<const ContactSurface> surfaces() const { return extras_.surfaces; }
  std::span<const Crossing> crossings() const { return extras_.crossings; }

  /// Makes room for so many contacts and surfaces, which give_back() leaves.
  void reserve(std::size_t contacts, std::size_t surfaces);
  /// Frees all memory but the reserved. bind() has to follow.
  void give_back();

  PairPriority priority;
  std::unique_ptr<PairPatches> patches;  ///< null until the pair had patches
  bool has_rested = false;  ///< set by FrontStore: whether it was spare or parted when memory was freed last

 private:
  bool is_worth_a_descent(const SceneOptions& options, std::size_t most_tests, bool by_time) const;
  bool may_carry() const;
  bool carries() const;
  Descent descend(const SceneOptions& options, std::size_t most_tests);
  ContactStatus refine_front(const SceneOptions& options, const Budget& budget);
  CollideOptions options_for(const SceneOptions& options, const Budget& budget) const;

  /// The bodies of the front. bind() fills it first; unbind() clears the ids.
  struct Bodies {
    BodyId id_a{}, id_b{};
    const Collider *a = nullptr, *b = nullptr;
    std::size_t tests_to_open = 0;
  };
  /// The result of visit() or part() for the roots in the present poses.
  struct Roots {
    bool overlap = false;
    double overlap_share = 0;
    Contact coarse{};
  };
  /// The front: refine_front() makes and continues it; descend() and forget_front() end it.
  struct Front {
    std::unique_ptr<ContactQuery> query{};  ///< null until there was a front
    std::size_t tests = 0;                  ///< tests that a new front has cost
    bool is_there = false;                  ///< whether there is a front of these or earlier poses
    bool carrying_was_dear = false;         ///< whether carrying saved too few tests, because bodies had moved far
  };
  /// The cost of refine() in these and earlier poses.
  struct Cost {
    std::optional<std::size_t> to_finish{};  ///< tests of the last finished refinement
    std::size_t in_vain = 0;                 ///< tests of the last descent, if it was stopped; else 0
  };
  /// Extras of finished contacts: add_extras() fills it, and every change of contacts empties it.
  struct Extras {
    bool are_due = false;  ///< whether extras have to be computed, if the options request them
    std::vector<ContactSurface> surfaces;
    std::vector<Crossing> crossings;
    void forget() { surfaces.clear(), crossings.clear(); }
  };

  Bodies bodies_;
  Roots roots_;
  Front front_;
  Cost cost_;
  std::vector<Contact> descended_;  ///< contacts found without a front
  bool is_current_ = false;   ///< whether contacts belong to the present poses: the query's contacts, or else all of
                              ///< descended_
  bool is_reserved_ = false;  ///< whether lists keep their memory
  bool touch_found_ = false;  ///< whether a stopped descent has found a contact of the present poses
  Extras extras_;
};

template <class IsLate>
void PairFront::add_extras(const SceneOptions& options, PairExtras& extras, const IsLate& is_late) {
  extras_.forget();
  extras_.are_due = false;
  // A sleeping body may have had a rejected update since it was read.
  if (!askable(a()) || !askable(b())) return;
  const std::span<const Contact> finished = contacts().first(finished_count());
  if (options.surfaces) {
    extras.surfaces.start(a(), b());
    for (const Contact& c : finished) {
      // If time ended its surfaces, a pair at rest continues with them in the next update.
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
