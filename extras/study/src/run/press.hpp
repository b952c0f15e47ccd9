// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Presses, measured; and as JSON, for the cache and for study.json.
#pragma once

#include <morula/parallel/threads.hpp>
#include <morula/study/press.hpp>
#include <morula/study/run.hpp>
#include <morula/tree/cover.hpp>

#include "json.hpp"

namespace morula::study {

/// A press from three sides. None for a body that cannot be bent, has no inside, or passes its copy from all of them;
/// `skipped` gets the parts left out, with reasons. built: any tree of the body; it speeds the search up and does not
/// affect the result.
std::optional<PressScene> make_press(const Plan& plan, std::size_t body, const CoveredTree& model,
                                     std::vector<Skipped>& skipped);

/// source: a place in Plan::pressed; rule: a place in Plan::press_rules. Throws BuildStopped when the stop is
/// requested.
PressCell run_press(const Plan& plan, std::size_t source, std::size_t rule, const CoveredTree& model,
                    const PressScene& scene, const StopToken& stop);

Json figures_json(const PressCell& cell);
/// Throws nlohmann::json::exception when it is none.
std::vector<PressFigures> figures_from_json(const Json& json);

}  // namespace morula::study
