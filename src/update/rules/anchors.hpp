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
/// Where the weights reproduce c0, e is zero and an affine map of the anchors moves the center along.
/// Where it is not, e = c0 - sum w x0 is carried by axes of three anchors, so that at least a rigid one does. The
/// axes are built anew from positions alone; nothing remembers the frame before.
struct CenterTie {
  std::uint32_t begin = 0, end = 0;  ///< range in points and weights, of which the next is `step` entries on
  std::uint32_t step = 1;
  bool carries = false;                 ///< e is not zero
  bool degenerate = false;              ///< as in AnchorChoice
  std::array<std::uint32_t, 3> axes{};  ///< anchors; repeated ones where they are collinear or fewer
  Vec3f in_axes;                        ///< e in the coordinates of these axes
  Vec3f rest_carried;                   ///< e, by the very routine that runs per frame
};

/// Ties of many centers, with what they share.
class Anchors {
 public:
  /// Adds a tie to some of the candidates (choose_anchors); without any the center stays where it is.
  void tie(const Vec3f& center, float radius, std::span<const LocalPoint> rest_points,
           std::span<const std::uint32_t> candidates);

  /// Adds the ties of another, in order.
  void append(const Anchors& others);
  /// After the last: lays anchors side by side, so that centers() may be asked.
  void pack();

  std::size_t size() const { return ties_.size(); }
  const CenterTie& operator[](std::size_t k) const { return ties_[k]; }
  /// visit(point) for each anchor of center k.
  template <class Visit>
  void each_point(std::size_t k, const Visit& visit) const {
    for (std::uint32_t i = ties_[k].begin; i < ties_[k].end; i += ties_[k].step) visit(points_[i]);
  }
  /// Where center k is now. At rest exactly where it was tied, because both differences are.
  Vec3f center(std::size_t k, std::span<const LocalPoint> points) const noexcept;
  /// The same, bit for bit, for centers begin … end - 1, where begin is a multiple of nodes_per_group. centers has room
  /// for whole groups; those beyond the last center are of no use.
  void centers(std::size_t begin, std::size_t end, std::span<const LocalPoint> points,
               LocalPoint* centers) const noexcept;
  /// For some, ascending.
  void centers(std::span<const std::uint32_t> some, std::span<const LocalPoint> points,
               LocalPoint* centers) const noexcept;

 private:
  Vec3f weighted_sum(const CenterTie& tie, std::span<const LocalPoint> points) const noexcept;

  std::vector<CenterTie> ties_;
  // Of each tie, apart from what few frames read: c0, and sum w x0 by the very routine that runs per frame.
  struct AtRest {
    Vec3f center, sum;
  };
  std::vector<AtRest> at_rest_;
  std::vector<std::uint32_t> points_;
  std::vector<float> weights_;
  // When packed: the ties that carry a remainder, with what a kernel reads of them, and where the groups of
  // nodes_per_group nodes begin in points_ and weights_, and the end.
  std::vector<std::uint32_t> carrying_;
  std::array<std::vector<std::uint32_t>, 3> axes_;
  std::array<std::vector<float>, 3> in_axes_, rest_carried_;
  std::vector<std::uint32_t> group_begin_;
};

}  // namespace morula::detail
