// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "../../../examples/study_own/own.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/study/study.hpp>
#include <morula/update/body.hpp>
#include <nlohmann/json.hpp>
#include <support/scratch_folder.hpp>

#include "small_plan.hpp"

namespace morula::study {
namespace {

Plan own_plan() {
  return coarse_plan({Method::grid}, {Rule::traditional, Rule::approach2, Rule::exact});
}

using example::Drift;

/// approach2 of the library, as if it were one's own.
struct Twin {
  Body body;
  SphereTree follow(const std::vector<Vec3>& positions) {
    EXPECT_TRUE(body.update(positions));
    return body.current_tree();
  }
};
std::shared_ptr<const OwnRule> twin(std::string version = {}) {
  return own_rule(
      "twin",
      [](const Mesh& mesh, const CoveredTree& model) { return Twin{Body(mesh, model, {.rules = {Rule::approach2}})}; },
      std::move(version));
}

void expect_same_figures(const MotionRun& a, const MotionRun& b) {
  EXPECT_EQ(a.returns_to_rest, b.returns_to_rest);
  ASSERT_EQ(a.samples.size(), b.samples.size());
  for (std::size_t s = 0; s < a.samples.size(); ++s) {
    ASSERT_EQ(a.samples[s].levels.size(), b.samples[s].levels.size());
    for (std::size_t l = 0; l < a.samples[s].levels.size(); ++l) {
      const LevelFigures &one = a.samples[s].levels[l], &two = b.samples[s].levels[l];
      EXPECT_EQ(one.looseness(), two.looseness());
      EXPECT_EQ(one.looseness_fixed(), two.looseness_fixed());
      EXPECT_EQ(one.uncovered_area(), two.uncovered_area());
      EXPECT_EQ(one.protrusion_mean(), two.protrusion_mean());
    }
  }
}

TEST(StudyOwn, a_rule_that_does_what_approach2_does_has_its_figures_and_verdicts) {
  Plan plan = own_plan();
  plan.rules.emplace_back(twin());
  const Study study = make_study(plan);
  ASSERT_EQ(study.result.cells.size(), 2u * 4);
  for (std::size_t motion = 0; motion < 2; ++motion)
    expect_same_figures(*study.result.find({0, motion, 3}), *study.result.find({0, motion, 1}));
  const auto verdict = [&](const char* id) {
    const Claim* claim = find_claim(study.claims, id);
    return claim == nullptr ? throw std::out_of_range(id) : claim->verdict;
  };
  EXPECT_EQ(verdict("twin-below-traditional"), verdict("approach2-below-traditional"));
  EXPECT_EQ(verdict("twin-uncovered"), verdict("approach2-uncovered"));
  EXPECT_EQ(verdict("twin-uncovered"), Verdict::holds);
  EXPECT_EQ(verdict("twin-returns-to-rest"), Verdict::holds);
  EXPECT_TRUE(find_claim(study.claims, "twin-tighter-than-exact") != nullptr);
}

TEST(StudyOwn, a_rule_is_in_every_table_figure_and_file_of_rules) {
  Plan plan = own_plan();
  plan.rules.emplace_back(own_rule(
      "drift",
      [](const Mesh& rest, const CoveredTree& model) {
        return Drift{rest, model.tree};
      },
      "1"));
  const Study study = make_study(plan);
  const auto of_name = [](const nlohmann::json& list, const char* key) {
    return std::count_if(list.begin(), list.end(), [&](const nlohmann::json& item) { return item[key] == "drift"; });
  };
  const nlohmann::json json = nlohmann::json::parse(study_json(study));
  EXPECT_EQ(json["settings"]["rules"].back(), "drift");
  EXPECT_EQ(of_name(json["cells"], "rule"), 2);
  EXPECT_EQ(of_name(json["cost"]["rules"], "name"), 1);
  EXPECT_NE(cells_csv(study.plan, study.result).find("limb,grid,stretch 2,drift,3,1,2,"), std::string::npos);
  std::size_t curves = 0;
  for (const Figure& figure : study.figures)
    for (const Series& series : figure.series) curves += series.name == "drift" ? 1 : 0;
  EXPECT_EQ(curves, 2u * 2 * 4) << "motions, levels and measures";
  std::size_t rows = 0;
  for (const Table& table : study.tables)
    for (const auto& row : table.rows)
      for (const TableValue& value : row) rows += value == TableValue(std::string("drift")) ? 1 : 0;
  EXPECT_EQ(rows, 2u * 2 + 1) << "rules.csv for motions and levels, cost.csv";
  EXPECT_EQ(find_claim(study.claims, "drift-uncovered")->verdict, Verdict::holds) << "it does not follow a stretch";
  EXPECT_TRUE(faults(study.plan, study.result).empty()) << "a rule of one's own promises nothing";
}

TEST(StudyOwn, a_generator_that_builds_as_grid_does_has_its_figures) {
  Plan plan = own_plan();
  plan.rules.emplace_back(fresh);
  plan.sources.push_back(own_source(0, own_generator("lattice", [](const Mesh& mesh) {
                                      return build(mesh, {.method = Method::grid, .branching = 4, .depth = 2});
                                    })));
  const Study study = make_study(plan);
  for (std::size_t rule = 0; rule < plan.rules.size(); ++rule)
    for (std::size_t motion = 0; motion < 2; ++motion)
      expect_same_figures(*study.result.find({0, motion, rule}), *study.result.find({1, motion, rule}));
  EXPECT_EQ(study.result.trees[1].levels.back().nodes, study.result.trees[0].levels.back().nodes);
  EXPECT_EQ(find_claim(study.claims, "lattice-below-generators")->verdict, Verdict::fails) << "as tight as grid";
  EXPECT_TRUE(std::any_of(study.figures.begin(), study.figures.end(), [](const Figure& figure) {
    return figure.id == "fig2d-bend" && figure.series.at(1).name == "lattice" &&
           figure.series.at(1).role == SeriesRole::method;
  }));
}

TEST(StudyOwn, balls_of_a_generator_are_made_to_cover) {
  Plan plan = own_plan();
  plan.rules = {Rule::exact};
  plan.sources.push_back(own_source(0, own_generator("vertices", [](const Mesh& mesh) {
                                      std::vector<Sphere> balls;
                                      for (const Vec3& p : mesh.positions) balls.push_back({p, 0.01});
                                      return tree_from_spheres(balls, 8);
                                    })));
  const Result result = run(plan);
  ASSERT_NE(result.find({1, 0, 0}), nullptr);
  EXPECT_EQ(result.find({1, 0, 0})->worst_uncovered_area(), 0);
  EXPECT_GT(result.trees[1].levels.back().grown, 0u);
}

TEST(StudyOwn, a_metric_is_measured_as_by_hand_and_is_in_every_file) {
  Plan plan = own_plan();
  plan.metrics.push_back({"total-radius", "mesh units", [](const Mesh&, std::span<const Sphere> spheres, std::size_t) {
                            double sum = 0;
                            for (const Sphere& sphere : spheres) sum += sphere.radius;
                            return sum;
                          }});
  plan.metrics.push_back({"no-number", "-", [](const Mesh&, std::span<const Sphere>, std::size_t) { return NAN; }});
  const Study study = make_study(plan);
  const Mesh& rest = plan.bodies[0].mesh;
  Body body(rest, study.result.model[0], {.rules = {Rule::approach2}});
  ASSERT_TRUE(body.update(deform(rest, {Stretch{}}, 2.0 / 3)));
  double sum = 0;
  for (const Sphere& sphere : level_set_spheres(body.current_tree(), 2)) sum += sphere.radius;
  const LevelFigures& measured = *study.result.find({0, 0, 1})->at(2, 2);
  ASSERT_EQ(measured.metrics.size(), 2u);
  EXPECT_EQ(measured.metrics[0], sum);
  EXPECT_FALSE(measured.metrics[1]);

  const nlohmann::json json = nlohmann::json::parse(study_json(study));
  EXPECT_EQ(json["settings"]["metrics"][0]["unit"], "mesh units");
  EXPECT_TRUE(json["cells"][0]["samples"][0]["levels"][0]["metrics"]["no-number"].is_null());
  EXPECT_GT(json["cells"][0]["samples"][0]["levels"][0]["metrics"]["total-radius"].get<double>(), 0);
  const std::string csv = cells_csv(study.plan, study.result);
  EXPECT_NE(csv.find(",returns_to_rest,seed,looseness_half_grid,total-radius,no-number\n"), std::string::npos);
  EXPECT_TRUE(std::any_of(study.figures.begin(), study.figures.end(), [](const Figure& figure) {
    return figure.id.ends_with("-stretch-2-total-radius") || figure.id == "fig2b-total-radius";
  }));
  EXPECT_TRUE(std::any_of(study.tables.begin(), study.tables.end(), [](const Table& table) {
    return table.id == "rules" &&
           std::find(table.columns.begin(), table.columns.end(), "total-radius, mean") != table.columns.end();
  }));
}

TEST(StudyOwn, cells_of_entries_with_a_version_are_cached_and_no_others) {
  std::atomic<int> made = 0;
  const auto counted = [&](std::string version) {
    return own_rule(
        "counted",
        [&](const Mesh& rest, const CoveredTree& model) {
          ++made;
          return Drift{rest, model.tree};
        },
        std::move(version));
  };
  const test::ScratchFolder folder;
  const Cache cache(folder.path());
  Plan plan = own_plan();
  plan.rules = {Rule::exact, FollowRule(counted(""))};
  const std::string expected = cells_csv(plan, run(plan, serial_workers(), {.cache = &cache}));
  EXPECT_EQ(run(plan, serial_workers(), {.cache = &cache}).taken_from_cache, 2u) << "those of exact";
  EXPECT_EQ(made, 4);
  plan.rules[1] = FollowRule(counted("a"));
  EXPECT_EQ(run(plan, serial_workers(), {.cache = &cache}).taken_from_cache, 2u);
  EXPECT_EQ(made, 6);
  const Result again = run(plan, serial_workers(), {.cache = &cache});
  EXPECT_EQ(again.taken_from_cache, 4u);
  EXPECT_EQ(made, 6);
  EXPECT_EQ(cells_csv(plan, again), expected);
  plan.rules[1] = FollowRule(counted("b"));
  EXPECT_EQ(run(plan, serial_workers(), {.cache = &cache}).taken_from_cache, 2u) << "a version of its own";
  plan.metrics.push_back({"one", "-", [](const Mesh&, std::span<const Sphere>, std::size_t) { return 1.0; }});
  run(plan, serial_workers(), {.cache = &cache});
  EXPECT_EQ(run(plan, serial_workers(), {.cache = &cache}).taken_from_cache, 0u) << "a metric without a version";
  plan.metrics[0].version = "1";
  run(plan, serial_workers(), {.cache = &cache});
  const Result kept = run(plan, serial_workers(), {.cache = &cache});
  EXPECT_EQ(kept.taken_from_cache, 4u);
  EXPECT_EQ(kept.find({0, 1, 1})->at(3, 2)->metrics.at(0), 1.0);
}

TEST(StudyOwn, names_that_are_taken_or_no_names_of_files_are_rejected) {
  const auto refusal = [](const auto& change) -> std::string {
    Plan plan = own_plan();
    change(plan);
    try {
      run(plan);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  const auto rule = [](std::string name) {
    return FollowRule(own_rule(std::move(name), [](const Mesh& rest, const CoveredTree& model) {
      return Drift{rest, model.tree};
    }));
  };
  const auto cubes = [](std::string name) {
    return own_source(0, own_generator(std::move(name), [](const Mesh& mesh) {
                        return build(mesh, {.method = Method::octree, .depth = 1});
                      }));
  };
  EXPECT_EQ(refusal([&](Plan& plan) { plan.rules.push_back(rule("exact")); }),
            "study: rule 'exact': the name is taken");
  EXPECT_EQ(refusal([&](Plan& plan) { plan.rules = {rule("a"), rule("a")}; }), "study: rule 'a': the name is taken");
  EXPECT_EQ(refusal([&](Plan& plan) { plan.rules.push_back(rule("../a")); }),
            "study: rule '../a': a name has letters, digits, '_', '-' and '.' only");
  EXPECT_EQ(refusal([&](Plan& plan) { plan.sources.push_back(cubes("medial")); }),
            "study: generator 'medial': the name is taken");
  EXPECT_EQ(refusal([&](Plan& plan) {
              plan.metrics.push_back({"uncovered", "", nullptr});
            }),
            "study: metric 'uncovered' has no function");
  EXPECT_EQ(refusal([&](Plan& plan) {
              plan.rules.emplace_back(own_rule("short", [](const Mesh& rest, const CoveredTree&) {
                return Drift{rest, tree_from_spheres(std::vector<Sphere>{{{0, 0, 0}, 1}})};
              }));
            }).rfind("study: rule 'short': a tree of 1 nodes", 0),
            0u);
}

}  // namespace
}  // namespace morula::study
