// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What closes an open surface: facets from its border to a point in the middle of each piece of border.
#pragma once

#include <cstdint>
#include <morula/geometry/connectivity.hpp>
#include <morula/geometry/mesh_view.hpp>
#include <vector>

namespace morula::detail {

/// Hangs on the facets alone, so that no deformation changes it. The winding number of the open surface is that of the
/// closed one, a whole number, less that of the caps, wherever these lie [jacobson2013].
class BorderCaps {
 public:
  explicit BorderCaps(const MeshView& mesh);

  bool empty() const { return sides_.empty(); }
  /// The closed surface: the mesh's vertices and facets, then the middles and the caps.
  void close(const MeshView& mesh, std::vector<Vec3>& positions, std::vector<Facet>& facets) const;

 private:
  struct Side {
    std::uint32_t from, to;  // as the cap goes, against the facet
    std::uint32_t piece;
  };
  std::vector<Side> sides_;
  std::uint32_t piece_count_ = 0;
};

}  // namespace morula::detail
