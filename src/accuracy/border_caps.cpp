// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "accuracy/border_caps.hpp"

#include <algorithm>
#include <map>

#include "geometry/disjoint_sets.hpp"

namespace morula::detail {

BorderCaps::BorderCaps(const MeshView& mesh) {
  const Connectivity all = connectivity(mesh);
  DisjointSets sets(mesh.vertex_count());
  for (std::uint32_t e = 0; e < all.edge_count(); ++e) {
    // Facets that go along an edge both ways cancel; what is left over is border.
    const auto [a, b] = all.edges[e];
    int forward = 0;
    for (const std::uint32_t side : all.edge_sides(e)) forward += side_ends(mesh.facets, side)[0] == a ? 1 : -1;
    if (forward != 0) sets.join(a, b);
    for (int n = 0; n < std::abs(forward); ++n) sides_.push_back(forward > 0 ? Side{b, a, 0} : Side{a, b, 0});
  }
  std::map<std::uint32_t, std::uint32_t> pieces;
  for (Side& side : sides_) {
    const auto [found, is_new] = pieces.try_emplace(sets.root(side.from), piece_count_);
    piece_count_ += is_new;
    side.piece = found->second;
  }
}

void BorderCaps::close(const MeshView& mesh, std::vector<Vec3>& positions, std::vector<Facet>& facets) const {
  const auto first_middle = static_cast<std::uint32_t>(mesh.vertex_count());
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) positions.push_back(mesh.positions[v]);
  std::vector<Vec3> sums(piece_count_);
  std::vector<double> counts(piece_count_, 0);
  for (const Side& side : sides_) {
    sums[side.piece] += mesh.positions[side.from];
    counts[side.piece] += 1;
  }
  for (std::size_t piece = 0; piece < sums.size(); ++piece) positions.push_back(sums[piece] / counts[piece]);
  facets.assign(mesh.facets.begin(), mesh.facets.end());
  for (const Side& side : sides_) facets.push_back({side.from, side.to, first_middle + side.piece});
}

}  // namespace morula::detail
