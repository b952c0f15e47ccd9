// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/study/amounts.hpp>
#include <morula/update/body.hpp>

namespace morula::study {
namespace {

TEST(StudyAmounts, bisection_finds_the_least_share_of_a_growing_function) {
  const auto square = [](double x) { return x * x; };
  const double found = share_reaching(0.25, square).value();
  EXPECT_GE(found, 0.5);
  EXPECT_LE(found, 0.5 + 1.0 / 256);
  EXPECT_GE(square(share_reaching(0.14, square).value()), 0.14);
  EXPECT_LT(square(share_reaching(0.14, square).value() - 1.0 / 256), 0.14);
  EXPECT_FALSE(share_reaching(1.01, square)) << "not at the full amount";
  EXPECT_FALSE(share_reaching(0, square)) << "at rest already";
  EXPECT_EQ(share_reaching(1, square), 1.0);
}

TEST(StudyAmounts, units_divide_the_outside_volume_as_their_words_say) {
  Looseness loose;
  loose.outside_volume = 8;
  loose.object_volume = 4;
  loose.voxels = 1000;
  loose.voxel_edge = 0.5;  // the grid has 125
  const UnitValues values = unit_values(loose, 40, 5, 16);
  EXPECT_EQ(values[static_cast<std::size_t>(AmountUnit::object)], 2);
  EXPECT_EQ(values[static_cast<std::size_t>(AmountUnit::box)], 0.5);
  EXPECT_DOUBLE_EQ(values[static_cast<std::size_t>(AmountUnit::grid)], 0.064);
  EXPECT_DOUBLE_EQ(values[static_cast<std::size_t>(AmountUnit::thickness)], 0.04);
  EXPECT_DOUBLE_EQ(values[static_cast<std::size_t>(AmountUnit::edge)], 0.4);
}

/// One search that both tests look at.
class StudyPaperAmounts : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    plan = {};
    plan.bodies = {{"limb", sample_body("limb", 12)}, {"torus", sample_body("torus", 8)}};
    plan.sources = sources_of(plan.bodies, {Method::medial, Method::octree, Method::grid});
    plan.motions = {{Stretch{}}};
    plan.samples = 3;
    plan.resolution = 32;
    plan.needle_sides = 0;
    amounts = find_paper_amounts(plan);
    for (const NamedMesh& body : plan.bodies)
      for (const Method method : {Method::medial, Method::grid})
        models.push_back(build(body.mesh, {.method = method, .branching = 8, .depth = 3}));
  }
  /// The largest curve, by the library's functions alone.
  static double largest(const FoundAmount& found, double share) {
    const Mesh& mesh = plan.bodies[found.body].mesh;
    const bool rules = found.part == FigurePart::a || found.part == FigurePart::b;
    const std::size_t level = found.part == FigurePart::a || found.part == FigurePart::c ? 2 : 3;
    const Vec3 extent = bounding_box(mesh).extent();
    double most = 0;
    for (const Method method : {Method::medial, Method::grid}) {
      for (const Rule rule : {Rule::approach1, Rule::approach2}) {
        if (rules ? method != Method::medial : rule != Rule::approach2) continue;
        Body body(mesh, models[2 * found.body + (method == Method::grid ? 1 : 0)], {.rules = {rule}});
        Mesh moved = mesh;
        moved.positions = deform(mesh, plan.motions[found.motion], share);
        EXPECT_TRUE(body.update(moved.positions));
        const Looseness loose = looseness(moved, level_set_spheres(body.current_tree(), level), {.resolution = 32});
        most =
            std::max(most, found.unit == AmountUnit::object ? loose.looseness.value()
                                                            : loose.outside_volume / (extent.x * extent.y * extent.z));
      }
    }
    return most;
  }

  static Plan plan;
  static PaperAmounts amounts;
  static std::vector<CoveredTree> models;  // medial and grid of each body
};
Plan StudyPaperAmounts::plan;
PaperAmounts StudyPaperAmounts::amounts;
std::vector<CoveredTree> StudyPaperAmounts::models;

TEST_F(StudyPaperAmounts, end_the_largest_curve_at_the_end_of_the_paper_s_axes) {
  EXPECT_EQ(amounts.found.size(), 2u * 4 * 5) << "bodies, parts of Fig. 2 and units";
  std::size_t reached = 0;
  for (const FoundAmount& found : amounts.found) {
    if (found.unit != AmountUnit::object && found.unit != AmountUnit::box) continue;
    EXPECT_DOUBLE_EQ(largest(found, 0), found.at_rest);
    EXPECT_DOUBLE_EQ(largest(found, 1), found.at_full);
    if (!found.share) {
      EXPECT_TRUE(found.at_rest >= paper_axis_end || found.at_full < paper_axis_end);
      continue;
    }
    ++reached;
    EXPECT_GE(largest(found, *found.share), paper_axis_end);
    EXPECT_LT(largest(found, *found.share - 1.0 / 256), paper_axis_end);
  }
  EXPECT_GT(reached, 4u);
}

TEST_F(StudyPaperAmounts, are_in_a_table_and_in_figures_on_the_paper_s_axes) {
  const Table table = amounts_table(plan, amounts);
  ASSERT_EQ(table.rows.size(), 2u * 5);
  for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.columns.size());
  ASSERT_FALSE(amounts.figures.empty());
  for (const Figure& figure : amounts.figures) {
    if (figure.id.ends_with("-full")) continue;
    EXPECT_EQ(figure.y_end, paper_axis_end);
    double last = 0;
    for (const Series& series : figure.series) last = std::max(last, series.y.back().value());
    EXPECT_GE(last, paper_axis_end) << figure.id;
    EXPECT_LT(last, 2 * paper_axis_end) << figure.id;
  }
}

}  // namespace
}  // namespace morula::study
