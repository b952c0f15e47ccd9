// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <morula/generators/build.hpp>
#include <vector>

#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

// Estimates how many patches a tree of so many leaves has. Leaves share the surface evenly, and a row of spheres along
// a slender body has diameters that add up to its length: that gives the least width of a leaf's part. A facet falls
// into as many patches as it is parts long, times as many as it is parts high, and into no more than there are leaves.
class ExpectedPatches {
 public:
  explicit ExpectedPatches(const MeshView& mesh) : diagonal_(bounding_box(mesh).diagonal()) {
    extents_.reserve(mesh.facet_count());
    for (const Facet& f : mesh.facets) {
      const Triangle t{mesh.positions[f[0]], mesh.positions[f[1]], mesh.positions[f[2]]};
      const double longest = std::max({distance(t[0], t[1]), distance(t[1], t[2]), distance(t[2], t[0])});
      const double facet_area = area(t);
      extents_.push_back({longest, longest > 0 ? 2 * facet_area / longest : 0});
      surface_ += facet_area;
    }
  }
  double operator()(double leaves) const {
    const double width = std::max(std::sqrt(surface_ / leaves), diagonal_ / leaves);
    if (!(width > 0)) return static_cast<double>(extents_.size());
    double patches = 0;
    for (const auto& [longest, height] : extents_)
      patches += std::min(leaves, (1 + longest / width) * (1 + height / width));
    return patches;
  }
  /// The estimate for as many equilateral facets, on a surface that is not slender.
  double of_equilateral_facets(double leaves) const {
    constexpr double edge = 1.5196713713031853, height = 1.3160740129524924;  // edge and height of a facet of area 1
    const auto facets = static_cast<double>(extents_.size());
    const double per_width = std::sqrt(leaves / facets);
    return facets * std::min(leaves, (1 + edge * per_width) * (1 + height * per_width));
  }

 private:
  struct Extent {
    double longest, height;
  };
  std::vector<Extent> extents_;  // extents of the facets
  double surface_ = 0, diagonal_;
};

}  // namespace

int automatic_depth(std::size_t facet_count, int branching) {
  constexpr std::size_t most_leaves = 512, facets_per_leaf = 4;
  const auto children = static_cast<std::size_t>(branching);
  const std::size_t most = std::min(most_leaves, facet_count / facets_per_leaf);
  int depth = 1;
  for (std::size_t leaves = children; depth < max_depth && leaves <= most / children; leaves *= children) ++depth;
  return depth;
}

int automatic_depth(const MeshView& mesh, int branching) {
  const StandardFloats standard;
  // Estimated and real numbers differ by a half: real patches are to stay below three times as many.
  // mutant automatic-depth-by-number: `2` -> `20`
  constexpr double most_times = 2;
  int depth = automatic_depth(mesh.facet_count(), branching);
  if (depth == 1) return depth;
  const ExpectedPatches expected(mesh);
  double leaves = 1;
  for (int level = 0; level < depth; ++level) leaves *= branching;
  const double most = most_times * expected.of_equilateral_facets(leaves);
  for (; depth > 1 && expected(leaves) > most; --depth) leaves /= branching;
  return depth;
}

}  // namespace morula
