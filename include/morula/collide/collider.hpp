// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Collider: one side of a collision query. A sphere state, its transform, and the surface that its nodes own.
//
//   morula::Body body(mesh, morula::build(mesh));         // update it whenever its vertices move
//   morula::Collider collider(mesh, body);                // made once; it follows the body
//   collider.set_transform({.translation = {0, 0, 0.1}}); // whenever the body moves as a whole
//   const morula::Vec3 corner = collider.vertex(0);       // in the world
#pragma once

#include <cstdint>
#include <memory>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/rigid_transform.hpp>
#include <morula/geometry/status.hpp>
#include <morula/geometry/triangle.hpp>
#include <morula/tree/cover.hpp>
#include <morula/tree/sphere_state.hpp>
#include <morula/update/body.hpp>
#include <optional>
#include <span>
#include <vector>

namespace morula {
namespace detail {
class ColliderAsRead;

/// Counts the changes of the object that it is a member of. Assigning to the object is a change.
struct ChangeCount {
  std::uint64_t value = 0;
  ChangeCount() = default;
  ChangeCount(const ChangeCount&) noexcept {}
  ChangeCount& operator=(const ChangeCount&) noexcept { return ++value, *this; }
};
}  // namespace detail

/// Borrows the mesh's arrays, and a pose and a cover of the caller's own: these must outlive it, and may be moved
/// meanwhile, with whatever holds them. Of a Body or PosedSpheres it keeps what it needs: when that is destroyed, or
/// another is assigned to it, queries refuse the collider with body_replaced. Made once per tree and cover: a
/// rebuilding body needs another collider when its tree_version() changes.
///
/// A copy is another side over the same body, placed by itself. Queries borrow the collider that they were given: it
/// must outlive them where it is, so colliders in a container that grows are to be held by pointers.
class Collider {
 public:
  /// A body with its surface. It must have been made from mesh. Throws std::invalid_argument when their sizes differ.
  /// Cost: linear in patches; memory 4 bytes per pair of leaf and facet.
  Collider(const MeshView& mesh, const Body& body);
  /// A pose with the surface that it goes with: a copy of a body's pose, for one. Facets need set_positions().
  Collider(const MeshView& mesh, const Cover& cover, const SphereState& pose);
  /// Spheres alone, of a body, an imported tree or a set of spheres. Queries that look at facets refuse it.
  explicit Collider(const SphereState& pose);

  /// Where the body is from now on: x ↦ transform(x). A rotation of single precision becomes the nearest one. Throws
  /// std::invalid_argument where deviation_from_rigid() is above largest_float_deviation; nothing has changed then.
  void set_transform(const RigidTransform& transform);
  const RigidTransform& transform() const { return transform_; }

  /// The vertices of the present frame, for a pose that does not know them: spheres of the caller's own, or a body that
  /// follows coordinates alone. A body that was given positions needs no call: they are read where it keeps the view.
  /// The view's data is borrowed until the next frame. Throws std::invalid_argument for a wrong count.
  void set_positions(const PositionView& positions);
  /// In the body's own coordinates: as they were given, not placed. At rest the mesh's.
  const PositionView& positions() const {
    if (given_ && given_frame_ == pose_->frame) return *given_;
    return pose_->positions ? *pose_->positions : *rest_;
  }
  /// Are positions() those of the present frame?
  bool has_current_positions() const {
    return has_surface() && (pose_->positions || pose_->frame == 0 || (given_ && given_frame_ == pose_->frame));
  }

  const SphereState& sphere_state() const { return *pose_; }
  const SphereTree& tree() const { return *pose_->tree; }

  /// Does it know facets?
  bool has_surface() const { return cover_ != nullptr; }
  /// Which part of the surface each node owns. Only with a surface.
  const Cover& cover() const { return *cover_; }
  /// The mesh's facets; none without a surface.
  std::span<const Facet> mesh_facets() const { return mesh_facets_; }
  std::size_t vertex_count() const { return rest_ ? rest_->size() : 0; }
  /// Facets and positions(), not placed. Only with a surface.
  MeshView surface() const { return {positions(), mesh_facets_}; }
  /// Facets of which the node's region has a part. A leaf's are ascending, each once; an inner node's are those of the
  /// leaves below it, one leaf after the other. None without a surface.
  std::span<const std::uint32_t> facets(std::uint32_t node) const {
    if (facet_begin_.empty()) return {};
    return std::span(facets_).subspan(facet_begin_[node], facet_end_[node] - facet_begin_[node]);
  }
  /// A vertex where it is now: position, then transform, each rounded to double. These numbers are what exact verdicts
  /// are about.
  Vec3 vertex(std::uint32_t index) const { return transform_(positions()[index]); }
  Triangle triangle(std::uint32_t facet) const {
    const Facet& f = mesh_facets_[facet];
    return {vertex(f[0]), vertex(f[1]), vertex(f[2])};
  }

 private:
  friend class detail::ColliderAsRead;
  const SphereState* pose_;
  std::shared_ptr<const void> kept_;  // pose and cover, of a source that shares them
  const Cover* cover_ = nullptr;
  std::span<const Facet> mesh_facets_{};
  RigidTransform transform_{};
  std::optional<PositionView> rest_{}, given_{};
  std::uint64_t given_frame_ = 0;
  std::vector<std::uint32_t> facets_, facet_begin_, facet_end_;
  detail::ChangeCount changes_{};  // of the transform and of the positions given
};

/// A node of one body and a node of another.
struct NodePair {
  std::uint32_t a, b;
  constexpr bool operator==(const NodePair&) const = default;
};

/// May queries that look at facets ask this body? ok, or one of the faults of bodies.
/// body: which one, for the status.
Status askable(const Collider& collider, std::uint8_t body = 0);

}  // namespace morula
