// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <morula/geometry/inspect.hpp>
#include <morula/study/run.hpp>
#include <morula/update/body.hpp>
#include <numbers>
#include <scenes/scenes.hpp>
#include <set>
#include <stdexcept>

namespace morula::study {
namespace {

TEST(StudyPlan, the_motions_of_the_paper_are_scenes) {
  std::set<std::string> known;
  for (const scenes::NamedMotion& motion : scenes::standard_motions()) known.insert(motion.name);
  std::vector<std::string> words;
  for (const Deformations& motion : paper_motions()) words.push_back(describe_all(motion));
  EXPECT_EQ(words, (std::vector<std::string>{"stretch 2", "twist 180", "bend 90"}));
  for (const std::string& motion : words) EXPECT_EQ(known.count(motion), 1u) << motion;
}

TEST(StudyPlan, every_way_to_follow_is_found_by_its_name) {
  std::set<std::string> names;
  for (const RuleKey& key : all_rule_keys()) {
    names.insert(name(key));
    EXPECT_EQ(rule_key_from_name(name(key)), key) << name(key);
    EXPECT_EQ(FollowRule(key).key(), key) << name(key);
  }
  EXPECT_EQ(names.size(), all_rule_keys().size());
  EXPECT_EQ(names.count("rebuilt") + names.count("fresh") + names.count("exact"), 3u);
  EXPECT_FALSE(rule_key_from_name("exat"));
}

TEST(StudyPlan, mixes_differ_and_pass_for_no_rule) {
  std::set<std::string> names;
  for (const FollowRule& mix : rule_mixes(2)) {
    names.insert(mix.name);
    EXPECT_FALSE(mix.key()) << mix.name;
    ASSERT_EQ(mix.options.rules.size(), 3u) << mix.name;
    EXPECT_EQ(mix.options.rules[0], mix.options.rules[1]) << mix.name;
  }
  EXPECT_EQ(names.size(), 31u);  // 4 × 4, and all but one made to cover
}

TEST(StudyPlan, samples_go_out_or_there_and_back) {
  Plan plan;
  plan.samples = 5;
  EXPECT_EQ(plan.parameters(), (std::vector<double>{0, 0.25, 0.5, 0.75, 1}));
  plan.and_back = true;
  EXPECT_EQ(plan.parameters(), (std::vector<double>{0, 0.5, 1, 0.5, 0}));
  plan.measured = {0, 2};
  EXPECT_EQ(plan.measured_samples(), (std::vector<std::size_t>{0, 2}));
  EXPECT_EQ(plan.levels(), (std::vector<std::size_t>{2, 3}));
}

TEST(StudyPlan, fresh_trees_end_at_the_full_amount_also_there_and_back) {
  for (const bool and_back : {false, true}) {
    for (const std::size_t samples : {3, 5, 8, 13, 25}) {
      Plan plan;
      plan.samples = samples;
      plan.and_back = and_back;
      for (const Method method : {Method::medial, Method::octree}) {
        const Source source{.body = 0, .method = std::string(name(method)), .generator = method, .file = {}};
        const std::vector<std::size_t> fresh_at = plan.fresh_samples(source);
        EXPECT_EQ(fresh_at.front(), 0u);
        EXPECT_EQ(plan.parameters().at(fresh_at.back()), 1) << samples << and_back;
        EXPECT_TRUE(std::is_sorted(fresh_at.begin(), fresh_at.end(), std::less_equal<>()));
      }
    }
  }
}

TEST(StudyPlan, the_origin_of_a_sph_file_is_the_one_that_its_name_says) {
  const Mesh prism = needle_prism(8);
  const Vec3 point{1, -0.5, 1e-3};
  using Kind = SphOrigin::Kind;
  EXPECT_EQ(name(SphOrigin{Kind::none, point}), "none");
  EXPECT_EQ((SphOrigin{Kind::none, point}.of(prism)), (Vec3{0, 0, 0}));
  EXPECT_EQ(name(SphOrigin{Kind::box_center, point}), "bbox-center");
  EXPECT_EQ((SphOrigin{Kind::box_center, point}.of(prism)), bounding_box(prism).center());
  EXPECT_EQ(name(SphOrigin{Kind::point, point}), "1,-0.5,0.001");
  EXPECT_EQ((SphOrigin{Kind::point, point}.of(prism)), point);
}

TEST(StudyPlan, axes_have_four_names) {
  std::set<std::string_view> names;
  for (const Axis axis : {Axis::x, Axis::y, Axis::z, Axis::automatic}) names.insert(name(axis));
  EXPECT_EQ(names, (std::set<std::string_view>{"x", "y", "z", "auto"}));
}

TEST(StudyPlan, trials_are_bodies_times_seeds) {
  Plan plan;
  plan.bodies = {{"limb", needle_prism(8)}, {"bar", needle_prism(6)}};
  plan.seeds = {5, 6, 7};
  plan.sources = sources_of(plan.bodies, {Method::medial, Method::octree}, plan.seeds);
  ASSERT_EQ(plan.sources.size(), 2u * 4);
  ASSERT_EQ(plan.trials().size(), 6u);
  EXPECT_EQ(plan.trials()[4], (Trial{1, 6}));
  EXPECT_EQ(plan.sources_of(Trial{1, 6}), (std::vector<std::size_t>{5, 6}));
  EXPECT_EQ(plan.find_source(Trial{1, 6}, Method::octree), 5u);
  EXPECT_EQ(plan.find_source(Trial{1, 7}, Method::medial), 7u);
  // Trees without a seed make one trial of each body.
  plan.sources = sources_of(plan.bodies, {Method::medial});
  EXPECT_EQ(plan.trials(), (std::vector<Trial>{{0, 5}, {1, 5}}));
}

TEST(StudyPlan, the_prism_is_closed_and_has_its_volume) {
  const MeshReport report = inspect(needle_prism(16));
  ASSERT_TRUE(report.has_volume());
  // 16 triangles of two radii of 1/2, times the length of 4.
  EXPECT_NEAR(report.volume, 4 * 16 * 0.5 * 0.25 * std::sin(2 * std::numbers::pi / 16), 1e-12);
}

TEST(StudyPlan, refuses_what_names_something_that_is_not_there) {
  Plan good;
  good.bodies = {{"prism", needle_prism(8)}};
  good.sources = sources_of(good.bodies, {Method::octree});
  good.needle_sides = 0;
  EXPECT_NO_THROW(run(good));
  std::vector<Plan> bad(10, good);
  bad[0].bodies.clear();
  bad[1].sources.clear();
  bad[2].sources[0].body = 1;
  bad[3].measured = {2, 1};
  bad[4].measured = {good.samples};
  bad[5].press_rules = {fresh};
  bad[6].seeds.clear();
  bad[7].decisive = {good.samples};
  bad[8].decisive = {2, 1};
  bad[9].recorded = {{"short", 0, {{Vec3{0, 0, 0}}}}};
  for (std::size_t i = 0; i < bad.size(); ++i) EXPECT_THROW(run(bad[i]), std::invalid_argument) << i;
}

TEST(RuleLevels, are_told_by_spans_of_levels) {
  const std::vector<Rule> rules{Rule::exact, Rule::exact, Rule::approach2};
  EXPECT_EQ(describe_rules(rules, 2), "exact");
  EXPECT_EQ(describe_rules(rules, 3), "exact on levels 0-1, approach2 on level 2");
  EXPECT_EQ(describe_rules(rules, 5), "exact on levels 0-1, approach2 on levels 2-4");
  EXPECT_EQ(rule_of_level(rules, 9), Rule::approach2);
}

}  // namespace
}  // namespace morula::study
