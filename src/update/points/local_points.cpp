// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/points/local_points.hpp"

#include <algorithm>
#include <cmath>

#include "parallel/interruption.hpp"
#include "update/points/narrow.hpp"

namespace morula::detail {
namespace {

constexpr std::uint32_t vertices_per_stretch = 128;
constexpr std::size_t stretches_per_chunk = 32;
constexpr std::size_t cut_points_per_chunk = 1024;

bool is_ascending_from_zero(std::span<const std::uint32_t> items) {
  for (std::uint32_t i = 0; i < items.size(); ++i)
    if (items[i] != i) return false;
  return true;
}

}  // namespace

VertexNumbers::VertexNumbers(std::size_t mesh_vertex_count, std::span<const std::uint32_t> vertices)
    : count_(vertices.size()) {
  if (is_ascending_from_zero(vertices)) return;
  point_of_.assign(mesh_vertex_count, no_point);
  for (std::uint32_t i = 0; i < count_; ++i) point_of_[vertices[i]] = i;
}

Vec3 OriginGuide::origin_of(const PositionView& positions) const noexcept {
  return origin_near(rest_origin + (positions[vertex] - vertex_rest), size);
}

LocalPoints::LocalPoints(const MeshView& rest, const Cover& cover, const Ownership& ownership)
    : numbers_(rest.vertex_count(), ownership.vertices) {
  add_stretches(rest.vertex_count());
  add_cuts(cover, ownership);
  points_.resize(vertex_count() + cut_point_count());
  changed_ = {.stretches = Marks(stretches_.size()), .blocks = Marks(block_count()), .cuts = Marks(cut_point_count())};
  list_cuts_of_blocks();
  const Box box = bounding_box(rest);
  guide_.rest_origin = box.center();
  guide_.size = max_norm(box.extent());
  guide_.vertex = *std::min_element(ownership.vertices.begin(), ownership.vertices.end());
  guide_.vertex_rest = rest.positions[guide_.vertex];
}

void LocalPoints::add_stretches(std::size_t mesh_vertex_count) {
  for (std::uint32_t v = 0; v < mesh_vertex_count; ++v) {
    if (!numbers_.is_used(v)) continue;
    // mutant local-gap: `stretches_.back().end ... || v - stretches_.back().begin =` -> `v - stretches_.back().begin >`
    if (stretches_.empty() || stretches_.back().end != v || v - stretches_.back().begin == vertices_per_stretch)
      stretches_.push_back({v, v});
    stretches_.back().end = v + 1;
  }
  stretch_largest_.resize(stretches_.size());
}

void LocalPoints::add_cuts(const Cover& cover, const Ownership& ownership) {
  for (const std::uint32_t k : ownership.cut_points) {
    const CutPoint& c = cover.cut_points[k];
    // Heaviest first, then in order; weights 0 last.
    std::array<int, 3> by_weight{0, 1, 2};
    std::stable_sort(by_weight.begin(), by_weight.end(), [&](int i, int j) { return c.weight[i] > c.weight[j]; });
    const auto point = [&](int rank) { return point_of(c.vertex[by_weight[rank]]); };
    const auto weight = [&](int rank) { return static_cast<float>(c.weight[by_weight[rank]]); };
    // A vertex without weight may be any vertex, even one that no facet uses.
    if (is_on_edge(c))
      cuts_.on_edges.push_back({{point(0), point(c.weight[by_weight[1]] == 0 ? 0 : 1)}, weight(1)});
    else
      cuts_.in_facets.push_back({{point(0), point(1), point(2)}, weight(1), weight(2)});
  }
  // The slack is computed over all cut points: a certificate also tests those that no leaf has to test.
  for (const CutPoint& c : cover.cut_points)
    // mutant local-weight-slack-one-way: `std::abs( ... - 1)` -> `c.weight[0] + c.weight[1] + c.weight[2] - 1`
    cuts_.weight_slack = std::max(cuts_.weight_slack, std::abs(c.weight[0] + c.weight[1] + c.weight[2] - 1));
}

void LocalPoints::list_cuts_of_blocks() {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> cuts;
  for (std::uint32_t cut = 0; cut < cut_point_count(); ++cut)
    each_block(static_cast<std::uint32_t>(vertex_count()) + cut,
               [&](std::uint32_t block) { cuts.emplace_back(block, cut); });
  cuts_.of_block = BlockLists(std::move(cuts), block_count());
}

LocalPoints::Frame LocalPoints::move_about(const Vec3& origin, const PositionView& positions,
                                           Workers& workers) noexcept {
  const Uninterrupted whole;
  origin_ = origin;
  parallel_for(workers, stretch_largest_.size(), stretches_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t stretch = begin; stretch < end; ++stretch) narrow_stretch(positions, stretch);
  });
  const Frame frame = finished_frame(positions);
  if (frame.finite) move_cut_points(workers);
  return frame;
}

LocalPoints::Frame LocalPoints::move_changed(const PositionView& positions,
                                             std::span<const VertexRange> changed) noexcept {
  changed_.clear();
  for (const VertexRange& range : changed) mark(range);
  changed_.stretches.each([&](std::uint32_t stretch) {
    changed_.vertices += stretches_[stretch].end - stretches_[stretch].begin;
    narrow_stretch(positions, stretch);
  });
  changed_.blocks.each([&](std::uint32_t block) {
    for (const std::uint32_t cut : cuts_.of_block.of(block)) changed_.cuts.add(cut);
  });
  const Frame frame = finished_frame(positions);
  if (!frame.finite) return frame;
  // Consecutive vertices are narrowed at once.
  std::uint32_t begin = 0, end = 0;
  changed_.cuts.each([&](std::uint32_t cut) {
    ++changed_.cut_points;
    if (cut != end) move_cuts(begin, end), begin = cut;
    end = cut + 1;
  });
  move_cuts(begin, end);
  return frame;
}

// Marks the stretches and blocks in which the range has vertices that facets use.
void LocalPoints::mark(const VertexRange& range) noexcept {
  constexpr auto per_block = static_cast<std::uint32_t>(vertices_per_block);
  const auto first = std::partition_point(stretches_.begin(), stretches_.end(),
                                          [&](const VertexRange& s) { return s.end <= range.begin; });
  // mutant local-stretch: `begin <` -> `begin + 1 <`
  for (auto s = first; s != stretches_.end() && s->begin < range.end; ++s) {
    changed_.stretches.add(static_cast<std::uint32_t>(s - stretches_.begin()));
    const std::uint32_t begin = std::max(s->begin, range.begin), end = std::min(s->end, range.end);
    // Vertices in the mesh's order share blocks with their neighbors.
    for (std::uint32_t v = begin; v < end; v = numbers_.is_mesh_order() ? (v / per_block + 1) * per_block : v + 1)
      changed_.blocks.add(point_of(v) / per_block);
  }
}

void LocalPoints::narrow_stretch(const PositionView& positions, std::size_t stretch) noexcept {
  const auto [begin, end] = stretches_[stretch];
  stretch_largest_[stretch] = numbers_.is_mesh_order() ? narrow(positions, begin, end - begin, origin_, &points_[begin])
                                                       : narrow_scattered(positions, begin, end - begin, origin_,
                                                                          numbers_.points_from(begin), points_.data());
}

// The frame after all vertices are narrowed.
LocalPoints::Frame LocalPoints::finished_frame(const PositionView& positions) const noexcept {
  Frame frame;
  frame.origin = origin_;
  const float largest = *std::max_element(stretch_largest_.begin(), stretch_largest_.end());
  // mutant local-range: `largest_local_coordinate` -> `1e30f`
  if (!(largest <= largest_local_coordinate && max_norm(origin_) <= largest_origin_coordinate)) {
    frame.finite = false;
    frame.first_bad_vertex = first_bad_vertex(positions, origin_);
    return frame;
  }
  // mutant local-weight-slack: `cuts_.weight_slack` -> `0`
  // mutant local-origin: `max_norm(origin_)` -> `0`
  frame.rounding = {static_cast<double>(largest), max_norm(origin_), cuts_.weight_slack};
  return frame;
}

void LocalPoints::move_cut_points(Workers& workers) noexcept {
  parallel_for(workers, cut_point_count(), cut_points_per_chunk,
               [&](std::size_t begin, std::size_t end) { move_cuts(begin, end); });
}

// Cuts on edges come first.
void LocalPoints::move_cuts(std::size_t begin, std::size_t end) noexcept {
  const std::size_t on_edges = cuts_.on_edges.size(), edge_end = std::min(end, on_edges);
  if (begin < edge_end)
    kernels().move_edge_cuts(points_.data(), &cuts_.on_edges[begin], edge_end - begin,
                             &points_[vertex_count() + begin]);
  const std::size_t inner_begin = std::max(begin, on_edges);
  if (inner_begin < end)
    kernels().move_inner_cuts(points_.data(), &cuts_.in_facets[inner_begin - on_edges], end - inner_begin,
                              &points_[vertex_count() + inner_begin]);
}

// A rare path, so it runs on one thread: the result cannot depend on chunks.
std::size_t LocalPoints::first_bad_vertex(const PositionView& positions, const Vec3& origin) const noexcept {
  const bool far = !(max_norm(origin) <= largest_origin_coordinate);
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (!numbers_.is_used(v)) continue;
    const Vec3f p(positions[v] - origin);
    const bool good = std::abs(p.x) <= largest_local_coordinate && std::abs(p.y) <= largest_local_coordinate &&
                      std::abs(p.z) <= largest_local_coordinate;
    if (far || !good) return v;
  }
  return positions.size();
}

}  // namespace morula::detail
