// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <functional>
#include <morula/geometry/box.hpp>
#include <morula/geometry/connectivity.hpp>
#include <morula/geometry/scale.hpp>

#include "parallel/interruptible_sort.hpp"
#include "parallel/interruption.hpp"
#include "surface/boxes/tree_state.hpp"

namespace morula::detail {
namespace {

/// Sorts facets so that aligned runs of 8, 64, 512 … are compact.
class Sorter {
 public:
  Sorter(const MeshView& mesh, std::vector<std::uint32_t>& order) : order_(order), middle_(mesh.facet_count()) {
    InterruptPoller poll_interrupt(1u << 14);
    for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
      poll_interrupt();
      const auto corners = mesh.corners(f);
      middle_[f] = (corners[0] * (1.0 / 3) + corners[1] * (1.0 / 3)) + corners[2] * (1.0 / 3);
    }
  }
  void sort() {
    order_.resize(middle_.size());
    for (std::uint32_t f = 0; f < order_.size(); ++f) order_[f] = f;
    std::size_t run = 8;
    while (run < order_.size()) run *= 8;
    divide(0, order_.size(), run);
  }

 private:
  /// Divides into runs of so many facets, the last of them perhaps shorter, by halves along the longest axis; then
  /// divides each run.
  void divide(std::size_t begin, std::size_t end, std::size_t run) {
    const std::size_t runs = (end - begin + run - 1) / run;
    if (runs > 1) {
      const std::size_t cut = begin + (runs + 1) / 2 * run;
      if (end - begin > 65536) check_interrupt();
      poll_interrupt_();
      Box box;
      for (std::size_t i = begin; i < end; ++i) box.add(middle_[order_[i]]);
      const int axis = box.longest_axis();
      const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
      std::nth_element(at(begin), at(cut), at(end), [&](std::uint32_t f, std::uint32_t g) {
        const double x = middle_[f][axis], y = middle_[g][axis];
        return x != y ? x < y : f < g;
      });
      divide(begin, cut, run);
      divide(cut, end, run);
    } else if (run > 8) {
      divide(begin, end, run / 8);
    } else {
      std::sort(order_.begin() + static_cast<std::ptrdiff_t>(begin), order_.begin() + static_cast<std::ptrdiff_t>(end));
    }
  }

  std::vector<std::uint32_t>& order_;
  std::vector<Vec3> middle_;
  // mutant looks-surface-tree: `16` -> `1u << 30`
  InterruptPoller poll_interrupt_{16};
};

/// The edges of all facets: each pair of different vertices of a facet.
std::vector<std::array<std::uint32_t, 2>> all_edges(std::span<const Facet> facets) {
  std::vector<std::array<std::uint32_t, 2>> edges;
  edges.reserve(3 * facets.size());
  for (const Facet& f : facets)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = f[k], w = f[(k + 1) % 3];
      if (v != w) edges.push_back({std::min(v, w), std::max(v, w)});
    }
  sort_interruptibly(edges, std::less<>());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

/// Assigns each used vertex to the first block that has it; then numbers slots, and corners by slots.
void give_vertices(const SurfaceMesh& mesh, SurfaceBlocks& blocks) {
  blocks.slot_of_vertex.assign(mesh.rest.size(), SurfaceTreeState::no_slot);
  blocks.own_vertices = {0};
  blocks.corners_begin = {0};
  InterruptPoller poll_interrupt(64);
  for (std::uint32_t block = 0; block < blocks.count(); ++block) {
    poll_interrupt();
    std::vector<std::uint32_t> corners;
    for (std::size_t i = 8 * std::size_t{block}; i < std::min(blocks.order.size(), 8 * std::size_t{block} + 8); ++i)
      corners.insert(corners.end(), mesh.facets[blocks.order[i]].begin(), mesh.facets[blocks.order[i]].end());
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    for (const std::uint32_t v : corners) {
      std::uint32_t& slot = blocks.slot_of_vertex[v];
      if (slot == SurfaceTreeState::no_slot) {
        slot = static_cast<std::uint32_t>(blocks.vertex_of_slot.size());
        blocks.vertex_of_slot.push_back(v);
      }
      blocks.corners.push_back(slot);
    }
    while (blocks.corners.size() % corners_step != 0) blocks.corners.push_back(blocks.corners.back());
    blocks.own_vertices.push_back(static_cast<std::uint32_t>(blocks.vertex_of_slot.size()));
    blocks.corners_begin.push_back(static_cast<std::uint32_t>(blocks.corners.size()));
  }
}

/// Assigns each edge to the first block that has it.
void give_edges(const SurfaceMesh& mesh, SurfaceBlocks& blocks) {
  std::vector<std::uint8_t> is_given(mesh.edges.size());
  blocks.own_edges_begin = {0};
  InterruptPoller poll_interrupt(64);
  for (std::uint32_t block = 0; block < blocks.count(); ++block) {
    poll_interrupt();
    for (std::size_t i = 8 * std::size_t{block}; i < std::min(blocks.order.size(), 8 * std::size_t{block} + 8); ++i) {
      const Facet& f = mesh.facets[blocks.order[i]];
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = f[k], w = f[(k + 1) % 3];
        if (v == w) continue;
        const std::array<std::uint32_t, 2> ends{std::min(v, w), std::max(v, w)};
        const auto edge = static_cast<std::uint32_t>(std::lower_bound(mesh.edges.begin(), mesh.edges.end(), ends) -
                                                     mesh.edges.begin());
        // mutant surface-edges-of-blocks: `[edge]` -> `[edge] && k < 2`
        if (!is_given[edge]) blocks.own_edges.push_back(edge);
        is_given[edge] = 1;
      }
    }
    blocks.own_edges_begin.push_back(static_cast<std::uint32_t>(blocks.own_edges.size()));
  }
}

void find_rings(SurfaceMesh& mesh) {
  InterruptPoller poll_interrupt(1u << 16);
  mesh.ring_begin.assign(mesh.rest.size() + 1, 0);
  for (const auto& edge : mesh.edges) {
    poll_interrupt();
    ++mesh.ring_begin[edge[0] + 1], ++mesh.ring_begin[edge[1] + 1];
  }
  for (std::size_t v = 0; v < mesh.rest.size(); ++v) mesh.ring_begin[v + 1] += mesh.ring_begin[v];
  mesh.ring.resize(2 * mesh.edges.size());
  std::vector<std::uint32_t> next(mesh.ring_begin.begin(), mesh.ring_begin.end() - 1);
  // The neighbors of a vertex ascend because edges do: first come the edges whose higher vertex it is, then the edges
  // whose lower vertex it is.
  for (const auto& edge : mesh.edges) {
    poll_interrupt();
    mesh.ring[next[edge[1]]++] = edge[0];
  }
  for (const auto& edge : mesh.edges) {
    poll_interrupt();
    mesh.ring[next[edge[0]]++] = edge[1];
  }
}

SurfaceMesh copy_and_link(const MeshView& mesh) {
  SurfaceMesh made;
  InterruptPoller poll_interrupt(1u << 16);
  made.facets.assign(mesh.facets.begin(), mesh.facets.end());
  made.rest.resize(mesh.vertex_count());
  for (std::size_t v = 0; v < made.rest.size(); ++v) {
    poll_interrupt();
    made.rest[v] = mesh.positions[v];
  }
  made.edges = all_edges(made.facets);
  find_rings(made);
  const Components components = components_by_vertices(mesh);
  made.component.assign(made.rest.size(), 0);
  for (std::size_t f = 0; f < made.facets.size(); ++f) {
    poll_interrupt();
    for (const std::uint32_t v : made.facets[f]) made.component[v] = components.of_facet[f];
  }
  return made;
}

SurfaceBlocks sort_into_blocks(const MeshView& view, const SurfaceMesh& mesh) {
  SurfaceBlocks blocks;
  Sorter(view, blocks.order).sort();
  InterruptPoller poll_interrupt(1u << 16);
  for (const std::uint32_t f : blocks.order) {
    poll_interrupt();
    blocks.facets_in_order.push_back(mesh.facets[f]);
  }
  give_vertices(mesh, blocks);
  give_edges(mesh, blocks);
  for (const std::uint32_t e : blocks.own_edges) {
    poll_interrupt();
    blocks.ends_of_own_edges.push_back(mesh.edges[e]);
  }
  return blocks;
}

}  // namespace

SurfaceTreeState make_surface_tree(const MeshView& mesh) {
  require_usable(mesh);
  require_usable_scale(mesh);
  SurfaceTreeState s;
  const Box box = bounding_box(mesh);
  s.origin = box.lower * 0.5 + box.upper * 0.5;
  s.rest_reach = std::max(max_norm(box.lower), max_norm(box.upper));
  s.mesh = copy_and_link(mesh);
  s.blocks = sort_into_blocks(mesh, s.mesh);
  s.boxes.vertices.resize(s.blocks.vertex_of_slot.size());
  s.next_vertex_boxes.resize(s.blocks.vertex_of_slot.size());
  s.boxes.make_levels(s.block_count());
  s.borders = region_borders(s.blocks.facets_in_order, s.blocks.slot_of_vertex, s.boxes.levels.size());
  return s;
}

}  // namespace morula::detail
