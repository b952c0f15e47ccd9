// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Obstacle search: down a surface tree to the vertices or facets of blocks whose boxes an obstacle comes near.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <morula/surface/obstacles.hpp>
#include <optional>
#include <vector>

#include "parallel/float_environment.hpp"
#include "surface/boxes/box_node.hpp"
#include "surface/boxes/lazy_boxes.hpp"
#include "surface/boxes/tree_state.hpp"
#include "surface/pairs/pair_search.hpp"

namespace morula::detail {

/// It keeps its memory. A list of nodes holds the part of the tree that is not visited yet.
template <class Found>
class ObstacleSearch {
 public:
  void start(const SurfaceTreeState& surface, Workers& workers) {
    surface_ = &surface;
    kept_ = surface.weak_from_this().lock();
    frame_ = surface.frame;
    boxes_.start(surface, surface, 0, false, workers);
    candidates_ = 0;
    found_.clear();
    open_.assign(1, BoxNode::root(surface));
  }
  /// Resets the search to a new one.
  void forget() noexcept { *this = ObstacleSearch(); }
  bool is_started() const { return surface_ != nullptr; }
  bool is_current() const { return surface_->frame == frame_ && surface_->askable(0); }
  const SurfaceBoxes& boxes() const { return boxes_.a(); }
  const SurfaceTreeState& surface() const { return *surface_; }

  /// is_far(center, half): whether the box is away from the obstacle. narrow(corners, found): whether the vertex or
  /// facet with these vertices is near enough to be a candidate; it fills `found` except for its number. Workers call
  /// both. Returns changed_during_call if a callback has moved the surface.
  template <class IsFar, class Narrow>
  SurfaceQueryStatus run(const ObstacleOptions& options, Workers& workers, const IsFar& is_far, const Narrow& narrow) {
    SurfaceMeter meter(options.budget, options.clock, tests);
    if (meter.is_unlimited())
      run_all(meter, options, workers, is_far, narrow);
    else
      run_within_budget(meter, options, is_far, narrow);
    std::sort(found_.begin(), found_.end(), [](const Found& p, const Found& q) { return p.feature < q.feature; });
    list_open();
    // mutant surface-before-obstacle-moved: `if ... ()) return {{.code = Status::Code::changed_during_call}}` -> ``
    if (!is_current()) return {{.code = Status::Code::changed_during_call}};
    SurfaceQueryStatus status;
    status.finished = open_.empty();
    status.box_tests = tests * meter.groups_tested;
    status.candidates = candidates_;
    return status;
  }

  const std::vector<Found>& found() const { return found_; }
  const std::vector<std::span<const std::uint32_t>>& open() const { return open_facets_; }

 private:
  static constexpr std::size_t tests = 8;
  struct alignas(64) Chunk {
    std::vector<Found> found;
    std::size_t candidates = 0;
    void clear() { found.clear(), candidates = 0; }
  };

  // Visits nodes one after the other, so that a budget in tests always reaches the same nodes.
  template <class IsFar, class Narrow>
  void run_within_budget(SurfaceMeter& meter, const ObstacleOptions& options, const IsFar& is_far,
                         const Narrow& narrow) {
    if (chunks_.empty()) chunks_.resize(1);
    chunks_[0].clear();
    while (!open_.empty() && meter.try_spend(1)) {
      const BoxNode node = open_.back();
      open_.pop_back();
      if (node.is_block()) {
        visit(node.number, options, narrow, chunks_[0]);
        continue;
      }
      for (std::uint32_t bits = near_boxes(node, is_far); bits != 0;) {
        const auto i = static_cast<std::uint32_t>(std::bit_width(bits)) - 1;
        bits ^= 1u << i;
        open_.push_back(node.child(i));
      }
    }
    gather(1);
  }

  // Visits nodes level by level, each node by itself.
  template <class IsFar, class Narrow>
  void run_all(SurfaceMeter& meter, const ObstacleOptions& options, Workers& workers, const IsFar& is_far,
               const Narrow& narrow) {
    nodes_.clear();
    blocks_.clear();
    for (const BoxNode& node : open_) (node.is_block() ? blocks_ : nodes_).push_back(node);
    open_.clear();
    while (!nodes_.empty()) {
      near_.resize(nodes_.size());
      parallel_for(workers, nodes_.size(), 64, [&](std::size_t begin, std::size_t end) {
        const StandardFloats standard;
        for (std::size_t e = begin; e < end; ++e) near_[e] = static_cast<std::uint8_t>(near_boxes(nodes_[e], is_far));
      });
      meter.groups_tested += nodes_.size();
      next_.clear();
      for (std::size_t e = 0; e < nodes_.size(); ++e)
        for (std::uint32_t bits = near_[e]; bits != 0; bits &= bits - 1) {
          const BoxNode node = nodes_[e].child(static_cast<std::uint32_t>(std::countr_zero(bits)));
          (node.is_block() ? blocks_ : next_).push_back(node);
        }
      nodes_.swap(next_);
    }
    meter.groups_tested += blocks_.size();
    constexpr std::size_t blocks_at_once = 32;
    const std::size_t count = (blocks_.size() + blocks_at_once - 1) / blocks_at_once;
    if (chunks_.size() < count) chunks_.resize(count);
    parallel_for(workers, blocks_.size(), blocks_at_once, [&](std::size_t begin, std::size_t end) {
      const StandardFloats standard;
      Chunk& chunk = chunks_[begin / blocks_at_once];
      chunk.clear();
      for (std::size_t b = begin; b < end; ++b) visit(blocks_[b].number, options, narrow, chunk);
    });
    gather(count);
  }

  /// Bit i: box i of the group is not far.
  template <class IsFar>
  std::uint32_t near_boxes(const BoxNode& node, const IsFar& is_far) const {
    const BoxGroup& group = node.boxes(boxes_.a());
    // Bounds are floats about the origin, rounded outwards; added to it in double they are off by 2^-53 of the result.
    const double pad = 0x1p-50 * (max_norm(surface_->origin) + boxes_.a().extent);
    std::uint32_t near = 0;
    for (std::uint32_t i = 0; i < 8; ++i) {
      if (!(group.bound[0][i] <= group.bound[3][i])) continue;
      Vec3 center, half;
      for (int k = 0; k < 3; ++k) {
        const double lower = group.bound[k][i], upper = group.bound[k + 3][i];
        center[k] = surface_->origin[k] + 0.5 * (lower + upper);
        half[k] = 0.5 * (upper - lower) + pad;
      }
      if (!is_far(center, half)) near |= 1u << i;
    }
    return near;
  }

  template <class Narrow>
  void visit(std::uint32_t block, const ObstacleOptions& options, const Narrow& narrow, Chunk& chunk) const {
    const auto take = [&](std::uint32_t feature, std::span<const std::uint32_t> corners) {
      if (options.accepts && !options.accepts(feature)) return;
      std::optional<Found> found;
      if (!narrow(corners, found)) return;
      ++chunk.candidates;
      if (!found) return;
      found->feature = feature;
      chunk.found.push_back(*found);
    };
    const SurfaceTreeState& s = *surface_;
    if (options.features == ObstacleFeatures::vertices) {
      for (std::uint32_t slot = s.blocks.own_vertices[block]; slot < s.blocks.own_vertices[block + 1]; ++slot)
        take(s.blocks.vertex_of_slot[slot], std::span(&s.blocks.vertex_of_slot[slot], 1));
    } else {
      for (std::size_t i = 8 * std::size_t{block}; i < std::min(s.blocks.order.size(), 8 * std::size_t{block} + 8); ++i)
        take(s.blocks.order[i], s.blocks.facets_in_order[i]);
    }
  }

  void gather(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      found_.insert(found_.end(), chunks_[i].found.begin(), chunks_[i].found.end());
      candidates_ += chunks_[i].candidates;
    }
  }

  void list_open() {
    open_facets_.clear();
    for (const BoxNode& node : open_) open_facets_.push_back(facets_below(*surface_, node.number, node.height));
  }

  const SurfaceTreeState* surface_ = nullptr;
  std::shared_ptr<const SurfaceTreeState> kept_;  // the same state, if a SurfaceTree owns it
  std::uint64_t frame_ = 0;
  QueryBoxes boxes_;
  std::vector<BoxNode> open_, nodes_, next_, blocks_;
  std::vector<std::uint8_t> near_;
  std::vector<Chunk> chunks_;
  std::vector<Found> found_;
  std::size_t candidates_ = 0;
  std::vector<std::span<const std::uint32_t>> open_facets_;
};

}  // namespace morula::detail
