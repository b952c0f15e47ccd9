// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Contacts in every frame, of several pairs of bodies under one budget; queries can be interrupted and resumed.
//
//   morula::ContactQuery query({.budget = std::chrono::microseconds(200)});
//   query.add(a, b);                           // once: colliders follow their bodies
//   const auto status = query.run();           // every frame
//   if (!status) std::puts(message(status).c_str());
//   for (const morula::Contact& contact : query.contacts().contacts) std::printf("depth %g\n", contact.depth);
#pragma once

#include <memory>
#include <morula/collide/contacts.hpp>
#include <morula/collide/front.hpp>
#include <morula/parallel/workers.hpp>

namespace morula {

/// A rejection, or the progress of the call.
struct [[nodiscard]] ContactStatus : Status {
  bool finished = false;       ///< every contact is final, as in Contacts::finished
  std::size_t pair_tests = 0;  ///< pair tests of this call
};

/// A contact query owns pairs of bodies, the front and all memory: a call allocates nothing if the memory suffices. All
/// pairs share one queue and one budget. A rejected call changes nothing.
///
/// The result of every call is sound: each crossing lies within a pair of contacts(). An exception of a callback
/// (refresh_children, clock, executor) leaves the query without contacts and front; resume() and carry() are then
/// rejected. A callback that moves a body of the query has the same effect: the call fails with changed_during_call. A
/// callback must not call the query itself: such a call is rejected, by std::invalid_argument if it returns no status.
class ContactQuery {
 public:
  /// Throws std::invalid_argument, naming the option, as collide() does.
  explicit ContactQuery(CollideOptions options = {});
  ~ContactQuery();
  ContactQuery(ContactQuery&&) noexcept;
  ContactQuery& operator=(ContactQuery&&) noexcept;

  /// Adds a pair and returns its number, from 0. Colliders are borrowed until clear(). weight: factor of
  /// Priority::importance, finite, not negative; otherwise throws std::invalid_argument. Ends the front.
  std::uint32_t add(const Collider& a, const Collider& b, double weight = 1);
  /// Removes all pairs, with the front and the contacts, which refer to them. Keeps the memory.
  void clear();
  /// Sets the options of the next call. Throws like the constructor.
  void set_options(CollideOptions options);
  const CollideOptions& options() const;

  /// Prepares the memory and the tables of the bodies, so that the first call is as quick as later ones. Keeps no front
  /// and no contacts. Cost: a whole query.
  Status warm_up(Workers& workers = serial_workers());

  /// Finds all contacts of the pairs in their present state and keeps no front: the quickest way to a complete result.
  /// Contacts are listed pair by pair, depth-first, by the nodes of b, then of a. With a budget or `refresh_children`
  /// their order is that of start().
  ContactStatus run(Workers& workers = serial_workers());
  /// Starts from the roots and keeps a front for resume() and carry().
  ContactStatus start(Workers& workers = serial_workers());
  /// Continues from the front, with a new budget. Rejected if a body was updated or has another transform.
  ContactStatus resume(Workers& workers = serial_workers());
  /// Begins the next frame from the front: pairs are opened without a test if the motion of the bodies since the test
  /// cannot change a verdict. A finished call has the same contacts as start(). Pairs that have separated are dropped
  /// with all pairs below them, so the front never outgrows a fresh one. With `refresh_children`, which can hide
  /// motion, all pairs are tested. Cost besides tests: linear in nodes that moved.
  ContactStatus carry(Workers& workers = serial_workers());

  /// Contacts of the last call that was not rejected.
  const Contacts& contacts() const;
  /// The contacts, moved out of the query; contacts() is empty afterwards.
  Contacts take_contacts();
  /// The surface of a contact of contacts(). A contact that is not finished may take as long as the whole query,
  /// because all facets of both nodes are read. Throws std::invalid_argument if run() with `surfaces` would be
  /// rejected, and for an index out of range. Colliders must be current.
  ContactSurface surface(std::size_t contact);

  const Front& front() const;
  /// Replaces the query's own front. resume(), carry() and cut() check that it belongs to the pairs and that no index
  /// of it is out of range; its verdicts are taken as they are.
  void set_front(Front front);
  /// The complete cut: separated, finished and waiting pairs; each final pair is in it or below exactly one pair of it.
  /// Empty without a front. Colliders must be current. Throws std::invalid_argument for a front of set_front() that is
  /// of other bodies or has indices out of range.
  void cut(std::vector<FrontPair>& pairs) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula
