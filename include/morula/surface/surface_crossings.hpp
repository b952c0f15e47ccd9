// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Crossings of surfaces: pairs of facets that intersect, of two surfaces or of one with itself.
//
//   morula::SurfaceTree surface(mesh);
//   morula::SurfaceCrossingQuery query;
//   if (!surface.update(positions) || !query.run(surface)) std::puts("rejected");
//   for (const morula::FeaturePair& pair : query.pairs()) std::printf("%u crosses %u\n", pair.a, pair.b);
#pragma once

#include <memory>
#include <morula/geometry/triangle_intersection.hpp>
#include <morula/surface/feature_pairs.hpp>
#include <morula/surface/surface_tree.hpp>
#include <vector>

namespace morula {

struct SurfaceCrossingOptions {
  PairFilter filter{};
  Budget budget{};
  Clock clock{};
};

/// Crossing query on surface trees, exact like intersect(): touching and coplanar facets count. For one surface with
/// itself, facets that share a vertex are skipped. A surface in a step is tested at its beginning.
class SurfaceCrossingQuery {
 public:
  explicit SurfaceCrossingQuery(SurfaceCrossingOptions options = {});
  ~SurfaceCrossingQuery();
  SurfaceCrossingQuery(SurfaceCrossingQuery&&) noexcept;
  SurfaceCrossingQuery& operator=(SurfaceCrossingQuery&&) noexcept;
  void set_options(SurfaceCrossingOptions options);
  const SurfaceCrossingOptions& options() const;

  SurfaceQueryStatus run(const SurfaceTree& surface, Workers& workers = serial_workers());
  SurfaceQueryStatus run(const SurfaceTree& a, const SurfaceTree& b, Workers& workers = serial_workers());
  SurfaceQueryStatus resume(Workers& workers = serial_workers());

  /// Pairs in the order of (a, b), each once; a < b for one surface with itself.
  std::span<const FeaturePair> pairs() const;
  const std::vector<OpenFacets>& open() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula
