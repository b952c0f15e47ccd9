// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "demo/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <morula/io/mesh_file.hpp>
#include <morula/io/tree_file.hpp>
#include <stdexcept>

#include "shared/exact_check.hpp"
#include "shared/figures.hpp"
#include "shared/progress.hpp"

namespace morula::cli {
namespace {

struct Counter {
  std::size_t done = 0;
  std::size_t total = 0;
  const std::function<void(double, std::string)>& report;

  void next(std::string label) {
    report(static_cast<double>(done) / static_cast<double>(total), std::move(label));
    ++done;
  }
};

DemoCell run_cell(const NamedMesh& body, const Built& built, const MovedFrames& motion, const DemoTree& tree, Rule rule,
                  const DemoPlan& plan, const std::filesystem::path& folder, Workers& workers) {
  DemoCell cell;
  cell.body = body.name;
  cell.method = tree.method;
  cell.motion = motion.name;
  cell.rule = rule;
  const std::vector<std::size_t> measured = measured_frames(plan.frame_count);
  const std::vector<double> parameters = frame_parameters(plan.frame_count);
  const LoosenessMeter meter(body.mesh);
  const VoxelGrid grid{.kind = VoxelGrid::Kind::fixed, .voxel_edge = tree.voxel_edge};

  Body moving(body.mesh, built, {.rules = {rule}, .details = {}}, workers);
  std::vector<double> microseconds;
  std::uint64_t first_hash = 0;
  cell.certified = rule == Rule::exact;
  for (std::size_t i = 0; i < motion.frames.size(); ++i) {
    const std::vector<Vec3>& positions = motion.frames[i];
    for (int repeat = 0; repeat < plan.repeats; ++repeat) {
      Stopwatch watch;
      const UpdateStatus status = moving.update(positions);
      microseconds.push_back(1e6 * watch.lap());
      if (!status) throw std::logic_error("the demo's own motion was refused by update");
    }
    if (i == 0) first_hash = moving.hash();
    if (i + 1 == motion.frames.size()) cell.returns_to_rest = moving.hash() == first_hash;
    if (rule == Rule::exact) {
      const Certificate certificate = certify_promised_levels(moving, positions, workers);
      cell.certified = cell.certified && certificate.covered;
      cell.worst_excess = i == 0 ? certificate.worst_excess : std::max(cell.worst_excess, certificate.worst_excess);
    }
    if (std::find(measured.begin(), measured.end(), i) == measured.end()) continue;
    const SphereTree current = moving.current_tree();
    const std::vector<Sphere> leaves = level_set_spheres(current, current.level_count() - 1);
    cell.frames.push_back({i, parameters[i], meter.measure(positions, leaves, grid, workers),
                           coverage({positions, body.mesh.facets}, leaves, workers)});
    if (parameters[i] == 1.0 && tree.method == Method::morula) {
      const std::string stem = file_stem(body.name, motion.name);
      write_tree(folder / fmt::format("{}-{}.sph", stem, name(rule)), current);
    }
  }
  cell.microseconds = median(microseconds);
  cell.nanoseconds_per_vertex = 1e3 * cell.microseconds / static_cast<double>(body.mesh.vertex_count());
  return cell;
}

}  // namespace

double DemoCell::worst_looseness() const {
  double worst = 0;
  for (const FrameFigures& f : frames) worst = std::max(worst, f.looseness.looseness.value_or(0));
  return worst;
}

double DemoCell::worst_bare_area() const {
  double worst = 0;
  for (const FrameFigures& f : frames) worst = std::max(worst, f.coverage.bare_area);
  return worst;
}

double DemoCell::worst_gap() const {
  double worst = 0;
  for (const FrameFigures& f : frames) worst = std::max(worst, f.coverage.gap);
  return worst;
}

std::vector<std::size_t> measured_frames(std::size_t frame_count) {
  const std::size_t last = frame_count - 1;
  return {0, last / 4, last / 2, last};
}

// The loosest generator and the tightest.
constexpr std::array shown_methods{Method::octree, Method::morula};

std::vector<DemoTree> run_demo(const DemoPlan& plan, const std::filesystem::path& folder, Workers& workers,
                               const std::function<void(double, std::string)>& progress) {
  const std::size_t per_tree = 1 + plan.motions.size() * demo_rules.size();
  Counter counter{0, plan.bodies.size() * shown_methods.size() * per_tree, progress};
  std::vector<DemoTree> trees;
  for (const NamedMesh& body : plan.bodies) {
    std::vector<std::string> skipped;
    const std::vector<double> parameters = frame_parameters(plan.frame_count);
    const std::vector<MovedFrames> motions = move_frames(body, plan.motions, parameters, skipped);
    write_mesh(folder / (body.name + ".obj"), body.mesh);
    for (const MovedFrames& motion : motions) {
      for (std::size_t i = 0; i < parameters.size(); ++i) {
        if (parameters[i] != 1.0) continue;
        write_mesh(folder / (file_stem(body.name, motion.name) + ".obj"), Mesh{motion.frames[i], body.mesh.facets});
      }
    }
    for (const Method method : shown_methods) {
      counter.next(fmt::format("building {} {}", body.name, name(method)));
      Stopwatch watch;
      Built built = build(body.mesh, {.method = method, .progress = {}}, workers);
      DemoTree tree;
      tree.body = body.name;
      tree.method = method;
      tree.vertices = body.mesh.vertex_count();
      tree.facets = body.mesh.facet_count();
      tree.spheres = built.tree.node_count();
      tree.leaves = built.tree.leaf_count();
      tree.build_seconds = watch.lap();
      tree.voxel_edge = bounding_box(body.mesh).diagonal() / plan.resolution;
      tree.skipped = skipped;
      write_tree(folder / fmt::format("{}-{}.morula", body.name, name(method)), built);
      for (const MovedFrames& motion : motions) {
        for (const Rule rule : demo_rules) {
          counter.next(fmt::format("{} {} {} {}", body.name, name(method), motion.name, name(rule)));
          tree.cells.push_back(run_cell(body, built, motion, tree, rule, plan, folder, workers));
        }
      }
      tree.built = std::move(built);
      trees.push_back(std::move(tree));
    }
  }
  return trees;
}

}  // namespace morula::cli
