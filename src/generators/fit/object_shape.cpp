// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/fit/object_shape.hpp"

#include "geometry/inspect_sides.hpp"

namespace morula::detail {

ObjectShape::ObjectShape(const MeshView& mesh) : mesh_(mesh) {
  const MeshReport report = inspect_sides(mesh, connectivity(mesh));
  has_volume_ = report.has_volume();
  orientation_ = detail::orientation(report);
  for (const Facet& facet : mesh.facets)
    for (const std::uint32_t v : facet) box_.add(mesh.positions[v]);
}

ObjectShape::ObjectShape(const MeshView& mesh, Workers& workers)
    : mesh_(mesh),
      distance_(std::in_place, mesh, workers),
      has_volume_(distance_->has_volume()),
      orientation_(distance_->orientation()),
      box_(distance_->bvh().bounding_box()) {}

const SignedDistance& ObjectShape::distance() const {
  std::call_once(computed_, [this] {
    if (!distance_) distance_.emplace(mesh_);
  });
  return *distance_;
}

}  // namespace morula::detail
