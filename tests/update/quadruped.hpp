// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A four-legged body like a game's character: 24 bones, four weights per vertex, and gaits.
#pragma once

#include <morula/geometry/mesh.hpp>
#include <morula/update/skin.hpp>
#include <vector>

namespace morula::test {

struct Quadruped {
  Mesh mesh;  ///< closed tubes around chains of bones; height and length about 2
  Skin skin;
  std::vector<Vec3> pivots;          ///< joint of each bone at rest
  std::vector<std::size_t> parents;  ///< parent of each bone, before it; the first is its own

  /// The transforms of a moment of a gait. phase: in turns. swing: largest angle of a joint, in radians; a walk has
  /// about 0.5.
  std::vector<AffineTransform> gait(double phase, double swing) const;
};

/// around: vertices around each tube; facets are proportional to its square, about 12,000 for 24.
Quadruped quadruped(int around);

}  // namespace morula::test
