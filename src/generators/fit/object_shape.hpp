// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The object that a build fits spheres to, with an index of facets only if one is needed.
#pragma once

#include <morula/query/signed_distance.hpp>
#include <mutex>
#include <optional>

namespace morula::detail {

/// The object's inside, and the distance of its surface. Trees of draft and fast quality, and flat sets of closed
/// meshes, are built without distance queries: on fine meshes the index of facets would be a fifth of their time and
/// most of their memory.
class ObjectShape {
 public:
  /// The index is not made yet. mesh: borrowed. Cost: linear.
  explicit ObjectShape(const MeshView& mesh);
  /// For builds that need distances. The index is made on all workers.
  ObjectShape(const MeshView& mesh, Workers& workers);

  bool has_volume() const { return has_volume_; }
  /// −1 for an inside-out mesh, else 1.
  double orientation() const { return orientation_; }
  /// Box of the facets' corners.
  const Box& bounding_box() const { return box_; }
  /// Made by the first call, while concurrent calls wait.
  const SignedDistance& distance() const;
  /// Whether distance() was called; must not run while another thread may call it.
  bool has_index() const { return distance_.has_value(); }

 private:
  MeshView mesh_;
  mutable std::once_flag computed_;
  mutable std::optional<SignedDistance> distance_;
  bool has_volume_;
  double orientation_;
  Box box_;
};

}  // namespace morula::detail
