// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "accuracy/largest_gap.hpp"

#include <algorithm>

namespace morula::detail {
namespace {

constexpr auto lower_bound_first = [](const auto& a, const auto& b) { return a.upper < b.upper; };

// The corner opposite to the longest edge; the first of equals.
int apex_over_longest_edge(const Triangle& t) {
  int apex = 0;
  double longest = -1;
  for (int k = 0; k < 3; ++k) {
    const double squared = squared_distance(t[(k + 1) % 3], t[(k + 2) % 3]);
    if (squared > longest) longest = squared, apex = k;
  }
  return apex;
}

}  // namespace

double LargestGap::wanted() const {
  constexpr double relative = 5e-7;
  return best_ + std::max(relative * best_, 0.25 * tolerance_);
}

void LargestGap::look_at(const Vec3& x, std::uint32_t facet) {
  const double gap = diagram_->least_growth(std::span(&x, 1)).amount;
  if (gap > best_ || (gap == best_ && facet < best_facet_)) best_ = gap, best_facet_ = facet;
}

void LargestGap::push(const Piece& piece) {
  if (piece.upper <= wanted()) {
    dropped_ = std::max(dropped_, piece.upper);
    return;
  }
  pieces_.push_back(piece);
  std::push_heap(pieces_.begin(), pieces_.end(), lower_bound_first);
}

void LargestGap::add(std::span<const Vec3> polygon, std::uint32_t facet, double upper) {
  if (upper <= wanted()) {
    dropped_ = std::max(dropped_, upper);
    return;
  }
  for (const Vec3& x : polygon) look_at(x, facet);
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
    const Triangle corners{polygon[0], polygon[k], polygon[k + 1]};
    push({corners, facet, polygon.size() == 3 ? upper : std::min(upper, diagram_->least_growth(corners).amount)});
  }
}

void LargestGap::add(const LargestGap& other) {
  if (other.best_ > best_ || (other.best_ == best_ && other.best_facet_ < best_facet_))
    best_ = other.best_, best_facet_ = other.best_facet_;
  dropped_ = std::max(dropped_, other.dropped_);
  for (const Piece& p : other.pieces_) push(p);
}

void LargestGap::refine() {
  constexpr int most_halvings = 1 << 20;
  for (int i = 0; i < most_halvings && !pieces_.empty() && pieces_.front().upper > wanted(); ++i) {
    std::pop_heap(pieces_.begin(), pieces_.end(), lower_bound_first);
    const Piece piece = pieces_.back();
    pieces_.pop_back();
    const int apex = apex_over_longest_edge(piece.corners);
    const int from = (apex + 1) % 3, to = (apex + 2) % 3;
    const Vec3 middle = 0.5 * (piece.corners[from] + piece.corners[to]);
    look_at(middle, piece.facet);
    for (const int replaced : {from, to}) {
      Piece half = piece;
      half.corners[replaced] = middle;
      half.upper = std::min(piece.upper, diagram_->least_growth(half.corners).amount);
      push(half);
    }
  }
}

double LargestGap::upper() const {
  const double waiting = pieces_.empty() ? dropped_ : std::max(dropped_, pieces_.front().upper);
  return std::max(best_, waiting);
}

}  // namespace morula::detail
