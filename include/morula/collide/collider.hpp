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
#include <utility>
#include <vector>

namespace morula {
class Collider;
namespace detail {
class ColliderAsRead;
class CornerReader;
class FacetLists;
/// Copies, for each facet of a leaf, the share of its area that the leaf owns.
void copy_shares(const Collider& collider, std::uint32_t leaf, std::vector<float>& shares);
/// The same side, for a user that keeps it: it stays in place when the collider is moved, and after its end. Allocates
/// nothing.
std::shared_ptr<const Collider> hold(const Collider& collider);

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
/// Queries and scenes that keep a collider share its state: they follow set_transform(), an assignment to the collider,
/// and the move that makes a new collider of it, such as in a growing vector, and they may keep a temporary one. A move
/// assignment is an assignment to its left side: after erase() from a vector, they follow the collider that is now at
/// the same place. ContactPatchQuery rejects a collider to which that of another body was assigned, with body_replaced.
/// A copy is another side over the same body: it shares the body and all tables, and has its own transform and
/// positions. Cost of a copy: constant, one allocation; an assignment allocates nothing, unless the left side was moved
/// from. A collider that was moved from may only be assigned to or destroyed.
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
  // Temporaries that a collider would borrow.
  Collider(const Mesh&&, const Body&) = delete;
  Collider(const MeshView&, const Body&&) = delete;
  Collider(const Mesh&&, const Body&&) = delete;
  Collider(const Mesh&&, const Cover&, const SphereState&) = delete;
  Collider(const MeshView&, const Cover&&, const SphereState&) = delete;
  Collider(const MeshView&, const Cover&, const SphereState&&) = delete;
  explicit Collider(const SphereState&&) = delete;
  ~Collider();
  Collider(const Collider& other);
  Collider& operator=(const Collider& other);
  Collider(Collider&& other) noexcept;
  Collider& operator=(Collider&& other) noexcept;

  /// True if both are the same side: one is the other, or the view of the other that a query passes to a callback.
  friend bool operator==(const Collider& a, const Collider& b) { return a.data_ == b.data_; }

  /// Sets the transform of the body: x ↦ transform(x). A rotation in single precision becomes the nearest one in
  /// double. Throws std::invalid_argument, and changes nothing, if deviation_from_rigid() exceeds
  /// largest_float_deviation.
  void set_transform(const RigidTransform& transform);
  const RigidTransform& transform() const { return data_->transform; }

  /// Sets the vertices of the present frame, for a sphere state without positions: the caller's own spheres. A body
  /// needs no call: the collider reads the positions that it was updated with, or those that it computes from modes or
  /// bones. The view's data is borrowed until the next frame. Throws std::invalid_argument for a wrong count.
  void set_positions(const PositionView& positions);
  /// Positions in the body's own coordinates, without the transform. At rest the mesh's.
  ///
  /// Of a body whose levels all follow `modal` or `skinned`, the first call in a frame computes all, vertex() only one;
  /// a body's first read allocates 32 bytes per vertex. Cost: linear in the modes or influences of these vertices.
  const PositionView& positions() const {
    const PositionView* const stored = stored_positions();
    return stored != nullptr ? *stored : all_posed();
  }
  /// True if positions() belong to the present frame.
  bool has_current_positions() const {
    return has_surface() && (data_->pose->positions || data_->pose->vertices != nullptr || data_->pose->frame == 0 ||
                             (data_->given && data_->given_frame == data_->pose->frame));
  }

  const SphereState& sphere_state() const { return *data_->pose; }
  const SphereTree& tree() const { return *data_->pose->tree; }

  /// True if the collider has facets.
  bool has_surface() const { return data_->cover != nullptr; }
  /// The part of the surface that each node owns. Requires a surface.
  const Cover& cover() const { return *data_->cover; }
  /// The mesh's facets; empty without a surface.
  std::span<const Facet> mesh_facets() const { return data_->mesh_facets; }
  std::size_t vertex_count() const { return data_->rest ? data_->rest->size() : 0; }
  /// Facets and positions(), without the transform. Requires a surface.
  MeshView surface() const { return {positions(), data_->mesh_facets}; }
  /// Facets that the node's region contains in whole or in part. A leaf's facets are ascending, each once; an inner
  /// node's are the lists of the leaves below it, in order. Empty without a surface.
  std::span<const std::uint32_t> facets(std::uint32_t node) const {
    if (data_->facet_begin.empty()) return {};
    return data_->facets.subspan(data_->facet_begin[node], data_->facet_end[node] - data_->facet_begin[node]);
  }
  /// Position of a vertex in the world: the present position, then the transform, each rounded to double. Exact
  /// verdicts are about these numbers.
  Vec3 vertex(std::uint32_t index) const {
    const PositionView* const stored = stored_positions();
    return data_->transform(stored != nullptr ? (*stored)[index] : posed(index));
  }
  Triangle triangle(std::uint32_t facet) const {
    const Facet& f = data_->mesh_facets[facet];
    return {vertex(f[0]), vertex(f[1]), vertex(f[2])};
  }

 private:
  friend class detail::ColliderAsRead;
  friend class detail::CornerReader;
  friend void detail::copy_shares(const Collider& collider, std::uint32_t leaf, std::vector<float>& shares);
  friend std::shared_ptr<const Collider> detail::hold(const Collider& collider);
  struct Data {
    const SphereState* pose;
    std::shared_ptr<const void> kept;  // sphere state and cover, if the source shares them
    const Cover* cover = nullptr;
    std::span<const Facet> mesh_facets{};
    RigidTransform transform{};
    std::optional<PositionView> rest{}, given{};
    std::uint64_t given_frame = 0;
    std::shared_ptr<const detail::FacetLists> facet_lists{};
    std::span<const std::uint32_t> facets{}, facet_begin{}, facet_end{};  // of facet_lists
    detail::ChangeCount changes{};  // changes of the transform, of the given positions, and assignments
  };
  struct Shared;  // Data, and the collider that users of hold() read
  explicit Collider(std::shared_ptr<Data> data) : data_(std::move(data)) {}
  Collider(const MeshView& mesh, const Cover& cover, const SphereState& pose,
           std::shared_ptr<const detail::FacetLists> facet_lists);
  // Positions in memory; nullptr if the body computes each when it is read.
  const PositionView* stored_positions() const {
    if (data_->given && data_->given_frame == data_->pose->frame) return &*data_->given;
    if (data_->pose->positions) return &*data_->pose->positions;
    return data_->pose->vertices != nullptr ? nullptr : &*data_->rest;
  }
  // Without stored positions.
  Vec3 posed(std::uint32_t vertex) const;
  const PositionView& all_posed() const;
  std::shared_ptr<Data> data_;
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
