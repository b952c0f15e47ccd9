// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <map>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/triangle.hpp>
#include <morula/study/study.hpp>
#include <morula/update/body.hpp>
#include <nlohmann/json.hpp>
#include <set>
#include <support/scratch_folder.hpp>

#include "small_plan.hpp"

namespace morula::study {
namespace {

Plan small_plan() {
  Plan plan = coarse_plan({}, {Rule::approach2, Rule::exact});
  plan.bodies.push_back({"prism", needle_prism(6)});
  plan.sources = sources_of(plan.bodies, {Method::octree, Method::grid});
  return plan;
}

TEST(StudyRun, a_cell_is_what_the_library_measures_step_by_step) {
  const Plan plan = small_plan();
  const Result result = run(plan);
  ASSERT_EQ(result.cells.size(), 2u * 2 * 2 * 2);
  EXPECT_EQ(result.mixes.size(), 0u);
  EXPECT_TRUE(result.skipped.empty());
  const std::size_t rule = plan.find_rule(Rule::approach2).value();
  const MotionRun* cell = result.find({1, 1, rule});
  ASSERT_NE(cell, nullptr);
  ASSERT_EQ(cell->samples.size(), 4u);

  const Mesh& rest = plan.bodies[0].mesh;
  const CoveredTree model = build(rest, {.method = Method::grid, .branching = 4, .depth = 2});
  Body body(rest, model, {.rules = {Rule::approach2}});
  Mesh moved = rest;
  moved.positions = deform(rest, {Bend{60}}, 2.0 / 3);
  ASSERT_TRUE(body.update(moved.positions));
  const std::vector<Sphere> leaves = level_set_spheres(body.current_tree(), 2);
  const LevelFigures* figures = cell->at(2, 2);
  ASSERT_NE(figures, nullptr);
  EXPECT_EQ(figures->spheres, leaves.size());
  EXPECT_EQ(figures->looseness(), looseness(moved, leaves, {.resolution = 24}).looseness);
  EXPECT_EQ(figures->uncovered_area(), coverage(moved, leaves).uncovered_area);
  EXPECT_EQ(figures->uncovered_distance(), coverage(moved, leaves).uncovered_distance / bounding_box(rest).diagonal());
  EXPECT_TRUE(cell->returns_to_rest.value());
  EXPECT_FALSE(cell->certificate);
  EXPECT_FALSE(cell->update_seconds);
}

TEST(StudyRun, cells_ascend_and_each_is_found_by_its_key) {
  Plan plan = small_plan();
  plan.rules.emplace_back(fresh);
  const Result result = run(plan);
  for (std::size_t i = 0; i < result.cells.size(); ++i) {
    EXPECT_EQ(result.find(result.cells[i].key), &result.cells[i]);
    if (i > 0) {
      EXPECT_LT(result.cells[i - 1].key, result.cells[i].key);
    }
  }
  EXPECT_EQ(result.find({4, 0, 0}), nullptr);
  EXPECT_EQ(result.find({0, 0, 3}), nullptr);
  const MotionRun* anew = result.find({0, 0, 2});
  ASSERT_NE(anew, nullptr);
  EXPECT_EQ(anew->samples.size(), 2u);  // rest and the full amount
  EXPECT_FALSE(anew->returns_to_rest);
}

TEST(StudyRun, keeps_trees_of_the_first_body_or_of_all) {
  Plan plan = small_plan();
  plan.rules = {Rule::exact};
  Result result = run(plan);
  EXPECT_GT(result.model[1].tree.node_count(), 0u);
  EXPECT_EQ(result.model[3].tree.node_count(), 0u);
  plan.keep_trees = true;
  result = run(plan);
  EXPECT_GT(result.model[3].tree.node_count(), 0u);
}

TEST(StudyRun, there_and_back_certified_and_timed) {
  Plan plan = small_plan();
  plan.samples = 5;
  plan.and_back = true;
  plan.measured = {0, 2, 4};
  plan.of_levels = {2};
  plan.measures = {.paper_grid = false, .protrusion = false, .certificate = true, .timed_updates = 2};
  Workers two(2);
  const Result result = run(plan, two);
  for (const MotionRun& cell : result.cells) {
    ASSERT_EQ(cell.samples.size(), 3u);
    const LevelFigures &first = cell.samples[0].levels.at(0), &last = cell.samples[2].levels.at(0);
    EXPECT_EQ(first.looseness_fixed(), last.looseness_fixed());
    EXPECT_FALSE(first.looseness());
    EXPECT_FALSE(first.protrusion);
    EXPECT_GT(cell.update_seconds.value(), 0);
    const bool is_exact = plan.rules[cell.key.rule].key() == RuleKey(Rule::exact);
    ASSERT_EQ(cell.certificate.has_value(), is_exact);
    if (is_exact) {
      EXPECT_TRUE(cell.certificate->covered);
    }
  }
  for (const TreeFigures& tree : result.trees) EXPECT_GT(tree.build_seconds, 0);
}

TEST(StudyRun, only_trees_that_were_built_in_a_run_with_times_have_a_time) {
  Plan plan = small_plan();
  plan.rules = {Rule::traditional};
  plan.measures = {.paper_grid = false, .protrusion = false, .timed_updates = 1};
  const test::ScratchFolder folder;
  const Cache cache(folder.path());
  const RunOptions options{.cache = &cache};
  for (const TreeFigures& tree : run(plan, serial_workers(), options).trees) EXPECT_GT(tree.build_seconds, 0);
  for (const TreeFigures& tree : run(plan, serial_workers(), options).trees) EXPECT_EQ(tree.build_seconds, 0);
  plan.measures.timed_updates = 0;
  for (const TreeFigures& tree : run(plan).trees) EXPECT_EQ(tree.build_seconds, 0);
}

TEST(StudyRun, same_figures_for_any_workers_from_the_cache_and_after_a_stop) {
  const Plan plan = small_plan();
  const std::string expected = cells_csv(plan, run(plan));
  const test::ScratchFolder folder;
  const Cache cache(folder.path());
  StopSource stop;
  std::atomic<int> steps = 0;
  const auto stop_half_way = [&](double, std::string) {
    if (++steps == 9) stop.request_stop();
  };
  Workers three(3);
  EXPECT_THROW(run(plan, three, {&cache, stop.get_token(), stop_half_way}), Stopped);
  const Result continued = run(plan, three, {.cache = &cache});
  EXPECT_EQ(cells_csv(plan, continued), expected);
  EXPECT_GT(continued.taken_from_cache, 0u);
  EXPECT_LT(continued.taken_from_cache, continued.cell_count());
  const Result again = run(plan, serial_workers(), {.cache = &cache});
  EXPECT_EQ(cells_csv(plan, again), expected);
  EXPECT_EQ(again.taken_from_cache, again.cell_count());
}

/// A plan with two seeds, whose later trials measure less.
Plan seeded_plan() {
  Plan plan = small_plan();
  plan.seeds = {1, 2};
  plan.sources = sources_of(plan.bodies, {Method::octree, Method::hubbard}, plan.seeds);
  plan.rules = {Rule::approach2, Rule::exact, fresh};
  plan.press_rules = {Rule::exact};
  plan.samples = 5;
  plan.decisive = {0, 2, 4};
  plan.measures.half_grid = true;
  return plan;
}

TEST(StudyRun, trees_of_methods_that_are_not_random_are_the_same_for_every_seed) {
  const Mesh mesh = sample_body("limb", 8);
  for (const Method method : all_methods()) {
    const auto tree_of = [&](std::uint64_t seed) {
      return tree_hash(build(mesh, {.method = method, .branching = 4, .depth = 2, .seed = seed}).tree);
    };
    EXPECT_EQ(tree_of(1) != tree_of(2), is_random(method)) << name(method);
  }
}

TEST(StudyRun, later_seeds_measure_what_decides_and_nothing_else) {
  const Plan plan = seeded_plan();
  ASSERT_EQ(plan.sources.size(), 6u);  // octree, hubbard, hubbard for each body
  const Result result = run(plan);
  const std::size_t fresh_rule = plan.find_rule(fresh).value();
  for (std::size_t s = 0; s < plan.sources.size(); ++s) {
    const bool first = plan.is_first_seed(plan.sources[s]);
    for (std::size_t m = 0; m < plan.motions.size(); ++m) {
      EXPECT_EQ(result.find({s, m, fresh_rule}) != nullptr, first);
      const MotionRun* cell = result.find({s, m, 0});
      ASSERT_NE(cell, nullptr);
      ASSERT_EQ(cell->samples.size(), first ? 5u : 3u);
      for (const std::size_t sample : plan.decisive) {
        const LevelFigures* figures = cell->at(sample, 2);
        ASSERT_NE(figures, nullptr);
        EXPECT_TRUE(figures->looseness());
        EXPECT_EQ(figures->looseness_fixed().has_value(), first);
        EXPECT_EQ(figures->protrusion.has_value(), first);
        EXPECT_EQ(figures->half_grid.has_value(), first);
      }
    }
  }
  for (const PressCell& cell : result.presses) EXPECT_TRUE(plan.is_first_seed(plan.pressed(cell.source)));
  // Each trial decides the same claims from what it has, and the trees without a seed are shared.
  const std::vector<Trial> trials = plan.trials();
  ASSERT_EQ(trials.size(), 4u);
  for (const Trial& trial : trials) {
    EXPECT_EQ(plan.sources_of(trial).size(), 2u);
    const std::vector<Claim> claims = make_claims(plan, result, trial, nullptr);
    EXPECT_EQ(find_claim(claims, "exact-covers")->verdict, Verdict::holds);
    EXPECT_EQ(find_claim(claims, "exact-cost")->trials[0].cases, 2u * 2 * 2);
    EXPECT_NE(find_claim(claims, "cost-like-boxes")->verdict, Verdict::undecided);
    EXPECT_EQ(find_claim(claims, "exact-keeps-crossings")->verdict,
              trial.seed == 1 ? Verdict::holds : Verdict::undecided);
  }
}

TEST(StudyRun, parts_in_any_order_join_to_the_whole) {
  Plan plan = seeded_plan();
  plan.sources = sources_of(plan.bodies, {Method::octree, Method::grid}, plan.seeds);
  plan.motions.resize(1);
  plan.cost_repeats = 1;
  const Study alone = make_study(plan);
  const test::ScratchFolder folder;
  const Cache cache(folder.path());
  constexpr std::size_t parts = 3;
  std::size_t cells = 0;
  for (const std::size_t number : {3, 1, 2}) {
    RunOptions options{.cache = &cache};
    options.shard = {number, parts};
    cells += run(plan, serial_workers(), options).cell_count();
  }
  const Study joined = make_study(plan, serial_workers(), {.cache = &cache});
  EXPECT_EQ(joined.result.taken_from_cache, joined.result.cell_count());
  EXPECT_EQ(cells, joined.result.cell_count());
  EXPECT_EQ(cells_csv(plan, joined.result), cells_csv(plan, alone.result));
  nlohmann::json a = nlohmann::json::parse(study_json(alone)), b = nlohmann::json::parse(study_json(joined));
  for (nlohmann::json* study : {&a, &b}) {
    study->erase("cost");
    nlohmann::json kept = nlohmann::json::array();
    for (const nlohmann::json& table : study->at("tables"))
      if (!table.value("timed", false)) kept.push_back(table);
    study->at("tables") = kept;
    for (nlohmann::json& claim : study->at("claims")) claim.erase("times");
  }
  EXPECT_TRUE(a == b);
  RunOptions none;
  none.shard = {1, 2};
  EXPECT_THROW(run(plan, serial_workers(), none), std::invalid_argument);
  none = {.cache = &cache};
  none.shard = {3, 2};
  EXPECT_THROW(run(plan, serial_workers(), none), std::invalid_argument);
}

TEST(StudyRun, a_recorded_motion_is_one_of_its_body) {
  Plan plan = small_plan();
  const std::vector<double> parameters = plan.parameters();
  RecordedMotion recorded{"solver", 1, {}};
  for (std::size_t i = 1; i < parameters.size(); ++i)
    recorded.frames.push_back(deform(plan.bodies[1].mesh, {Bend{60}}, parameters[i]));
  plan.recorded = {recorded};
  const Result result = run(plan);
  EXPECT_EQ(plan.motion_name(2), "solver");
  EXPECT_EQ(result.find({0, 2, 0}), nullptr);  // of the other body
  const MotionRun *cell = result.find({2, 2, 0}), *bend = result.find({2, 1, 0});
  ASSERT_NE(cell, nullptr);
  ASSERT_EQ(cell->samples.size(), bend->samples.size());
  for (std::size_t i = 0; i < cell->samples.size(); ++i)
    EXPECT_EQ(cell->samples[i].levels[0].looseness(), bend->samples[i].levels[0].looseness());
  plan.recorded[0].body = 0;
  EXPECT_THROW(run(plan), std::invalid_argument);
}

TEST(StudyCost, counted_work_follows_from_the_tree) {
  const Mesh mesh = sample_body("limb", 8);
  const CoveredTree model = build(mesh, {.method = Method::hubbard, .branching = 4, .depth = 2});
  const SphereTree& tree = model.tree;
  // The vertices of all facets that touch a leaf, by brute force.
  std::size_t linked = 0, links_of_nearest = 0;
  for (std::uint32_t node = 0; node < tree.node_count(); ++node) {
    if (!tree.is_leaf(node)) continue;
    std::set<std::uint32_t> vertices;
    for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
      const Vec3 nearest = closest_point(mesh.corners(f), tree.spheres[node].center).point;
      if (distance(nearest, tree.spheres[node].center) <= tree.spheres[node].radius)
        vertices.insert(mesh.facets[f].begin(), mesh.facets[f].end());
    }
    linked += vertices.size();
    links_of_nearest += vertices.empty() ? 3 : 0;
  }
  linked += links_of_nearest;
  std::map<std::string, UpdateCounts> counts;
  for (const UpdateCounts& c : count_updates(mesh, model)) counts[c.name] = c;
  const std::size_t nodes = tree.node_count(), children = nodes - 1;
  EXPECT_EQ(counts["approach2"].points_read, linked);
  EXPECT_EQ(counts["approach1"].points_read, 2 * linked);
  EXPECT_EQ(counts["approach1"].distances, linked + children);
  EXPECT_EQ(counts["approach2"].distances, nodes);
  EXPECT_EQ(counts["boxes"].children_read, children);
  EXPECT_EQ(counts["boxes"].distances, 0u);
  // Beyond the points of the frame: 20 bytes per point and 16 per child; 52 and 56; 20 and 24 per box.
  const std::size_t vertices = mesh.vertex_count();
  EXPECT_EQ(counts["approach2"].bytes_read, 24 * vertices + 20 * linked + 16 * children);
  EXPECT_EQ(counts["approach1"].bytes_read, 24 * vertices + 52 * linked + 56 * children);
  EXPECT_EQ(counts["approach1"].bytes_written, 16 * (vertices + nodes));
  // Boxes also move the points of cuts, from three points and three weights each.
  const std::size_t frame = counts["boxes"].bytes_read - 20 * counts["boxes"].points_read - 24 * children;
  ASSERT_EQ((frame - 24 * vertices) % 72, 0u);
  const std::size_t cuts = (frame - 24 * vertices) / 72;
  EXPECT_EQ(counts["boxes"].bytes_written, 16 * (vertices + cuts) + 24 * nodes);
  // Every vertex of the mesh is owned by a leaf.
  EXPECT_GE(counts["boxes"].points_read, mesh.vertex_count());
}

TEST(StudyCost, work_of_exact_is_a_bound_between_its_walk_and_its_parts) {
  const Mesh mesh = sample_body("limb", 8);
  const CoveredTree model = build(mesh, {.method = Method::hubbard, .branching = 4, .depth = 2});
  const SphereTree& tree = model.tree;
  const std::vector<UpdateCounts> all = count_updates(mesh, model);
  const UpdateCounts& exact = all.back();
  ASSERT_EQ(exact.name, "exact");
  // Every level tests every vertex; a node has at most 28 anchors, 3 axes, 32 points of a core and 4 pulls.
  Body body(mesh, model, {.rules = {Rule::exact}, .details = {}, .modes = {}});
  const UpdateStatus status = body.update(mesh.positions);
  const std::size_t walk = status.points_tested, nodes = tree.node_count(), vertices = mesh.vertex_count();
  EXPECT_GE(walk, tree.level_count() * vertices);
  EXPECT_GE(exact.points_read, walk + 28 * nodes + 4 * nodes);
  EXPECT_LE(exact.points_read, walk + (28 + 3 + 32 + 4) * nodes);
  // The root has 32 points, or all.
  EXPECT_GE(exact.distances, walk + 5 * std::min<std::size_t>(32, vertices));
  EXPECT_LE(exact.distances, walk + 5 * 32 * nodes);
  // A walk reads each owned point once, since three levels fit into the registers; every vertex is owned.
  EXPECT_GE(exact.bytes_read, 24 * vertices + 20 * vertices + 24 * 28 * nodes);
  EXPECT_GE(exact.bytes_written, 16 * (vertices + nodes));
}

/// Cells that rebuild in the same pose share the tree: that must not change them.
TEST(StudyRun, rebuilt_cells_of_two_trees_are_those_of_each_alone) {
  const auto planned = [](std::vector<Method> methods) {
    Plan plan = coarse_plan(methods, {rebuilt, Rule::exact});
    plan.samples = 6;
    return plan;
  };
  const Plan both = planned({Method::grid, Method::hubbard});
  Workers two(2);
  const Result together = run(both, two);
  std::size_t differing = 0;
  for (std::size_t source = 0; source < 2; ++source) {
    const Plan alone = planned({*both.sources[source].generator});
    const Result one = run(alone);
    for (std::size_t motion = 0; motion < 2; ++motion) {
      const MotionRun &a = *together.find({source, motion, 0}), &b = *one.find({0, motion, 0});
      const MotionRun& exact = *together.find({source, motion, 1});
      ASSERT_EQ(a.samples.size(), 6u);
      for (std::size_t s = 0; s < 6; ++s) {
        for (const std::size_t level : both.levels()) {
          EXPECT_EQ(a.at(s, level)->looseness(), b.at(s, level)->looseness());
          EXPECT_EQ(a.at(s, level)->uncovered_area(), 0);
          differing += a.at(s, level)->looseness() != exact.at(s, level)->looseness() ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(differing, 0u) << "trees were rebuilt";
}

/// Cells that have the same tree in the same pose share its figures. Plans with a metric of one's own share nothing.
TEST(StudyRun, shared_figures_are_those_that_each_cell_measures) {
  Plan shared = coarse_plan({Method::grid, Method::octree}, {Rule::approach1, Rule::approach2, Rule::exact, rebuilt});
  Plan each = shared;
  std::size_t calls = 0, figures = 0;
  each.metrics.push_back({"calls", "-", [&calls](const Mesh&, std::span<const Sphere>, std::size_t) {
                            return static_cast<double>(++calls);
                          }});
  Workers two(2);
  const Result a = run(shared, two), b = run(each);
  ASSERT_EQ(a.cells.size(), b.cells.size());
  for (std::size_t i = 0; i < a.cells.size(); ++i) {
    ASSERT_EQ(a.cells[i].samples.size(), b.cells[i].samples.size());
    for (std::size_t s = 0; s < a.cells[i].samples.size(); ++s) {
      for (const std::size_t level : shared.levels()) {
        const LevelFigures &x = *a.cells[i].at(s, level), &y = *b.cells[i].at(s, level);
        EXPECT_EQ(x.spheres, y.spheres);
        EXPECT_EQ(x.looseness(), y.looseness());
        EXPECT_EQ(x.looseness_fixed(), y.looseness_fixed());
        EXPECT_EQ(x.error_on_half_grid(ErrorUnit::volume), y.error_on_half_grid(ErrorUnit::volume));
        EXPECT_EQ(x.uncovered_area(), y.uncovered_area());
        EXPECT_EQ(x.uncovered_distance(), y.uncovered_distance());
        EXPECT_EQ(x.protrusion_worst(), y.protrusion_worst());
        ++figures;
      }
    }
  }
  EXPECT_EQ(calls, figures) << "each cell measured its own";
}

TEST(StudyCost, rules_take_turns_and_have_quartiles) {
  Plan plan = small_plan();
  plan.cost_repeats = 3;
  const Result result = run(plan);
  const Cost cost = measure_cost(plan, result);
  EXPECT_EQ(cost.rules.size(), position_rules().size());
  for (const std::vector<UpdateCost>* list : {&cost.rules, &cost.boxes}) {
    for (const UpdateCost& c : *list) {
      EXPECT_GT(c.lower_quartile, 0) << c.name;
      EXPECT_LE(c.lower_quartile, c.nanoseconds_per_vertex) << c.name;
      EXPECT_LE(c.nanoseconds_per_vertex, c.upper_quartile) << c.name;
    }
  }
}

TEST(StudyRun, study_json_holds_every_cell_and_claim) {
  Plan plan = small_plan();
  plan.rules.emplace_back(Rule::traditional);
  plan.cost_repeats = 1;
  const Study study = make_study(plan);
  EXPECT_TRUE(faults(study.plan, study.result).empty());
  const nlohmann::json json = nlohmann::json::parse(study_json(study));
  EXPECT_EQ(json["cells"].size(), study.result.cells.size());
  ASSERT_EQ(json["claims"].size(), study.claims.size());
  for (std::size_t i = 0; i < study.claims.size(); ++i) {
    EXPECT_EQ(json["claims"][i]["id"], study.claims[i].id);
    EXPECT_EQ(json["claims"][i]["verdict"], std::string(name(study.claims[i].verdict)));
  }
  EXPECT_EQ(find_claim(study.claims, "exact-covers")->verdict, Verdict::holds);
  EXPECT_EQ(find_claim(study.claims, "rebuilt-covers")->verdict, Verdict::undecided);
  EXPECT_EQ(json["bodies"][1]["name"], "prism");
}

}  // namespace
}  // namespace morula::study
