// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <morula/geometry/sample_bodies.hpp>
#include <morula/study/variants.hpp>
#include <morula/update/body.hpp>

#include "reference.hpp"
#include "small_plan.hpp"

namespace morula::study {
namespace {

using Approach = Variant::Approach;
using Links = Variant::Links;

Mesh limb() {
  return sample_body("limb", 10);
}
CoveredTree medial(const Mesh& mesh) {
  return build(mesh, {.method = Method::medial, .branching = 4, .depth = 3});
}
std::vector<std::vector<Vec3>> poses(const Mesh& mesh) {
  return {mesh.positions, deform(mesh, {Stretch{}}, 1), deform(mesh, {Twist{}}, 0.7), deform(mesh, {Bend{}}, 1),
          deform(mesh, {Noise{}}, 1)};
}

Variant variant_of(const std::string& name) {
  for (const Variant& variant : paper_variants())
    if (variant.name == name) return variant;
  throw std::out_of_range(name);
}

/// The library's options for a variant; none if the library does not read the sentence so.
std::optional<UpdateOptions> library_options(const Variant& v) {
  if (v.links != Links::facets || v.weighs_children) return std::nullopt;
  if (v.approach == Approach::second && v.inner_vertices) return std::nullopt;
  UpdateOptions options{.rules = {v.approach == Approach::first ? Rule::approach1 : Rule::approach2}};
  RuleOptions& details = options.details;
  details.approach1_weights = v.weights == Variant::Weights::area               ? RuleOptions::Weights::area
                              : v.weights == Variant::Weights::inverse_distance ? RuleOptions::Weights::inverse_distance
                                                                                : RuleOptions::Weights::uniform;
  if (v.inner_vertices) details.approach1_inner_center = RuleOptions::InnerCenter::linked_vertices;
  if (v.boxes_of_centers) details.approach2_inner_boxes = RuleOptions::InnerBoxes::child_centers;
  details.distance_floor = v.distance_floor;
  return options;
}

TEST(StudyVariants, choices_of_the_library_are_its_spheres_bit_for_bit) {
  const Mesh mesh = limb();
  const CoveredTree model = medial(mesh);
  std::size_t compared = 0;
  for (const Variant& variant : paper_variants()) {
    const std::optional<UpdateOptions> options = library_options(variant);
    if (!options) continue;
    ++compared;
    Body body(mesh, model, *options);
    const std::unique_ptr<OwnFollower> plain = rule_of(variant)->make(mesh, model);
    for (const std::vector<Vec3>& positions : poses(mesh)) {
      ASSERT_TRUE(body.update(positions));
      EXPECT_TRUE(plain->follow(positions).spheres == body.current_tree().spheres) << variant.name;
    }
  }
  EXPECT_EQ(compared, 7u);
}

/// The vertices that a variant links a node to, found by looking at everything.
std::set<std::uint32_t> links_of(const test::RestFacts& facts, Links kind, std::uint32_t node) {
  const Sphere& ball = facts.model.tree.spheres[node];
  std::set<std::uint32_t> found;
  if (kind == Links::facets) return facts.linked[node];
  if (kind == Links::enclosed) found = facts.enclosed[node];
  if (kind == Links::region) {
    for (std::size_t p = 0; p < facts.model.cover.patch_count(); ++p)
      if (p >= facts.model.cover.region_begin[node] && p < facts.model.cover.region_end[node])
        for (const std::uint32_t v : facts.mesh.facets[facts.model.cover.patch_facet[p]]) found.insert(v);
  }
  if (kind == Links::nearest) {
    std::vector<std::pair<double, std::uint32_t>> order;
    for (std::uint32_t v = 0; v < facts.mesh.vertex_count(); ++v)
      order.emplace_back(squared_distance(facts.mesh.positions[v], ball.center), v);
    std::sort(order.begin(), order.end());
    for (std::size_t i = 0; i < 8; ++i) found.insert(order[i].second);
  }
  return found.empty() ? facts.of_nearest[node] : found;
}

TEST(StudyVariants, each_kind_of_link_follows_the_vertices_that_brute_force_finds) {
  const Mesh mesh = limb();
  const CoveredTree model = medial(mesh);
  const test::RestFacts plain(mesh, model);
  const double tolerance = 1e-5 * bounding_box(mesh).diagonal();
  for (const Variant& variant : paper_variants()) {
    if (variant.inner_vertices || variant.weighs_children) continue;
    test::RestFacts facts = plain;
    for (std::uint32_t node = 0; node < model.tree.node_count(); ++node)
      facts.linked[node] = links_of(plain, variant.links, node);
    UpdateOptions options{.rules = {variant.approach == Approach::first ? Rule::approach1 : Rule::approach2}};
    if (variant.links == Links::facets) options = library_options(variant).value();
    const std::unique_ptr<OwnFollower> rule = rule_of(variant)->make(mesh, model);
    for (const std::vector<Vec3>& positions : poses(mesh)) {
      const SphereTree now = rule->follow(positions);
      const test::Reference expected =
          test::reference_update(facts, options, positions, model.tree.spheres, now.spheres);
      for (std::uint32_t node = 0; node < model.tree.node_count(); ++node) {
        const Sphere &mine = now.spheres[node], &wanted = expected.now[node];
        ASSERT_LE(distance(mine.center, wanted.center), tolerance * (1 + wanted.radius)) << variant.name << node;
        ASSERT_LE(std::abs(mine.radius - wanted.radius), tolerance * (1 + 10 * wanted.radius)) << variant.name << node;
      }
    }
  }
}

TEST(StudyVariants, inner_boxes_of_vertices_follow_equations_1_and_5) {
  const Mesh mesh = limb();
  const CoveredTree model = medial(mesh);
  const test::RestFacts facts(mesh, model);
  const std::unique_ptr<OwnFollower> rule = rule_of(variant_of("approach2-inner-vertices"))->make(mesh, model);
  const std::vector<Vec3> positions = deform(mesh, {Bend{}}, 1);
  const SphereTree now = rule->follow(positions);
  for (std::uint32_t node = 0; node < model.tree.node_count(); ++node) {
    const Sphere& rest = model.tree.spheres[node];
    Box before, after;
    for (const std::uint32_t v : facts.linked[node]) before.add(mesh.positions[v]), after.add(positions[v]);
    const Vec3 center = rest.center + after.center() - before.center();
    const auto reach = [](const Box& box, const Vec3& c) {
      const Vec3 a = box.lower - c, b = box.upper - c;
      return length(Vec3{std::max(std::abs(a.x), std::abs(b.x)), std::max(std::abs(a.y), std::abs(b.y)),
                         std::max(std::abs(a.z), std::abs(b.z))});
    };
    EXPECT_LE(distance(now.spheres[node].center, center), 1e-5);
    EXPECT_NEAR(now.spheres[node].radius, rest.radius * reach(after, center) / reach(before, rest.center), 1e-5);
  }
}

TEST(StudyVariants, inner_centers_move_with_their_children_weighted_by_inverse_distance) {
  const Mesh mesh = limb();
  const CoveredTree model = medial(mesh);
  const std::unique_ptr<OwnFollower> rule = rule_of(variant_of("approach1-inverse-all"))->make(mesh, model);
  const SphereTree& rest = model.tree;
  const SphereTree now = rule->follow(deform(mesh, {Twist{}}, 1));
  for (std::uint32_t node = 0; node < rest.node_count(); ++node) {
    if (rest.is_leaf(node)) continue;
    Vec3 moved{};
    double total = 0;
    for (std::uint32_t c = rest.first_child[node]; c < rest.first_child[node] + rest.child_count[node]; ++c) {
      const double apart = distance(rest.spheres[c].center, rest.spheres[node].center);
      const double weight = 1 / std::max(apart, 0.001 * rest.spheres[node].radius);
      moved += (now.spheres[c].center - rest.spheres[c].center) * weight;
      total += weight;
    }
    EXPECT_LE(distance(now.spheres[node].center, rest.spheres[node].center + moved / total), 1e-5);
  }
}

TEST(StudyVariants, the_library_s_reading_gets_the_verdicts_of_the_study) {
  Plan plan = coarse_plan({Method::medial}, {Rule::traditional, Rule::approach1, Rule::approach2}, paper_motions());
  plan.samples = 5;
  plan.resolution = 32;
  const std::vector<Claim> claims = make_claims(plan, run(plan), plan.trials().front(), nullptr);
  const std::vector<VariantResult> results = run_variants(plan);
  ASSERT_EQ(results.size(), paper_variants().size());
  const auto expect = [&](const VariantResult& result, std::size_t place, const std::string& id) {
    EXPECT_EQ(result.verdicts.at(place).claim, variant_claims()[place]);
    EXPECT_EQ(result.verdicts.at(place).verdict, find_claim(claims, id)->verdict) << id;
  };
  for (const VariantResult& result : results) {
    EXPECT_EQ(result.verdicts.size(), variant_claims().size());
    EXPECT_GT(result.looseness, result.looseness_rest) << result.variant.name;
    EXPECT_EQ(result.verdicts.at(3).verdict, Verdict::holds) << result.variant.name << " returns to rest";
    const bool first = result.variant.name == "approach1-plain";
    if (!first && result.variant.name != "approach2-plain") continue;
    const std::string rule = first ? "approach1" : "approach2";
    expect(result, 0, rule + "-below-traditional");
    if (first) expect(result, 1, "approach1-exponential");
    expect(result, 2, "approach2-largely-better");
    expect(result, 3, "returns-to-rest");
    expect(result, 4, rule + "-uncovered");
  }
  const Table table = variants_table(plan, results);
  ASSERT_EQ(table.rows.size(), results.size());
  for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.columns.size());
}

}  // namespace
}  // namespace morula::study
