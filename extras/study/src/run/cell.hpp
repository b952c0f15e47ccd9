// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Cells, measured; and as JSON, for the cache.
#pragma once

#include <memory>
#include <morula/parallel/threads.hpp>
#include <morula/parallel/workers.hpp>
#include <morula/query/signed_distance.hpp>
#include <morula/study/cell.hpp>

#include "json.hpp"
#include "run/measured_trees.hpp"
#include "run/pose_trees.hpp"
#include "run/poses.hpp"

namespace morula::study {

/// The poses of one motion, with the data that all its cells use.
struct Poses {
  MovedFrames motion;
  std::vector<std::unique_ptr<SignedDistance>> distances{};                     // one per pose; empty without an inside
  std::unique_ptr<PoseTrees> trees = std::make_unique<PoseTrees>();             // of rebuilds
  std::shared_ptr<MeasuredTrees> measured = std::make_shared<MeasuredTrees>();  // shared by motions of the body
};

/// Throws BuildStopped when the stop is requested. meter: of the body at rest.
MotionRun run_cell(const Plan& plan, const MotionRunKey& key, const CoveredTree& model, const Poses& poses,
                   const FollowRule& rule, const LoosenessMeter& meter, bool with_protrusion, const StopToken& stop);

/// Seconds of one update of the cell's body; none for rules that are no plain update.
std::optional<double> time_cell(const Plan& plan, const MotionRunKey& key, const CoveredTree& model, const Poses& poses,
                                const FollowRule& rule);

/// All measured figures.
Json stored_json(const MotionRun& cell);
/// Throws nlohmann::json::exception when the JSON is no cell.
MotionRun cell_from_json(const Json& json);

}  // namespace morula::study
