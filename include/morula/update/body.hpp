// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A body: a mesh with its tree and cover. Its spheres follow the mesh's vertices from frame to frame.
//
//   morula::Body body(mesh, morula::build(mesh));
//   if (const morula::UpdateStatus status = body.update(positions); !status) std::puts(message(status).c_str());
//   std::vector<morula::Sphere> spheres;
//   body.copy_spheres(spheres);                           // one per node, the root first, in mesh coordinates
//   const bool proven = body.certify(positions).covered;  // every level
#pragma once

#include <memory>
#include <morula/geometry/positions.hpp>
#include <morula/geometry/status.hpp>
#include <morula/tree/cover.hpp>
#include <morula/tree/sphere_state.hpp>
#include <morula/update/rules.hpp>

namespace morula {
namespace detail {
struct FittedBody;
}

/// A body computes the spheres of its tree from the positions of the mesh's vertices. Copies of a body are independent
/// of each other. Every update starts from the rest state, so the result depends on the given positions alone, not on
/// earlier frames: back at rest, the spheres equal the rest spheres bit for bit.
///
/// Several threads may call const members at once; no other member may run at the same time.
class Body {
 public:
  // ---- Construction. ----

  /// Copies the required data of mesh and model. The model must be built from the mesh.
  ///
  /// The body starts at rest, with the spheres that update(mesh.positions) computes. With approach1 and approach2 these
  /// are the tree's spheres in float, with radii rounded up (and enlarged further if UpdateOptions::conservative
  /// requires it). The other rules keep the tree's centers and compute their own radii; only `wrapped` with
  /// WrappedCenter::smallest also moves centers, and `skinned` where the corners of a node fit into a sphere of less
  /// than a quarter of the size.
  ///
  /// Throws std::invalid_argument if mesh and model do not belong together (sizes, indices, regions, mesh hash); if the
  /// list of rules is empty or has an invalid rule; if an option is out of range; if modes or a skin are not finite,
  /// belong to another mesh, or are missing for a level of the rule `modal` or `skinned`; or if levels use both of
  /// these rules.
  ///
  /// It also throws if a coordinate relative to the center of the mesh's box exceeds 2^57 (1.4e17), because squares
  /// would leave the range of float, or if the center is farther than 2^100 (1e30) from the origin of the mesh's
  /// coordinates. There is no lower limit: a pad of at least 2^-62 (2e-19) mesh units on radii keeps the smallest body
  /// covered, but makes the spheres of bodies below about 1e-18 loose.
  Body(const MeshView& mesh, const CoveredTree& model, UpdateOptions options = {}, Workers& workers = serial_workers());
  Body(const MeshView& mesh, CoveredTree&& model, UpdateOptions options = {}, Workers& workers = serial_workers());
  /// Shares the model with the caller and with other bodies instead of copying it. Otherwise like the constructors
  /// above; also throws std::invalid_argument for a null pointer.
  Body(const MeshView& mesh, std::shared_ptr<const CoveredTree> model, UpdateOptions options = {},
       Workers& workers = serial_workers());
  ~Body();
  /// Another body of the same model in the same pose, independent from then on; the two share tree and cover. A copy is
  /// cheaper than construction: it copies arrays that the constructors above compute.
  Body(const Body&);
  Body& operator=(const Body&);
  Body(Body&&) noexcept;
  Body& operator=(Body&&) noexcept;

  // ---- Updates by positions. ----

  /// Updates all spheres to the given positions: one per mesh vertex, in mesh order and units, float or double.
  ///
  /// With the rule `exact` on all levels, every level then covers the surface; radii are rounded up, so rounding cannot
  /// lose cover. Positions are converted to float relative to an origin that moves with the body, so a body far
  /// from the mesh's origin loses no precision.
  ///
  /// Rejects another number of positions; a vertex that facets use with a coordinate that is not finite, or more than
  /// 2^57 from the origin; an origin beyond 2^100; and a body with levels of the rule `modal` or `skinned`, because
  /// positions do not determine coordinates or transforms. After a rejection the last good spheres stay, and
  /// is_current() is false.
  ///
  /// Allocates nothing. The result has the same bits for any number of workers. Cost: linear in vertices, cut points,
  /// and the points that the rules read: owned corners (exact) or vertices of linked facets and children (other rules).
  UpdateStatus update(const PositionView& positions, Workers& workers = serial_workers()) noexcept;

  // ---- Updates by modes or bones. ----

  /// Updates all spheres to the given coordinates q of UpdateOptions::modes: vertex i is then at rest_i + sum_j q_j
  /// U_ij.
  ///
  /// coordinates: one per mode, finite; all 0 gives rest, bit for bit. Spheres on levels of the rule `modal` contain
  /// every corner that their nodes own [james2004], both for positions summed in double (move_by_modes) and in exact
  /// arithmetic. Levels of other rules follow these positions, which the update computes first, and keep their own
  /// guarantees.
  ///
  /// Rejects bad coordinates, and a body without modes or with levels of the rule `skinned`; the last good spheres then
  /// stay, and is_current() is false. Allocates nothing. The result has the same bits for any number of workers. Cost:
  /// nodes × modes if all levels are modal, for any number of vertices; otherwise vertices × modes plus the cost of
  /// update().
  UpdateStatus update_modal(std::span<const double> coordinates, Workers& workers = serial_workers()) noexcept;

  /// Updates all spheres to the given transforms T of the bones of UpdateOptions::skin, relative to rest: vertex i is
  /// then at rest_i + sum_b w_ib (T_b rest_i - rest_i).
  ///
  /// transforms: one per bone, finite, affine: singular, mirrored and uneven ones also; the identity for all gives
  /// rest, bit for bit. Spheres on levels of the rule `skinned` contain every corner that their nodes own, both for
  /// positions summed in double (move_by_skin) and in exact arithmetic. Levels of other rules follow these positions,
  /// which the update computes first, and keep their own guarantees.
  ///
  /// Rejects bad transforms, and a body without a skin or with levels of the rule `modal`; the last good spheres then
  /// stay, and is_current() is false. Allocates nothing. The result has the same bits for any number of workers. Cost:
  /// nodes × bones per node if all levels are skinned, for any number of vertices; otherwise linear in the skin's
  /// influences, plus the cost of update(). Measured nodes add that of their vertices (RuleOptions::skinned_measured).
  UpdateStatus update_skinned(std::span<const AffineTransform> transforms,
                              Workers& workers = serial_workers()) noexcept;
  /// Like update_skinned(), with morph targets: vertex i first moves by its modes, to m_i = rest_i + sum_j morphs_j
  /// U_ij, and then by its bones, to m_i + sum_b w_ib (T_b m_i - m_i).
  ///
  /// morphs: one coordinate per mode of UpdateOptions::modes, finite, of any sign; none for a body without modes. The
  /// guarantees are those of update_skinned(), which takes all morphs as 0. Also rejects bad coordinates. Cost: for a
  /// node of the rule `skinned`, linear in those of its morphs that are not 0, besides its bones.
  UpdateStatus update_skinned(std::span<const AffineTransform> transforms, std::span<const double> morphs,
                              Workers& workers = serial_workers()) noexcept;

  /// The sphere that a node on a level of the rule `modal` has at the given coordinates, in mesh coordinates; the
  /// current spheres stay unchanged. A traversal from the root that uses it pays only for the nodes that it visits. The
  /// result has the same bits as sphere(node) after update_modal(coordinates). Coordinates that update_modal() rejects,
  /// and nodes on levels of other rules, give a sphere of infinite radius, which contains everything. Cost: linear in
  /// modes.
  Sphere modal_sphere(std::uint32_t node, std::span<const double> coordinates) const noexcept;

  // ---- Partial and lazy updates. ----

  /// Updates the spheres to positions that differ from those of the last update only in the vertices of some ranges.
  /// The spheres have the same bits as after update(positions).
  ///
  /// positions: of all vertices. changed: the ranges; the caller ensures that no other vertex has moved. With `exact`
  /// or `wrapped` on all levels, the cost depends on the moved vertices: the update visits the leaves that own parts of
  /// their facets, and the leaves below nodes whose centers depend on them. It updates the whole body with other rules,
  /// after a rejected or lazy update, and if the lowest vertex that facets use has moved, because that vertex
  /// determines the origin. Rejects a range that ends before it begins or beyond the last vertex (bad_range), and the
  /// input that update() rejects.
  UpdateStatus update(const PositionView& positions, std::span<const VertexRange> changed,
                      Workers& workers = serial_workers()) noexcept;

  /// Updates only the nodes of levels 0 to `level`. Nodes on deeper levels keep spheres of an older frame, about an
  /// older origin; do not read them until refresh_children() has updated them.
  ///
  /// Lazy updates need the rule `exact` on all levels; other bodies, and a level beyond the last, get a full update. A
  /// lazy update saves time if queries visit few nodes of a tree with many leaves. It reads every vertex, because the
  /// root's sphere depends on all of them. Once all nodes are refreshed, the spheres equal those of update(), bit for
  /// bit.
  UpdateStatus update_lazily(const PositionView& positions, std::size_t level,
                             Workers& workers = serial_workers()) noexcept;
  /// Like update_modal(), but updates only the nodes of levels 0 to `level`, like update_lazily(). It is lazy if all
  /// levels follow `modal`; otherwise it updates all nodes. Cost: linear in modes × updated nodes.
  UpdateStatus update_modal_lazily(std::span<const double> coordinates, std::size_t level,
                                   Workers& workers = serial_workers()) noexcept;
  /// Updates the children of a node to the frame of the last lazy update. The node itself must be fresh (is_fresh).
  /// Returns the number of updated nodes: 0 for a leaf, if the children are fresh, and if an update has been rejected
  /// since the lazy one. Allocates nothing. Only one thread may call it at a time. Cost: linear in the corners that the
  /// children own (exact) or in modes × children (modal).
  std::size_t refresh_children(std::uint32_t node) noexcept;
  /// True if the node's sphere belongs to the frame of the last good update. A lazy update leaves nodes for which it is
  /// false.
  bool is_fresh(std::uint32_t node) const;
  /// True if is_fresh() is true for all nodes.
  bool is_complete() const;

  // ---- Spheres. ----

  /// The current spheres, one per node, in float, with centers relative to origin(), mesh units. The span stays valid
  /// until the body is assigned to or destroyed; do not read it during an update.
  std::span<const Spheref> spheres() const;
  /// The origin of spheres(), in mesh coordinates; updates move it with the body.
  Vec3 origin() const;
  /// The current sphere of a node, in mesh coordinates.
  Sphere sphere(std::uint32_t node) const;
  /// Writes the current spheres in mesh coordinates, one per node, over the contents of `spheres`.
  void copy_spheres(std::vector<Sphere>& spheres) const;
  /// A copy of the tree with the current spheres, in mesh coordinates. `morula update` writes it for each frame.
  SphereTree current_tree() const;
  /// Checks the proof that the current spheres of every level contain the surface at these positions, one per mesh
  /// vertex. Throws std::invalid_argument for another number of positions. Cost: linear in corners × levels; about 0.1
  /// us for each.
  Certificate certify(const PositionView& positions, Workers& workers = serial_workers()) const;
  /// 64-bit FNV-1a over origin() and spheres(): equal for equal bits.
  std::uint64_t hash() const;

  /// The current spheres in the form that queries read, with the number of the frame. The reference stays valid if the
  /// body is moved. Assignment to the body and its destruction end the state (SphereState::ended): colliders keep its
  /// data alive, and queries reject these colliders with body_replaced.
  ///
  /// `positions` of the state is the view that the last good update got, so queries on facets need the caller's array
  /// unchanged until the next update. After update_modal() and update_skinned() it is a view of the body's own array,
  /// or has no value if the body computes positions only when queries read them.
  const SphereState& sphere_state() const;

  // ---- Identity: frame and tree. ----

  /// Number of good updates of this body; 0 before the first one. A query that stores it recognizes new spheres.
  std::uint64_t frame() const;
  /// False after a rejected update, until the next good one. The spheres then belong to an older frame.
  bool is_current() const;
  /// Hash of the tree and the sizes of its regions: equal for bodies of one model, at any positions.
  std::uint64_t cover_id() const;

  /// The tree that the body follows, with its cover.
  const CoveredTree& model() const;
  /// The tree of the model, with its spheres at rest.
  const SphereTree& rest_tree() const;
  const Cover& cover() const;
  const UpdateOptions& options() const;
  /// Degenerate cases that the constructor found.
  const BindReport& bind_report() const;
  /// Number of vertices of the mesh: the number of positions of an update.
  std::size_t vertex_count() const;

 private:
  friend struct detail::FittedBody;
  struct State;
  void end() noexcept;

  std::shared_ptr<State> state_;  // shared with the colliders
};

/// True if the rule of at least one level guarantees cover, with the body's options.
bool any_promises_cover(const Body& body);

/// Checks the body's current spheres at these positions like Body::certify, but only on the levels whose rules
/// guarantee cover. Throws std::invalid_argument for another number of positions.
Certificate certify_promised_levels(const Body& body, const std::vector<Vec3>& positions,
                                    Workers& workers = serial_workers());

/// True if at least one inner level has the rule `wrapped`: each of its spheres contains the spheres of its children.
bool any_promises_nesting(const Body& body);

/// Checks with certify_nesting() that the current spheres of these levels contain their children's, both as stored (in
/// float, about origin()) and in mesh coordinates. Returns the worse result.
Nesting certify_promised_nesting(const Body& body);

}  // namespace morula
