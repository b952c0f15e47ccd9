// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Re-owning: whole patches change hands between neighbouring leaves, a few in each frame, where that makes spheres
// tighter. Who owns what is settled here; the rule `exact` then measures what each leaf has.
#pragma once

#include <cstdint>
#include <memory>
#include <morula/geometry/sphere.hpp>
#include <morula/tree/cover.hpp>
#include <span>
#include <vector>

#include "simd/float4.hpp"
#include "update/points/ownership.hpp"

namespace morula::detail {

/// A cover of its own, which starts as the tree's. A value: copies are independent and share what never changes.
class Reowning {
 public:
  /// ownership: with a point for every cut point that a patch has as a corner. squared_reaches: of all nodes, in the
  /// pose that `points` are of, which is the one that the tree was made for.
  Reowning(std::shared_ptr<const CoveredTree> built, const LeafOrder& order, const Ownership& ownership,
           std::span<const std::uint32_t> point_of_vertex, std::span<const LocalPoint> points,
           std::span<const Spheref> spheres, std::span<const float> squared_reaches);

  /// One frame: the points, the spheres of all nodes, and how far these have to reach for what they own.
  struct Frame {
    std::span<const LocalPoint> points;
    std::span<const Spheref> spheres;
    std::span<const float> squared_reaches;
  };
  /// Lets patches change hands. Leaves that cost most come first, until some `most_tests` distances to corners
  /// have been taken. No node above a leaf comes to reach farther. No allocation. Returns the leaves, by their order,
  /// that own something else now; none that own nothing.
  std::span<const std::uint32_t> exchange(const Frame& frame, std::size_t most_tests) noexcept;

  /// Everyone owns again what the tree says.
  void give_back() noexcept;

  const Cover& cover() const { return cover_; }
  /// Tells dealings apart; 0 when everyone owns what the tree says.
  std::uint64_t dealing() const { return dealing_; }

  /// The points of all corners of what a leaf owns, each once, in no order. Good until the next call.
  std::span<const std::uint32_t> points_of(std::size_t leaf) noexcept;
  /// At most so many, over all leaves, whoever owns what.
  std::size_t most_points() const { return fixed_->points.size(); }

 private:
  // What never changes.
  struct Fixed {
    std::shared_ptr<const CoveredTree> built;
    std::vector<std::uint32_t> leaves, leaf_begin, leaf_end;  // as LeafOrder
    std::vector<std::uint32_t> points;                        // parallel to the corners of the tree's cover
    std::vector<float> area;                                  // of patches, at the pose that the tree was made for
    std::vector<std::uint32_t> at_begin, at;                  // the patches around each point
    std::vector<float> depth;                                 // of leaves, at that pose
  };
  // Of a leaf, in one frame.
  struct Leaf {
    float squared_reach = 0;
    float depth = 0;  // as measured last: from the centre to the nearest of what it owns
    float area = 0;
    std::uint64_t retry = 0, pause = 0;  // the first frame in which it is worth trying again, and how long it waited
    std::uint32_t first = 0, count = 0;
    bool changed = false;
  };
  struct Candidate {
    float gain;
    std::uint32_t leaf;
    bool operator<(const Candidate& o) const { return gain != o.gain ? gain < o.gain : leaf > o.leaf; }
  };
  struct Peeled {
    float squared;
    std::uint32_t patch;
    bool operator<(const Peeled& o) const { return squared != o.squared ? squared > o.squared : patch < o.patch; }
  };
  struct Recipient {
    std::uint32_t leaf;
    float squared_reach, area;
  };

  void start();
  std::span<const std::uint32_t> points_of_patch(std::uint32_t patch) const noexcept;
  float farthest(std::uint32_t patch, const Vec3f& center) noexcept;
  float nearest(std::uint32_t patch, const Vec3f& center) noexcept;
  bool stays_inside(std::uint32_t patch, std::uint32_t from, std::uint32_t to, const Frame& frame) noexcept;
  void attempt(std::uint32_t leaf, const Frame& frame) noexcept;
  void move(std::uint32_t patch, std::uint32_t to) noexcept;
  void mark(std::uint32_t leaf) noexcept;
  void write_cover() noexcept;

  std::shared_ptr<const Fixed> fixed_;
  Cover cover_;
  std::vector<std::uint32_t> owner_, next_, before_;  // of patches: the leaf, and its patches as a list
  std::vector<Leaf> leaves_;
  std::uint64_t dealing_ = 0, frame_ = 0;
  std::size_t tests_ = 0;
  std::span<const LocalPoint> points_{};  // of the frame at work
  // Room, so that no frame allocates.
  std::vector<Candidate> candidates_;
  std::vector<Peeled> peeled_;
  std::vector<Recipient> recipients_;
  std::vector<std::uint32_t> takers_, seen_, changed_, distinct_, listed_;
  std::uint32_t listing_ = 0;
  std::vector<std::uint32_t> spare_facet_, spare_begin_, spare_corners_;
};

}  // namespace morula::detail
