// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Judging leaves, and joining children again where fewer are wanted than a generator made.
#pragma once

#include "build/top_down.hpp"

namespace morula {

class Judge {
 public:
  /// max_protrusion: 0 where only the number of spheres matters.
  Judge(const Mesh& mesh, const SignedDistance& shape, double max_protrusion);

  /// Upper bound of how far the sphere sticks out.
  double bound(const Sphere& sphere) const { return shape_.protrusion_bound(sphere); }
  /// What there is to gain by dividing a node with this sphere.
  double worth(const Sphere& sphere) const;

  /// Joins siblings until at most `most` are left, each time those that then take in least more.
  void join_to(Division& division, std::size_t most) const;
  /// Joins siblings as long as the common sphere sticks out by no more than max_protrusion.
  void join_while_good(Division& division) const;

 private:
  BuildNode joined(const BuildNode& a, const BuildNode& b) const;

  const Mesh& mesh_;
  const SignedDistance& shape_;
  double max_protrusion_, pad_;
};

/// Six significant digits at most.
std::string short_number(double value);

}  // namespace morula
