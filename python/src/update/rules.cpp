// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Update rules, and what an update and a binding report.
#include <morula/morula.hpp>
#include <morula/update/body.hpp>
#include <string>
#include <vector>

#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

void bind_rules(nb::module_& m) {
  Record<UpdateStatus>(m, "UpdateStatus", "The work of an update, the same in every run.")
      .field("nodes_updated", &UpdateStatus::nodes_updated)
      .field("vertices_read", &UpdateStatus::vertices_read, doc::UpdateStatus_vertices_read)
      .field("cut_points_moved", &UpdateStatus::cut_points_moved)
      .field("points_tested", &UpdateStatus::points_tested, doc::UpdateStatus_points_tested);
  Record<BindReport>(m, "BindReport", doc::BindReport)
      .field("void_spheres", &BindReport::void_spheres, doc::BindReport_void_spheres)
      .field("unlinked_spheres", &BindReport::unlinked_spheres, doc::BindReport_unlinked_spheres)
      .field("degenerate_anchors", &BindReport::degenerate_anchors, doc::BindReport_degenerate_anchors)
      .field("carried_centers", &BindReport::carried_centers, doc::BindReport_carried_centers)
      .field("corners_owned", &BindReport::corners_owned, doc::BindReport_corners_owned)
      .field("nodes_measured", &BindReport::nodes_measured, doc::BindReport_nodes_measured);
  Record<RuleTraits>(m, "RuleTraits", doc::RuleTraits)
      .property("name", [](const RuleTraits& t) { return std::string(t.name); })
      .property("follows",
                [](const RuleTraits& t) {
                  return t.follows == RuleTraits::Follows::positions ? "positions"
                         : t.follows == RuleTraits::Follows::modes   ? "modes"
                                                                     : "bones";
                })
      .property(
          "reads",
          [](const RuleTraits& t) {
            switch (t.reads) {
              case RuleTraits::Reads::corners:
                return "corners";
              case RuleTraits::Reads::links:
                return "links";
              case RuleTraits::Reads::children:
                return "children";
              case RuleTraits::Reads::nothing:
                break;
            }
            return "nothing";
          },
          doc::RuleTraits_Reads)
      .field("covers", &RuleTraits::covers, doc::RuleTraits_covers);
  m.def(
      "all_rules", [] { return names_of(all_rules()); }, "Names of the update rules.");
  m.def(
      "position_rules", [] { return names_of(position_rules()); }, doc::position_rules);
  m.def(
      "rule_table", [] { return std::vector<RuleTraits>(rule_table.begin(), rule_table.end()); },
      "The properties of each rule.");
  const auto rules_of = [](const std::vector<std::string>& names) {
    if (names.empty()) throw std::invalid_argument("rules: at least one is needed");
    std::vector<Rule> rules;
    for (const std::string& rule : names) rules.push_back(choice<Rule>(rule, "rules", rule_from_name, all_rules()));
    return rules;
  };
  m.def(
      "rule_of_level",
      [rules_of](const std::vector<std::string>& rules, std::size_t level) {
        return std::string(name(rule_of_level(rules_of(rules), level)));
      },
      nb::arg("rules"), nb::arg("level"), doc::rule_of_level);
  m.def(
      "describe_rules",
      [rules_of](const std::vector<std::string>& rules, std::size_t level_count) {
        return describe_rules(rules_of(rules), level_count);
      },
      nb::arg("rules"), nb::arg("level_count"), doc::describe_rules);
}

}  // namespace morula::python
