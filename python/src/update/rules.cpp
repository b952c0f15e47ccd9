// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Update rules, and what an update and a binding report.
#include <morula/morula.hpp>
#include <string>
#include <vector>

#include "module.hpp"
#include "records.hpp"

namespace morula::python {

void bind_rules(nb::module_& m) {
  Record<UpdateStatus>(m, "UpdateStatus", "The work that an update did: the same on every run.")
      .field("nodes_updated", &UpdateStatus::nodes_updated)
      .field("vertices_read", &UpdateStatus::vertices_read, doc::UpdateStatus_vertices_read)
      .field("cut_points_moved", &UpdateStatus::cut_points_moved)
      .field("points_tested", &UpdateStatus::points_tested, doc::UpdateStatus_points_tested);
  Record<BindReport>(m, "BindReport", doc::BindReport)
      .field("void_spheres", &BindReport::void_spheres, doc::BindReport_void_spheres)
      .field("unlinked_spheres", &BindReport::unlinked_spheres, doc::BindReport_unlinked_spheres)
      .field("degenerate_anchors", &BindReport::degenerate_anchors, doc::BindReport_degenerate_anchors)
      .field("carried_centers", &BindReport::carried_centers, doc::BindReport_carried_centers)
      .field("corners_owned", &BindReport::corners_owned, doc::BindReport_corners_owned);
  Record<RuleTraits>(m, "RuleTraits", doc::RuleTraits)
      .property("name", [](const RuleTraits& t) { return std::string(t.name); })
      .property("follows",
                [](const RuleTraits& t) {
                  return t.follows == RuleTraits::Follows::positions ? "positions"
                         : t.follows == RuleTraits::Follows::modes   ? "modes"
                                                                     : "bones";
                })
      .field("covers", &RuleTraits::covers, doc::RuleTraits_covers);
  m.def(
      "all_rules",
      [] {
        std::vector<std::string> names;
        for (const Rule rule : all_rules()) names.emplace_back(name(rule));
        return names;
      },
      "Names of the update rules.");
  m.def(
      "position_rules",
      [] {
        std::vector<std::string> names;
        for (const Rule rule : position_rules()) names.emplace_back(name(rule));
        return names;
      },
      doc::position_rules);
  m.def(
      "rule_table", [] { return std::vector<RuleTraits>(rule_table.begin(), rule_table.end()); },
      "What is known of each rule.");
}

}  // namespace morula::python
