// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bodies that collide, placed at random; and what brute force finds between them.
#pragma once

#include <memory>
#include <morula/collide/contacts.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/reproducible.hpp>
#include <string>
#include <support/transforms.hpp>
#include <vector>

namespace morula::test {

/// What builds in no time.
inline const BuildOptions quick{.method = Method::octree, .depth = 3};

/// A body with all that it hangs on, and where its vertices are.
struct Specimen {
  Specimen(std::string_view sample, int resolution, const BuildOptions& options, double scale = 1,
           const Vec3& offset = {});
  /// Random noise of every vertex and a random stretch; rest for an amplitude of 0.
  void deform(Random& random, double amplitude);
  void set_transform(const RigidTransform& transform) { collider->set_transform(transform); }

  Mesh mesh;
  CoveredTree model;
  std::unique_ptr<Body> body;
  std::unique_ptr<Collider> collider;
  std::vector<Vec3> positions;
  double size;  ///< diagonal of the box at rest
};

/// A point where an edge of one facet goes through the other facet.
struct Crossing {
  std::uint32_t facet_a, facet_b;
  Vec3 point;
};
/// In double, over all pairs of facets.
std::vector<Crossing> crossings_by_brute_force(const Collider& a, const Collider& b);

/// The crossings that no contact accounts for: both facets among those of its nodes, the point within its error bound.
std::size_t crossings_missed(const std::vector<Crossing>& crossings, const Collider& a, const Collider& b,
                             const std::vector<Contact>& contacts);

}  // namespace morula::test
