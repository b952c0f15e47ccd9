// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The promise of collision queries, tried on many poses: no crossing is missed.
#pragma once

#include "scenario.hpp"

namespace morula::bench {

/// So many random poses of pairs of small bodies, deformed and placed at random; every query interrupted somewhere,
/// resumed, carried to a next frame and interrupted there, against crossings of facets by brute force. On all workers.
Result sweep_poses(std::size_t poses, const Settings& settings);

}  // namespace morula::bench
