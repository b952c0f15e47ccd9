// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bounds of skinned clusters: input that is rejected, and lists of clusters.
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <stdexcept>

#include "bodies.hpp"
#include "skin_bounds_oracle.hpp"

namespace morula {
namespace {

using test::Specimen;
using test::specimens;
using namespace test::skin_bounds;

TEST(SkinBounds, reject_transforms_that_they_cannot_bound) {
  const Mesh& mesh = specimens()[0].mesh;
  const Skin skin = skin_of_kind(mesh, 9, Weights::negative, 1);
  SkinBounds bounds(mesh, skin, some_clusters(mesh, 25));
  Motions motions(18);
  std::vector<Spheref> spheres(2 * bounds.cluster_count(), Spheref{{1, 2, 3}, 4});
  const std::vector<Spheref> before = spheres;
  constexpr double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {std::nan(""), inf, -inf, 1e300, 0x1p56}) {
    for (int entry = 0; entry < 4; ++entry) {
      Motions wrong = motions;
      (entry == 3 ? wrong[13].translation : wrong[13].columns[static_cast<std::size_t>(entry)]).y = bad;
      const Status status = bounds.bounds(wrong, {.spheres = spheres});
      EXPECT_EQ(status.code, Status::Code::bad_transform);
      EXPECT_EQ(status.index, 13u);
    }
  }
  EXPECT_EQ(bounds.bounds(Motions(10), {.spheres = spheres}).code, Status::Code::wrong_transform_count);
  EXPECT_EQ(spheres, before);
  EXPECT_THROW(static_cast<void>(bounds.bounds(motions, {.spheres = std::span(spheres).first(3)})),
               std::invalid_argument);
  std::vector<Spheref> whole(2);
  EXPECT_THROW(static_cast<void>(bounds.bounds(motions, {.whole_spheres = whole})), std::invalid_argument);
}

TEST(SkinBounds, refuse_input_by_name) {
  const Mesh& mesh = specimens()[0].mesh;
  const Skin skin = skin_of_kind(mesh, 9, Weights::rough, 1);
  const std::vector<std::uint32_t> clusters = some_clusters(mesh, 25);
  EXPECT_THROW(SkinBounds(mesh, skin, std::span(clusters).first(5)), std::invalid_argument);
  std::vector<std::uint32_t> beyond = clusters;
  beyond.back() = 1u << 24;
  EXPECT_THROW(SkinBounds(mesh, skin, beyond), std::invalid_argument);
  Skin other = skin;
  other.weights[0] += 1;
  EXPECT_THROW(SkinBounds(mesh, other, clusters), std::invalid_argument);
  Mesh huge = mesh;
  for (Vec3& p : huge.positions) p = p * 0x1p52;
  EXPECT_THROW(SkinBounds(huge, skin, clusters), std::invalid_argument);

  const SkinBoundsData good = SkinBounds(mesh, skin, clusters).data();
  const auto refuses = [&](const std::function<void(SkinBoundsData&)>& spoil) {
    SkinBoundsData bad = good;
    spoil(bad);
    EXPECT_THROW(SkinBounds{std::move(bad)}, std::invalid_argument);
  };
  refuses([](SkinBoundsData& d) { d.bone_count = 8; });
  refuses([](SkinBoundsData& d) { d.reach = 0; });
  refuses([](SkinBoundsData& d) { d.clusters[3].row_count = 1u << 20; });
  refuses([](SkinBoundsData& d) { d.clusters[3].first_row = 0xffffffff; });
  refuses([](SkinBoundsData& d) { d.clusters[3].radius = -1; });
  refuses([](SkinBoundsData& d) { d.clusters[3].growth = 0.5f; });
  refuses([](SkinBoundsData& d) { d.rows[3].center.x = NAN; });
  refuses([](SkinBoundsData& d) { d.rows[3].weight_stray = HUGE_VALF; });
}

TEST(SkinBounds, numbers_of_runs) {
  EXPECT_EQ(clusters_of_runs(std::vector<std::uint32_t>{0, 2, 2, 3}), (std::vector<std::uint32_t>{0, 0, 2}));
  EXPECT_TRUE(clusters_of_runs(std::vector<std::uint32_t>{0}).empty());
  EXPECT_THROW(clusters_of_runs({}), std::invalid_argument);
  EXPECT_THROW(clusters_of_runs(std::vector<std::uint32_t>{1, 2}), std::invalid_argument);
  EXPECT_THROW(clusters_of_runs(std::vector<std::uint32_t>{0, 3, 2}), std::invalid_argument);
}

}  // namespace
}  // namespace morula
