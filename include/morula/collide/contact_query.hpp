// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Contacts frame after frame, of several pairs of bodies under one budget, interrupted and continued.
#pragma once

#include <memory>
#include <morula/collide/contacts.hpp>
#include <morula/collide/front.hpp>
#include <morula/parallel/workers.hpp>

namespace morula {

/// Refused, or how far it came.
struct [[nodiscard]] ContactStatus : Status {
  bool finished = false;       ///< as Contacts::finished
  std::size_t pair_tests = 0;  ///< done by this call
};

/// Holds pairs of bodies, the front and all memory: a call allocates nothing once that suffices. All pairs share one
/// queue and one budget. A call that is refused changes nothing.
///
/// The result after any call is sound: every crossing lies within a pair of contacts(). An exception of a callback
/// (refresh_children, clock, executor) leaves the query without contacts and front, and resume() and carry() refused.
/// So does a callback that moves a body of the query: its call is refused with changed_during_call. A callback that
/// calls the query itself is refused, by std::invalid_argument where there is no status.
class ContactQuery {
 public:
  /// Throws std::invalid_argument, naming the option, as collide() does.
  explicit ContactQuery(CollideOptions options = {});
  ~ContactQuery();
  ContactQuery(ContactQuery&&) noexcept;
  ContactQuery& operator=(ContactQuery&&) noexcept;

  /// Another pair, by number from 0. Colliders are borrowed until clear(). weight: finite, not negative; of
  /// Priority::importance. Throws std::invalid_argument for another one. There is no front then.
  std::uint32_t add(const Collider& a, const Collider& b, double weight = 1);
  void clear();
  /// For the next call. Throws as the constructor does.
  void set_options(CollideOptions options);
  const CollideOptions& options() const;

  /// Does what the first call would do beside answering: memory, tables of the bodies. The first call is then as quick
  /// as later ones. Keeps no front and no contacts. Cost: a whole query.
  Status warm_up(Workers& workers = serial_workers());

  /// All contacts of the pairs as they are now, and no front: the quickest way to a whole answer. Of each pair in turn,
  /// depth-first, by the nodes of b, then of a. With a budget, or `refresh_children`, as start() finds them.
  ContactStatus run(Workers& workers = serial_workers());
  /// From the roots, with a front that resume() and carry() go on from.
  ContactStatus start(Workers& workers = serial_workers());
  /// Goes on where the front ends, with a new budget. Refused when a body was updated or placed elsewhere.
  ContactStatus resume(Workers& workers = serial_workers());
  /// Begins the next frame with what the front knows: pairs are opened without a test where the bodies have moved less
  /// since they were tested than would change a verdict. The same contacts as by start(), when finished; pairs that
  /// have separated are dropped with all that was below them, so the front never outgrows a fresh one. With
  /// `refresh_children`, which may hide what moved, all pairs are tested. Cost besides tests: linear in nodes that
  /// moved.
  ContactStatus carry(Workers& workers = serial_workers());

  /// Of the last call that was not refused.
  const Contacts& contacts() const;
  /// The same, moved out of the query, which has none then.
  Contacts take_contacts();
  /// Of any contact of contacts(), also one that is not finished, which may take as long as the whole query: all facets
  /// of both nodes are looked at. Refused as run() is with `surfaces`: throws std::invalid_argument then, and for a
  /// contact that is none. Of current colliders.
  ContactSurface surface(std::size_t contact);

  const Front& front() const;
  /// Takes the place of the query's own; resume() and carry() check it.
  void set_front(Front front);
  /// The complete cut: separated, finished and waiting pairs, each final pair in or below exactly one of them. Of
  /// current colliders.
  void cut(std::vector<FrontPair>& pairs) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula
