// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Join: scores of leaves, and children joined again if a generator made more than run.spheres.
#pragma once

#include "generators/driver/top_down.hpp"

namespace morula::detail {

struct Verdict {
  double bound;  // bound of the sphere's protrusion
  double gain;   // expected gain of dividing the node; the node with the greatest is divided first
};

/// The common node that two siblings would become.
struct Join {
  double cost;  // outside volume or protrusion that joining adds
  Sphere sphere;
  Verdict verdict;
};

/// Radius of the smallest sphere around two; it shows which siblings are close.
double common_radius(const Sphere& a, const Sphere& b);
/// The siblings' regions and cells as one, with the given sphere.
BuildNode joined(const BuildNode& a, const BuildNode& b, const Sphere& sphere);

class LeafScore {
 public:
  /// run.max_protrusion: 0 if only the number of spheres matters.
  LeafScore(const MeshView& mesh, const SignedDistance& shape, const BuildRun& run);

  Verdict operator()(const Sphere& sphere) const;

  /// The cost is the outside volume of the common sphere minus that of the two, or its protrusion, if a greatest
  /// protrusion is the aim.
  Join join(const BuildNode& a, const Verdict& of_a, const BuildNode& b, const Verdict& of_b) const;
  /// Moves spheres that stick out by more than max_protrusion to centers where they do not, if there are such centers.
  /// Then it joins siblings as long as their common sphere does not stick out more either.
  void make_few(Division& division) const;

 private:
  Sphere fitted(const std::vector<Vec3>& points, const Vec3& start) const;
  Sphere common_sphere(const BuildNode& a, const BuildNode& b) const;

  MeshView mesh_;
  const SignedDistance& shape_;
  double max_protrusion_, pad_;
};

/// Six significant digits at most.
std::string short_number(double value);

}  // namespace morula::detail
