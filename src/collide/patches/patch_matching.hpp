// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Which patch of a run is which patch of the run before.
#pragma once

#include <array>
#include <cstdint>
#include <morula/geometry/vector.hpp>
#include <span>
#include <vector>

namespace morula::detail {

/// A patch, by which the next run recognizes it: its centroid in the coordinates of both bodies, and the axis of a's
/// coordinates from which its sectors are counted.
struct KnownPatch {
  std::uint32_t id;
  std::array<Vec3, 2> centroid;
  double size;  ///< square root of its area
  int axis;
};

/// Matches patches of two runs, each with at most one. Two may match if the centroid moved, with either body, by no
/// more than the larger of both sizes. Of all matchings it is the one with the least sum of moves over sizes, where a
/// patch without a match counts 1: so a row of equal patches that slides by its spacing is not mistaken for its
/// neighbors. A patch may match one of the 16 known ones nearest to it.
class PatchMatching {
 public:
  /// Returns, for each present patch, the index of the known one, or `none`.
  std::span<const std::uint32_t> find(std::span<const KnownPatch> known, std::span<const KnownPatch> present);
  static constexpr std::uint32_t none = 0xffffffffu;

 private:
  struct Candidate {
    std::uint32_t known;
    double gain;  // 1 minus the move over the size
  };
  void keep_nearest();
  void augment(std::uint32_t patch);

  std::vector<Candidate> candidates_;
  std::vector<std::size_t> begin_;                          // of a present patch's candidates
  std::vector<std::uint32_t> known_of_, patch_of_, queue_;  // by present patch, by known patch
  // By known patch, in augment(): the largest gain of a path to it, the patch before it, and its own gain there.
  std::vector<double> best_, matched_gain_;
  std::vector<std::uint32_t> from_;
  std::vector<double> from_gain_;
};

}  // namespace morula::detail
