// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <morula/collide/collider.hpp>
#include <morula/geometry/rigid_transform.hpp>
#include <stdexcept>
#include <string>

#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;

Collider::Collider(const MeshView& mesh, const Body& body) : Collider(mesh, body.cover(), body.sphere_state()) {}

Collider::Collider(const SphereState& pose) : pose_(&pose), kept_(pose.shared.lock()) {}

Collider::Collider(const MeshView& mesh, const Cover& cover, const SphereState& pose)
    : pose_(&pose), kept_(pose.shared.lock()), cover_(&cover), mesh_facets_(mesh.facets), rest_(mesh.positions) {
  const StandardFloats standard;
  const SphereTree& tree = *pose.tree;
  if (mesh.vertex_count() != cover.vertex_count || mesh.facet_count() != cover.facet_count)
    throw std::invalid_argument("the body is of another mesh: " + std::to_string(cover.facet_count) + " facets, not " +
                                std::to_string(mesh.facet_count()));
  if (cover.region_begin.size() != tree.node_count())
    throw std::invalid_argument("the cover is of another tree: " + std::to_string(cover.region_begin.size()) +
                                " nodes, not " + std::to_string(tree.node_count()));
  facet_begin_.assign(tree.node_count(), 0);
  facet_end_.assign(tree.node_count(), 0);

  // Patches are in depth-first order of leaves: so are the lists, and the list of an inner node is one range.
  std::vector<std::uint32_t> leaves;
  for (std::uint32_t node = 0; node < tree.node_count(); ++node)
    if (tree.is_leaf(node)) leaves.push_back(node);
  std::stable_sort(leaves.begin(), leaves.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return cover.region_begin[a] < cover.region_begin[b]; });
  for (const std::uint32_t leaf : leaves) {
    const auto begin = static_cast<std::ptrdiff_t>(facets_.size());
    facets_.insert(facets_.end(), cover.patch_facet.begin() + cover.region_begin[leaf],
                   cover.patch_facet.begin() + cover.region_end[leaf]);
    std::sort(facets_.begin() + begin, facets_.end());
    facets_.erase(std::unique(facets_.begin() + begin, facets_.end()), facets_.end());
    facet_begin_[leaf] = static_cast<std::uint32_t>(begin);
    facet_end_[leaf] = static_cast<std::uint32_t>(facets_.size());
  }
  for (std::uint32_t node = static_cast<std::uint32_t>(tree.node_count()); node-- > 0;) {
    if (tree.is_leaf(node)) continue;
    facet_begin_[node] = facet_begin_[tree.first_child[node]];
    facet_end_[node] = facet_end_[tree.first_child[node] + tree.child_count[node] - 1];
  }
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
