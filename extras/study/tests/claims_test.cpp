// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
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
    result.trees = {{.source = 0, .levels = {{1, 0, 0}, {4, 1, 0}}}};
    for (std::size_t rule = 0; rule < 2; ++rule) {
      MotionRun cell;
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
    const std::vector<Claim> claims = make_claims(plan, result, {0, 1}, nullptr);
    const Claim* claim = find_claim(claims, id);
    return claim == nullptr ? throw std::out_of_range(id) : claim->verdict;
  }
};

TEST(StudyClaims, follow_from_uncovered_surface) {
  Story story;
  EXPECT_EQ(story.verdict("exact-covers"), Verdict::holds);
  EXPECT_EQ(story.verdict("approach2-uncovered"), Verdict::fails);
  EXPECT_EQ(story.verdict("traditional-uncovered"), Verdict::undecided);
  EXPECT_TRUE(faults(story.plan, story.result).empty());
  story.coverage(1, 1).uncovered_area = 0.25;
  EXPECT_EQ(story.verdict("approach2-uncovered"), Verdict::holds);
  EXPECT_EQ(story.verdict("approach2-gain-is-uncovered"), Verdict::holds);
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

/// Claims of trials by hand: body, seed and verdict.
struct Told {
  std::string body;
  std::uint64_t seed;
  Verdict verdict;
  std::optional<double> value{};
};

std::vector<std::vector<Claim>> trials_of(const std::vector<Told>& told, bool guarantee = false) {
  std::vector<std::vector<Claim>> of_trials;
  for (const Told& t : told) {
    Claim claim{.id = "it", .verdict = t.verdict, .guarantee = guarantee, .quantity = {.name = "length"}};
    claim.trials = {{.body = t.body, .seed = t.seed, .verdict = t.verdict, .value = t.value}};
    of_trials.push_back({claim});
  }
  return of_trials;
}

Claim joined(const std::vector<Told>& told, bool guarantee = false) {
  return join_claims(trials_of(told, guarantee)).at(0);
}

/// `holds` trials that hold, then `fails` that fail, of one body.
std::vector<Told> told(std::size_t holds, std::size_t fails) {
  std::vector<Told> list;
  for (std::size_t i = 0; i < holds + fails; ++i)
    list.push_back({"limb", i, i < holds ? Verdict::holds : Verdict::fails});
  return list;
}

TEST(StudyClaims, join_by_nine_tenths) {
  using enum Verdict;
  const auto verdict = [](std::vector<Verdict> verdicts) {
    std::vector<Told> list;
    for (const Verdict v : verdicts) list.push_back({"limb", list.size(), v});
    return joined(list).verdict;
  };
  EXPECT_EQ(verdict({holds, holds}), holds);
  EXPECT_EQ(verdict({holds, undecided}), holds);
  EXPECT_EQ(verdict({fails, fails, undecided}), fails);
  EXPECT_EQ(verdict({holds, fails}), partly);
  EXPECT_EQ(verdict({partly, partly}), partly);
  EXPECT_EQ(verdict({undecided, undecided}), undecided);
  EXPECT_EQ(joined(told(9, 1)).verdict, holds);
  EXPECT_EQ(joined(told(17, 2)).verdict, partly);
  EXPECT_EQ(joined(told(1, 9)).verdict, fails);
  EXPECT_EQ(joined(told(2, 17)).verdict, partly);
  // A guarantee has no exceptions.
  EXPECT_EQ(joined(told(99, 1), true).verdict, partly);
  EXPECT_EQ(joined(told(10, 0), true).verdict, holds);
}

TEST(StudyClaims, joined_count_trials_and_name_the_others) {
  const Claim claim = joined({{"limb", 1, Verdict::fails},
                              {"limb", 2, Verdict::holds},
                              {"bar", 1, Verdict::holds},
                              {"bar", 2, Verdict::holds},
                              {"torus", 1, Verdict::undecided}});
  EXPECT_EQ(claim.count(Verdict::holds), 3u);
  EXPECT_EQ(claim.decided(), 4u);
  EXPECT_EQ(claim.trials.size(), 5u);
  EXPECT_NE(claim.numbers.find("Holds in 3 of 4 trials (bodies × seeds); fails on limb (1 of 2 seeds)."),
            std::string::npos)
      << claim.numbers;
}

TEST(StudyClaims, joined_say_what_a_verdict_depends_on) {
  // Each body has its verdict, whatever the seed.
  Claim claim = joined({{"limb", 1, Verdict::fails},
                        {"limb", 2, Verdict::fails},
                        {"bar", 1, Verdict::holds},
                        {"bar", 2, Verdict::holds}});
  EXPECT_EQ(claim.dependence.seed, 0);
  EXPECT_EQ(claim.dependence.body, 1);
  EXPECT_FALSE(claim.dependence.amount);
  // Each seed has its verdict, whatever the body.
  claim = joined({{"limb", 1, Verdict::fails},
                  {"limb", 2, Verdict::holds},
                  {"bar", 1, Verdict::fails},
                  {"bar", 2, Verdict::holds}});
  EXPECT_EQ(claim.dependence.seed, 1);
  EXPECT_EQ(claim.dependence.body, 0);
  std::vector<std::vector<Claim>> of_trials = trials_of(told(4, 0));
  for (std::size_t i = 0; i < 4; ++i)
    of_trials[i][0].trials[0].at_half_amount = i == 0 ? Verdict::partly : Verdict::holds;
  claim = join_claims(of_trials).at(0);
  EXPECT_EQ(claim.dependence.amount, 0.25);
  EXPECT_FALSE(claim.dependence.resolution);
  EXPECT_FALSE(joined(told(1, 0)).dependence.seed);
}

TEST(StudyClaims, intervals_hold_what_bootstrap_draws) {
  // Equal values have no spread; one value has no interval.
  const std::optional<Interval> same = interval_of({{2, 2}, {2, 2, 2}}, false);
  ASSERT_TRUE(same);
  EXPECT_EQ(same->mean, 2);
  EXPECT_EQ(same->low, 2);
  EXPECT_EQ(same->high, 2);
  EXPECT_EQ(same->trials, 5u);
  EXPECT_FALSE(interval_of({{2}}, false));
  // The mean of 10,000 even steps from 0 to 1, in one group: 1/2 ± 1.96 / √(12 n).
  std::vector<double> even;
  for (int i = 0; i < 10000; ++i) even.push_back((i + 0.5) / 10000);
  const Interval wide = interval_of({even}, false).value();
  EXPECT_NEAR(wide.mean, 0.5, 1e-12);
  EXPECT_NEAR(wide.high - wide.low, 2 * 1.96 / std::sqrt(12.0 * 10000), 0.001);
  // Bodies are drawn as wholes: with all spread between two bodies, a sample often has one body only.
  const Interval bodies = interval_of({{0, 0, 0, 0}, {1, 1, 1, 1}}, false).value();
  EXPECT_EQ(bodies.low, 0);
  EXPECT_EQ(bodies.high, 1);
  // Ratios have a geometric mean.
  const Interval ratio = interval_of({{0.25, 4}}, true).value();
  EXPECT_NEAR(ratio.mean, 1, 1e-12);
  EXPECT_NEAR(ratio.low, 0.25, 1e-12);
  EXPECT_NEAR(ratio.high, 4, 1e-12);
  const std::optional<Interval> again = interval_of({even}, false);
  EXPECT_EQ(again->low, wide.low);
}

TEST(StudyClaims, halves_of_the_seeds_are_compared) {
  Plan plan;
  plan.seeds = {1, 2, 3, 4};
  // Even and odd seeds agree on the first claim, differ on the second, and cannot be compared on the third.
  std::vector<std::vector<Claim>> of_trials;
  for (const std::uint64_t seed : plan.seeds) {
    std::vector<Claim> claims;
    for (const Verdict v : {Verdict::holds, seed % 2 == 0 ? Verdict::holds : Verdict::fails,
                            seed % 2 == 0 ? Verdict::undecided : Verdict::holds}) {
      Claim claim{.id = "claim" + std::to_string(claims.size()), .verdict = v};
      claim.trials = {{.body = "limb", .seed = seed, .verdict = v}};
      claims.push_back(claim);
    }
    of_trials.push_back(std::move(claims));
  }
  const Stability stability = stability_of(plan, of_trials).value();
  EXPECT_EQ(stability.seeds[0], (std::vector<std::uint64_t>{1, 3}));
  EXPECT_EQ(stability.seeds[1], (std::vector<std::uint64_t>{2, 4}));
  EXPECT_EQ(stability.compared, 2u);
  EXPECT_EQ(stability.same, 1u);
  EXPECT_EQ(stability.differing, (std::vector<std::string>{"claim1"}));
  plan.seeds = {1};
  EXPECT_FALSE(stability_of(plan, {of_trials[0]}));
}

TEST(StudyClaims, of_one_trial_use_deciding_samples_and_half_the_amount) {
  Story story;  // at the full amount exact is 3, approach2 is 2; at rest both are 1
  for (MotionRun& cell : story.result.cells) {
    Sample half = cell.samples[1];
    half.sample = 1, half.parameter = 0.5;
    half.levels[0].grid->looseness = 1.5;
    cell.samples[1].sample = 2;
    cell.samples.insert(cell.samples.begin() + 1, half);
  }
  story.plan.samples = 3;
  const auto tighter = [&] {
    const std::vector<Claim> claims = make_claims(story.plan, story.result, {0, 1}, nullptr);
    return find_claim(claims, "exact-below-approach1") == nullptr
               ? 0.0
               : find_claim(claims, "approach2-gain-is-uncovered")->trials[0].value.value();
  };
  EXPECT_EQ(tighter(), 0.5);
  story.plan.decisive = {0, 2};
  EXPECT_EQ(tighter(), 1.0);
  story.plan.decisive.clear();
  story.coverage(1, 2).uncovered_area = 0.25;
  const std::vector<Claim> claims = make_claims(story.plan, story.result, {0, 1}, nullptr);
  const TrialVerdict& trial = find_claim(claims, "approach2-uncovered")->trials[0];
  EXPECT_EQ(trial.verdict, Verdict::holds);
  EXPECT_EQ(trial.at_half_amount, Verdict::fails);
  EXPECT_FALSE(trial.at_half_resolution);
}

TEST(StudyTables, values_are_written_with_all_digits_and_quoted) {
  Table table;
  table.columns = {"a", "b, %"};
  table.rows = {{std::string("x,y"), std::size_t{3}}, {0.1, {}}};
  EXPECT_EQ(table_csv(table), "a,\"b, %\"\n\"x,y\",3\n0.1,\n");
}

TEST(Claims, to_the_bad_of_a_rule_are_better_where_they_fail) {
  const Claim bad{.claim = "It leaves surface uncovered", .verdict = Verdict::fails, .adverse = true};
  const Claim good{.claim = "It covers", .verdict = Verdict::fails, .guarantee = true};
  const Claim open{.claim = "It is fast"};
  EXPECT_EQ(word(bad), "better");
  EXPECT_EQ(word(good), "fails");
  EXPECT_EQ(word({.claim = "It leaves surface uncovered", .verdict = Verdict::holds, .adverse = true}), "holds");
  const std::vector<Claim> all{bad, good, open};
  const std::string text = claims_text(all);
  EXPECT_NE(text.find("  better      It leaves surface uncovered\n"), std::string::npos) << text;
  EXPECT_NE(text.find("  not decided It is fast\n"), std::string::npos) << text;
}

}  // namespace
}  // namespace morula::study
