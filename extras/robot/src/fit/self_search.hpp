// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Single changes of a link's spheres that reduce false self-collisions.
#pragma once

#include <memory>
#include <vector>

#include "fit/self_table.hpp"

namespace morula::robot {

/// A change that may be the next step.
struct Candidate {
  Change change{};
  std::size_t added = 0;  // number of spheres
  double score = -1;      // decrease of the objective per sphere; 0 or less: there is no change
};

/// The inputs of a search; all are borrowed.
struct SelfSearch {
  OverlapTable& table;
  const std::vector<std::unique_ptr<PieceMaker>>& makers;  // per link
  const std::vector<std::vector<Pieces>>& fits;            // per number of spheres and link: fits of whole links
  const std::vector<bool>& stays;                          // per link
  std::size_t samples;                                     // number of all samples
  double volume;                                           // of all links in one sphere each
  const StopToken& stop;

  /// The gain is the decrease of the objective by a change: the costs of overlaps, and outside volume. present: volume
  /// of the link's spheres; below 0: it is computed.
  OverlapTable::Effect effect_of(const Change& change, double& present) const;
  /// The best change of a link that adds spheres or moves one. Safe to call for different links at once.
  Candidate best_change(std::size_t link) const;
  /// Leaves out spheres of a link as long as one increases the objective by less than `worth`.
  void leave_out(std::size_t link, double worth, Workers& workers);

 private:
  std::vector<std::pair<std::size_t, Vec3>> most_blamed(std::size_t link) const;
  Change cheapest_without(std::size_t link, double worth, Workers& workers) const;
};

}  // namespace morula::robot
