// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Steps of a haptic probe, and the distances of their moves from all facets by brute force.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <morula/surface/haptic_probe.hpp>
#include <string>
#include <support/numbers.hpp>

#include "../collide/placed_bodies.hpp"

namespace morula::test {

inline double slow_clearance(const PlacedBody& body, const Vec3& from, const Vec3& to) {
  double least = infinity;
  for (const Facet& f : body.mesh.facets)
    least = std::min(
        least, slow_segment_distance(from, to, {body.positions[f[0]], body.positions[f[1]], body.positions[f[2]]}));
  return least;
}

/// Checks that the moves of the last step kept their distance from all facets, in the body's coordinates.
inline void expect_clear_path(const HapticProbe& probe, const PlacedBody& body, double radius, double skin,
                              const std::string& what) {
  const auto path = probe.path();
  const double at_start = path.size() < 2 ? 0 : slow_clearance(body, path[1], path[1]);
  for (std::size_t k = 2; k < path.size(); ++k) {
    const double lost = static_cast<double>(k - 1) * skin / 64 + 1e-9 * skin;
    const double least = std::min(radius + skin * 7 / 8, at_start) - lost,
                 found = slow_clearance(body, path[k - 1], path[k]);
    ASSERT_GE(found, least) << what << ", move " << k - 1;
    ASSERT_GT(found, 0) << what << ", move " << k - 1;
  }
}

/// Steps until the proxy is settled.
inline HapticStep settle(HapticProbe& probe, const Collider& body, const Vec3& device, int most = 50) {
  HapticStep step = probe.step(body, device);
  for (int k = 0; k < most && step.status && !step.settled; ++k) step = probe.step(body, device);
  return step;
}

}  // namespace morula::test
