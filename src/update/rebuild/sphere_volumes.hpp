// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What the spheres of an ownership take up in the present pose: by which it is seen whether another is tighter.
#pragma once

#include <morula/update/body.hpp>
#include <vector>

namespace morula::detail {

/// Σ r³ over every level set that counts, over the same of the home ownership at rest. Unlike an estimate of looseness
/// it counts many times what spheres share, so of ownerships only clear differences say something
/// (docs/rebuild.md#how-an-ownership-is-chosen); one pass over the spheres.
class SphereVolumes {
 public:
  /// home: at rest.
  explicit SphereVolumes(const Body& home);
  double of(const Body& body) const noexcept;

 private:
  std::vector<double> home_;  // per level set
};

}  // namespace morula::detail
