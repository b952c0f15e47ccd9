// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The adaptive medial axis of a node [bradshaw2004].
#pragma once

#include "generators/reduce/ball_set.hpp"
#include "generators/reduce/reduce.hpp"

namespace morula::detail {

/// Voronoi balls of points of the surface about the node. Points are added where a ball sticks out most, until all
/// stick out less than half as far as the node's sphere or there are enough. Nearly every sample is in a ball with its
/// center inside the object, or in one from outside that was chosen for that sample. Balls inscribed at a part of the
/// samples are added, because these exist on flat parts also.
///
/// The result may be empty: fewer than four samples, or all in one plane and none with a normal that a ball fits under.
/// Same bits for the same node. Cost: about 200 insertions into a diagram, and a query for every ball that they leave;
/// a few milliseconds.
BallSet adaptive_medial(const ReducerInput& node);

}  // namespace morula::detail
