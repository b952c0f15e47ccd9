// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The object that a build fits spheres to, with its index of facets only where it is needed.
#pragma once

#include <morula/query/signed_distance.hpp>
#include <mutex>
#include <optional>

namespace morula::detail {

/// What is inside, and how far away the surface is. Trees of draft and fast quality, and flat sets of closed meshes,
/// are built without asking for a distance: on fine meshes the index of facets would be a fifth of their time and most
/// of their memory.
class ObjectShape {
 public:
  /// Not yet asked for a distance. mesh: borrowed. Cost: linear.
  explicit ObjectShape(const MeshView& mesh);
  /// For builds that will ask. The index is made on all workers.
  ObjectShape(const MeshView& mesh, Workers& workers);

  bool has_volume() const { return has_volume_; }
  /// −1 for an inside-out mesh, else 1.
  double orientation() const { return orientation_; }
  /// Of the facets' corners.
  const Box& bounding_box() const { return box_; }
  /// Made by whoever asks first, while others wait.
  const SignedDistance& distance() const;
  /// Whether anybody has asked; not while others may be asking.
  bool has_index() const { return distance_.has_value(); }

 private:
  MeshView mesh_;
  mutable std::once_flag asked_;
  mutable std::optional<SignedDistance> distance_;
  bool has_volume_;
  double orientation_;
  Box box_;
};

}  // namespace morula::detail
