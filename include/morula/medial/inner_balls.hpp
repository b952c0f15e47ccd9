// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Inner balls: a few balls inside an object that fill most of it.
#pragma once

#include <cstdint>
#include <morula/parallel/workers.hpp>
#include <morula/query/signed_distance.hpp>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

namespace morula {

struct InnerBallOptions {
  std::size_t candidates = 2000;       ///< points of the surface where balls are looked for
  double margin = 0;                   ///< every ball stays at least so far away from the surface
  double min_radius = 0;               ///< smaller ones are left out
  std::optional<double> max_radius{};  ///< larger ones are made smaller
  std::uint64_t seed = 1;
};

/// Medial balls of a mesh, each as large as its distance to the surface allows less the margin: no facet reaches into
/// one, and the surface winds round its center, so the whole of it is inside. None of a mesh that is not closed and
/// oriented (object.has_volume()). object: of this mesh. Same bits for any number of workers.
std::vector<Sphere> inner_ball_candidates(const MeshView& mesh, const SignedDistance& object,
                                          const InnerBallOptions& options = {}, WorkersOrAll workers = {});

/// At most `count` of the balls, the one that adds most volume first; fewer where the others would add nothing, or once
/// stopped. Volume is counted on a lattice of 40 points along the longest side of their box.
std::vector<Sphere> fullest_balls(std::span<const Sphere> balls, std::size_t count, const std::stop_token& stop = {});

}  // namespace morula
