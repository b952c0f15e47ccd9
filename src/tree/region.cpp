// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "tree/region.hpp"

#include <unordered_map>

#include "geometry/hash.hpp"

namespace morula::detail {
namespace {

struct CutPointHash {
  std::size_t operator()(const CutPoint& c) const {
    Hasher hash;
    for (const std::uint32_t v : c.vertex) hash.add(v);
    for (const double w : c.weight) hash.add(w);
    return static_cast<std::size_t>(hash.value());
  }
};

// Gives every distinct corner a number. Numbers follow first use, so they do not depend on the hash table's order.
class CornerNumbers {
 public:
  explicit CornerNumbers(std::size_t vertex_count) : vertex_count_(vertex_count) {}

  std::uint32_t number(const Facet& facet, const Barycentric& b) {
    for (int k = 0; k < 3; ++k)
      if (b[(k + 1) % 3] == 0 && b[(k + 2) % 3] == 0) return facet[k];
    CutPoint point{facet, b};
    for (int k = 0; k < 3; ++k) {
      if (b[k] != 0) continue;
      int from = (k + 1) % 3, to = (k + 2) % 3;
      if (facet[from] > facet[to]) std::swap(from, to);
      point = {{facet[from], facet[to], facet[to]}, {b[from], b[to], 0}};
    }
    const auto next = static_cast<std::uint32_t>(vertex_count_ + points_.size());
    const auto [entry, is_new] = numbers_.try_emplace(point, next);
    if (is_new) points_.push_back(point);
    return entry->second;
  }
  std::vector<CutPoint> take() { return std::move(points_); }

 private:
  std::size_t vertex_count_;
  std::vector<CutPoint> points_;
  std::unordered_map<CutPoint, std::uint32_t, CutPointHash> numbers_;
};

}  // namespace

Region whole_surface(const Mesh& mesh) {
  constexpr std::array<Barycentric, 3> whole{Barycentric{1, 0, 0}, Barycentric{0, 1, 0}, Barycentric{0, 0, 1}};
  Region region;
  region.facet.reserve(mesh.facet_count());
  region.corner_begin.reserve(mesh.facet_count() + 1);
  region.corners.reserve(3 * mesh.facet_count());
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) region.add(static_cast<std::uint32_t>(f), whole);
  return region;
}

void corner_positions(const Mesh& mesh, const Region& region, std::vector<Vec3>& points) {
  points.clear();
  points.reserve(region.corners.size());
  for (std::size_t k = 0; k < region.size(); ++k) {
    const Triangle t = mesh.corners(region.facet[k]);
    for (const Barycentric& b : region.polygon(k)) points.push_back(at_barycentric(t, b));
  }
}

Cover assemble_cover(const Mesh& mesh, const SphereTree& tree, std::span<const Region> regions) {
  Cover cover;
  cover.vertex_count = static_cast<std::uint32_t>(mesh.vertex_count());
  cover.facet_count = static_cast<std::uint32_t>(mesh.facet_count());
  cover.corner_begin.push_back(0);
  cover.region_begin.resize(tree.node_count());
  cover.region_end.resize(tree.node_count());
  CornerNumbers numbers(mesh.vertex_count());

  const auto add_region = [&](const Region& region) {
    for (std::size_t k = 0; k < region.size(); ++k) {
      cover.patch_facet.push_back(region.facet[k]);
      for (const Barycentric& b : region.polygon(k))
        cover.corners.push_back(numbers.number(mesh.facets[region.facet[k]], b));
      cover.corner_begin.push_back(static_cast<std::uint32_t>(cover.corners.size()));
    }
  };
  const auto visit = [&](const auto& self, std::uint32_t node) -> void {
    cover.region_begin[node] = static_cast<std::uint32_t>(cover.patch_count());
    if (tree.is_leaf(node)) add_region(regions[node]);
    for (std::uint32_t c = 0; c < tree.child_count[node]; ++c) self(self, tree.first_child[node] + c);
    cover.region_end[node] = static_cast<std::uint32_t>(cover.patch_count());
  };
  visit(visit, 0);
  cover.cut_points = numbers.take();
  return cover;
}

}  // namespace morula::detail
