// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/collide/collider.hpp>
#include <morula/geometry/rigid_transform.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "parallel/float_environment.hpp"
#include "tree/facet_lists.hpp"
#include "update/posed_vertices.hpp"

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

// A user of hold() shares the ownership of the data and reads `self`, which does not own them.
struct Collider::Shared : Data, std::enable_shared_from_this<Collider::Shared> {
  Collider self{std::shared_ptr<Data>(std::shared_ptr<void>(), this)};
  explicit Shared(const Data& data) : Data(data) {}
};

std::shared_ptr<const Collider> detail::hold(const Collider& collider) {
  const auto& shared = static_cast<const Collider::Shared&>(*collider.data_);
  return {shared.shared_from_this(), &shared.self};
}

Collider::~Collider() = default;
Collider::Collider(const Collider& other) : data_(std::make_shared<Shared>(*other.data_)) {}
Collider::Collider(Collider&& other) noexcept = default;
Collider& Collider::operator=(const Collider& other) {
  if (data_) {
    *data_ = *other.data_;
  } else {
    data_ = std::make_shared<Shared>(*other.data_);
  }
  return *this;
}
// A query of this collider follows it to its new body, so the data stay in place.
Collider& Collider::operator=(Collider&& other) noexcept {
  if (data_ && other.data_) {
    *data_ = *other.data_;
  } else {
    data_ = std::move(other.data_);
  }
  return *this;
}

Collider::Collider(const MeshView& mesh, const Body& body)
    : Collider(mesh, body.cover(), body.sphere_state(), body.model().facet_lists.get(body.rest_tree(), body.cover())) {}

Collider::Collider(const SphereState& pose)
    : data_(std::make_shared<Shared>(Data{.pose = &pose, .kept = pose.shared.lock()})) {}

Collider::Collider(const MeshView& mesh, const Cover& cover, const SphereState& pose)
    : Collider(mesh, cover, pose, nullptr) {}

Collider::Collider(const MeshView& mesh, const Cover& cover, const SphereState& pose,
                   std::shared_ptr<const FacetLists> facet_lists) {
  const StandardFloats standard;
  require_matching(mesh, cover, *pose.tree);
  if (!facet_lists) facet_lists = std::make_shared<const FacetLists>(*pose.tree, cover);
  data_ = std::make_shared<Shared>(Data{.pose = &pose,
                                        .kept = pose.shared.lock(),
                                        .cover = &cover,
                                        .mesh_facets = mesh.facets,
                                        .rest = mesh.positions,
                                        .facets = facet_lists->facets(),
                                        .facet_begin = facet_lists->begin(),
                                        .facet_end = facet_lists->end()});
  data_->facet_lists = std::move(facet_lists);
}

void detail::copy_shares(const Collider& collider, std::uint32_t leaf, std::vector<float>& shares) {
  collider.data_->facet_lists->copy_shares(leaf, collider.cover(), collider.mesh_facets(), shares);
}

void Collider::set_transform(const RigidTransform& transform) {
  const StandardFloats standard;
  data_->transform = rigid_or_throw(transform, "the transform of a body");
  ++data_->changes.value;
}

void Collider::set_positions(const PositionView& positions) {
  const StandardFloats standard;
  if (positions.size() != vertex_count())
    throw std::invalid_argument(std::to_string(positions.size()) + " positions for a mesh of " +
                                std::to_string(vertex_count()) + " vertices");
  data_->given = positions;
  data_->given_frame = data_->pose->frame;
  ++data_->changes.value;
}

Vec3 Collider::posed(std::uint32_t vertex) const {
  return (*data_->pose->vertices)[vertex];
}

const PositionView& Collider::all_posed() const {
  return data_->pose->vertices->all();
}

}  // namespace morula
