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

/// Reads positions, writes spheres, nothing else. A value: copies are independent.
/// Every update starts from the rest state, so the result depends only
/// on the positions: back at rest the spheres are those of rest, bit for bit.
class Body {
 public:
  // ---- Making. ----

  /// Copies what it needs from mesh and built. The tree must be the cover's.
  ///
  /// Starts at rest, with the spheres that update(mesh.positions) makes: the tree's, narrowed to float with radii
  /// rounded up, by approach1 and approach2; of the same center and the radius that their rule gives, by the others.
  /// Throws std::invalid_argument when mesh and built do not belong together (sizes, indices, regions, mesh hash), a
  /// rule list is empty or names no rule, an option is out of range, modes or a skin are not finite, not for this mesh
  /// or missing for a level of the rule `modal` or `skinned`, two levels ask for these two, or coordinates about the
  /// center reach 2^57 (1.4e17): their squares would leave the range of float. The center itself may be as far as 2^100
  /// (1e30). However small a body is, its spheres contain it; below about 2^-60 (1e-18) they are the size of what float
  /// cannot tell.
  Body(const MeshView& mesh, const CoveredTree& model, UpdateOptions options = {}, Workers& workers = serial_workers());
  Body(const MeshView& mesh, CoveredTree&& model, UpdateOptions options = {}, Workers& workers = serial_workers());
  /// Shares tree and cover instead of copying them: bodies of one model, or a caller who keeps them anyway.
  Body(const MeshView& mesh, std::shared_ptr<const CoveredTree> model, UpdateOptions options = {},
       Workers& workers = serial_workers());
  ~Body();
  /// Another body of the same model in the same pose, independent from now on; tree and cover are shared. Making one
  /// this way is a copy of some arrays, while the constructors work out anchors and owned corners.
  Body(const Body&);
  Body& operator=(const Body&);
  Body(Body&&) noexcept;
  Body& operator=(Body&&) noexcept;

  // ---- Following positions. ----

  /// Moves every sphere to the given positions: one per mesh vertex, in mesh order and units, float or double.
  ///
  /// With the rule `exact`, every level then covers the surface; radii are rounded up, so rounding cannot lose cover.
  /// Positions are narrowed to float about an origin that moves with the body, so being far away costs no precision.
  /// A wrong count or a coordinate (of a vertex that facets use) that is not finite, or 2^57 or more from the origin,
  /// or an origin beyond 2^100, is reported and changes nothing: the last good spheres stay. No allocation. Same bits
  /// for any number of workers. A body with levels of the rule `modal` or `skinned` is refused: where its vertices are
  /// does not tell its coordinates or transforms. Cost: linear in vertices + cut points + owned corners (exact) or
  /// links (other rules).
  UpdateStatus update(const PositionView& positions, Workers& workers = serial_workers()) noexcept;

  // ---- Following modes or bones. ----

  /// Moves every sphere to the given coordinates of the modes: vertex i is then at rest_i + sum_j q_j U_ij.
  ///
  /// coordinates: one per mode, finite; all 0 gives rest, bit for bit. Levels of the rule `modal` contain every corner
  /// they own [james2004], for positions summed in double (move_by_modes) as well as exactly. Other levels follow the
  /// positions, which are formed first, and promise what they promise. Bad coordinates are reported and change nothing.
  /// No allocation. Same bits for any number of workers.
  /// Cost: nodes × modes when all levels are modal, whatever the number of vertices; else vertices × modes and that of
  /// update().
  UpdateStatus update_modal(std::span<const double> coordinates, Workers& workers = serial_workers()) noexcept;

  /// Moves every sphere by the transforms of the skin's bones, relative to rest: vertex i is then at
  /// rest_i + sum_b w_ib (T_b rest_i - rest_i).
  ///
  /// transforms: one per bone, finite, affine; the identity for all gives rest, bit for bit. Levels of the rule
  /// `skinned` blend the transforms with the mean weights of what they own, and take no care to cover: levels that do
  /// are those of covers(options(), rule). Other levels follow the positions, which are formed first as move_by_skin
  /// does, and promise what they promise. Bad transforms are reported and change nothing. No allocation. Same bits for
  /// any number of workers.
  /// Cost: nodes × their bones when all levels are skinned, whatever the number of vertices; else influences, and that
  /// of update().
  UpdateStatus update_skinned(std::span<const AffineTransform> transforms,
                              Workers& workers = serial_workers()) noexcept;

  /// One node's sphere at the given coordinates, in mesh coordinates; the current spheres stay as they are. What a
  /// traversal from the root asks for, node by node: those that it never reaches cost nothing. The same bits as
  /// sphere() after update_modal(). Coordinates that update_modal() would refuse, and nodes on levels of other rules,
  /// give a sphere that contains everything: of infinite radius. Cost: modes. Several threads may ask at once.
  Sphere modal_sphere(std::uint32_t node, std::span<const double> coordinates) const noexcept;

  // ---- Partial and lazy updates. ----

  /// The same spheres, bit for bit, when only vertices in these ranges may differ from the last update's positions.
  ///
  /// positions: of all vertices. With `find_crossings` or `wrapped` on all levels, the cost follows what moved: the
  /// leaves that own something of it, and the leaves below nodes whose centers hang on it. Everything is updated where
  /// that is not possible: other rules, after an update that failed, and when the vertex moved that the origin follows
  /// (the first one that a facet uses). A range that ends before it begins or behind the last vertex gives bad_range
  /// and changes nothing.
  UpdateStatus update(const PositionView& positions, std::span<const VertexRange> changed,
                      Workers& workers = serial_workers()) noexcept;

  /// As update(), but only of the nodes of levels 0…level. Those below keep the spheres of an older frame, about an
  /// older origin, until refresh_children() is asked for them; nobody may read them before.
  ///
  /// Where all levels follow `exact`; other bodies are updated in full. It pays where few nodes are asked for and
  /// leaves are many: every vertex is read all the same, because the root's sphere depends on it. Once all nodes have
  /// been reached, the spheres are those of update(), bit for bit.
  UpdateStatus update_lazily(const PositionView& positions, std::size_t level,
                             Workers& workers = serial_workers()) noexcept;
  /// As update_modal(), lazily; where all levels follow `modal`, the cost is that of the nodes asked for.
  UpdateStatus update_modal_lazily(std::span<const double> coordinates, std::size_t level,
                                   Workers& workers = serial_workers()) noexcept;
  /// Brings the children of a node, which must be current itself, to the frame of the last lazy update. Not to be
  /// called by several threads at once. No allocation. Cost: what the children own, or modes; nothing when they are
  /// current. Returns how many were brought; none when an update was refused since.
  std::size_t refresh_children(std::uint32_t node) noexcept;
  /// Does the node's sphere belong to this frame? All do after an update that was not lazy.
  bool is_fresh(std::uint32_t node) const;
  /// Do those of all nodes?
  bool is_complete() const;

  // ---- Reading spheres. ----

  /// The current spheres, one per node, about origin(). Read them between updates, not during one.
  std::span<const Spheref> spheres() const;
  Vec3 origin() const;
  /// The current spheres in mesh coordinates.
  Sphere sphere(std::uint32_t node) const;
  void copy_spheres(std::vector<Sphere>& spheres) const;
  /// The current tree in mesh coordinates: what `morula update` writes per frame.
  SphereTree current_tree() const;
  /// The proof that the current spheres of every level contain the surface at these positions: one per mesh vertex.
  /// Throws std::invalid_argument for another number of them. Cost: some 0.1 us per corner and level.
  Certificate certify(const PositionView& positions, Workers& workers = serial_workers()) const;
  /// 64-bit FNV-1a over origin and spheres.
  std::uint64_t hash() const;

  /// The current spheres as queries ask them, with what tells one frame from the next. At one address as long as the
  /// body's state lives: moving the body keeps it. Assigning to the body and destroying it end it (SphereState::ended):
  /// colliders keep what they need of it, and queries refuse them with body_replaced. Its `positions` is the view of
  /// the last update, whose data the caller keeps until the next one where a query looks at facets.
  const SphereState& sphere_state() const;

  // ---- Identity: which frame, which tree. ----

  /// Good updates so far: tells one set of spheres from the next. 0 at rest, before the first.
  std::uint64_t frame() const;
  /// False after an update that was refused, until the next good one: the spheres are then those of an older frame.
  bool is_current() const;
  /// Tells trees and their regions apart: equal for bodies made from the same tree, whatever their positions.
  std::uint64_t cover_id() const;

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

/// True when some level promises cover.
bool any_promises_cover(const Body& body);

/// certify() of the body's current spheres at these positions, over the levels whose rules promise cover.
Certificate certify_promised_levels(const Body& body, const std::vector<Vec3>& positions,
                                    Workers& workers = serial_workers());

/// True when the nodes of some inner level promise to contain their children's spheres: those of the rule `wrapped`.
bool any_promises_nesting(const Body& body);

/// certify_nesting() of the body's current spheres below the nodes that promise to contain their children's, both about
/// its origin and in mesh coordinates.
Nesting certify_promised_nesting(const Body& body);

}  // namespace morula
