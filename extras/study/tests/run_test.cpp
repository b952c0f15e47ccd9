// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/study/study.hpp>
#include <morula/update/body.hpp>
#include <nlohmann/json.hpp>
#include <support/scratch_folder.hpp>

namespace morula::study {
namespace {

Plan small_plan() {
  Plan plan;
  plan.bodies = {{"limb", sample_body("limb", 8)}, {"prism", needle_prism(6)}};
  plan.sources = sources_of(plan.bodies, {Method::octree, Method::grid});
  plan.motions = {{Stretch{}}, {Bend{60}}};
  plan.rules = {Rule::approach2, Rule::exact};
  plan.samples = 4;
  plan.resolution = 24;
  plan.branching = 4;
  plan.depth = 2;
  plan.needle_sides = 0;
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
  std::stop_source stop;
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
  EXPECT_EQ(find_claim(study.claims, "rebuilt-covers")->verdict, Verdict::untested);
  EXPECT_EQ(json["bodies"][1]["name"], "prism");
}

}  // namespace
}  // namespace morula::study
