// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "commands/bounds/clusters.hpp"

#include <algorithm>
#include <morula/geometry/box.hpp>
#include <numeric>

namespace morula::cli {
namespace {

/// Halves facets until there are clusters enough, the lower half first.
class Halving {
 public:
  explicit Halving(const Mesh& mesh) : cluster_of_facet_(mesh.facet_count()) {
    middles_.reserve(mesh.facet_count());
    for (const Facet& f : mesh.facets) {
      Box box;
      for (const std::uint32_t v : f) box.add(mesh.positions[v]);
      middles_.push_back(0.5 * box.lower + 0.5 * box.upper);
    }
  }

  void halve(std::span<std::uint32_t> facets, std::size_t count) {
    if (count == 1) {
      for (const std::uint32_t f : facets) cluster_of_facet_[f] = cluster_count_;
      ++cluster_count_;
      return;
    }
    Box box;
    for (const std::uint32_t f : facets) box.add(middles_[f]);
    const int axis = box.longest_axis();
    const std::size_t lower = count / 2, half = facets.size() * lower / count;
    const auto middle = facets.begin() + static_cast<std::ptrdiff_t>(half);
    std::nth_element(facets.begin(), middle, facets.end(), [&](std::uint32_t f, std::uint32_t g) {
      const double a = middles_[f][axis], b = middles_[g][axis];
      return a < b || (a == b && f < g);
    });
    halve(facets.first(half), lower);
    halve(facets.subspan(half), count - lower);
  }
  std::vector<std::uint32_t> take() { return std::move(cluster_of_facet_); }

 private:
  std::vector<Vec3> middles_{};
  std::vector<std::uint32_t> cluster_of_facet_;
  std::uint32_t cluster_count_ = 0;
};

}  // namespace

std::vector<std::uint32_t> halved_clusters(const Mesh& mesh, std::size_t count) {
  std::vector<std::uint32_t> facets(mesh.facet_count());
  std::iota(facets.begin(), facets.end(), std::uint32_t{0});
  Halving halving(mesh);
  halving.halve(facets, std::min(count, facets.size()));
  return halving.take();
}

std::vector<std::uint32_t> primitive_clusters(const GltfParts& parts) {
  std::vector<std::uint32_t> cluster_of_facet;
  for (std::uint32_t i = 0; i < parts.primitives.size(); ++i)
    cluster_of_facet.insert(cluster_of_facet.end(), parts.primitives[i].facet_count, i);
  return cluster_of_facet;
}

std::vector<FacetRanges> facet_ranges(std::span<const std::uint32_t> cluster_of_facet, std::size_t cluster_count) {
  std::vector<FacetRanges> ranges(cluster_count);
  for (std::uint32_t f = 0; f < cluster_of_facet.size(); ++f) {
    FacetRanges& own = ranges[cluster_of_facet[f]];
    if (own.empty() || own.back().second != f) own.emplace_back(f, f);
    ++own.back().second;
  }
  return ranges;
}

std::vector<std::vector<std::uint32_t>> cluster_vertices(const Mesh& mesh,
                                                         std::span<const std::uint32_t> cluster_of_facet,
                                                         std::size_t cluster_count) {
  std::vector<std::vector<std::uint32_t>> vertices(cluster_count);
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    std::vector<std::uint32_t>& own = vertices[cluster_of_facet[f]];
    own.insert(own.end(), mesh.facets[f].begin(), mesh.facets[f].end());
  }
  for (std::vector<std::uint32_t>& own : vertices) {
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
  }
  return vertices;
}

}  // namespace morula::cli
