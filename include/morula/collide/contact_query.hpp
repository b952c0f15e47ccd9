// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Contacts frame after frame, of several pairs of bodies under one budget, interrupted and continued.
#pragma once

#include <memory>
#include <morula/collide/contacts.hpp>
#include <morula/collide/front.hpp>
#include <morula/parallel/workers.hpp>

namespace morula {

struct ContactStatus {
  enum class Code : std::uint8_t {
    ok,
    body_not_current,       ///< the last update of a body was refused
    body_not_complete,      ///< a lazy update left nodes of a body behind, and there is no CollideOptions::reach
    positions_not_current,  ///< facets are asked for, and Collider::set_positions has not seen the last update
    no_front,               ///< nothing was started
    other_bodies,           ///< the front is of another number of bodies, or of another ownership
    other_frame,            ///< a body was updated: carry() the front
    other_placement,        ///< a body was placed elsewhere: carry() the front
    other_options,          ///< the front is of another margin or level
    bad_front,              ///< one from set_front() has indices out of range
    bad_level,              ///< both trees of a pair have fewer levels
  };
  Code code = Code::ok;
  std::uint32_t bodies = 0;  ///< which pair, where it is about one
  bool finished = false;
  std::size_t pair_tests = 0;  ///< done by this call

  explicit operator bool() const { return code == Code::ok; }
};
/// In words, with the remedy.
std::string message(const ContactStatus& status);

/// Holds pairs of bodies, the front and all memory: a call allocates nothing once that suffices. All pairs share one
/// queue and one budget. A call that is refused changes nothing.
///
/// The result after any call is sound: every crossing lies within a pair of contacts().
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

  /// From the roots.
  ContactStatus start(Workers& workers = serial_workers());
  /// Goes on where the front ends, with a new budget. Refused when a body was updated or placed elsewhere.
  ContactStatus resume(Workers& workers = serial_workers());
  /// Begins the next frame with what the front knows: pairs are opened without a test where the bodies have moved less
  /// since they were tested than would change a verdict. The same contacts as by start(), when finished; pairs that
  /// have separated are dropped with all that was below them, so the front never outgrows a fresh one. With `reach`,
  /// which may hide what moved, all pairs are tested. Cost besides tests: linear in nodes that moved.
  ContactStatus carry(Workers& workers = serial_workers());

  /// Of the last call that was not refused.
  const Contacts& contacts() const;
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
