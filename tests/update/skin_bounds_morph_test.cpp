// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bounds of skinned clusters that morph targets displace before the bones move them.
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <support/allocations.hpp>

#include "bodies.hpp"
#include "simd/processors.hpp"
#include "skin_bounds_oracle.hpp"

namespace morula {
namespace {

using namespace test::skin_bounds;
using test::specimens;

std::vector<double> morphs_of_kind(Random& random, std::size_t count, std::size_t kind) {
  const double most = kind % 5 == 4 ? 1e6 : kind % 5 == 3 ? 1e-6 : 1;
  std::vector<double> morphs(count);
  for (double& q : morphs)
    if (kind % 3 != 0 || random.uniform() < 0.3) q = most * random.uniform(-1, 1);
  return morphs;
}

void expect_all_morphed_inside(const std::string& name, const Mesh& mesh, double size) {
  constexpr std::size_t characters = 10, count = 6;
  const Modes targets = targets_of_kinds(mesh, count, size);
  for (const Weights kind : {Weights::smooth, Weights::rough, Weights::negative, Weights::eight, Weights::loose_sums})
    for (const std::size_t per_cluster : {std::size_t{3}, mesh.facet_count()}) {
      const Skin skin = skin_of_kind(mesh, 9, kind, size);
      const std::vector<std::uint32_t> clusters = some_clusters(mesh, per_cluster);
      SkinBounds bounds(mesh, skin, targets, clusters);
      Random random(13);
      Motions motions;
      std::vector<double> morphs;
      for (std::size_t c = 0; c < characters; ++c) {
        const std::vector<double> own = morphs_of_kind(random, count, c);
        morphs.insert(morphs.end(), own.begin(), own.end());
        const AffineTransform alike = motion_of_kind(random, 0, size);
        for (std::size_t b = 0; b < skin.bone_count; ++b)
          motions.push_back(c % 2 == 0 ? alike : motion_of_kind(random, static_cast<int>(c / 2) % motion_kinds, size));
      }
      const Bounds result = bounds_of(bounds, motions, morphs);
      for (std::size_t c = 0; c < characters; ++c)
        for (const Missing missing : {Missing::stays_at_rest, Missing::is_dropped}) {
          const Excess most = excess_of(result, mesh, clusters, c, [&](std::size_t v) {
            return moved_vertex(morphed(mesh, targets, morphs.data() + c * count, v), skin,
                                motions.data() + c * skin.bone_count, v, missing);
          });
          const std::string where =
              name + ", weights " + std::to_string(static_cast<int>(kind)) + ", character " + std::to_string(c);
          EXPECT_LE(most.sphere, 0) << where;
          EXPECT_LE(most.box, 0) << where;
          EXPECT_LE(most.whole, 0) << where;
        }
    }
}

TEST(SkinBoundsMorphs, contain_every_vertex_at_any_numbers_and_transforms) {
  for (const test::Specimen& b : specimens()) expect_all_morphed_inside(b.name, b.mesh, 1);
}

TEST(SkinBoundsMorphs, contain_every_vertex_far_from_the_origin_and_at_any_size) {
  const test::Specimen& b = specimens()[0];
  for (const double scale : {1e-25, 1e-9, 1e3})
    for (const double away : {0.0, 1e7}) {
      Mesh mesh = b.mesh;
      for (Vec3& p : mesh.positions) p = (p + Vec3{away, -away, 0.3 * away}) * scale;
      expect_all_morphed_inside("scale " + std::to_string(scale) + ", away " + std::to_string(away), mesh, scale);
    }
}

// A vertex as a shader computes it in float: targets first, in any order.
Vec3f shaded_morph(const Mesh& mesh, const Modes& targets, std::span<const double> morphs, std::size_t v) {
  Vec3f p(mesh.positions[v]);
  for (std::size_t k = 0; k < targets.mode_count; ++k) {
    const std::size_t j = v % 2 == 0 ? k : targets.mode_count - 1 - k;
    p += Vec3f(targets.mode(j)[v]) * static_cast<float>(morphs[j]);
  }
  return p;
}

// Facets far smaller than the rounding of their positions, and targets that move them far and all but alike.
TEST(SkinBoundsMorphs, pay_for_rounding) {
  Random random(12);
  for (int round = 0; round < 4000; ++round) {
    Mesh mesh;
    const bool is_near = round % 3 == 0;  // targets that move the facet by less than they round its places
    const Vec3 middle = vector_within(random, is_near ? 3 : 0.1);
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(middle + vector_within(random, 0x1p-33));
    mesh.facets = {{0, 1, 2}};
    const std::size_t count = round % 2 == 0 ? 1 : 60;
    Modes targets{3, count, {}};
    std::vector<double> morphs;
    for (std::size_t j = 0; j < count; ++j) {
      const Vec3 far = vector_within(random, is_near ? 1e-4 : 3);
      for (int k = 0; k < 3; ++k) targets.displacements.push_back(far + vector_within(random, 0x1p-33));
      morphs.push_back(random.uniform(-1, 1) * (is_near || round % 4 < 2 ? 1 : 1000));
    }
    const Skin skin{1, {0, 1, 2, 3}, {0, 0, 0}, {1, 1, 1}};
    const std::vector<std::uint32_t> cluster{0};
    // The allowances of the bones alone would pay for most of it.
    SkinBoundsData data = SkinBounds(mesh, skin, targets, cluster).data();
    data.clusters[0].rounding *= round % 8 < 4 ? 1.0f : 0x1p-20f;
    SkinBounds bounds(data);
    const bool stands = round % 8 >= 4;
    const Motions motions{stands ? AffineTransform{} : motion_of_kind(random, 0, 1)};
    const Bounds result = bounds_of(bounds, motions, morphs);
    const Excess exact = excess_of(result, mesh, cluster, 0, [&](std::size_t v) {
      return moved_vertex(morphed(mesh, targets, morphs.data(), v), skin, motions.data(), v, Missing::stays_at_rest);
    });
    const Excess shaded = excess_of(result, mesh, cluster, 0, [&](std::size_t v) {
      return shaded_vertex(shaded_morph(mesh, targets, morphs, v), skin, motions.data(), v);
    });
    ASSERT_LE(std::max({exact.sphere, exact.box, exact.whole}), 0) << round;
    ASSERT_LE(std::max({shaded.sphere, shaded.box, shaded.whole}), 0) << round;
    // Not by a wide margin: less than 2^-13 of how far the targets move.
    EXPECT_LE(result.spheres[0].radius, 0x1p-13f * static_cast<float>(2 * count * (round % 4 < 2 ? 1 : 1000)) + 1e-3f);
  }
}

// Displacements below the range of float times numbers near its end. A shader may take such displacements for 0.
TEST(SkinBoundsMorphs, pay_for_displacements_below_the_range_of_float) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {0x1p-40, 0, 0}, {0, 0x1p-40, 0}};
  mesh.facets = {{0, 1, 2}};
  const Skin skin{1, {0, 1, 2, 3}, {0, 0, 0}, {1, 1, 1}};
  const std::vector<std::uint32_t> cluster{0};
  Random random(15);
  for (int round = 0; round < 100; ++round) {
    Modes targets{3, 1, {}};
    targets.displacements.assign(3, vector_within(random, 1e-42));
    const std::vector<double> morphs{1e37};
    SkinBounds bounds(mesh, skin, targets, cluster);
    const Motions motions(1);
    const Bounds result = bounds_of(bounds, motions, morphs);
    for (const bool is_flushed : {false, true}) {
      const Excess most = excess_of(result, mesh, cluster, 0, [&](std::size_t v) {
        const Vec3f p = is_flushed ? Vec3f(mesh.positions[v]) : shaded_morph(mesh, targets, morphs, v);
        return shaded_vertex(p, skin, motions.data(), v);
      });
      EXPECT_LE(std::max({most.sphere, most.box, most.whole}), 0) << round;
    }
  }
}

// The size of the transforms grows with the targets: they move a cluster at the origin far away.
TEST(SkinBoundsMorphs, pay_for_rounding_of_far_displacements) {
  Random random(14);
  for (int round = 0; round < 2000; ++round) {
    Mesh mesh;
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(vector_within(random, 0x1p-33));
    mesh.facets = {{0, 1, 2}};
    Modes targets{3, 1, {}};
    targets.displacements.assign(3, vector_within(random, 3));
    Skin skin{.bone_count = 8, .begin = {0}};
    for (std::uint32_t v = 0; v < 3; ++v) {
      for (std::uint32_t k = 0; k < 8; ++k) skin.bones.push_back(k), skin.weights.push_back(0.125);
      skin.begin.push_back(8 * (v + 1));
    }
    const std::vector<std::uint32_t> cluster{0};
    SkinBoundsData data = SkinBounds(mesh, skin, targets, cluster).data();
    data.targets[0].radius *= 0x1p-20f;  // without the allowance for the sums of targets
    data.targets[0].half_extent *= 0x1p-20f;
    SkinBounds bounds(data);
    Motions motions;
    for (int b = 0; b < 8; ++b) motions.push_back(motion_of_kind(random, 3, 0x1p-33));
    const std::vector<double> morphs{random.uniform(-1, 1)};
    const Bounds result = bounds_of(bounds, motions, morphs);
    const Excess exact = excess_of(result, mesh, cluster, 0, [&](std::size_t v) {
      return moved_vertex(morphed(mesh, targets, morphs.data(), v), skin, motions.data(), v, Missing::stays_at_rest);
    });
    ASSERT_LE(std::max({exact.sphere, exact.box, exact.whole}), 0) << round;
  }
}

TEST(SkinBoundsMorphs, at_zero_and_in_clusters_that_they_do_not_move_cost_nothing) {
  const Mesh& mesh = specimens()[2].mesh;
  const Skin skin = skin_of_kind(mesh, 9, Weights::rough, 1);
  const std::vector<std::uint32_t> clusters = some_clusters(mesh, 25);
  Modes targets{mesh.vertex_count(), 2, std::vector<Vec3>(2 * mesh.vertex_count())};
  const std::uint32_t moved = clusters.back();
  for (std::size_t f = 0; f < mesh.facet_count(); ++f)
    if (clusters[f] == moved) targets.displacements[mesh.facets[f][0]] = {0, 1, 0};
  SkinBounds plain(mesh, skin, clusters), with(mesh, skin, targets, clusters);
  EXPECT_EQ(SkinBounds(mesh, skin, Modes{}, clusters).data(), plain.data());
  EXPECT_EQ(plain.data().target_begin.size(), 0u);
  EXPECT_EQ(with.target_count(), 2u);
  Random random(3);
  Motions motions;
  for (int b = 0; b < 9; ++b) motions.push_back(motion_of_kind(random, 0, 1));
  const Bounds expected = bounds_of(plain, motions), result = bounds_of(with, motions, std::vector<double>{3, -2});
  std::size_t same = 0;
  for (std::size_t k = 0; k < plain.cluster_count(); ++k) {
    const bool is_moved = with.data().target_begin[k] != with.data().target_begin[k + 1];
    EXPECT_EQ(with.data().clusters[k] == plain.data().clusters[k], !is_moved);
    if (is_moved) continue;
    EXPECT_EQ(result.spheres[k], expected.spheres[k]);
    EXPECT_EQ(result.boxes[k], expected.boxes[k]);
    ++same;
  }
  EXPECT_GT(same, plain.cluster_count() / 2);
  EXPECT_LT(same, plain.cluster_count());
  // Numbers of 0 give the bits of no numbers.
  EXPECT_EQ(bounds_of(with, motions, std::vector<double>{0, -0.0}), bounds_of(with, motions));
}

// A target that moves all vertices alike moves the bounds; one that moves them differently enlarges them no more than
// by its largest displacement.
TEST(SkinBoundsMorphs, are_near_the_least_ones) {
  const Mesh& mesh = specimens()[0].mesh;
  const Skin skin = skin_of_kind(mesh, 4, Weights::smooth, 1);
  const std::vector<std::uint32_t> clusters(mesh.facet_count(), 0);
  Modes targets = targets_of_kinds(mesh, 2, 1);
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    targets.displacements[v] = {3, -2, 1};
    targets.displacements[mesh.vertex_count() + v] = {0, 0, v % 2 == 0 ? 1.0 : 0.5};
  }
  SkinBounds bounds(mesh, skin, targets, clusters);
  const Motions still(4);
  const Bounds rest = bounds_of(bounds, still), moved = bounds_of(bounds, still, std::vector<double>{2, 0});
  EXPECT_NEAR(moved.spheres[0].radius, rest.spheres[0].radius, 3e-4f);
  EXPECT_LE(max_norm(Vec3(moved.boxes[0].lower) - Vec3(rest.boxes[0].lower) - Vec3{6, -4, 2}), 3e-4);
  EXPECT_LE(max_norm(Vec3(moved.boxes[0].upper) - Vec3(rest.boxes[0].upper) - Vec3{6, -4, 2}), 3e-4);
  const Bounds spread = bounds_of(bounds, still, std::vector<double>{0, 2});
  EXPECT_NEAR(spread.spheres[0].radius, rest.spheres[0].radius + 0.5f, 1e-4f);
  EXPECT_NEAR(spread.boxes[0].upper.z, rest.boxes[0].upper.z + 2, 1e-4f);
  EXPECT_NEAR(spread.boxes[0].lower.z, rest.boxes[0].lower.z + 1, 1e-4f);
  EXPECT_NEAR(spread.boxes[0].upper.x, rest.boxes[0].upper.x, 1e-4f);
}

TEST(SkinBoundsMorphs, have_the_same_bits_however_they_are_computed) {
  const Mesh& mesh = specimens()[2].mesh;
  const Skin skin = skin_of_kind(mesh, 9, Weights::rough, 1);
  const Modes targets = targets_of_kinds(mesh, 5, 1);
  SkinBounds bounds(mesh, skin, targets, some_clusters(mesh, 25));
  Random random(9);
  constexpr std::size_t characters = 37;
  Motions motions;
  std::vector<double> morphs;
  for (std::size_t c = 0; c < characters; ++c) {
    for (std::size_t b = 0; b < 9; ++b)
      motions.push_back(motion_of_kind(random, static_cast<int>(c % motion_kinds), 1));
    const std::vector<double> own = morphs_of_kind(random, 5, c);
    morphs.insert(morphs.end(), own.begin(), own.end());
  }
  const Bounds all = bounds_of(bounds, motions, morphs);
  const std::size_t n = bounds.cluster_count();
  for (std::size_t c = 0; c < characters; ++c) {
    const auto first = motions.begin() + static_cast<std::ptrdiff_t>(9 * c);
    const Bounds one = bounds_of(bounds, Motions(first, first + 9), std::span(morphs).subspan(5 * c, 5));
    for (std::size_t k = 0; k < n; ++k) {
      EXPECT_EQ(one.spheres[k], all.spheres[c * n + k]);
      EXPECT_EQ(one.boxes[k], all.boxes[c * n + k]);
    }
    EXPECT_EQ(one.whole_spheres[0], all.whole_spheres[c]);
  }
  Workers three(3);
  EXPECT_EQ(bounds_of(bounds, motions, morphs, three), all);
  EXPECT_EQ(SkinBounds(mesh, skin, targets, some_clusters(mesh, 25), three).data(), bounds.data());
  SkinBounds stored{SkinBoundsData(bounds.data())};
  EXPECT_EQ(bounds_of(stored, motions, morphs), all);
  const std::size_t kinds = detail::runnable_kinds();
  for (std::size_t most = 1; most <= kinds; ++most) {
    detail::allow_kinds(most);
    EXPECT_EQ(bounds_of(bounds, motions, morphs), all) << detail::kind_name(most - 1);
  }
  detail::allow_kinds(kinds);
  Bounds part = all;
  EXPECT_EQ(
      test::allocations_once_warm([&] { ASSERT_TRUE(bounds.bounds(motions, morphs, {.spheres = part.spheres})); }), 0u);
}

// The largest numbers that are accepted: all results are numbers, and cover.
TEST(SkinBoundsMorphs, stay_in_range_at_the_largest_numbers) {
  const Mesh& mesh = specimens()[0].mesh;
  const Skin skin = skin_of_kind(mesh, 9, Weights::negative, 1);
  const std::vector<std::uint32_t> clusters = some_clusters(mesh, 25);
  for (const double scale : {1.0, 1e-30, 1e-300}) {
    Modes targets = targets_of_kinds(mesh, 2, 1);
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) targets.displacements[v] = scale * targets.displacements[v];
    SkinBounds bounds(mesh, skin, targets, clusters);
    const Motions motions(9);
    double least = 0, most = 1e300;
    std::vector<Spheref> spheres(bounds.cluster_count());
    for (int step = 0; step < 2000; ++step) {
      const double middle = least < 1 ? 0.5 * (least + std::min(most, 2.0)) : std::sqrt(least) * std::sqrt(most);
      const bool accepted =
          static_cast<bool>(bounds.bounds(motions, std::vector<double>{middle, 0}, {.spheres = spheres}));
      (accepted ? least : most) = middle;
    }
    EXPECT_GE(least, 1e12);
    const std::vector<double> morphs{least, 0};
    const Bounds result = bounds_of(bounds, motions, morphs);
    const Excess excess = excess_of(result, mesh, clusters, 0, [&](std::size_t v) {
      return moved_vertex(morphed(mesh, targets, morphs.data(), v), skin, motions.data(), v, Missing::stays_at_rest);
    });
    EXPECT_LE(std::max({excess.sphere, excess.box, excess.whole}), 0) << scale;
    for (const Spheref& s : result.spheres) EXPECT_TRUE(std::isfinite(s.radius));
  }
}

TEST(SkinBoundsMorphs, reject_numbers_that_they_cannot_bound) {
  const Mesh& mesh = specimens()[0].mesh;
  const Skin skin = skin_of_kind(mesh, 9, Weights::rough, 1);
  const Modes targets = targets_of_kinds(mesh, 3, 1);
  SkinBounds bounds(mesh, skin, targets, some_clusters(mesh, 25));
  const Motions motions(18);
  std::vector<Spheref> spheres(2 * bounds.cluster_count(), Spheref{{1, 2, 3}, 4});
  const std::vector<Spheref> before = spheres;
  constexpr double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {std::nan(""), inf, -inf, 1e300, -1e30}) {
    const std::vector<double> morphs{0, 0, 0, 1, bad, 1};
    const Status status = bounds.bounds(motions, morphs, {.spheres = spheres});
    EXPECT_EQ(status.code, Status::Code::bad_coordinate);
    EXPECT_EQ(status.index, 4u);
  }
  for (const std::size_t count : {1u, 3u, 5u, 7u})
    EXPECT_EQ(bounds.bounds(motions, std::vector<double>(count), {.spheres = spheres}).code,
              Status::Code::wrong_coordinate_count);
  SkinBounds plain(mesh, skin, some_clusters(mesh, 25));
  EXPECT_EQ(plain.bounds(motions, std::vector<double>(2), {.spheres = spheres}).code,
            Status::Code::wrong_coordinate_count);
  EXPECT_EQ(spheres, before);
  EXPECT_TRUE(bounds.bounds({}, {}, SkinBoundsOutput{}));
}

TEST(SkinBoundsMorphs, refuse_targets_and_rest_data_by_name) {
  const Mesh& mesh = specimens()[0].mesh;
  const Skin skin = skin_of_kind(mesh, 9, Weights::rough, 1);
  const std::vector<std::uint32_t> clusters = some_clusters(mesh, 25);
  const auto refuses_targets = [&](const Modes& targets) {
    EXPECT_THROW(SkinBounds(mesh, skin, targets, clusters), std::invalid_argument);
  };
  Modes targets = targets_of_kinds(mesh, 3, 1);
  targets.displacements.pop_back();
  refuses_targets(targets);
  targets = targets_of_kinds(mesh, 3, 1);
  targets.displacements[5].y = std::nan("");
  refuses_targets(targets);
  targets.displacements[5].y = 0x1p51;
  refuses_targets(targets);
  const SkinBoundsData good = SkinBounds(mesh, skin, targets_of_kinds(mesh, 3, 1), clusters).data();
  const auto refuses = [&](const std::function<void(SkinBoundsData&)>& spoil) {
    SkinBoundsData bad = good;
    spoil(bad);
    EXPECT_THROW(SkinBounds{std::move(bad)}, std::invalid_argument);
  };
  refuses([](SkinBoundsData& d) { d.target_count = 2; });
  refuses([](SkinBoundsData& d) { d.target_count = 0; });
  refuses([](SkinBoundsData& d) { d.target_begin.clear(); });
  refuses([](SkinBoundsData& d) { d.target_begin.back() += 1; });
  refuses([](SkinBoundsData& d) { d.target_begin[2] = d.target_begin.back() + 5; });
  refuses([](SkinBoundsData& d) { d.targets[1].target = 3; });
  refuses([](SkinBoundsData& d) { d.targets[1].radius = -1; });
  refuses([](SkinBoundsData& d) { d.targets[1].half_extent.z = NAN; });
  refuses([](SkinBoundsData& d) { d.targets[1].shift.x = HUGE_VALF; });
}

}  // namespace
}  // namespace morula
