// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Judging leaves, and joining children again where fewer are wanted than a generator made.
#pragma once

#include "build/top_down.hpp"

namespace morula {

struct Verdict {
  double bound;  // of how far the sphere sticks out
  double worth;  // what there is to gain by dividing the node; the greatest is divided first
};

/// Two siblings made one.
struct Join {
  double cost;  // what is lost by it
  BuildNode node;
  Verdict verdict;
  std::size_t first, second;  // which
};

class Judge {
 public:
  /// max_protrusion: 0 where only the number of spheres matters.
  Judge(const Mesh& mesh, const SignedDistance& shape, double max_protrusion);

  Verdict operator()(const Sphere& sphere) const;

  /// Of the closest pairs, the one whose common sphere takes in least more than the two do, or, where protrusion is
  /// what matters, sticks out least. verdicts: one per sibling. Nothing of fewer than two.
  std::optional<Join> cheapest_join(std::span<const BuildNode* const> siblings,
                                    std::span<const Verdict> verdicts) const;
  /// Moves spheres that stick out by more than max_protrusion where they do not, if they can be, and joins siblings as
  /// long as their common sphere does not either.
  void make_few(Division& division) const;

 private:
  Sphere fitted(const Region& region, const Vec3& start) const;
  BuildNode joined(const BuildNode& a, const BuildNode& b) const;

  const Mesh& mesh_;
  const SignedDistance& shape_;
  double max_protrusion_, pad_;
};

/// Six significant digits at most.
std::string short_number(double value);

}  // namespace morula
