// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Queries of the C interface about one body: rays, and points inside.
#include <limits>
#include <morula/collide/containment.hpp>
#include <morula/collide/primitives.hpp>

#include "c/handles.hpp"

using namespace morula;
using namespace morula::detail;

namespace {

Vec3 vector_from(const double* from) {
  return {from[0], from[1], from[2]};
}

morula_ray_hit hit_of(const RayHit& found) {
  morula_ray_hit to{};
  to.certified = found.certified ? 1 : 0;
  to.t = std::numeric_limits<double>::infinity();
  to.facet = std::numeric_limits<std::uint32_t>::max();
  if (!found.first) return to;
  const RayPoint& first = *found.first;
  to.t = first.t;
  to.facet = first.point.facet;
  for (int axis = 0; axis < 3; ++axis) to.point[axis] = first.point.point[axis], to.normal[axis] = first.normal[axis];
  std::copy_n(first.point.barycentric.begin(), 3, to.barycentric);
  return to;
}

}  // namespace

morula_status morula_first_hits(const morula_body* body, const morula_ray* rays, size_t ray_count,
                                morula_ray_hit* hits) {
  return guarded([&] {
    require_pointer(body, "body");
    if (ray_count == 0) return MORULA_OK;
    require_pointer(rays, "rays");
    require_pointer(hits, "hits");
    std::vector<morula_ray_hit> found(ray_count);
    const RayQuery query;
    for (std::size_t i = 0; i < ray_count; ++i) {
      const Ray ray{vector_from(rays[i].origin), vector_from(rays[i].direction), rays[i].t_end};
      const RayHit hit = query.run(body->collider, ray);
      if (!hit.status) return code_of(hit.status);
      found[i] = hit_of(hit);
    }
    std::copy(found.begin(), found.end(), hits);
    return MORULA_OK;
  });
}

morula_status morula_locate(morula_body* body, const double* points, size_t point_count, morula_location* locations) {
  return guarded([&] {
    require_pointer(body, "body");
    if (!body->inside) body->inside.emplace(body->collider);
    if (point_count == 0) return MORULA_OK;
    require_pointer(points, "points");
    require_pointer(locations, "locations");
    std::vector<morula_location> found(point_count);
    for (std::size_t i = 0; i < point_count; ++i) {
      const PointLocation at = body->inside->locate(vector_from(points + 3 * i));
      if (!at.status) return code_of(at.status);
      found[i] = {at.inside ? 1 : 0, at.on_surface ? 1 : 0, at.winding, at.certified ? 1 : 0};
    }
    std::copy(found.begin(), found.end(), locations);
    return MORULA_OK;
  });
}
