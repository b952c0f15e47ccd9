// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The update rules once more, plain and slow, in double and in mesh coordinates, straight from the paper's equations.
#pragma once

#include <morula/update/body.hpp>
#include <set>
#include <span>
#include <vector>

namespace morula::test {

/// What the rules ask of the rest mesh, found by looking at everything.
struct RestFacts {
  RestFacts(const Mesh& mesh, const CoveredTree& model);

  const Mesh& mesh;
  const CoveredTree& model;
  std::vector<std::vector<std::uint32_t>> children;  ///< per node
  std::vector<bool> touches;                         ///< per node: does a facet meet the ball?
  std::vector<std::set<std::uint32_t>> linked;       ///< per node: vertices of facets that meet it, or of the nearest
  std::vector<std::set<std::uint32_t>> enclosed;     ///< per node: vertices in it
  std::vector<std::set<std::uint32_t>> of_nearest;   ///< per node: vertices of the facet nearest to its center
  std::vector<double> vertex_area;
};

/// Spheres of all nodes after an update, by rules other than exact and modal. Nodes on levels of these two are taken
/// from the body's spheres at rest and now: their centers are not the paper's business.
struct Reference {
  std::vector<Sphere> rest, now;
};
Reference reference_update(const RestFacts& facts, const UpdateOptions& options, const std::vector<Vec3>& positions,
                           std::span<const Sphere> body_rest, std::span<const Sphere> body_now);

/// Radius of the smallest sphere about `center` that contains the node's region.
double owned_reach(const CoveredTree& model, std::uint32_t node, const Vec3& center,
                   const std::vector<Vec3>& positions);

}  // namespace morula::test
