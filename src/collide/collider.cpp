// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/collide/collider.hpp>
#include <morula/geometry/rigid_transform.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "parallel/float_environment.hpp"
#include "tree/facet_lists.hpp"

namespace morula {
using namespace detail;

namespace {

void require_matching(const MeshView& mesh, const Cover& cover, const SphereTree& tree) {
  if (mesh.vertex_count() != cover.vertex_count || mesh.facet_count() != cover.facet_count)
    throw std::invalid_argument("the body is of another mesh: " + std::to_string(cover.facet_count) + " facets, not " +
                                std::to_string(mesh.facet_count()));
  if (cover.region_begin.size() != tree.node_count())
    throw std::invalid_argument("the cover is of another tree: " + std::to_string(cover.region_begin.size()) +
                                " nodes, not " + std::to_string(tree.node_count()));
}

}  // namespace

Collider::Collider(const MeshView& mesh, const Body& body)
    : Collider(mesh, body.cover(), body.sphere_state(), body.model().facet_lists.get(body.rest_tree(), body.cover())) {}

Collider::Collider(const SphereState& pose) : pose_(&pose), kept_(pose.shared.lock()) {}

Collider::Collider(const MeshView& mesh, const Cover& cover, const SphereState& pose)
    : Collider(mesh, cover, pose, nullptr) {}

Collider::Collider(const MeshView& mesh, const Cover& cover, const SphereState& pose,
                   std::shared_ptr<const FacetLists> facet_lists)
    : pose_(&pose),
      kept_(pose.shared.lock()),
      cover_(&cover),
      mesh_facets_(mesh.facets),
      rest_(mesh.positions),
      facet_lists_(std::move(facet_lists)) {
  const StandardFloats standard;
  require_matching(mesh, cover, *pose.tree);
  if (!facet_lists_) facet_lists_ = std::make_shared<const FacetLists>(*pose.tree, cover);
  facets_ = facet_lists_->facets();
  facet_begin_ = facet_lists_->begin();
  facet_end_ = facet_lists_->end();
}

void detail::copy_shares(const Collider& collider, std::uint32_t leaf, std::vector<float>& shares) {
  collider.facet_lists_->copy_shares(leaf, collider.cover(), collider.mesh_facets(), shares);
}

void Collider::set_transform(const RigidTransform& transform) {
  const StandardFloats standard;
  transform_ = rigid_or_throw(transform, "the transform of a body");
  ++changes_.value;
}

void Collider::set_positions(const PositionView& positions) {
  const StandardFloats standard;
  if (positions.size() != vertex_count())
    throw std::invalid_argument(std::to_string(positions.size()) + " positions for a mesh of " +
                                std::to_string(vertex_count()) + " vertices");
  given_ = positions;
  given_frame_ = pose_->frame;
  ++changes_.value;
}

}  // namespace morula
