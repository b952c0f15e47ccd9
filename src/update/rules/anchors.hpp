// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Centers of the exact rule: each is tied to a few points of the surface, its anchors, and moves with them.
#pragma once

#include <array>
#include <cstdint>
#include <morula/geometry/vector.hpp>
#include <span>
#include <vector>

#include "simd/float4.hpp"

namespace morula::detail {

/// A center c as a function of its anchors x, with weights w that add up to 1:
///   c = c0 + (sum w x - sum w x0) + (turned(e) - e)      x0: at rest
/// If the weights reproduce c0, e is zero and an affine map of the anchors moves the center along. If not, axes of
/// three anchors carry e = c0 - sum w x0, so that a rigid map at least moves it along. The axes are computed from
/// positions alone; no state of another frame enters them.
struct CenterTie {
  std::uint32_t begin = 0, end = 0;  ///< range in points and weights; the entries of a tie are `step` apart
  std::uint32_t step = 1;
  bool carries = false;                 ///< e is not zero
  bool degenerate = false;              ///< flag of the AnchorChoice
  std::array<std::uint32_t, 3> axes{};  ///< anchors; repeated ones if they are collinear or fewer
  Vec3f in_axes;                        ///< e in the coordinates of these axes
  Vec3f rest_carried;                   ///< e, by the routine that runs per frame
};

/// Ties of many centers, with their shared data.
class Anchors {
 public:
  /// Adds a tie to a few of the candidates (choose_anchors); without candidates the center stays.
  void tie(const Vec3f& center, float radius, std::span<const LocalPoint> rest_points,
           std::span<const std::uint32_t> candidates);

  /// Adds the ties of another, in order.
  void append(const Anchors& others);
  /// Lays anchors side by side; called after the last tie and before centers().
  void pack();

  std::size_t size() const { return ties_.size(); }
  const CenterTie& operator[](std::size_t k) const { return ties_[k]; }
  /// Calls visit(point) for each anchor of center k.
  template <class Visit>
  void each_point(std::size_t k, const Visit& visit) const {
    for (std::uint32_t i = ties_[k].begin; i < ties_[k].end; i += ties_[k].step) visit(points_[i]);
  }
  /// Position of center k in the frame. At rest it is exactly where it was tied, because both differences are zero.
  Vec3f center(std::size_t k, std::span<const LocalPoint> points) const noexcept;
  /// Writes the centers begin … end - 1, with the bits of center(). begin is a multiple of nodes_per_group. centers has
  /// room for whole groups; entries beyond the last center are meaningless.
  void centers(std::size_t begin, std::size_t end, std::span<const LocalPoint> points,
               LocalPoint* centers) const noexcept;
  /// Writes the centers of the given ties, ascending.
  void centers(std::span<const std::uint32_t> some, std::span<const LocalPoint> points,
               LocalPoint* centers) const noexcept;

 private:
  Vec3f weighted_sum(const CenterTie& tie, std::span<const LocalPoint> points) const noexcept;

  std::vector<CenterTie> ties_;
  // State at rest of each tie, stored apart from the members that every frame reads: c0, and sum w x0 by the routine
  // that runs per frame.
  struct AtRest {
    Vec3f center, sum;
  };
  std::vector<AtRest> at_rest_;
  std::vector<std::uint32_t> points_;
  std::vector<float> weights_;
  // Packed data: the ties that carry a remainder, with the inputs of the kernel, and the begins of the groups of
  // nodes_per_group nodes in points_ and weights_, and the end.
  std::vector<std::uint32_t> carrying_;
  std::array<std::vector<std::uint32_t>, 3> axes_;
  std::array<std::vector<float>, 3> in_axes_, rest_carried_;
  std::vector<std::uint32_t> group_begin_;
};

}  // namespace morula::detail
