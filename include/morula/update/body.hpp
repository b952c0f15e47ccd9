// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A body: a mesh with its tree and cover, whose spheres follow the vertices.
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

/// A body reads positions and writes spheres. It has value semantics: copies are independent. Every update starts from
/// the rest state, so the result depends only on the positions: back at rest, the spheres equal the rest spheres bit
/// for bit.
class Body {
 public:
  // ---- Construction. ----

  /// Copies the required data of mesh and model. The model must be built from the mesh.
  ///
  /// The body starts at rest, with the spheres that update(mesh.positions) makes. With approach1 and approach2 these
  /// are the tree's spheres, narrowed to float with radii rounded up; with the other rules they have the same centers
  /// and the radii of the rule.
  /// Throws std::invalid_argument if mesh and model do not belong together (sizes, indices, regions, mesh hash); if a
  /// rule list is empty or has an invalid rule; if an option is out of range; if modes or a skin are not finite, belong
  /// to another mesh, or are missing for a level of the rule `modal` or `skinned`; if levels use both of these rules;
  /// or if coordinates about the center reach 2^57 (1.4e17), because their squares would leave the range of float. The
  /// center itself may be as far away as 2^100 (1e30). The spheres contain even the smallest body; below about 2^-60
  /// (1e-18) the spheres are as large as the resolution of float.
  Body(const MeshView& mesh, const CoveredTree& model, UpdateOptions options = {}, Workers& workers = serial_workers());
  Body(const MeshView& mesh, CoveredTree&& model, UpdateOptions options = {}, Workers& workers = serial_workers());
  /// Shares tree and cover instead of copying them, for several bodies of one model, or a caller that keeps the model.
  Body(const MeshView& mesh, std::shared_ptr<const CoveredTree> model, UpdateOptions options = {},
       Workers& workers = serial_workers());
  ~Body();
  /// Another body of the same model in the same pose, independent from then on; tree and cover are shared. A copy only
  /// copies a few arrays, while the constructors compute anchors and owned corners.
  Body(const Body&);
  Body& operator=(const Body&);
  Body(Body&&) noexcept;
  Body& operator=(Body&&) noexcept;

  // ---- Updates by positions. ----

  /// Moves every sphere to the given positions: one per mesh vertex, in mesh order and units, float or double.
  ///
  /// With the rule `exact`, every level then covers the surface; radii are rounded up, so rounding cannot lose cover.
  /// Positions are narrowed to float about an origin that moves with the body, so a distant body loses no precision.
  /// Reports faults and then changes nothing, so the last good spheres stay: a wrong count; a coordinate, of a vertex
  /// that facets use, that is not finite or 2^57 or more from the origin; an origin beyond 2^100. Rejects a body with
  /// levels of the rule `modal` or `skinned`, because positions do not determine coordinates or transforms. Allocates
  /// nothing. The result has the same bits for any number of workers. Cost: linear in vertices + cut points + owned
  /// corners (exact) or links (other rules).
  UpdateStatus update(const PositionView& positions, Workers& workers = serial_workers()) noexcept;

  // ---- Updates by modes or bones. ----

  /// Moves every sphere to the given coordinates of the modes: vertex i is then at rest_i + sum_j q_j U_ij.
  ///
  /// coordinates: one per mode, finite; all 0 gives rest, bit for bit. Levels of the rule `modal` contain every corner
  /// they own [james2004], both for positions summed in double (move_by_modes) and in exact arithmetic. Other levels
  /// follow the positions, which are computed first, with their usual guarantees. Reports bad coordinates, and then
  /// changes nothing. Allocates nothing. The result has the same bits for any number of workers.
  /// Cost: nodes × modes if all levels are modal, for any number of vertices; otherwise vertices × modes plus the cost
  /// of update().
  UpdateStatus update_modal(std::span<const double> coordinates, Workers& workers = serial_workers()) noexcept;

  /// Moves every sphere by the transforms of the skin's bones, relative to rest: vertex i is then at rest_i + sum_b
  /// w_ib (T_b rest_i - rest_i).
  ///
  /// transforms: one per bone, finite, affine; the identity for all gives rest, bit for bit. Levels of the rule
  /// `skinned` blend the transforms with the mean weights of their regions, without a guarantee of cover;
  /// covers(options(), rule) tests the guarantee of a rule. Other levels follow the positions, which are computed first
  /// as by move_by_skin, with their usual guarantees. Reports bad transforms, and then changes nothing. Allocates
  /// nothing. The result has the same bits for any number of workers.
  /// Cost: nodes × their bones if all levels are skinned, for any number of vertices; otherwise influences plus the
  /// cost of update().
  UpdateStatus update_skinned(std::span<const AffineTransform> transforms,
                              Workers& workers = serial_workers()) noexcept;

  /// One node's sphere at the given coordinates, in mesh coordinates; the current spheres stay unchanged. It serves
  /// traversals from the root, which then pay only for the nodes that they reach. The result has the same bits as
  /// sphere() after update_modal(). Coordinates that update_modal() rejects, and nodes on levels of other rules, give a
  /// sphere of infinite radius, which contains everything. Cost: modes. Several threads may call it at once.
  Sphere modal_sphere(std::uint32_t node, std::span<const double> coordinates) const noexcept;

  // ---- Partial and lazy updates. ----

  /// The same spheres as update(), bit for bit, if only vertices in these ranges differ from the last update's
  /// positions.
  ///
  /// positions: of all vertices. With `exact` or `wrapped` on all levels, the cost depends on the moved vertices: the
  /// leaves that own parts of their facets, and the leaves below nodes whose centers depend on them. The whole body is
  /// updated with other rules, after a failed update, and if the first vertex that a facet uses has moved, which
  /// determines the origin. A range that ends before it begins or beyond the last vertex gives bad_range and changes
  /// nothing.
  UpdateStatus update(const PositionView& positions, std::span<const VertexRange> changed,
                      Workers& workers = serial_workers()) noexcept;

  /// Updates the nodes of levels 0…level only. Nodes below keep the spheres of an older frame, about an older origin,
  /// until refresh_children() updates them; they must not be read earlier.
  ///
  /// Lazy updates need the rule `exact` on all levels; other bodies are updated in full. They pay off if queries visit
  /// few nodes of a tree with many leaves. Every vertex is read in any case, because the root's sphere depends on it.
  /// When all nodes are refreshed, the spheres equal those of update(), bit for bit.
  UpdateStatus update_lazily(const PositionView& positions, std::size_t level,
                             Workers& workers = serial_workers()) noexcept;
  /// The lazy form of update_modal(); if all levels follow `modal`, it costs only the nodes that are refreshed.
  UpdateStatus update_modal_lazily(std::span<const double> coordinates, std::size_t level,
                                   Workers& workers = serial_workers()) noexcept;
  /// Updates the children of a node, which must be current itself, to the frame of the last lazy update. Not for
  /// several threads at once. Allocates nothing. Cost: the corners that the children own, or modes; none if they are
  /// current. Returns the number of updated nodes; 0 if an update was rejected since.
  std::size_t refresh_children(std::uint32_t node) noexcept;
  /// True if the node's sphere belongs to this frame, as all do after an update that was not lazy.
  bool is_fresh(std::uint32_t node) const;
  /// True if all nodes are fresh.
  bool is_complete() const;

  // ---- Spheres. ----

  /// The current spheres, one per node, about origin(). They must not be read during an update.
  std::span<const Spheref> spheres() const;
  Vec3 origin() const;
  /// The current spheres in mesh coordinates.
  Sphere sphere(std::uint32_t node) const;
  void copy_spheres(std::vector<Sphere>& spheres) const;
  /// The current tree in mesh coordinates, as `morula update` writes it for each frame.
  SphereTree current_tree() const;
  /// Proves that the current spheres of every level contain the surface at these positions, one per mesh vertex. Throws
  /// std::invalid_argument for another number of them. Cost: about 0.1 us per corner and level.
  Certificate certify(const PositionView& positions, Workers& workers = serial_workers()) const;
  /// 64-bit FNV-1a over origin and spheres.
  std::uint64_t hash() const;

  /// The current spheres in the form that queries read, with a number for the frame. The address stays valid as long as
  /// the body's state lives, even if the body is moved. Assignment to the body and its destruction end the state
  /// (SphereState::ended): colliders share its data, and queries reject them with body_replaced. Its `positions` is the
  /// view of the last update; for queries on facets the caller keeps the data until the next update.
  const SphereState& sphere_state() const;

  // ---- Identity: frame and tree. ----

  /// Number of good updates, which identifies a set of spheres. 0 at rest, ahead of the first update.
  std::uint64_t frame() const;
  /// False after a rejected update, until the next good one: the spheres then belong to an older frame.
  bool is_current() const;
  /// Identifies the tree and its regions: equal for bodies of one tree, at any positions.
  std::uint64_t cover_id() const;

  /// The tree that the body follows, with its cover.
  const CoveredTree& model() const;
  const SphereTree& rest_tree() const;
  const Cover& cover() const;
  const UpdateOptions& options() const;
  const BindReport& bind_report() const;
  std::size_t vertex_count() const;

 private:
  friend struct detail::FittedBody;
  struct State;
  void end() noexcept;

  std::shared_ptr<State> state_;  // shared with the colliders
};

/// True if the rule of some level guarantees cover.
bool any_promises_cover(const Body& body);

/// certify() of the body's current spheres at these positions, for the levels whose rules guarantee cover.
Certificate certify_promised_levels(const Body& body, const std::vector<Vec3>& positions,
                                    Workers& workers = serial_workers());

/// True if the nodes of some inner level are guaranteed to contain their children's spheres, by the rule `wrapped`.
bool any_promises_nesting(const Body& body);

/// certify_nesting() of the body's current spheres, for the nodes with that guarantee, both about its origin and in
/// mesh coordinates.
Nesting certify_promised_nesting(const Body& body);

}  // namespace morula
