// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The body behind a collider. Bodies of one tree count their frames alike, and one may be assigned to the collider of
// another, so numbers of frames do not tell them apart.
#pragma once

#include <memory>
#include <morula/collide/collider.hpp>

namespace morula::detail {

class BodyIdentity {
 public:
  BodyIdentity() = default;
  explicit BodyIdentity(const Collider& collider)
      : pose_(&collider.sphere_state()), shared_(collider.sphere_state().shared) {}
  /// A later body at the same address has another owner.
  bool operator==(const BodyIdentity& other) const {
    return pose_ == other.pose_ && !shared_.owner_before(other.shared_) && !other.shared_.owner_before(shared_);
  }

 private:
  const SphereState* pose_ = nullptr;
  std::weak_ptr<const void> shared_{};
};

}  // namespace morula::detail
