// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The driver that every generator goes through: each node's region is divided among children, level by level, or the
// worst leaf first.
#pragma once

#include <functional>
#include <morula/query/signed_distance.hpp>

#include "generators/driver/build_node.hpp"
#include "generators/driver/build_run.hpp"

namespace morula::detail {

class ObjectLines;

/// What a generator has for the driver. Pointers are borrowed.
struct DriverInput {
  Divider divide;            ///< returns at most run.branching children with non-empty regions
  Box root_cell = {};        ///< of the root node
  LevelHook new_level = {};  ///< level by level only
  /// Of the mesh; null: made where it is needed.
  const SignedDistance* distance = nullptr;
  /// Of the mesh. With lines no level is looser than the level above it.
  const ObjectLines* lines = nullptr;
  /// Called when no level is divided any more, so that what only dividing needs is gone when the cover takes its
  /// memory; not where the worst leaf is first.
  std::function<void()> divided = {};
};

/// Whether the run asks for a number of spheres or a protrusion instead of a depth: then the worst leaf is divided
/// first.
inline bool is_worst_first(const BuildRun& run) {
  return run.spheres > 0 || run.max_protrusion > 0;
}
CoveredTree top_down(const Mesh& mesh, const BuildRun& run, const DriverInput& input, Workers& workers);

}  // namespace morula::detail
