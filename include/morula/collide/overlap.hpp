// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Overlap of two bodies: yes or no, as early as possible.
#pragma once

#include <morula/collide/collider.hpp>

namespace morula {

/// Does a leaf sphere of a overlap a leaf sphere of b, and all spheres above them? False is a proof, whatever the
/// rounding: the surfaces have no point in common, where the spheres cover (rules exact and modal, wrapped over those,
/// or conservative). True says that they are near each other: nearer than the leaves are wide.
///
/// Surfaces: a body wholly inside another one is not an overlap by itself. Allocates nothing.
/// Throws std::invalid_argument when the last update of a body was refused.
bool overlap(const Collider& a, const Collider& b);

}  // namespace morula
