// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Demo text: tables of the two experiments, what they show, and the same figures for machines.
#pragma once

#include <morula/study/run.hpp>
#include <morula/study/touch.hpp>
#include <string>
#include <vector>

#include "shared/report.hpp"

namespace morula::cli {

/// A study that followed motions there and back, with what was measured of it.
struct Demo {
  study::Plan plan;
  study::Result result;

  const study::NamedMesh& body(const study::TreeFigures& tree) const { return plan.body_of(tree.source); }
  const std::string& method(const study::TreeFigures& tree) const { return plan.sources[tree.source].method; }
  /// Of one tree, ascending by motion and rule.
  std::vector<const study::Run*> cells(const study::TreeFigures& tree) const;
};

std::string demo_table(const Demo& demo);
/// Sentences that hold for these figures: each one is chosen by looking at them.
std::vector<std::string> demo_findings(const Demo& demo);
std::string demo_csv(const Demo& demo);
Json demo_json(const Demo& demo);

std::string touch_table(const study::Touch& touch);
/// What the table shows: chosen by looking at the figures.
std::string touch_finding(const study::Touch& touch);
/// A crossing outside all contacts must never happen, at no budget.
std::vector<std::string> touch_faults(const study::Touch& touch);
std::string touch_csv(const study::Touch& touch);
Json touch_json(const study::Touch& touch);

}  // namespace morula::cli
