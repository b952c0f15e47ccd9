// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "commands/collide/bodies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <morula/generators/build.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/io/tree_file.hpp>
#include <numbers>

#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/options.hpp"

namespace morula::cli {

RigidTransform parse_transform(const SideFiles& files) {
  Vec3 place, axis{1, 0, 0};
  double degrees = 0;
  if (!files.translate.empty()) place = parse_vector(fmt::format("--translate-{}", files.letter), files.translate);
  if (!files.rotate.empty()) {
    const std::string option = fmt::format("--rotate-{}", files.letter);
    const std::size_t comma = files.rotate.rfind(',');
    if (comma == std::string::npos) {
      throw UsageError(fmt::format("{} '{}' is not an axis and degrees such as 0,0,1,90", option, files.rotate));
    }
    axis = parse_vector(option, files.rotate.substr(0, comma));
    degrees = parse_vector(option, "0,0," + files.rotate.substr(comma + 1)).z;
    if (axis == Vec3{}) throw UsageError(fmt::format("{} '{}': the axis has no direction", option, files.rotate));
  }
  // Squares of very long and very short axes would leave the range of double.
  axis = axis / max_norm(axis);
  degrees = std::fmod(degrees, 360);
  return RigidTransform::from_axis(axis, degrees * std::numbers::pi / 180, place);
}

Side::Side(const SideFiles& files, const std::string& sph_origin, Workers& workers)
    : files_(files),
      transform_(parse_transform(files)),
      loaded_(load_mesh(files.mesh, files.weld)),
      positions_(loaded_.mesh.positions) {
  if (!files.motion.empty()) motion_.emplace(files.motion, mesh(), MotionOptions{.weld = loaded_.merged()});
  const ReadTreeOptions reading = parse_sph_origin(sph_origin, &mesh());
  if (!files.tree.empty()) built_ = read_covered_tree(files.tree, mesh(), reading, workers);
}

void Side::prepare(const std::vector<Rule>& rules, Workers& workers) {
  CoveredTree model = built_ ? *std::move(built_) : build(mesh(), {.quality = Quality::fast}, workers);
  double largest = 0;
  for (const LevelGrowth& level : model.report.growth) largest = std::max(largest, level.largest_growth);
  if (largest > 0)
    note("spheres of {} grew by up to {}, so that they cover {}", files_.tree, figure(largest), files_.mesh);
  if (rules.size() > model.tree.level_count()) {
    throw UsageError(fmt::format("--rule names level {}, but the tree of {} has levels 0 to {}", rules.size() - 1,
                                 files_.mesh, model.tree.level_count() - 1));
  }
  body_.emplace(mesh(), std::move(model), UpdateOptions{.rules = rules, .details = {}}, workers);
  collider_.emplace(mesh(), *body_);
  collider_->set_transform(transform_);
}

std::string Side::stem() const {
  return std::filesystem::path(files_.mesh).stem().string();
}

std::string Side::frame_name(std::size_t frame) const {
  return motion_ ? motion_->frame_name(std::min(frame, motion_->frame_count() - 1))
                 : std::filesystem::path(files_.mesh).filename().string();
}

void Side::move_to(std::size_t frame, Workers& workers) {
  if (!motion_) return;
  frame = std::min(frame, motion_->frame_count() - 1);
  if (frame_ == frame) return;
  positions_ = motion_->frame(frame);
  if (const UpdateStatus status = body_->update(positions_, workers); !status) {
    throw UsageError(fmt::format("{}: vertex {} is not finite, or too far away for single precision; mend it",
                                 motion_->frame_name(frame), status.index));
  }
  collider_->set_positions(positions_);
  frame_ = frame;
}

}  // namespace morula::cli
