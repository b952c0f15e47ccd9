// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Requirements of queries on their arguments, at the beginning and at the end of a call.
#pragma once

#include <morula/collide/collider.hpp>
#include <morula/collide/contacts.hpp>

namespace morula::detail {

/// The requirements of a query on a body, besides an update that was not rejected.
struct Needs {
  bool all_spheres = true;  ///< whether spheres that a lazy update has left stale must be fresh
  bool positions = false;
};
/// ok, or the first fault.
Status status_of(const Collider& collider, std::uint8_t body, Needs needs);
/// ok, or the first fault of either.
Status status_of_pair(const Collider& a, const Collider& b, Needs needs);

/// A collider as a call begins to read it. Callbacks of the call must not move it, and counters reveal whether one has:
/// each change increases one of them, so they also reveal a collider that was moved there and back.
class ColliderAsRead {
 public:
  ColliderAsRead() = default;
  explicit ColliderAsRead(const Collider& collider)
      : data_(collider.data_.get()),
        pose_(data_->pose),
        frame_(pose_->frame),
        changes_(data_->changes.value),
        was_usable_(is_usable()) {}
  bool has_moved() const {
    // mutant collider-moved-in-call: `return ... ->changes.value != changes_ || pose_->frame != frame_ ||` -> `return`
    // mutant collider-placed-in-call: `data_->changes.value != changes_ || pose_` -> `pose_`
    return data_->pose != pose_ || data_->changes.value != changes_ || pose_->frame != frame_ ||
           // mutant body-refused-in-call: `is_usable() != was_usable_` -> `false`
           is_usable() != was_usable_;
  }

 private:
  // An update that is rejected and the end of a body do not count as a frame.
  bool is_usable() const { return pose_->current && !pose_->ended; }

  const Collider::Data* data_ = nullptr;
  const SphereState* pose_ = nullptr;
  std::uint64_t frame_ = 0, changes_ = 0;
  bool was_usable_ = true;
};

/// Two such colliders.
class PairAsRead {
 public:
  PairAsRead() = default;
  PairAsRead(const Collider& a, const Collider& b) : a_(a), b_(b) {}
  /// ok, or changed_during_call.
  Status status() const {
    if (a_.has_moved()) return {Status::Code::changed_during_call, 0};
    if (b_.has_moved()) return {Status::Code::changed_during_call, 1};
    return {};
  }

 private:
  ColliderAsRead a_, b_;
};

/// Throws std::invalid_argument with the message of a fault.
void require_good(const Status& status);
/// Throws std::invalid_argument with the message of the first fault of either.
void require_bodies(const Collider& a, const Collider& b, Needs needs);
/// Throws std::invalid_argument for a margin that is negative or not finite and for a negative budget.
void require_usable(const CollideOptions& options);
/// Whether one of both trees has such a level.
bool has_level(const Collider& a, const Collider& b, const std::optional<std::uint32_t>& level);

}  // namespace morula::detail
