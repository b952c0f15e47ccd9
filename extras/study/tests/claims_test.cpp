// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <morula/geometry/sample_bodies.hpp>
#include <morula/study/study.hpp>

namespace morula::study {
namespace {

/// Results made by hand: one tree, one motion, `exact` and `approach2`, two samples at one level.
struct Story {
  Plan plan;
  Result result;

  Story() {
    plan.bodies = {{"limb", sample_body("limb", 4)}};
    plan.sources = sources_of(plan.bodies, {Method::medial});
    plan.motions = {{Stretch{}}};
    plan.rules = {Rule::exact, Rule::approach2};
    plan.samples = 2;
    plan.of_levels = {1};
    result.trees = {{0, {{1, 0, 0}, {4, 1, 0}}, 0}};
    for (std::size_t rule = 0; rule < 2; ++rule) {
      Run cell;
      cell.key = {0, 0, rule};
      cell.returns_to_rest = true;
      for (std::size_t sample = 0; sample < 2; ++sample) {
        LevelFigures level;
        level.level = 1;
        level.diagonal = level.box_volume = 1;
        level.grid.emplace().looseness = 1.0 + static_cast<double>(sample * (2 - rule));
        cell.samples.push_back({sample, static_cast<double>(sample), {level}});
      }
      result.cells.push_back(cell);
    }
  }
  Coverage& coverage(std::size_t rule, std::size_t sample) {
    return result.cells[rule].samples[sample].levels[0].coverage;
  }
  Verdict verdict(const char* id) const {
    const std::vector<Claim> claims = make_claims(plan, result, 0, nullptr);
    const Claim* claim = find_claim(claims, id);
    return claim == nullptr ? throw std::out_of_range(id) : claim->verdict;
  }
};

TEST(StudyClaims, follow_from_bare_surface) {
  Story story;
  EXPECT_EQ(story.verdict("exact-covers"), Verdict::holds);
  EXPECT_EQ(story.verdict("approach2-bare"), Verdict::fails);
  EXPECT_EQ(story.verdict("traditional-bare"), Verdict::untested);
  EXPECT_TRUE(faults(story.plan, story.result).empty());
  story.coverage(1, 1).uncovered_area = 0.25;
  EXPECT_EQ(story.verdict("approach2-bare"), Verdict::holds);
  EXPECT_EQ(story.verdict("approach2-gain-is-bare"), Verdict::holds);
  EXPECT_TRUE(faults(story.plan, story.result).empty());
  story.coverage(0, 1).uncovered_area = 1e-9;
  EXPECT_EQ(story.verdict("exact-covers"), Verdict::fails);
  EXPECT_EQ(faults(story.plan, story.result).size(), 1u);
}

TEST(StudyClaims, follow_from_ratios_of_errors) {
  Story story;  // at the full amount exact is 3, approach2 is 2
  EXPECT_EQ(story.verdict("exact-cost"), Verdict::holds);
  story.result.cells[0].samples[1].levels[0].grid->looseness = 4.1;
  EXPECT_EQ(story.verdict("exact-cost"), Verdict::fails);
  EXPECT_EQ(story.verdict("void-spheres"), Verdict::holds);
}

TEST(StudyClaims, what_does_not_come_back_is_a_fault) {
  Story story;
  EXPECT_EQ(story.verdict("returns-to-rest"), Verdict::holds);
  story.result.cells[1].returns_to_rest = false;
  EXPECT_EQ(story.verdict("returns-to-rest"), Verdict::fails);
  const std::vector<std::string> found = faults(story.plan, story.result);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NE(found[0].find("approach2"), std::string::npos) << found[0];
}

TEST(StudyClaims, a_certificate_that_fails_is_a_fault) {
  Story story;
  story.result.cells[0].certificate = Certificate{.covered = false, .worst_excess = 1};
  EXPECT_EQ(faults(story.plan, story.result).size(), 1u);
}

TEST(StudyClaims, join_over_bodies) {
  const auto joined = [](std::vector<Verdict> verdicts) {
    std::vector<std::vector<Claim>> of_bodies;
    for (const Verdict verdict : verdicts) of_bodies.push_back({{.id = "it", .verdict = verdict}});
    return join_claims(of_bodies).at(0).verdict;
  };
  using enum Verdict;
  EXPECT_EQ(joined({holds, holds}), holds);
  EXPECT_EQ(joined({holds, untested}), holds);
  EXPECT_EQ(joined({fails, fails, untested}), fails);
  EXPECT_EQ(joined({holds, fails}), partly);
  EXPECT_EQ(joined({partly, partly}), partly);
  EXPECT_EQ(joined({untested, untested}), untested);
}

TEST(StudyTables, values_are_written_with_all_digits_and_quoted) {
  Table table;
  table.columns = {"a", "b, %"};
  table.rows = {{std::string("x,y"), std::size_t{3}}, {0.1, {}}};
  EXPECT_EQ(table_csv(table), "a,\"b, %\"\n\"x,y\",3\n0.1,\n");
}

TEST(Claims, to_the_bad_of_a_rule_are_better_where_they_fail) {
  const Claim bad{.claim = "It leaves surface bare", .verdict = Verdict::fails, .adverse = true};
  const Claim good{.claim = "It covers", .verdict = Verdict::fails, .guarantee = true};
  EXPECT_EQ(word(bad), "better");
  EXPECT_EQ(word(good), "fails");
  EXPECT_EQ(word({.claim = "It leaves surface bare", .verdict = Verdict::holds, .adverse = true}), "holds");
  const std::vector<Claim> both{bad, good};
  const std::string whole = claims_text(both), quick = claims_text(both, true);
  EXPECT_NE(whole.find("  better    It leaves surface bare\n"), std::string::npos) << whole;
  EXPECT_EQ(whole.find("always"), std::string::npos) << whole;
  EXPECT_NE(quick.find("  (better)  It leaves surface bare\n"), std::string::npos) << quick;
  EXPECT_NE(quick.find("  fails     It covers (always)\n"), std::string::npos) << quick;
}

}  // namespace
}  // namespace morula::study
