// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "demo_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <morula/version.hpp>
#include <toolbox/stopwatch.hpp>

#include "shared/figures.hpp"
#include "shared/table.hpp"

namespace morula::cli {
namespace {

using study::MotionRun;
using study::TreeFigures;

/// The frames that are shown, the one at the full amount among them, are of the leaves.
const study::LevelFigures& leaves(const study::Sample& sample) {
  return sample.levels.back();
}

const study::LevelFigures& at_rest(const MotionRun& cell) {
  return leaves(cell.samples.front());
}

double rest_looseness(const MotionRun& cell) {
  return at_rest(cell).looseness_fixed().value_or(0);
}

std::string rule_name(const Demo& demo, const MotionRun& cell) {
  return demo.plan.rules[cell.key.rule].name;
}

bool is(const Demo& demo, const MotionRun& cell, Rule rule) {
  return demo.plan.rules[cell.key.rule].key() == study::RuleKey(rule);
}

std::string looseness_cell(const std::optional<double>& looseness, double uncovered_area) {
  return fmt::format("{} ({} uncovered)", figure_or_na(looseness), uncovered_area == 0 ? "0" : percent(uncovered_area));
}

std::string worst_cell(const MotionRun& cell) {
  const bool known = at_rest(cell).looseness_fixed().has_value();
  return looseness_cell(known ? std::optional(cell.worst_looseness_fixed()) : std::nullopt,
                        cell.worst_uncovered_area());
}

/// The median over motions of one rule's time.
double typical_microseconds(const Demo& demo, const TreeFigures& tree, std::size_t rule) {
  std::vector<double> times;
  for (const MotionRun* cell : demo.cells(tree))
    if (cell->key.rule == rule) times.push_back(1e6 * cell->update_seconds.value());
  return median(times);
}

struct Pair {
  const MotionRun* a;
  const MotionRun* b;
};

/// Cells of two rules with the same body, method and motion.
std::vector<Pair> pairs(const Demo& demo, Rule a, Rule b) {
  std::vector<Pair> list;
  for (const MotionRun& cell : demo.result.cells) {
    if (!is(demo, cell, a)) continue;
    const MotionRun* other = demo.result.find({cell.key.source, cell.key.motion, demo.plan.find_rule(b).value()});
    if (other != nullptr) list.push_back({&cell, other});
  }
  return list;
}

std::string where(const Demo& demo, const MotionRun& cell) {
  return fmt::format("{}, {} tree, {}", demo.plan.body_of(cell.key.source).name,
                     demo.plan.sources[cell.key.source].method,
                     study::describe_all(demo.plan.motions[cell.key.motion]));
}

bool fails_to_cover(const MotionRun& cell) {
  return !cell.certificate || !cell.certificate->covered || cell.worst_uncovered_area() > 0;
}

/// "all 12 cases", "3 of 12 cases": a case is a body, a tree and a motion.
std::string share_of(std::size_t count, std::size_t total) {
  return count == total ? fmt::format("all {} cases", total) : fmt::format("{} of {} cases", count, total);
}

std::string cover_finding(const Demo& demo) {
  std::size_t frames = 0;
  std::size_t cases = 0;
  const MotionRun* worst = nullptr;
  for (const MotionRun& cell : demo.result.cells) {
    if (!is(demo, cell, Rule::exact)) continue;
    ++cases;
    frames += cell.samples.size();
    if (fails_to_cover(cell)) worst = &cell;
  }
  if (worst != nullptr) {
    return fmt::format("exact FAILED to cover ({}): that must not happen, please report it.", where(demo, *worst));
  }
  return fmt::format(
      "exact leaves no surface uncovered: 0 in every one of its {} measurements, and its certificate held at every "
      "level in "
      "every frame of all {} cases.",
      frames, cases);
}

std::string approach2_finding(const Demo& demo) {
  const std::vector<Pair> list = pairs(demo, Rule::approach2, Rule::exact);
  const auto tighter = static_cast<std::size_t>(std::count_if(list.begin(), list.end(), [](const Pair& p) {
    return p.a->worst_looseness_fixed() < p.b->worst_looseness_fixed();
  }));
  const auto uncovered = static_cast<std::size_t>(
      std::count_if(list.begin(), list.end(), [](const Pair& p) { return p.a->worst_uncovered_area() > 0; }));
  const Pair most = *std::max_element(list.begin(), list.end(), [](const Pair& x, const Pair& y) {
    return x.a->worst_uncovered_area() < y.a->worst_uncovered_area();
  });
  const std::string tightness =
      tighter == 0 ? fmt::format("approach2 is nowhere tighter than exact")
                   : fmt::format("approach2 is tighter than exact in {}", share_of(tighter, list.size()));
  if (uncovered == 0) return tightness + ", and left no surface uncovered here, though nothing guarantees it.";
  return fmt::format(
      "{}, {} it leaves surface uncovered in {}, up to {} of it ({}): looseness alone would not show that.", tightness,
      tighter == 0 ? "and" : "but", share_of(uncovered, list.size()), percent(most.a->worst_uncovered_area()),
      where(demo, *most.a));
}

std::string approach1_finding(const Demo& demo) {
  const std::vector<Pair> list = pairs(demo, Rule::approach1, Rule::exact);
  const Pair most = *std::max_element(list.begin(), list.end(), [](const Pair& x, const Pair& y) {
    return x.a->worst_looseness_fixed() < y.a->worst_looseness_fixed();
  });
  const auto looser = static_cast<std::size_t>(std::count_if(list.begin(), list.end(), [](const Pair& p) {
    return p.a->worst_looseness_fixed() > p.b->worst_looseness_fixed();
  }));
  const auto uncovered = static_cast<std::size_t>(
      std::count_if(list.begin(), list.end(), [](const Pair& p) { return p.a->worst_uncovered_area() > 0; }));
  const std::string cover = uncovered == 0 ? "left no surface uncovered here"
                                           : "still leaves surface uncovered in " + share_of(uncovered, list.size());
  if (looser == 0) return fmt::format("approach1 is nowhere looser than exact, and {}.", cover);
  const double ratio = most.a->worst_looseness_fixed() / std::max(most.b->worst_looseness_fixed(), 1e-300);
  return fmt::format(
      "approach1 is looser than exact in {}, at worst {} object volumes where exact has {} ({}: {} times), and {}.",
      share_of(looser, list.size()), figure(most.a->worst_looseness_fixed()), figure(most.b->worst_looseness_fixed()),
      where(demo, *most.a), figure(ratio), cover);
}

std::string cost_finding(const Demo& demo) {
  const auto loosening = [](const MotionRun& cell) { return cell.worst_looseness_fixed() / rest_looseness(cell); };
  const MotionRun* most = nullptr;
  for (const MotionRun& cell : demo.result.cells) {
    if (!is(demo, cell, Rule::exact) || rest_looseness(cell) == 0) continue;
    if (most == nullptr || loosening(cell) > loosening(*most)) most = &cell;
  }
  // Of the largest body; among its trees the last, whose method is the default one.
  const TreeFigures* largest = &demo.result.trees.front();
  for (const TreeFigures& tree : demo.result.trees)
    if (demo.body(tree).mesh.vertex_count() >= demo.body(*largest).mesh.vertex_count()) largest = &tree;
  const auto time_of = [&](Rule rule) {
    return figure(typical_microseconds(demo, *largest, demo.plan.find_rule(rule).value()));
  };
  const std::string time =
      fmt::format("On {} ({} vertices, {} tree) approach2 takes {} µs per frame on one thread, exact {} µs",
                  demo.body(*largest).name, demo.body(*largest).mesh.vertex_count(), demo.method(*largest),
                  time_of(Rule::approach2), time_of(Rule::exact));
  if (most == nullptr) return time + ".";
  return fmt::format(
      "{}. The spheres of exact keep the patches they were built for and grow where these drift apart: most in {}, "
      "from {} at rest to {}.",
      time, where(demo, *most), figure(rest_looseness(*most)), figure(most->worst_looseness_fixed()));
}

}  // namespace

std::vector<const study::MotionRun*> Demo::cells(const TreeFigures& tree) const {
  std::vector<const MotionRun*> list;
  for (const MotionRun& cell : result.cells)
    if (cell.key.source == tree.source) list.push_back(&cell);
  return list;
}

std::string demo_table(const Demo& demo) {
  const std::vector<study::FollowRule>& rules = demo.plan.rules;
  std::vector<std::string> header{"body", "method", "motion"};
  for (const study::FollowRule& rule : rules) header.push_back(rule.name);
  Table table(header, 3);
  for (const TreeFigures& tree : demo.result.trees) {
    table.add_rule();
    const std::vector<const MotionRun*> cells = demo.cells(tree);
    std::vector<std::string> rest{demo.body(tree).name, demo.method(tree), "at rest"};
    std::vector<std::string> back{"", "", "back at rest"};
    std::vector<std::string> times{"", "", "time per frame"};
    for (std::size_t rule = 0; rule < rules.size(); ++rule) {
      const auto has_rule = [&](const MotionRun* cell) { return cell->key.rule == rule; };
      const auto any = std::find_if(cells.begin(), cells.end(), has_rule);
      if (any == cells.end()) continue;
      const bool returns = std::none_of(cells.begin(), cells.end(), [&](const MotionRun* cell) {
        return has_rule(cell) && !cell->returns_to_rest.value();
      });
      rest.push_back(looseness_cell(at_rest(**any).looseness_fixed(), at_rest(**any).uncovered_area()));
      back.emplace_back(returns ? "same bits" : "DIFFERS");
      const double time = typical_microseconds(demo, tree, rule);
      const auto vertices = static_cast<double>(demo.body(tree).mesh.vertex_count());
      times.push_back(fmt::format("{} µs, {} ns/v", figure(time), figure(1e3 * time / vertices)));
    }
    table.add(rest);
    for (std::size_t motion = 0; motion < demo.plan.motions.size(); ++motion) {
      std::vector<std::string> row{"", "", study::describe_all(demo.plan.motions[motion])};
      for (const MotionRun* cell : cells)
        if (cell->key.motion == motion) row.push_back(worst_cell(*cell));
      if (row.size() > 3) table.add(row);
    }
    table.add(back);
    table.add(times);
  }
  return table.text();
}

std::vector<std::string> demo_findings(const Demo& demo) {
  return {cover_finding(demo), approach2_finding(demo), approach1_finding(demo), cost_finding(demo)};
}

std::string demo_csv(const Demo& demo) {
  std::string text =
      "body,method,motion,rule,frame,parameter,looseness,missed_volume,uncovered_area,uncovered_distance,covered,"
      "microseconds_per_frame,"
      "nanoseconds_per_vertex,returns_to_rest\n";
  const auto digits = [](const std::optional<double>& value) { return value ? exact_digits(*value) : std::string(); };
  for (const MotionRun& cell : demo.result.cells) {
    const study::NamedMesh& body = demo.plan.body_of(cell.key.source);
    const double seconds = cell.update_seconds.value();
    for (const study::Sample& s : cell.samples) {
      const study::LevelFigures& f = leaves(s);
      text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", body.name,
                          demo.plan.sources[cell.key.source].method,
                          study::describe_all(demo.plan.motions[cell.key.motion]), rule_name(demo, cell), s.sample,
                          exact_digits(s.parameter), digits(f.looseness_fixed()), digits(f.lattice->missed_volume),
                          exact_digits(f.coverage.uncovered_area), exact_digits(f.coverage.uncovered_distance),
                          f.coverage.covered ? "yes" : "no", exact_digits(1e6 * seconds),
                          exact_digits(1e9 * seconds / static_cast<double>(body.mesh.vertex_count())),
                          cell.returns_to_rest.value() ? "yes" : "no");
    }
  }
  return text;
}

Json cell_json(const Demo& demo, const MotionRun& cell) {
  Json frames = Json::array();
  for (const study::Sample& s : cell.samples) {
    Json frame{{"frame", s.sample}, {"parameter", s.parameter}};
    frame.update(looseness_json(leaves(s).lattice.value()));
    frame.update(coverage_json(leaves(s).coverage));
    frames.push_back(frame);
  }
  const double seconds = cell.update_seconds.value();
  const auto vertices = static_cast<double>(demo.plan.body_of(cell.key.source).mesh.vertex_count());
  Json json{{"motion", study::describe_all(demo.plan.motions[cell.key.motion])},
            {"rule", rule_name(demo, cell)},
            {"worst_looseness", at_rest(cell).looseness_fixed() ? Json(cell.worst_looseness_fixed()) : Json(nullptr)},
            {"worst_uncovered_area", cell.worst_uncovered_area()},
            {"worst_uncovered_distance", cell.worst_uncovered_distance()},
            {"microseconds_per_frame", 1e6 * seconds},
            {"nanoseconds_per_vertex", 1e9 * seconds / vertices},
            {"returns_to_rest", cell.returns_to_rest.value()},
            {"certificate", nullptr},
            {"frames", frames}};
  if (cell.certificate)
    json["certificate"] = {{"covered", cell.certificate->covered}, {"worst_excess", cell.certificate->worst_excess}};
  return json;
}

Json demo_json(const Demo& demo) {
  Json trees = Json::array();
  for (const TreeFigures& tree : demo.result.trees) {
    const Mesh& mesh = demo.body(tree).mesh;
    const SphereTree& spheres = demo.result.model[tree.source].tree;
    Json cells = Json::array();
    for (const MotionRun* cell : demo.cells(tree)) cells.push_back(cell_json(demo, *cell));
    Json skipped = Json::array();
    for (const study::Skipped& s : demo.result.skipped)
      if (s.body == demo.plan.sources[tree.source].body) skipped.push_back(s.reason);
    trees.push_back({{"body", demo.body(tree).name},
                     {"method", demo.method(tree)},
                     {"vertices", mesh.vertex_count()},
                     {"facets", mesh.facet_count()},
                     {"spheres", spheres.node_count()},
                     {"leaves", spheres.leaf_count()},
                     {"build_seconds", tree.build_seconds},
                     {"voxel_edge", bounding_box(mesh).diagonal() / demo.plan.resolution},
                     {"skipped", skipped},
                     {"cells", cells}});
  }
  return {{"morula", version},
          {"frame_count", demo.plan.samples},
          {"measured_frames", demo.plan.measured},
          {"grid", {{"kind", "fixed"}, {"resolution", demo.plan.resolution}}},
          {"level", "leaves"},
          {"findings", demo_findings(demo)},
          {"trees", trees}};
}

}  // namespace morula::cli
