// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "demo_text.hpp"
#include "shared/figures.hpp"
#include "shared/table.hpp"

namespace morula::cli {
namespace {

using study::Touch;
using study::TouchRow;

std::string budget_name(const TouchRow& row) {
  return row.budget ? std::to_string(*row.budget) : "unlimited";
}

}  // namespace

std::string touch_table(const Touch& touch) {
  Table table({"budget", "contacts", "finished", "crossings missed", "error bound", "pair tests", "time"});
  for (const TouchRow& row : touch.rows) {
    table.add({budget_name(row), fmt::format("{:.0f}", row.contacts), percent(row.finished_share),
               fmt::format("{} of {}", row.missed, touch.crossing_count()), percent(row.mean_error_bound),
               fmt::format("{:.0f}", row.pair_tests), fmt::format("{} µs", figure(1e6 * row.seconds))});
  }
  return table.text();
}

std::string touch_finding(const Touch& touch) {
  const std::vector<std::string> faults = touch_faults(touch);
  if (!faults.empty()) return faults.front() + ": that must not happen, please report it.";
  return fmt::format(
      "What a budget leaves undone stays in the answer as coarser contacts: less work makes contacts less exact, but "
      "none "
      "of the {} pairs of facets that cross is ever missed.",
      touch.crossing_count());
}

std::vector<std::string> touch_faults(const Touch& touch) {
  std::vector<std::string> faults;
  for (const TouchRow& row : touch.rows) {
    if (row.missed == 0) continue;
    faults.push_back(fmt::format("contacts MISS {} (budget {})", counted(row.missed, "crossing"), budget_name(row)));
  }
  return faults;
}

std::string touch_csv(const Touch& touch) {
  std::string text = "budget,contacts,finished_share,missed,crossings,mean_error_bound,pair_tests,microseconds\n";
  for (const TouchRow& row : touch.rows) {
    text +=
        fmt::format("{},{},{},{},{},{},{},{}\n", budget_name(row), exact_digits(row.contacts),
                    exact_digits(row.finished_share), row.missed, touch.crossing_count(),
                    exact_digits(row.mean_error_bound), exact_digits(row.pair_tests), exact_digits(1e6 * row.seconds));
  }
  return text;
}

Json touch_json(const Touch& touch) {
  Json rows = Json::array();
  for (const TouchRow& row : touch.rows) {
    rows.push_back({{"budget", row.budget ? Json(*row.budget) : Json(nullptr)},
                    {"contacts", row.contacts},
                    {"finished_share", row.finished_share},
                    {"missed", row.missed},
                    {"mean_error_bound", row.mean_error_bound},
                    {"pair_tests", row.pair_tests},
                    {"microseconds", 1e6 * row.seconds}});
  }
  return {{"frames", touch.crossings.size()},
          {"crossings", touch.crossings},
          {"finding", touch_finding(touch)},
          {"budgets", rows}};
}

}  // namespace morula::cli
