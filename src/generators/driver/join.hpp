// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Join: leaves judged, and children joined again where fewer are wanted than a generator made.
#pragma once

#include "generators/driver/top_down.hpp"

namespace morula::detail {

struct Verdict {
  double bound;  // of how far the sphere sticks out
  double gain;   // what there is to gain by dividing the node; the greatest is divided first
};

/// What two siblings would be as one.
struct Join {
  double cost;  // what is lost by it
  Sphere sphere;
  Verdict verdict;
};

/// Smallest sphere around two, as far as its radius goes: which siblings are close.
double common_radius(const Sphere& a, const Sphere& b);
/// The siblings' regions and cells as one, with the sphere given.
BuildNode joined(const BuildNode& a, const BuildNode& b, const Sphere& sphere);

class LeafScore {
 public:
  /// run.max_protrusion: 0 where only the number of spheres matters.
  LeafScore(const MeshView& mesh, const SignedDistance& shape, const BuildRun& run);

  Verdict operator()(const Sphere& sphere) const;

  /// The cost is how much more the common sphere takes in than the two do, or, where protrusion is what matters, how
  /// far it sticks out.
  Join join(const BuildNode& a, const Verdict& of_a, const BuildNode& b, const Verdict& of_b) const;
  /// Moves spheres that stick out by more than max_protrusion where they do not, if they can be, and joins siblings as
  /// long as their common sphere does not either.
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
