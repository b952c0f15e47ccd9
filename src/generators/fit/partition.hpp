// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Partition: a region is divided among spheres by power.
#pragma once

#include "tree/region.hpp"

namespace morula::detail {

struct Partition {
  std::vector<Region> regions;  // one per sphere; may be empty
  std::size_t leftover_patches =
      0;  // number of cut parts outside their own sphere, assigned to the sphere that grew least
};

/// Cuts every polygon by the power diagram of the spheres. A cut part outside its own sphere goes undivided to the
/// sphere that contains it after the least growth, never by power alone: power would assign parts in gaps to minute
/// spheres, which then swell. Facets with a repeated vertex, which are segments or points, are never cut.
Partition partition(const MeshView& mesh, const Region& region, std::span<const Sphere> spheres);

}  // namespace morula::detail
