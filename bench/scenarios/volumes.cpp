// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenario volumes: spheres, boxes and k-DOPs of one tree with one ownership: what a frame costs, how much empty space
// they take in, how many pairs of nodes two bodies have to test.
#include "volumes.hpp"

#include <cmath>
#include <morula/accuracy/looseness.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/tree/cover.hpp>

#include "frames.hpp"
#include "resources.hpp"

namespace morula::bench {
namespace {

/// Turned about its center and shifted: another pose of a body beside itself.
Frame posed(const Frame& frame, const Vec3& axis, double degrees, const Vec3& shift) {
  Box box;
  for (const Vec3f& p : frame) box.add(Vec3(p));
  const Vec3 u = normalized(axis), center = box.center();
  const auto [sin, cos] = sin_cos(degrees * std::numbers::pi / 180);
  Frame moved;
  for (const Vec3f& p : frame) {
    const Vec3 v = Vec3(p) - center;
    moved.emplace_back(center + v * cos + cross(u, v) * sin + u * (dot(u, v) * (1 - cos)) + shift);
  }
  return moved;
}

/// The body beside itself, turned.
struct Poses {
  std::vector<Frame> deep;      ///< half inside one another
  std::vector<Frame> touching;  ///< moved apart until few leaves are near one another
};

Poses make_poses(const Frame& frame, const Input& input, const CoveredTree& model) {
  constexpr std::array<Vec3, 3> turns{Vec3{1, 2, 3}, Vec3{-2, 1, 0.5}, Vec3{0.3, -1, 2}};
  Box box;
  for (const Vec3f& p : frame) box.add(Vec3(p));
  // The tightest of all decide.
  const std::unique_ptr<Volumes> here = volume_kinds().back().make(input.mesh, model);
  const std::unique_ptr<Volumes> there = volume_kinds().back().make(input.mesh, model);
  require(here->update(frame, serial_workers()));
  const std::size_t few = model.tree.leaf_count() / 50;

  Poses poses;
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = [&](double share) {
      Vec3 shift;
      shift[axis] = share * box.extent()[axis];
      return posed(frame, turns[static_cast<std::size_t>(axis)], 37.0 + 50 * axis, shift);
    };
    for (const double share : {0.1, 0.4}) poses.deep.push_back(at(share));
    double inside = 0, apart = 4;
    for (int step = 0; step < 12; ++step) {
      const double middle = 0.5 * (inside + apart);
      require(there->update(at(middle), serial_workers()));
      (here->traverse(*there).touching_leaves > few ? inside : apart) = middle;
    }
    poses.touching.push_back(at(inside));
  }
  return poses;
}

struct Contender {
  const VolumeKind* kind;
  std::unique_ptr<Volumes> volumes;
  std::vector<std::uint64_t> hashes{};  // one per frame
  UpdateStatus work{};
  bool covers = true;
  bool same = true;
  Result result;
};

Contender contender(const VolumeKind& kind, const Input& input, const CoveredTree& model,
                    const std::vector<Frame>& frames) {
  Contender c{.kind = &kind,
              .volumes = kind.make(input.mesh, model),
              .result = {.scenario = "volumes", .item = kind.name, .mesh = input.name}};
  bool updated = true;
  for (const Frame& frame : frames) {
    c.work = c.volumes->update(frame, serial_workers());
    require(c.work);
    updated = updated && c.work;
    c.hashes.push_back(c.volumes->hash());
    c.covers = c.covers && c.volumes->covers(frame);
  }
  c.result.expect(updated, "an update was rejected");
  // Approach 2 promises no cover.
  if (kind.name != "spheres, approach2") c.result.expect(c.covers, "surface outside the volumes");
  c.result.expect(c.hashes.front() == c.hashes.back(), "back at rest the volumes are not those of rest");
  return c;
}

/// All in turn, so that a machine that is busy for a while is busy for all of them.
void time_frames(std::vector<Contender>& contenders, const std::vector<Frame>& frames, const Settings& settings) {
  timed(settings, [&] {
    for (Contender& c : contenders)
      for (std::size_t f = 0; f < frames.size(); ++f) {
        c.result.seconds.push_back(
            processor_seconds_of([&] { require(c.volumes->update(frames[f], serial_workers())); }));
        c.same = c.same && c.volumes->hash() == c.hashes[f];
      }
  });
  for (Contender& c : contenders)
    for (std::size_t f = 0; f < frames.size(); ++f) {
      require(c.volumes->update(frames[f], *settings.workers));
      c.same = c.same && c.volumes->hash() == c.hashes[f];
    }
}

void measure_looseness(std::vector<Contender>& contenders, const SphereTree& tree, const MeshView& bent,
                       const Settings& settings) {
  const std::size_t levels = tree.level_count();
  Box box;
  for (const Contender& c : contenders)
    for (std::uint32_t node = tree.level_begin[std::min<std::size_t>(1, levels - 1)]; node < tree.node_count(); ++node)
      box.add(c.volumes->box(node));
  constexpr int resolution = 96;
  const SharedLattice lattice(box, resolution, bent, *settings.workers);
  for (Contender& c : contenders) {
    for (std::size_t level = 1; level < levels; ++level)
      c.result.figures.push_back(
          {"looseness " + std::to_string(level), lattice.looseness(*c.volumes, level_set(tree, level))});
    if (c.kind->name != "spheres, exact") continue;
    // The lattice is coarse; that it counts the right thing shows beside the finer measure.
    std::vector<Sphere> leaves;
    for (const std::uint32_t node : level_set(tree, levels - 1)) {
      const Box around = c.volumes->box(node);
      leaves.push_back({around.center(), 0.5 * around.extent().x});
    }
    const double finer = looseness(bent, leaves, {}, *settings.workers).looseness.value_or(-1);
    c.result.expect(std::abs(c.result.figures.back().value - finer) <= 0.03 + 0.1 * finer,
                    "the lattice finds another looseness than the measure");
  }
}

void count_pairs(Contender& c, const Volumes& here, Volumes& there, const std::vector<Frame>& poses,
                 const std::string& how) {
  Pairs sum;
  double seconds = 0;
  bool same = true;
  for (const Frame& pose : poses) {
    require(there.update(pose, serial_workers()));
    Pairs pairs;
    seconds += processor_seconds_of([&] { pairs = here.traverse(there); });
    sum.tests += pairs.tests, sum.touching_leaves += pairs.touching_leaves;
    const std::size_t touching = here.touching_leaves(there);
    same = same && (here.is_nested() ? pairs.touching_leaves == touching : pairs.touching_leaves <= touching);
  }
  c.result.expect(same, "trying all leaves finds other pairs");
  const auto count = static_cast<double>(poses.size());
  c.result.figures.push_back({"pair tests " + how, static_cast<double>(sum.tests) / count});
  c.result.figures.push_back({"leaf pairs " + how, static_cast<double>(sum.touching_leaves) / count});
  c.result.figures.push_back({"us " + how, 1e6 * seconds / count});
}

}  // namespace

std::vector<Result> run_volumes(const Input& unordered, const Settings& settings) {
  const CoveredTree as_built = build(unordered.mesh, tree_options(settings), *settings.workers);
  const std::vector<std::uint32_t> order = leaf_order(as_built);
  const Input input{unordered.name, renumbered(unordered.mesh, order)};
  const CoveredTree model = renumbered(as_built, input.mesh, order);
  const std::vector<Frame> frames = bend_and_back(input.mesh);
  const Frame& bent = frames[frames.size() / 2];
  std::vector<Contender> contenders;
  for (const VolumeKind& kind : volume_kinds()) contenders.push_back(contender(kind, input, model, frames));
  time_frames(contenders, frames, settings);

  const double exact = median(contenders.front().result.seconds);
  for (Contender& c : contenders) {
    c.result.expect(c.same, "other volumes than on one thread, or than before");
    c.result.figures = {{"ns/vertex", nanoseconds_per_vertex(c.result.seconds, input.mesh)},
                        {"times exact", median(c.result.seconds) / exact},
                        {"points tested", static_cast<double>(c.work.points_tested)},
                        {"cut points", static_cast<double>(c.work.cut_points_moved)},
                        {"bytes/node", static_cast<double>(c.volumes->bytes_per_node())},
                        {"covers all frames", c.covers ? 1.0 : 0.0}};
    require(c.volumes->update(bent, serial_workers()));
  }
  if (inspect(input.mesh).has_volume()) {
    measure_looseness(contenders, model.tree, {bent, input.mesh.facets}, settings);
  }
  const Poses poses = make_poses(bent, input, model);
  std::vector<Result> results;
  for (Contender& c : contenders) {
    const std::unique_ptr<Volumes> there = c.kind->make(input.mesh, model);
    require(c.volumes->update(bent, serial_workers()));
    count_pairs(c, *c.volumes, *there, poses.deep, "deep");
    count_pairs(c, *c.volumes, *there, poses.touching, "touching");
    results.push_back(std::move(c.result));
  }
  return results;
}

}  // namespace morula::bench
