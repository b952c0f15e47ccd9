// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Contact query: the contacts of several pairs of bodies in every frame, under one budget. A call that its budget ends
// can be resumed.
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
  bool finished = false;       ///< true: all contacts are final, as in Contacts::finished
  std::size_t pair_tests = 0;  ///< number of pair tests in this call
};

class ContactQuery;
namespace detail {
/// Runs start(), and keeps a front for resume() alone: carry() rejects it with other_bodies. Such a front takes no
/// memory and no time per node of the bodies.
ContactStatus start_for_resume(ContactQuery& query);
}  // namespace detail

/// Finds the contacts of a list of pairs of bodies. All pairs share one queue and one budget. The query keeps its front
/// and its memory, so a call that needs no more memory than earlier ones allocates nothing. A rejected call changes
/// nothing. Only one thread may use a query at a time; workers share its work.
///
/// After every call, also one that its budget ended, each crossing of the bodies lies within a contact of contacts(),
/// if the spheres of the bodies cover. If a callback (refresh_children, clock, executor) throws, the query has no
/// contacts and no front, and rejects resume() and carry(). A callback that moves a body of the query has the same
/// effect: the call returns changed_during_call. A callback must not call the query: it rejects such a call, with
/// std::invalid_argument from functions that return no status.
class ContactQuery {
 public:
  /// Throws std::invalid_argument, with the option, for a negative or infinite margin and for a negative budget, like
  /// collide().
  explicit ContactQuery(CollideOptions options = {});
  ~ContactQuery();
  ContactQuery(ContactQuery&&) noexcept;
  ContactQuery& operator=(ContactQuery&&) noexcept;

  /// Adds a pair, and returns its number: 0 for the first. The query shares the state of the colliders until
  /// clear(), so it follows them where they are moved. weight: factor of Priority::importance; throws
  /// std::invalid_argument if it is negative or not finite. The front is lost, so call run() or start() next.
  std::uint32_t add(const Collider& a, const Collider& b, double weight = 1);
  /// Removes all pairs, with the front and the contacts, which refer to them. Keeps the memory.
  void clear();
  /// Sets the options for the next call. Throws like the constructor.
  void set_options(CollideOptions options);
  const CollideOptions& options() const;

  /// Allocates the memory and makes the tables of the bodies, for a first call as fast as later ones, except memory of
  /// vertices that bodies compute. Keeps no front and no contacts. Cost: that of run() and start() without a budget.
  Status warm_up(Workers& workers = serial_workers());

  /// Finds the contacts of all pairs in their present state, and keeps no front: the fastest call for a complete
  /// result. The order of contacts is by pair, then depth-first by the nodes of b, then of a. With a budget or
  /// `refresh_children` the order is that of start().
  ContactStatus run(Workers& workers = serial_workers());
  /// Finds the contacts like run(), from the roots down, and keeps a front for resume() and carry().
  ContactStatus start(Workers& workers = serial_workers());
  /// Continues the last call from its front, with a new budget. Repeated calls always finish: unless it is zero, a call
  /// opens one pair of nodes at any cost, at most the product of two branchings, pair tests. Rejects a body that was
  /// updated, or has another transform, or was replaced by another one in its collider since that call.
  ContactStatus resume(Workers& workers = serial_workers());
  /// Finds the contacts of the next frame, starting at the front of the last call instead of the roots. It skips tests
  /// whose result the motion of the bodies since the last test cannot change. If the call finishes, its contacts are
  /// those of start(). Pairs that are apart leave the front, with all pairs below them, so the front does not grow
  /// beyond that of start(). With `refresh_children`, which can hide motion, it tests all pairs. Cost besides tests:
  /// linear in the nodes that moved.
  ContactStatus carry(Workers& workers = serial_workers());

  /// The contacts of the last call that was not rejected.
  const Contacts& contacts() const;
  /// Moves the contacts out of the query; contacts() is empty afterwards.
  Contacts take_contacts();
  /// Computes the surface of a contact. contact: index in contacts().contacts. Throws std::invalid_argument for an
  /// index out of range, and for bodies that run() with CollideOptions::surfaces rejects. The bodies must be in the
  /// state of the last call. Cost: linear in the facets of both nodes, so a contact that is not finished may cost as
  /// much as the whole query.
  ContactSurface surface(std::size_t contact);

  /// The front of the last call; empty if there is none.
  const Front& front() const;
  /// Replaces the front of the query, such as by an earlier front(). resume(), carry() and cut() check that it belongs
  /// to the pairs and that its indices are in range; they take its verdicts as they are.
  void set_front(Front front);
  /// Writes the cut of the last call to `pairs`: the pairs of nodes at which the search has ended or waits, which are
  /// apart, finished or waiting. Each final pair is in the cut, or below exactly one pair of it. Empty without a front.
  /// The bodies must be in the state of the last call. Throws std::invalid_argument for a front of set_front() that is
  /// of other bodies or has indices out of range.
  void cut(std::vector<FrontPair>& pairs) const;

 private:
  friend ContactStatus detail::start_for_resume(ContactQuery& query);
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula
