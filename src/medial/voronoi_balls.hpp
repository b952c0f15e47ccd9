// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Balls about the vertices of the Voronoi diagram of samples that are inserted one by one: Hubbard's medial balls
// [hubbard1996] and, kept up to date sample by sample, the balls of the adaptive medial axis [bradshaw2004].
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <morula/geometry/box.hpp>
#include <morula/query/signed_distance.hpp>
#include <optional>
#include <span>
#include <vector>

namespace morula::detail {

inline constexpr std::uint32_t no_sample = 0xffffffffu;
inline constexpr std::uint32_t no_ball = 0xffffffffu;

/// One Voronoi vertex: the ball through its four forming samples, with no sample inside; both to within the lattice.
struct VoronoiBall {
  Sphere ball;
  std::array<std::uint32_t, 4> samples;    ///< forming samples, by order of insertion
  std::array<std::uint32_t, 4> neighbors;  ///< balls that share three of them, opposite samples[k]; no_ball at the rim
  bool alive = false;                      ///< false: the slot is free
};

/// The diagram. Samples are rounded to a cubic lattice, 2²⁰ cells along the box's longest side, on which every decision
/// is exact: cospherical and grid-like samples need no special case. (Several balls may then be one and the same.)
/// Until four samples are not in one plane there are no balls; the sample that ends this brings those of all samples.
///
/// Properties of a ball's center are computed on first use, and kept while the ball is alive.
class VoronoiBalls {
 public:
  /// Samples must lie in the box. shape: borrowed.
  VoronoiBalls(const Box& box, const SignedDistance& shape);
  ~VoronoiBalls();

  /// Inserts a sample. Returns false, and nothing changes, if the sample coincides with an earlier one on the lattice
  /// or is not finite.
  bool insert(const Vec3& sample);
  /// Inserts many samples at once; returns the number inserted.
  std::size_t insert(std::span<const Vec3> samples);

  const std::vector<Vec3>& samples() const;       ///< the inserted samples
  const std::vector<VoronoiBall>& balls() const;  ///< slots; valid if alive
  /// Slots that the last successful insert freed, and slots that it filled. After an insert of many a slot can be in
  /// both: freed by one sample, filled by another.
  const std::vector<std::uint32_t>& removed() const;
  const std::vector<std::uint32_t>& created() const;

  // Properties of the centers of balls that are alive:

  /// Whether it is farther from the box than the box's diagonal: too far for the other properties.
  bool is_far(std::uint32_t slot) const;
  struct Closest {
    double distance;  ///< signed, to the object; negative inside; infinite if the center is far
    Vec3 point;       ///< point of the surface, at that distance; none if the center is far
  };
  const Closest& closest(std::uint32_t slot) const;
  double distance(std::uint32_t slot) const { return closest(slot).distance; }
  /// Sign of the distance: −1 inside, 0 on the surface, 1 outside. It mostly needs no distance query.
  int side(std::uint32_t slot) const;
  /// Nothing if the surface is farther than `most` from the center; that case takes less time.
  std::optional<Closest> closest_within(std::uint32_t slot, double most) const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace morula::detail
