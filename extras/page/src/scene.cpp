// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <morula/geometry/inspect.hpp>
#include <morula/page/page.hpp>
#include <morula/query/signed_distance.hpp>
#include <morula/update/body.hpp>
#include <numbers>
#include <stdexcept>

namespace morula {
namespace {

/// The empty share of each sphere; none for a mesh without an inside.
std::vector<float> empty_shares(const SignedDistance& object, const std::vector<Sphere>& spheres, Workers& workers) {
  std::vector<float> shares(spheres.size(), 0.0f);
  parallel_for(workers, spheres.size(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node) {
      const double radius = spheres[node].radius;
      const double volume = 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
      if (volume > 0) shares[node] = static_cast<float>(outside_volume(object, spheres[node]) / volume);
    }
  });
  return shares;
}

/// One lattice for all frames and levels, so that their figures are comparable; it is that of morula update --measure.
MeasureOptions measure_options(const MeshView& rest) {
  MeasureOptions options{.grid = {.kind = VoxelGrid::Kind::fixed}, .with_protrusion = false};
  options.grid.voxel_edge = bounding_box(rest).diagonal() / options.grid.resolution;
  return options;
}

void measure_frame(PageScene& scene, const MeshView& rest, const std::vector<Vec3>& positions, const SphereTree& tree,
                   Workers& workers) {
  const MeshView mesh{positions, rest.facets};
  scene.measured.push_back(measure(mesh, tree, measure_options(rest), workers));
  if (inspect(rest).has_volume())
    scene.empty_share.push_back(empty_shares(SignedDistance(mesh, workers), tree.spheres, workers));
}

}  // namespace

PageScene follow_motion(const PageMotion& motion, const MeshView& rest, const CoveredTree& model,
                        const std::string& tree, const std::vector<Rule>& rules, bool measured, Workers& workers,
                        const std::function<void(double)>& progress) {
  Body body(rest, model, {.rules = rules, .details = {}, .modes = {}}, workers);
  PageScene scene{.motion = 0,
                  .tree = tree,
                  .rule = describe_rules(rules, model.tree.level_count()),
                  .rest = body.current_tree(),
                  .frames = {},
                  .measured = {},
                  .empty_share = {}};
  for (std::size_t i = 0; i < motion.frames.size(); ++i) {
    if (progress) progress(static_cast<double>(i) / static_cast<double>(motion.frames.size()));
    if (!body.update(motion.frames[i], workers)) {
      throw std::invalid_argument(
          fmt::format("{}: a vertex is too far away for single precision; nothing was written", motion.frame_names[i]));
    }
    scene.frames.emplace_back();
    body.copy_spheres(scene.frames.back());
    if (measured) measure_frame(scene, rest, motion.frames[i], body.current_tree(), workers);
  }
  return scene;
}

PageScene show_spheres(const PageMotion& motion, const MeshView& rest, const std::string& tree,
                       const std::string& label, const std::function<SphereTree(std::size_t)>& tree_of_frame,
                       bool measured, Workers& workers, const std::function<void(double)>& progress) {
  PageScene scene{
      .motion = 0, .tree = tree, .rule = label, .rest = {}, .frames = {}, .measured = {}, .empty_share = {}};
  for (std::size_t i = 0; i < motion.frames.size(); ++i) {
    if (progress) progress(static_cast<double>(i) / static_cast<double>(motion.frames.size()));
    const SphereTree current = tree_of_frame(i);
    if (i == 0) scene.rest = current;
    scene.frames.push_back(current.spheres);
    if (measured) measure_frame(scene, rest, motion.frames[i], current, workers);
  }
  return scene;
}

}  // namespace morula
