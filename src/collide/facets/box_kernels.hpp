// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Kernels of boxes: one against many, the inner loop of all searches that prune facets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace morula::detail {

/// A closed box: lower x, y, z, then upper. An empty box meets nothing.
struct FloatBox {
  static constexpr float infinity = std::numeric_limits<float>::infinity();
  float bound[6] = {infinity, infinity, infinity, -infinity, -infinity, -infinity};

  void add(const FloatBox& b) {
    for (int k = 0; k < 3; ++k) {
      bound[k] = b.bound[k] < bound[k] ? b.bound[k] : bound[k];
      bound[k + 3] = b.bound[k + 3] > bound[k + 3] ? b.bound[k + 3] : bound[k + 3];
    }
  }
  /// The intersection of both; empty when they do not meet.
  FloatBox meet(const FloatBox& b) const {
    FloatBox common;
    for (int k = 0; k < 3; ++k) {
      common.bound[k] = bound[k] > b.bound[k] ? bound[k] : b.bound[k];
      common.bound[k + 3] = bound[k + 3] < b.bound[k + 3] ? bound[k + 3] : b.bound[k + 3];
    }
    return common;
  }
  bool is_empty() const { return !(bound[0] <= bound[3] && bound[1] <= bound[4] && bound[2] <= bound[5]); }
};

/// Boxes in columns: bound k of box i is column[k][i]. count: a multiple of box_list_step, filled up with empty boxes.
struct BoxList {
  const float* column[6];
  std::size_t count;
};
inline constexpr std::size_t box_list_step = 16;

struct BoxKernels {
  /// Writes the indices of the boxes that meet the given one, ascending, and returns their number. found: room for
  /// count.
  std::size_t (*select)(const BoxList& boxes, const FloatBox& box, std::uint32_t* found);
  /// The box of the boxes that meet the given one; empty when none does.
  FloatBox (*box_of_meeting)(const BoxList& boxes, const FloatBox& box);
};
/// The kernels that this processor runs, the narrowest first. All give the same results.
std::span<const BoxKernels> all_box_kernels();
/// The widest kernels.
const BoxKernels& box_kernels();

}  // namespace morula::detail
