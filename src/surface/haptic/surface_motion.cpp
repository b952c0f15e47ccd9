// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/haptic/surface_motion.hpp"

#include <algorithm>
#include <cmath>

namespace morula::detail {

void SurfaceMotion::start(const Collider& body) {
  const std::size_t vertices = body.vertex_count();
  std::vector<std::uint8_t> is_used(vertices, 0);
  for (const Facet& facet : body.mesh_facets())
    for (const std::uint32_t v : facet) is_used[v] = 1;
  used_.clear();
  for (std::uint32_t v = 0; v < vertices; ++v)
    if (is_used[v] != 0) used_.push_back(v);
  facet_count_ = body.mesh_facets().size();
  before_.assign(vertices, {});
  after_.assign(vertices, {});
  copy_positions(body);
  accept(body);
  after_ = before_;
}

void SurfaceMotion::accept(const Collider& body) {
  before_.swap(after_);
  source_ = body.sphere_state().shared;
  frame_ = body.sphere_state().frame;
  first_vertex_ = body.positions().address(0);
}

// Every state of a source has another frame, and positions that a state was updated with do not change. States that
// nobody shares may be anywhere and have any frame: their positions are compared.
bool SurfaceMotion::has_same_state(const Collider& body) const {
  const std::weak_ptr<const void>& source = body.sphere_state().shared;
  // mutant haptic-any-source: `source.owner_before(source_) || source_.owner_before(source)` -> `false`
  if (source.expired() || source.owner_before(source_) || source_.owner_before(source)) return false;
  // mutant haptic-any-frame: `body.sphere_state().frame == frame_ && ` -> ``
  return body.sphere_state().frame == frame_ && body.positions().address(0) == first_vertex_;
}

// Returns the largest distance that a vertex has moved.
double SurfaceMotion::copy_positions(const Collider& body) {
  const PositionView& positions = body.positions();
  double squared = 0;
  for (const std::uint32_t v : used_) {
    after_[v] = positions[v];
    squared = std::max(squared, squared_distance(before_[v], after_[v]));
  }
  return std::sqrt(squared);
}

double SurfaceMotion::compare(const Collider& body) {
  if (has_same_state(body)) return 0;
  const double farthest = copy_positions(body);
  if (farthest == 0) accept(body);
  return farthest;
}

}  // namespace morula::detail
