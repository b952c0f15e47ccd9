// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Balls about the vertices of the Voronoi diagram of samples that are inserted one by one: Hubbard's medial balls
// [hubbard1996] and, kept up to date sample by sample, those of the adaptive medial axis [bradshaw2004].
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <morula/geometry/box.hpp>
#include <morula/query/signed_distance.hpp>
#include <vector>

namespace morula {

inline constexpr std::uint32_t no_sample = 0xffffffffu;
inline constexpr std::uint32_t no_ball = 0xffffffffu;

/// One Voronoi vertex: the ball through its four forming samples, with no sample inside.
struct VoronoiBall {
  Sphere ball;
  double distance;                         ///< signed distance of the centre to the object; negative inside
  std::array<std::uint32_t, 4> samples;    ///< forming samples, by order of insertion
  std::array<std::uint32_t, 4> neighbors;  ///< balls that share three of them, opposite samples[k]; no_ball at the rim
  bool alive = false;                      ///< false: the slot is free
};

/// The diagram. Samples are rounded to an integer lattice, 2²⁰ across the box, on which every decision is exact:
/// cospherical and grid-like samples need no special case.
class VoronoiBalls {
 public:
  /// Samples must lie in the box. shape: borrowed.
  VoronoiBalls(const Box& box, const SignedDistance& shape);
  ~VoronoiBalls();

  /// False, and nothing changed, when the sample coincides with an earlier one on the lattice or cannot be told apart.
  bool insert(const Vec3& sample);

  const std::vector<Vec3>& samples() const;      ///< those inserted
  const std::vector<VoronoiBall>& balls() const;  ///< slots; look at alive
  /// Slots that the last successful insert freed, and those it filled.
  const std::vector<std::uint32_t>& removed() const;
  const std::vector<std::uint32_t>& created() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace morula
