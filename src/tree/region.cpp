// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "tree/region.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "parallel/interruption.hpp"
#include "tree/vertex_memo.hpp"

namespace morula::detail {
namespace {

// A hash for a table of this run: no file contains it, so a few multiplications suffice.
std::uint64_t hash_of(const CutPoint& c) {
  std::uint64_t hash = 0;
  const auto add = [&](std::uint64_t number) {
    hash = (hash ^ number) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 32;
  };
  add(std::uint64_t{c.vertex[0]} << 32 | c.vertex[1]);
  add(c.vertex[2]);
  for (const double w : c.weight) add(std::bit_cast<std::uint64_t>(w));
  return hash;
}

// Gives every distinct corner a number, in the order of first use. The table of places uses open addressing: cut points
// are many, and lie in `points_` already.
class CornerNumbers {
 public:
  explicit CornerNumbers(std::size_t vertex_count) : vertex_count_(vertex_count), places_(1024, free_place) {}

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
    std::uint32_t& place = place_of(point);
    if (place != free_place) return static_cast<std::uint32_t>(vertex_count_ + place);
    place = static_cast<std::uint32_t>(points_.size());
    points_.push_back(point);
    if (2 * points_.size() > places_.size()) grow();
    return static_cast<std::uint32_t>(vertex_count_ + points_.size() - 1);
  }
  std::vector<CutPoint> take() { return std::move(points_); }

 private:
  static constexpr std::uint32_t free_place = 0xffffffffu;

  std::uint32_t& place_of(const CutPoint& point) {
    std::size_t i = hash_of(point) & (places_.size() - 1);
    while (places_[i] != free_place && !(points_[places_[i]] == point)) i = (i + 1) & (places_.size() - 1);
    return places_[i];
  }
  void grow() {
    places_.assign(2 * places_.size(), free_place);
    for (std::uint32_t p = 0; p < points_.size(); ++p) place_of(points_[p]) = p;
  }

  std::size_t vertex_count_;
  std::vector<CutPoint> points_;
  std::vector<std::uint32_t> places_;  // their number is a power of two
};

}  // namespace

Region whole_surface(const MeshView& mesh) {
  Region region;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) region.add_whole(static_cast<std::uint32_t>(f));
  return region;
}

void corner_positions(const MeshView& mesh, const Region& region, std::vector<Vec3>& points) {
  points.clear();
  SeenVertices seen(region.size());
  for (std::size_t k = 0; k < region.size(); ++k) {
    if (region.is_whole(k)) {
      for (const std::uint32_t v : mesh.facets[region.facet[k]])
        if (seen.is_new(v)) points.push_back(mesh.positions[v]);
      continue;
    }
    each_corner(mesh, region, k, [&](const Vec3& p) { points.push_back(p); });
  }
}

std::vector<Vec3> some_corner_positions(const MeshView& mesh, const Region& region, std::size_t most) {
  const std::size_t step = 1 + region.corner_count() / most;
  std::vector<Vec3> points;
  std::size_t before = 0, next = 0;  // corners of earlier polygons; the next to be taken
  for (std::size_t k = 0; k < region.size(); ++k) {
    const auto polygon = region.polygon(k);
    for (; next < before + polygon.size(); next += step)
      points.push_back(at_barycentric(mesh.corners(region.facet[k]), polygon[next - before]));
    before += polygon.size();
  }
  return points;
}

std::optional<Barycentric> barycentric_on(const Cover& cover, const Facet& facet, std::uint32_t corner) {
  Barycentric b{0, 0, 0};
  const auto add = [&](std::uint32_t vertex, double weight) {
    if (weight == 0) return true;
    const auto at = std::find(facet.begin(), facet.end(), vertex);
    if (at == facet.end()) return false;
    b[static_cast<std::size_t>(at - facet.begin())] += weight;
    return true;
  };
  if (corner < cover.vertex_count) return add(corner, 1) ? std::optional(b) : std::nullopt;
  const CutPoint& point = cover.cut_points[corner - cover.vertex_count];
  const bool is_on_it = add(point.vertex[0], point.weight[0]) && add(point.vertex[1], point.weight[1]) &&
                        add(point.vertex[2], point.weight[2]);
  return is_on_it ? std::optional(b) : std::nullopt;
}

Cover assemble_cover(const MeshView& mesh, const SphereTree& tree, std::vector<Region> regions) {
  Cover cover;
  cover.vertex_count = static_cast<std::uint32_t>(mesh.vertex_count());
  cover.facet_count = static_cast<std::uint32_t>(mesh.facet_count());
  cover.corner_begin.push_back(0);
  cover.region_begin.resize(tree.node_count());
  cover.region_end.resize(tree.node_count());
  CornerNumbers numbers(mesh.vertex_count());
  std::size_t patches = 0, corners = 0;
  for (std::uint32_t node = 0; node < tree.node_count(); ++node)
    if (tree.is_leaf(node)) patches += regions[node].size(), corners += regions[node].corner_count();
  cover.patch_facet.reserve(patches);
  cover.corner_begin.reserve(patches + 1);
  cover.corners.reserve(corners);

  // mutant looks-cover: `14` -> `30`
  InterruptPoller poll_interrupt(1u << 14);
  const auto add_region = [&](const Region& region) {
    for (std::size_t k = 0; k < region.size(); ++k) {
      poll_interrupt();
      cover.patch_facet.push_back(region.facet[k]);
      const Facet& facet = mesh.facets[region.facet[k]];
      if (region.is_whole(k))
        cover.corners.insert(cover.corners.end(), facet.begin(), facet.end());
      else
        for (const Barycentric& b : region.polygon(k)) cover.corners.push_back(numbers.number(facet, b));
      cover.corner_begin.push_back(static_cast<std::uint32_t>(cover.corners.size()));
    }
  };
  const auto visit = [&](const auto& self, std::uint32_t node) -> void {
    cover.region_begin[node] = static_cast<std::uint32_t>(cover.patch_count());
    if (tree.is_leaf(node)) add_region(std::exchange(regions[node], {}));
    for (std::uint32_t c = 0; c < tree.child_count[node]; ++c) self(self, tree.first_child[node] + c);
    cover.region_end[node] = static_cast<std::uint32_t>(cover.patch_count());
  };
  visit(visit, 0);
  cover.cut_points = numbers.take();
  return cover;
}

}  // namespace morula::detail
