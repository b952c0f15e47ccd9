// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Trees for known poses: whichever serves, every level covers, none that takes up less is left aside, and rest is
// rest.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/deform/deformation.hpp>
#include <morula/geometry/rigid_transform.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/parallel/threads.hpp>
#include <morula/tree/cover.hpp>
#include <morula/update/known_poses.hpp>
#include <morula/update/rebuilt_body.hpp>
#include <optional>
#include <random>
#include <support/meshes.hpp>

#include "../bodies.hpp"
#include "limb.hpp"
#include "update/rebuild/strain_gauge.hpp"

namespace morula {
namespace {

using test::limb;
using test::stretched_limb;

const RebuildOptions known_only{.thread = RebuildThread::none};

std::vector<NamedPose> frames_of_stretch(int count = 8) {
  std::vector<NamedPose> poses;
  for (int i = 1; i <= count; ++i)
    poses.push_back({"frame " + std::to_string(i), stretched_limb(static_cast<double>(i) / count)});
  return poses;
}
const KnownPoseOptions quick_poses{.quality = Quality::draft, .pose_threshold = 1.5, .max_trees = 3};

const CoveredTree& home_with_poses() {
  static const CoveredTree model = [] {
    CoveredTree tree = build(limb(), {.depth = 2, .quality = Quality::draft});
    add_known_poses(limb(), tree, frames_of_stretch(), quick_poses);
    return tree;
  }();
  return model;
}
CoveredTree bare(CoveredTree model) {
  model.poses.clear();
  return model;
}

void expect_corners_inside(const RebuiltBody& body, const PositionView& positions, const std::string& where) {
  std::vector<Sphere> spheres;
  body.body().copy_spheres(spheres);
  // Corner by corner and level by level, not by the library's certificate.
  const Cover& cover = body.body().cover();
  for (std::uint32_t node = 0; node < spheres.size(); ++node)
    for (const std::uint32_t corner : cover.region_corners(node)) {
      Vec3 p;
      if (corner < cover.vertex_count) {
        p = positions[corner];
      } else {
        const CutPoint& cut = cover.cut_points[corner - cover.vertex_count];
        for (int k = 0; k < 3; ++k)
          if (cut.weight[k] != 0) p += positions[cut.vertex[k]] * cut.weight[k];
      }
      ASSERT_LE(distance(p, spheres[node].center), spheres[node].radius) << where << ", node " << node;
    }
}

TEST(KnownPoses, cover_in_every_frame_of_any_motion_on_every_specimen) {
  for (const test::Specimen& b : test::specimens()) {
    if (!(surface_area(b.mesh) > 0)) continue;
    std::vector<NamedPose> poses;
    for (const test::Motion& motion : test::motions()) {
      std::vector<Vec3> positions = motion.apply(b.mesh.positions);
      if (surface_area(MeshView{positions, b.mesh.facets}) > 0) poses.push_back({motion.name, std::move(positions)});
    }
    CoveredTree model = b.model;
    // All of them, tighter or not: hand-made trees are loose.
    for (const NamedPose& pose : poses) {
      const Mesh posed{pose.positions, b.mesh.facets};
      const BuildOptions how{.method = Method::octree, .depth = 2};
      model.poses.push_back({pose.name, pose.positions, std::make_shared<const CoveredTree>(build(posed, how))});
    }
    EXPECT_TRUE(validate(b.mesh, model).empty()) << b.name << ": " << validate(b.mesh, model).front();
    RebuiltBody body(b.mesh, model, known_only);
    for (int round = 0; round < 2; ++round)
      for (const NamedPose& pose : poses) {
        const RebuildStatus status = body.update(pose.positions);
        ASSERT_TRUE(status) << b.name << ", " << pose.name;
        expect_corners_inside(body, pose.positions, b.name + ", " + pose.name);
        const auto mixed = test::noisy(pose.positions, 0.05, static_cast<std::uint64_t>(round));
        ASSERT_TRUE(body.update(mixed));
        expect_corners_inside(body, mixed, b.name + ", noise on " + pose.name);
      }
    EXPECT_EQ(body.report().started, 0u);
  }
}

TEST(KnownPoses, at_a_known_pose_the_spheres_are_those_of_its_own_tree) {
  RebuiltBody body(limb(), home_with_poses(), known_only);
  ASSERT_FALSE(home_with_poses().poses.empty());
  for (const KnownPose& pose : home_with_poses().poses) {
    Body own({pose.positions, limb().facets}, *pose.model);
    ASSERT_TRUE(own.update(pose.positions));
    ASSERT_TRUE(body.update(pose.positions));
    EXPECT_EQ(body.body().hash(), own.hash()) << pose.name;
    EXPECT_FALSE(body.is_home());
  }
  EXPECT_EQ(body.report().pose_switches, home_with_poses().poses.size());
}

TEST(KnownPoses, rest_is_rest_bit_for_bit_after_any_of_them) {
  Body plain(limb(), bare(home_with_poses()));
  RebuiltBody body(limb(), home_with_poses(), known_only);
  EXPECT_EQ(body.body().hash(), plain.hash());
  EXPECT_EQ(body.body().frame(), 0u);
  ASSERT_TRUE(plain.update(limb().positions));
  for (const KnownPose& pose : home_with_poses().poses) {
    ASSERT_TRUE(body.update(pose.positions));
    ASSERT_TRUE(body.update(limb().positions));
    EXPECT_TRUE(body.is_home());
    EXPECT_EQ(body.body().hash(), plain.hash());
  }
}

TEST(KnownPoses, are_tighter_than_one_tree_over_the_motion) {
  RebuiltBody body(limb(), home_with_poses(), known_only);
  Body fixed(limb(), bare(home_with_poses()));
  for (const double t : {0.4, 0.7, 1.0}) {
    ASSERT_TRUE(body.update(stretched_limb(t)));
    ASSERT_TRUE(fixed.update(stretched_limb(t)));
    EXPECT_LT(estimate_looseness(limb(), body.body(), stretched_limb(t)).back(),
              0.8 * estimate_looseness(limb(), fixed, stretched_limb(t)).back())
        << t;
  }
}

// Long bodies that lie through each other and tumble, each on its own: leaves hold parts of several, and lengths within
// them feel some of what comes apart.
Mesh heap_at(std::uint64_t seed, int resolution = 6) {
  const Mesh part = sample_body("capsule", resolution);
  std::mt19937_64 random(seed);
  const auto within = [&](double most) { return most * (static_cast<double>(random() >> 11) * 0x1p-52 - 1); };
  const auto vector_within = [&](double most) { return Vec3{within(most), within(most), within(most)}; };
  Mesh heap;
  for (int i = 0; i < 10; ++i) {
    // One after the other: compilers differ in the order of arguments.
    const Vec3 axis = vector_within(1);
    const double turned = within(3);
    const RigidTransform place = RigidTransform::from_axis(axis, turned, vector_within(0.5));
    heap = test::joined(heap, test::placed(part, place));
  }
  return heap;
}

std::vector<Vec3> between(const Mesh& a, const Mesh& b, double t) {
  std::vector<Vec3> positions;
  for (std::size_t v = 0; v < a.positions.size(); ++v)
    positions.push_back(a.positions[v] + t * (b.positions[v] - a.positions[v]));
  return positions;
}

// Σ r³ of every level set but the root's.
std::vector<double> cubes_of_levels(const Body& body) {
  std::vector<Sphere> spheres;
  body.copy_spheres(spheres);
  std::vector<double> cubes;
  for (std::size_t level = 1; level < body.rest_tree().level_count(); ++level) {
    cubes.push_back(0);
    for (const Sphere& s : level_set_spheres(body.rest_tree(), spheres, level))
      cubes.back() += s.radius * s.radius * s.radius;
  }
  return cubes;
}

// A tree for a pose, and what its leaves took up there.
struct Ownership {
  Body body;
  double taken_up_as_made;
  std::vector<double> cubes_as_made;

  Ownership(const Mesh& posed, const std::shared_ptr<const CoveredTree>& tree, LoosenessEstimator& estimator)
      : body(posed, tree), cubes_as_made(cubes_of_levels(body)) {
    std::vector<double> looseness(tree->tree.level_count());
    estimator.pose(posed.positions);
    estimator.estimate(body, looseness);
    taken_up_as_made = 1 + looseness.back();
  }

  double growth() const {
    const std::vector<double> now = cubes_of_levels(body);
    double sum = 0;
    for (std::size_t level = 0; level < now.size(); ++level) sum += now[level] / cubes_as_made[level];
    return sum / static_cast<double>(now.size());
  }
  double taken_up() const { return taken_up_as_made * growth(); }
};

// As many poses of a heap as there are trees, and a body that knows all of them.
class Heap {
 public:
  Heap(std::uint64_t trees, int resolution) : estimator_(heap_at(1, resolution)) {
    const BuildOptions how{.method = Method::octree, .depth = 2};
    CoveredTree model;
    for (std::uint64_t seed = 1; seed <= trees; ++seed) {
      poses.push_back(heap_at(seed, resolution));
      const auto tree = std::make_shared<const CoveredTree>(build(poses.back(), how));
      ownerships_.emplace_back(poses.back(), tree, estimator_);
      if (seed == 1)
        model = *tree;
      else
        model.poses.push_back({"heap " + std::to_string(seed), poses.back().positions, tree});
    }
    body.emplace(poses.front(), model, known_only);
  }

  /// Of what serves at these positions, and of what takes up least there.
  struct Figures {
    double growth = 0, taken_up = std::numeric_limits<double>::infinity();
    double least = std::numeric_limits<double>::infinity();

    bool is_served_well() const { return taken_up <= 1.009 * least; }
  };
  Figures at(const std::vector<Vec3>& positions) {
    Figures figures;
    for (Ownership& ownership : ownerships_) {
      EXPECT_TRUE(ownership.body.update(positions));
      const double taken_up = ownership.taken_up();
      figures.least = std::min(figures.least, taken_up);
      if (ownership.body.hash() == body->body().hash())
        figures.growth = ownership.growth(), figures.taken_up = taken_up;
    }
    EXPECT_GT(figures.growth, 0) << "none of the trees serves";
    return figures;
  }

  std::vector<Mesh> poses;
  std::optional<RebuiltBody> body;

 private:
  LoosenessEstimator estimator_;
  std::vector<Ownership> ownerships_;
};

// Where the body waits, all ownerships have had their turn. As long as the one that serves takes up little more than
// where it was made, no other is looked at. From each of the first `starts` poses to all others. Returns at how many of
// the places where it waits the claim is about anything, and how many of these are served well after four frames.
struct Waits {
  int about_anything = 0, soon_served_well = 0;
};
Waits expect_none_is_left_aside(Heap& heap, std::size_t starts) {
  Waits waits;
  for (std::size_t from = 0; from < starts; ++from)
    for (std::size_t to = 0; to < heap.poses.size(); ++to)
      for (const double t : {0.5, 0.7, 1.5}) {
        if (from == to) continue;
        const std::vector<Vec3> positions = between(heap.poses[from], heap.poses[to], t);
        bool soon = false;
        for (int frame = 1; frame <= 24; ++frame) {
          EXPECT_TRUE(heap.body->update(positions));
          if (frame == 4) soon = heap.at(positions).is_served_well();
        }
        const std::uint64_t settled = heap.body->tree_version();
        for (int frame = 0; frame < 12; ++frame) EXPECT_TRUE(heap.body->update(positions));
        EXPECT_EQ(heap.body->tree_version(), settled);
        const Heap::Figures figures = heap.at(positions);
        if (figures.growth < 1.16) continue;
        ++waits.about_anything;
        waits.soon_served_well += soon;
        EXPECT_TRUE(figures.is_served_well())
            << from << " to " << to << " at " << t << ": " << figures.taken_up << " instead of " << figures.least;
      }
  return waits;
}

TEST(KnownPoses, leave_none_aside_that_takes_up_less) {
  Heap heap(7, 6);
  const Waits waits = expect_none_is_left_aside(heap, 7);
  EXPECT_GT(waits.about_anything, 60) << "of 126";
  EXPECT_EQ(waits.soon_served_well, waits.about_anything) << "several are looked at in a frame";
}

// More than are looked at before the first may be looked at again.
TEST(KnownPoses, leave_none_of_many_aside) {
  Heap heap(16, 16);
  const Waits waits = expect_none_is_left_aside(heap, 2);
  EXPECT_GT(waits.about_anything, 40) << "of 90";
}

// All others were looked at on the way, where none was any good.
TEST(KnownPoses, are_looked_at_again_when_the_body_comes_closer) {
  Heap heap(7, 6);
  for (std::size_t from = 0; from < heap.poses.size(); ++from) {
    const std::size_t to = (from + 3) % heap.poses.size();
    for (int frame = 0; frame < 12; ++frame) ASSERT_TRUE(heap.body->update(heap.poses[from].positions));
    for (const double t : {0.25, 0.5, 0.75, 0.97})
      ASSERT_TRUE(heap.body->update(between(heap.poses[from], heap.poses[to], t)));
    EXPECT_TRUE(heap.at(between(heap.poses[from], heap.poses[to], 0.97)).is_served_well()) << from << " to " << to;
  }
}

// docs/explanation/update_cost.md#how-a-rebuilt-body-chooses-its-tree
TEST(KnownPoses, of_large_bodies_one_is_looked_at_in_a_frame) {
  Heap heap(4, 40);
  const std::vector<Vec3> loose_in_all = between(heap.poses[0], heap.poses[1], 1.5);
  for (int frame = 1; frame <= 40; ++frame) {
    const std::size_t compared = heap.body->report().candidates_evaluated;
    const RebuildStatus status = heap.body->update(loose_in_all);
    ASSERT_GT(status.update.points_tested, 20'000u) << "a large body";
    EXPECT_LE(heap.body->report().candidates_evaluated, compared + 1) << frame;
  }
  EXPECT_GT(heap.body->report().candidates_evaluated, 20u);
}

// Bodies in a row that change places without a turn: leaves hold parts of one alone, so lengths feel nothing, and
// levels above would hold what has come apart.
TEST(KnownPoses, are_found_where_no_length_changes) {
  const auto eight = [](const auto& place) {
    const Mesh part = sample_body("capsule", 6);
    Mesh all;
    for (unsigned i = 0; i < 8; ++i) all = test::joined(all, test::translated(part, place(i)));
    return all;
  };
  const Mesh row = eight([](unsigned i) { return Vec3{0, 2.6 * i, 0}; });
  const Mesh mixed = eight([](unsigned i) { return Vec3{0, 2.6 * (3 * i % 8), 0}; });
  const BuildOptions how{.method = Method::octree, .depth = 4};
  CoveredTree model = build(row, how);
  model.poses.push_back({"mixed", mixed.positions, std::make_shared<const CoveredTree>(build(mixed, how))});
  ASSERT_LT(detail::StrainGauge(row, model.tree, model.cover).strain(mixed.positions), 1e-5);
  RebuiltBody body(row, model, known_only);
  for (int frame = 0; frame < 6; ++frame) ASSERT_TRUE(body.update(between(row, mixed, 0.96)));
  for (int frame = 0; frame < 200; ++frame) {
    ASSERT_TRUE(body.update(between(row, mixed, 0.96 + 0.0004 * frame)));
    EXPECT_FALSE(body.is_home()) << frame;
  }
  EXPECT_EQ(body.tree_version(), 1u) << "one change, and that is all: rounding does not choose";
}

// Trees for strong stretch tell little of what a little strain costs, by which what was rebuilt is judged.
TEST(KnownPoses, do_not_keep_what_was_rebuilt_for_another_motion_from_serving) {
  double leaves[2]{};
  for (const bool knows : {false, true}) {
    std::function<void()> job;
    RebuildOptions options{.thread = RebuildThread::host};
    options.executor = [&](std::function<void()> wanted) { job = std::move(wanted); };
    RebuiltBody body(limb(), knows ? home_with_poses() : bare(home_with_poses()), options);
    for (int frame = 1; frame <= 48; ++frame) {
      // A rebuild is done when the next estimate is begun.
      if (frame % 8 == 0 && job) std::exchange(job, nullptr)();
      const std::vector<Vec3> positions = deform(limb(), {Twist{180}}, frame / 48.0);
      ASSERT_TRUE(body.update(positions));
      if (frame % 4 == 0) leaves[knows] += estimate_looseness(limb(), body.body(), positions).back();
    }
    EXPECT_GT(body.report().swapped, 0u);
  }
  EXPECT_LT(leaves[1], 1.1 * leaves[0]);
}

TEST(KnownPoses, have_the_same_bits_for_any_number_of_workers) {
  std::vector<std::uint64_t> hashes[2];
  for (auto& run : hashes) {
    Workers workers(&run == hashes ? 1 : 3);
    CoveredTree model = bare(home_with_poses());
    add_known_poses(limb(), model, frames_of_stretch(), quick_poses, workers);
    RebuiltBody body(limb(), model, known_only, workers);
    for (int frame = 0; frame <= 24; ++frame) {
      ASSERT_TRUE(body.update(stretched_limb(std::min(1.0, frame / 20.0)), workers));
      run.push_back(body.body().hash());
    }
    EXPECT_GT(body.tree_version(), 1u);
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(KnownPoses, bad_positions_change_nothing_wherever_they_lead) {
  RebuiltBody body(limb(), home_with_poses(), known_only);
  ASSERT_TRUE(body.update(stretched_limb(1)));
  const std::uint64_t hash = body.body().hash(), version = body.tree_version();
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), 1e30}) {
    // Near rest, where another tree would serve.
    for (std::size_t v = 0; v < limb().vertex_count(); v += 7) {
      std::vector<Vec3> positions = stretched_limb(0.01);
      positions[v].x = bad;
      EXPECT_FALSE(body.update(positions));
      EXPECT_EQ(body.body().hash(), hash);
      EXPECT_EQ(body.tree_version(), version);
      EXPECT_FALSE(body.body().is_current());
    }
  }
  EXPECT_FALSE(body.update(std::vector<Vec3>(3)));
  EXPECT_EQ(body.body().hash(), hash);
  ASSERT_TRUE(body.update(stretched_limb(0.01)));
  expect_corners_inside(body, stretched_limb(0.01), "after bad positions");
}

TEST(KnownPoses, are_added_where_trees_are_loosest_until_none_is_too_loose) {
  CoveredTree model = bare(home_with_poses());
  std::vector<double> worst;
  std::size_t last = 0;
  KnownPoseOptions options = quick_poses;
  options.max_trees = 8;
  options.progress = [&](std::size_t count, double growth) {
    EXPECT_TRUE(count == last || count == last + 1) << count;
    last = count;
    worst.push_back(growth);
  };
  const KnownPosesReport report = add_known_poses(limb(), model, frames_of_stretch(), options);
  EXPECT_EQ(report.added, model.poses.size());
  EXPECT_EQ(report.trees_built, last);
  EXPECT_LE(report.added, report.trees_built);
  EXPECT_EQ(report.worst, worst.back());
  EXPECT_GT(worst.front(), 1.5);
  EXPECT_TRUE(report.worst <= 1.5 || report.added == 8u) << report.worst;
  EXPECT_TRUE(validate(limb(), model).empty());
  const std::size_t before = model.poses.size();
  EXPECT_EQ(
      add_known_poses(limb(), model, frames_of_stretch(), {.method = Method::octree, .pose_threshold = 100}).added, 0u);
  EXPECT_EQ(model.poses.size(), before);
}

// However many are built side by side: the same poses get the same trees, each that of a build alone.
TEST(KnownPoses, are_built_side_by_side_as_one_by_one) {
  KnownPoseOptions options = quick_poses;
  options.pose_threshold = 1.02;
  options.max_trees = 8;
  const BuildOptions alone{.depth = static_cast<int>(home_with_poses().tree.level_count()) - 1,
                           .seed = options.seed,
                           .quality = options.quality};
  std::vector<std::vector<std::pair<std::size_t, double>>> told(2);
  std::vector<std::vector<std::uint64_t>> hashes(2);
  for (std::size_t run = 0; run < 2; ++run) {
    options.progress = [&](std::size_t count, double worst) { told[run].push_back({count, worst}); };
    CoveredTree model = bare(home_with_poses());
    Workers workers(run == 0 ? 1 : 3);
    const KnownPosesReport report = add_known_poses(limb(), model, frames_of_stretch(16), options, workers);
    EXPECT_GE(report.trees_built, 10u) << "two are built side by side from eight on";
    EXPECT_EQ(told[run].back().first, report.trees_built);
    ASSERT_GE(model.poses.size(), 4u);
    for (const KnownPose& pose : model.poses) {
      hashes[run].push_back(tree_hash(pose.model->tree));
      EXPECT_EQ(hashes[run].back(), tree_hash(build({pose.positions, limb().facets}, alone).tree)) << pose.name;
    }
  }
  EXPECT_EQ(told[0], told[1]);
  EXPECT_EQ(hashes[0], hashes[1]);
}

// The tree at hand is as loose at the pose as at its own: what counts is what one built for the pose would do.
TEST(KnownPoses, are_added_beside_a_tree_that_is_loose_at_its_own_pose) {
  CoveredTree model = bare(home_with_poses());
  const Mesh stretched{stretched_limb(1), limb().facets};
  const auto loose = std::make_shared<const CoveredTree>(build(stretched, {.method = Method::octree, .depth = 2}));
  model.poses.push_back({"loose", stretched.positions, loose});
  const std::vector<NamedPose> poses{{"close", stretched_limb(0.99)}, {"closer", stretched_limb(0.995)}};
  const KnownPosesReport report =
      add_known_poses(limb(), model, poses, {.quality = Quality::draft, .pose_threshold = 1.5});
  ASSERT_EQ(report.added, 1u);  // which serves the other, too
  EXPECT_GE(report.trees_built, 1u);
  EXPECT_LE(report.worst, 1.5);
  const auto leaves = [](const Mesh& posed, const std::shared_ptr<const CoveredTree>& tree) {
    return estimate_looseness(posed, Body(posed, tree), posed.positions).back();
  };
  EXPECT_LT(1.5 * leaves({model.poses[1].positions, limb().facets}, model.poses[1].model), leaves(stretched, loose));
}

// Nothing is added, and a tree is built for a pose once at most.
TEST(KnownPoses, that_are_stopped_leave_the_tree_as_it_was) {
  CoveredTree model = bare(home_with_poses());
  StopSource stop;
  std::size_t trees = 0;
  KnownPoseOptions options = quick_poses;
  options.stop = stop.get_token();
  options.progress = [&](std::size_t count, double) {
    trees = count;
    if (count == 2) stop.request_stop();
  };
  EXPECT_THROW(add_known_poses(limb(), model, frames_of_stretch(), options), BuildStopped);
  EXPECT_EQ(trees, 2u);
  EXPECT_TRUE(model.poses.empty());
  options.stop = {};
  options.pose_threshold = 1.0001;
  options.max_trees = 64;
  options.progress = {};
  const KnownPosesReport report = add_known_poses(limb(), model, frames_of_stretch(), options);
  EXPECT_LE(report.trees_built, frames_of_stretch().size());
  EXPECT_EQ(report.added, model.poses.size());
}

TEST(KnownPoses, of_principal_strains_keep_the_volume_and_reach_twice_the_size) {
  const std::vector<NamedPose> poses = principal_strains(limb());
  const Vec3 extent = bounding_box(limb()).extent();
  Vec3 most;
  for (const NamedPose& pose : poses) {
    const MeshView posed{pose.positions, limb().facets};
    EXPECT_NEAR(signed_volume(posed), signed_volume(limb()), 1e-9 * signed_volume(limb())) << pose.name;
    most = max(most, bounding_box(posed).extent());
  }
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(most[axis], 2 * extent[axis], 1e-9 * extent[axis]);
  // A plate has no extent across: there is nothing to stretch.
  const Mesh flat{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  EXPECT_EQ(principal_strains(flat).size(), poses.size() / 3 * 2);
}

TEST(KnownPoses, follow_their_mesh_when_vertices_are_renumbered) {
  const auto order = leaf_order(home_with_poses());
  const Mesh mesh = renumbered(limb(), order);
  const CoveredTree model = renumbered(home_with_poses(), mesh, order);
  EXPECT_TRUE(validate(mesh, model).empty());
  RebuiltBody body(mesh, model, known_only), before(limb(), home_with_poses(), known_only);
  ASSERT_TRUE(body.update(renumbered(Mesh{stretched_limb(1), limb().facets}, order).positions));
  ASSERT_TRUE(before.update(stretched_limb(1)));
  EXPECT_EQ(body.body().rest_tree().spheres.size(), before.body().rest_tree().spheres.size());
  EXPECT_FALSE(body.is_home());
}

TEST(KnownPoses, that_are_none_of_the_mesh_are_refused) {
  const auto refused = [](CoveredTree model) {
    EXPECT_THROW(RebuiltBody(limb(), model, known_only), std::invalid_argument);
  };
  const auto words_of = [](const auto& call) -> std::string {
    try {
      call();
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "not refused";
  };
  CoveredTree model = home_with_poses();
  const std::string name = model.poses[0].name;
  // Before a body is made of it, so the words name the pose, and none of its positions is read.
  for (const bool fewer : {true, false}) {
    model = home_with_poses();
    std::vector<Vec3>& positions = model.poses[0].positions;
    fewer ? positions.pop_back() : positions.push_back({});
    EXPECT_FALSE(validate(limb(), model).empty());
    EXPECT_EQ(words_of([&] { RebuiltBody(limb(), model, known_only); }),
              "rebuild: the known pose \"" + name + "\" is not one of this mesh");
  }
  model = home_with_poses();
  model.poses[0].model = nullptr;
  EXPECT_FALSE(validate(limb(), model).empty());
  refused(model);
  model = home_with_poses();
  model.poses[0].positions[0].x += 0.5;  // no longer those that the tree was made for
  EXPECT_FALSE(validate(limb(), model).empty());
  refused(model);
  model = home_with_poses();
  const std::size_t count = limb().vertex_count();
  for (const std::size_t given : {std::size_t{2}, count + 1}) {
    std::vector<NamedPose> poses = frames_of_stretch(1);
    poses.push_back({"other", std::vector<Vec3>(given)});
    EXPECT_EQ(words_of([&] { add_known_poses(limb(), model, poses); }), "known poses: \"other\" has " +
                                                                            std::to_string(given) + " positions for " +
                                                                            std::to_string(count) + " vertices");
  }
  EXPECT_THROW(add_known_poses(limb(), model, frames_of_stretch(), {.pose_threshold = 1}), std::invalid_argument);
  EXPECT_THROW(principal_strains(limb(), 1), std::invalid_argument);
}

TEST(StrainGauge, feels_no_rigid_motion_and_every_stretch) {
  const CoveredTree& home = home_with_poses();
  const detail::StrainGauge gauge(limb(), home.tree, home.cover);
  EXPECT_EQ(gauge.strain(limb().positions), 0);
  std::vector<Vec3> turned;
  const RigidTransform place = RigidTransform::from_axis({1, 2, 3}, 0.7, {10, -20, 5});
  for (const Vec3& p : limb().positions) turned.push_back(place(p));
  EXPECT_LT(gauge.strain(turned), 1e-5);
  double before = 0;
  for (const double t : {0.05, 0.2, 0.5, 1.0}) {
    const double strain = gauge.strain(stretched_limb(t));
    EXPECT_GT(strain, before);
    before = strain;
  }
  // All lengths twice as long: half of 2 − ½.
  const std::vector<Vec3> larger = test::scaled(limb().positions, 2);
  EXPECT_NEAR(gauge.strain(larger), 0.75, 1e-6);
  const double smaller = detail::StrainGauge({larger, limb().facets}, home.tree, home.cover).strain(limb().positions);
  EXPECT_LT(smaller, 0.5) << "what shrinks is less loose";
  EXPECT_GT(smaller, 0.3);
}

}  // namespace
}  // namespace morula
