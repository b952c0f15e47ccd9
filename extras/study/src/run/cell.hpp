// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Cells, measured; and as JSON, for the cache.
#pragma once

#include <memory>
#include <morula/parallel/workers.hpp>
#include <morula/query/signed_distance.hpp>
#include <morula/study/cell.hpp>
#include <stop_token>

#include "json.hpp"
#include "run/poses.hpp"

namespace morula::study {

/// The poses of one motion, with what all cells of it ask.
struct Poses {
  MovedFrames motion;
  std::vector<std::unique_ptr<SignedDistance>> distances;  // one per pose; none of a mesh without inside
};

/// Throws BuildStopped when the stop is requested.
Run run_cell(const Plan& plan, const RunKey& key, const CoveredTree& model, const Poses& poses, const FollowRule& rule,
             bool with_protrusion, const std::stop_token& stop);

/// Seconds of one update of the cell's body; nothing of rules that are no plain update.
std::optional<double> time_cell(const Plan& plan, const RunKey& key, const CoveredTree& model, const Poses& poses,
                                const FollowRule& rule);

/// All that was measured.
Json stored_json(const Run& cell);
/// Throws nlohmann::json::exception when it is none.
Run cell_from_json(const Json& json);

}  // namespace morula::study
