// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Collider: one side of a collision query: a sphere state, its transform, and the surface that its nodes own.
//
//   morula::Body body(mesh, morula::build(mesh));         // update it whenever its vertices move
//   morula::Collider collider(mesh, body);                // made once; it follows the body
//   collider.set_transform({.translation = {0, 0, 0.1}}); // whenever the body moves rigidly
//   const morula::Vec3 corner = collider.vertex(0);       // in world coordinates
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
class Collider;
namespace detail {
class ColliderAsRead;
class FacetLists;
/// Copies, for each facet of a leaf, the share of its area that the leaf owns.
void copy_shares(const Collider& collider, std::uint32_t leaf, std::vector<float>& shares);

/// Counts the changes of the object that contains it. Assignment to the object is a change.
struct ChangeCount {
  std::uint64_t value = 0;
  ChangeCount() = default;
  ChangeCount(const ChangeCount&) noexcept {}
  ChangeCount& operator=(const ChangeCount&) noexcept { return ++value, *this; }
};
}  // namespace detail

/// A collider borrows the mesh's arrays, and a sphere state and a cover of the caller. These must outlive it, and may
/// be moved meanwhile together with their owner. It shares the data of a Body or PosedSpheres: if that object is
/// destroyed or assigned to, queries reject the collider with body_replaced. A collider is made once per tree and
/// cover: a rebuilding body needs another collider when its tree_version() changes.
///
/// A copy is another side over the same body with its own transform. Queries borrow colliders by address, so colliders
/// in a growing container should be held by pointers.
class Collider {
 public:
  /// A body with its surface. The body must have been made from mesh. Throws std::invalid_argument if their sizes
  /// differ. Cost: constant, except for the first collider of a tree: linear in patches. Colliders of all bodies that
  /// follow one CoveredTree share this memory, 4 bytes per pair of leaf and facet.
  Collider(const MeshView& mesh, const Body& body);
  /// A sphere state with its surface, such as a copy of a body's state. Queries on facets need set_positions(). Cost:
  /// linear in patches.
  Collider(const MeshView& mesh, const Cover& cover, const SphereState& pose);
  /// Spheres alone, of a body, an imported tree or a set of spheres. Queries on facets reject this collider.
  explicit Collider(const SphereState& pose);

  /// Sets the transform of the body: x ↦ transform(x). A rotation in single precision becomes the nearest one in
  /// double. Throws std::invalid_argument, and changes nothing, if deviation_from_rigid() exceeds
  /// largest_float_deviation.
  void set_transform(const RigidTransform& transform);
  const RigidTransform& transform() const { return transform_; }

  /// Sets the vertices of the present frame, for a sphere state without positions: the caller's own spheres, or a body
  /// that follows coordinates alone. A body that was updated with positions needs no call: the collider reads them from
  /// the body's view. The view's data is borrowed until the next frame. Throws std::invalid_argument for a wrong count.
  void set_positions(const PositionView& positions);
  /// Positions in the body's own coordinates, without the transform. At rest the mesh's.
  const PositionView& positions() const {
    if (given_ && given_frame_ == pose_->frame) return *given_;
    return pose_->positions ? *pose_->positions : *rest_;
  }
  /// True if positions() belong to the present frame.
  bool has_current_positions() const {
    return has_surface() && (pose_->positions || pose_->frame == 0 || (given_ && given_frame_ == pose_->frame));
  }

  const SphereState& sphere_state() const { return *pose_; }
  const SphereTree& tree() const { return *pose_->tree; }

  /// True if the collider has facets.
  bool has_surface() const { return cover_ != nullptr; }
  /// The part of the surface that each node owns. Requires a surface.
  const Cover& cover() const { return *cover_; }
  /// The mesh's facets; empty without a surface.
  std::span<const Facet> mesh_facets() const { return mesh_facets_; }
  std::size_t vertex_count() const { return rest_ ? rest_->size() : 0; }
  /// Facets and positions(), without the transform. Requires a surface.
  MeshView surface() const { return {positions(), mesh_facets_}; }
  /// Facets that the node's region contains in whole or in part. A leaf's facets are ascending, each once; an inner
  /// node's are the lists of the leaves below it, in order. Empty without a surface.
  std::span<const std::uint32_t> facets(std::uint32_t node) const {
    if (facet_begin_.empty()) return {};
    return facets_.subspan(facet_begin_[node], facet_end_[node] - facet_begin_[node]);
  }
  /// Position of a vertex in the world: the present position, then the transform, each rounded to double. Exact
  /// verdicts are about these numbers.
  Vec3 vertex(std::uint32_t index) const { return transform_(positions()[index]); }
  Triangle triangle(std::uint32_t facet) const {
    const Facet& f = mesh_facets_[facet];
    return {vertex(f[0]), vertex(f[1]), vertex(f[2])};
  }

 private:
  friend class detail::ColliderAsRead;
  friend void detail::copy_shares(const Collider& collider, std::uint32_t leaf, std::vector<float>& shares);
  Collider(const MeshView& mesh, const Cover& cover, const SphereState& pose,
           std::shared_ptr<const detail::FacetLists> facet_lists);
  const SphereState* pose_;
  std::shared_ptr<const void> kept_;  // sphere state and cover, if the source shares them
  const Cover* cover_ = nullptr;
  std::span<const Facet> mesh_facets_{};
  RigidTransform transform_{};
  std::optional<PositionView> rest_{}, given_{};
  std::uint64_t given_frame_ = 0;
  std::shared_ptr<const detail::FacetLists> facet_lists_;
  std::span<const std::uint32_t> facets_, facet_begin_, facet_end_;  // of facet_lists_
  detail::ChangeCount changes_{};  // changes of the transform and of the given positions
};

/// A node of each of two bodies.
struct NodePair {
  std::uint32_t a, b;
  constexpr bool operator==(const NodePair&) const = default;
};

/// Whether queries on facets may use this collider: ok, or one of the faults of queried bodies.
/// body: number of the body, for the status.
Status askable(const Collider& collider, std::uint8_t body = 0);

}  // namespace morula
