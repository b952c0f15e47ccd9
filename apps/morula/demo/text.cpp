// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "demo/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <morula/version.hpp>

#include "shared/figures.hpp"
#include "shared/table.hpp"

namespace morula::cli {
namespace {

std::vector<const DemoCell*> cells_of(const DemoTree& tree, const std::string& motion) {
  std::vector<const DemoCell*> cells;
  for (const DemoCell& cell : tree.cells) {
    if (cell.motion == motion) cells.push_back(&cell);
  }
  return cells;
}

std::vector<std::string> motions_of(const DemoTree& tree) {
  std::vector<std::string> motions;
  for (const DemoCell& cell : tree.cells) {
    if (std::find(motions.begin(), motions.end(), cell.motion) == motions.end()) motions.push_back(cell.motion);
  }
  return motions;
}

std::string looseness_cell(const std::optional<double>& looseness, double bare_area) {
  return fmt::format("{} ({} bare)", figure_or_na(looseness), bare_area == 0 ? "0" : percent(bare_area));
}

std::string worst_cell(const DemoCell& cell) {
  const bool known = cell.frames.front().looseness.looseness.has_value();
  return looseness_cell(known ? std::optional(cell.worst_looseness()) : std::nullopt, cell.worst_bare_area());
}

/// The median over motions of one rule's time.
double typical_microseconds(const DemoTree& tree, Rule rule) {
  std::vector<double> times;
  for (const DemoCell& cell : tree.cells) {
    if (cell.rule == rule) times.push_back(cell.microseconds);
  }
  return median(times);
}

struct Pair {
  const DemoCell* a;
  const DemoCell* b;
};

/// Cells of two rules with the same body, method and motion.
std::vector<Pair> pairs(const std::vector<DemoTree>& trees, Rule a, Rule b) {
  std::vector<Pair> list;
  for (const DemoTree& tree : trees) {
    for (const DemoCell& first : tree.cells) {
      for (const DemoCell& second : tree.cells) {
        if (first.rule == a && second.rule == b && first.motion == second.motion) list.push_back({&first, &second});
      }
    }
  }
  return list;
}

std::string where(const DemoCell& cell) {
  return fmt::format("{}, {} tree, {}", cell.body, name(cell.method), cell.motion);
}

/// "all 12 cases", "3 of 12 cases": a case is a body, a tree and a motion.
std::string share_of(std::size_t count, std::size_t total) {
  return count == total ? fmt::format("all {} cases", total) : fmt::format("{} of {} cases", count, total);
}

std::string cover_finding(const std::vector<DemoTree>& trees) {
  std::size_t frames = 0;
  std::size_t cases = 0;
  const DemoCell* worst = nullptr;
  for (const DemoTree& tree : trees) {
    for (const DemoCell& cell : tree.cells) {
      if (cell.rule != Rule::exact) continue;
      ++cases;
      frames += cell.frames.size();
      if (!cell.certified || cell.worst_bare_area() > 0) worst = &cell;
    }
  }
  if (worst != nullptr) {
    return fmt::format("exact FAILED to cover ({}): that must not happen, please report it.", where(*worst));
  }
  return fmt::format(
      "exact leaves no surface bare: 0 in every one of its {} measurements, and its certificate held at every level in "
      "every frame of all {} cases.",
      frames, cases);
}

std::string approach2_finding(const std::vector<DemoTree>& trees) {
  const std::vector<Pair> list = pairs(trees, Rule::approach2, Rule::exact);
  const auto tighter = static_cast<std::size_t>(std::count_if(
      list.begin(), list.end(), [](const Pair& p) { return p.a->worst_looseness() < p.b->worst_looseness(); }));
  const auto bare = static_cast<std::size_t>(
      std::count_if(list.begin(), list.end(), [](const Pair& p) { return p.a->worst_bare_area() > 0; }));
  const Pair most = *std::max_element(list.begin(), list.end(), [](const Pair& x, const Pair& y) {
    return x.a->worst_bare_area() < y.a->worst_bare_area();
  });
  const std::string tightness =
      tighter == 0 ? fmt::format("approach2 is nowhere tighter than exact")
                   : fmt::format("approach2 is tighter than exact in {}", share_of(tighter, list.size()));
  if (bare == 0) return tightness + ", and left nothing bare here, though nothing guarantees it.";
  return fmt::format("{}, {} it leaves surface bare in {}, up to {} of it ({}): looseness alone would not show that.",
                     tightness, tighter == 0 ? "and" : "but", share_of(bare, list.size()),
                     percent(most.a->worst_bare_area()), where(*most.a));
}

std::string approach1_finding(const std::vector<DemoTree>& trees) {
  const std::vector<Pair> list = pairs(trees, Rule::approach1, Rule::exact);
  const Pair most = *std::max_element(list.begin(), list.end(), [](const Pair& x, const Pair& y) {
    return x.a->worst_looseness() < y.a->worst_looseness();
  });
  const auto looser = static_cast<std::size_t>(std::count_if(
      list.begin(), list.end(), [](const Pair& p) { return p.a->worst_looseness() > p.b->worst_looseness(); }));
  const auto bare = static_cast<std::size_t>(
      std::count_if(list.begin(), list.end(), [](const Pair& p) { return p.a->worst_bare_area() > 0; }));
  const std::string cover =
      bare == 0 ? "left nothing bare here" : "still leaves surface bare in " + share_of(bare, list.size());
  if (looser == 0) return fmt::format("approach1 is nowhere looser than exact, and {}.", cover);
  const double ratio = most.a->worst_looseness() / std::max(most.b->worst_looseness(), 1e-300);
  return fmt::format(
      "approach1 is looser than exact in {}, at worst {} object volumes where exact has {} ({}: {} times), and {}.",
      share_of(looser, list.size()), figure(most.a->worst_looseness()), figure(most.b->worst_looseness()),
      where(*most.a), figure(ratio), cover);
}

std::string cost_finding(const std::vector<DemoTree>& trees) {
  const DemoCell* most = nullptr;
  for (const DemoTree& tree : trees) {
    for (const DemoCell& cell : tree.cells) {
      if (cell.rule != Rule::exact || cell.rest_looseness() == 0) continue;
      if (most == nullptr ||
          cell.worst_looseness() / cell.rest_looseness() > most->worst_looseness() / most->rest_looseness()) {
        most = &cell;
      }
    }
  }
  // Of the largest body; among its trees the last, whose method is the default one.
  const DemoTree* largest = &trees.front();
  for (const DemoTree& tree : trees) {
    if (tree.vertices >= largest->vertices) largest = &tree;
  }
  const std::string time = fmt::format(
      "On {} ({} vertices, {} tree) approach2 takes {} µs per frame on one thread, exact {} µs", largest->body,
      largest->vertices, name(largest->method), figure(typical_microseconds(*largest, Rule::approach2)),
      figure(typical_microseconds(*largest, Rule::exact)));
  if (most == nullptr) return time + ".";
  return fmt::format(
      "{}. The spheres of exact keep the patches they were built for and grow where these drift apart: most in {}, "
      "from {} "
      "at "
      "rest to {}.",
      time, where(*most), figure(most->rest_looseness()), figure(most->worst_looseness()));
}

}  // namespace

std::string demo_table(const std::vector<DemoTree>& trees) {
  std::vector<std::string> header{"body", "method", "motion"};
  for (const Rule rule : demo_rules) header.emplace_back(name(rule));
  Table table(header, 3);
  for (const DemoTree& tree : trees) {
    table.add_rule();
    const std::vector<std::string> motions = motions_of(tree);
    std::vector<std::string> rest{tree.body, std::string(name(tree.method)), "at rest"};
    std::vector<std::string> back{"", "", "back at rest"};
    std::vector<std::string> times{"", "", "time per frame"};
    for (const Rule rule : demo_rules) {
      bool returns = true;
      const DemoCell* any = nullptr;
      for (const DemoCell& cell : tree.cells) {
        if (cell.rule != rule) continue;
        returns = returns && cell.returns_to_rest;
        if (any == nullptr) any = &cell;
      }
      if (any == nullptr) continue;
      rest.push_back(looseness_cell(any->frames.front().looseness.looseness, any->frames.front().coverage.bare_area));
      back.emplace_back(returns ? "same bits" : "DIFFERS");
      const double time = typical_microseconds(tree, rule);
      times.push_back(
          fmt::format("{} µs, {} ns/v", figure(time), figure(1e3 * time / static_cast<double>(tree.vertices))));
    }
    table.add(rest);
    for (const std::string& motion : motions) {
      std::vector<std::string> row{"", "", motion};
      for (const DemoCell* cell : cells_of(tree, motion)) row.push_back(worst_cell(*cell));
      table.add(row);
    }
    table.add(back);
    table.add(times);
  }
  return table.text();
}

std::vector<std::string> demo_findings(const std::vector<DemoTree>& trees) {
  return {cover_finding(trees), approach2_finding(trees), approach1_finding(trees), cost_finding(trees)};
}

std::vector<std::string> demo_faults(const std::vector<DemoTree>& trees) {
  std::vector<std::string> faults;
  for (const DemoTree& tree : trees) {
    for (const DemoCell& cell : tree.cells) {
      if (!cell.returns_to_rest) {
        faults.push_back(fmt::format("{} does not return to rest ({})", name(cell.rule), where(cell)));
      }
      if (cell.rule == Rule::exact && (!cell.certified || cell.worst_bare_area() > 0)) {
        faults.push_back(fmt::format("exact leaves surface bare ({})", where(cell)));
      }
    }
  }
  return faults;
}

std::string demo_csv(const std::vector<DemoTree>& trees) {
  std::string text =
      "body,method,motion,rule,frame,parameter,looseness,missed_volume,bare_area,gap,covered,microseconds_per_frame,"
      "nanoseconds_per_vertex,returns_to_rest\n";
  const auto digits = [](const std::optional<double>& value) { return value ? exact_digits(*value) : std::string(); };
  for (const DemoTree& tree : trees) {
    for (const DemoCell& cell : tree.cells) {
      for (const FrameFigures& f : cell.frames) {
        text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", cell.body, name(cell.method), cell.motion,
                            name(cell.rule), f.frame, exact_digits(f.parameter), digits(f.looseness.looseness),
                            digits(f.looseness.missed_volume), exact_digits(f.coverage.bare_area),
                            exact_digits(f.coverage.gap), f.coverage.covered ? "yes" : "no",
                            exact_digits(cell.microseconds), exact_digits(cell.nanoseconds_per_vertex),
                            cell.returns_to_rest ? "yes" : "no");
      }
    }
  }
  return text;
}

Json demo_json(const DemoPlan& plan, const std::vector<DemoTree>& trees) {
  Json trees_json = Json::array();
  for (const DemoTree& tree : trees) {
    Json cells = Json::array();
    for (const DemoCell& cell : tree.cells) {
      Json frames = Json::array();
      for (const FrameFigures& f : cell.frames) {
        Json frame{{"frame", f.frame}, {"parameter", f.parameter}};
        frame.update(looseness_json(f.looseness));
        frame.update(coverage_json(f.coverage));
        frames.push_back(frame);
      }
      const bool known = cell.frames.front().looseness.looseness.has_value();
      Json json{{"motion", cell.motion},
                {"rule", name(cell.rule)},
                {"worst_looseness", known ? Json(cell.worst_looseness()) : Json(nullptr)},
                {"worst_bare_area", cell.worst_bare_area()},
                {"worst_gap", cell.worst_gap()},
                {"microseconds_per_frame", cell.microseconds},
                {"nanoseconds_per_vertex", cell.nanoseconds_per_vertex},
                {"returns_to_rest", cell.returns_to_rest},
                {"certificate", nullptr},
                {"frames", frames}};
      if (cell.rule == Rule::exact) {
        json["certificate"] = {{"covered", cell.certified}, {"worst_excess", cell.worst_excess}};
      }
      cells.push_back(json);
    }
    trees_json.push_back({{"body", tree.body},
                          {"method", name(tree.method)},
                          {"vertices", tree.vertices},
                          {"facets", tree.facets},
                          {"spheres", tree.spheres},
                          {"leaves", tree.leaves},
                          {"build_seconds", tree.build_seconds},
                          {"voxel_edge", tree.voxel_edge},
                          {"skipped", tree.skipped},
                          {"cells", cells}});
  }
  return {{"morula", version},
          {"frame_count", plan.frame_count},
          {"measured_frames", measured_frames(plan.frame_count)},
          {"grid", {{"kind", "fixed"}, {"resolution", plan.resolution}}},
          {"level", "leaves"},
          {"findings", demo_findings(trees)},
          {"trees", trees_json}};
}

}  // namespace morula::cli
