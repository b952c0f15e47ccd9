// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What the demo says: one table, what it shows, and the same figures for machines.
#pragma once

#include <string>
#include <vector>

#include "demo/run.hpp"
#include "shared/report.hpp"

namespace morula::cli {

std::string demo_table(const std::vector<DemoTree>& trees);
/// Sentences that hold for these figures: each one is chosen by looking at them.
std::vector<std::string> demo_findings(const std::vector<DemoTree>& trees);
/// What must never happen: surface bare under the rule exact, or spheres that do not return to rest.
std::vector<std::string> demo_faults(const std::vector<DemoTree>& trees);

std::string demo_csv(const std::vector<DemoTree>& trees);
Json demo_json(const DemoPlan& plan, const std::vector<DemoTree>& trees);

}  // namespace morula::cli
