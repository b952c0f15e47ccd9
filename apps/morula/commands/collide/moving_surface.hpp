// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A surface frame by frame, for queries that need no spheres.
#pragma once

#include <algorithm>
#include <filesystem>
#include <morula/surface/surface_tree.hpp>
#include <optional>
#include <string>
#include <vector>

#include "commands/collide/bodies.hpp"
#include "shared/command.hpp"
#include "shared/files.hpp"

namespace morula::cli {

class MovingSurface {
 public:
  explicit MovingSurface(const SideFiles& files)
      : name_(files.mesh),
        transform_(parse_transform(files)),
        loaded_(load_mesh(files.mesh, files.weld)),
        placed_(loaded_.mesh.positions),
        tree_(loaded_.mesh) {
    if (!files.motion.empty()) motion_.emplace(files.motion, loaded_.mesh, MotionOptions{.weld = loaded_.merged()});
  }
  std::size_t frame_count() const { return motion_ ? motion_->frame_count() : 1; }
  /// The name of a frame; the last one's beyond the end.
  std::string frame_name(std::size_t frame) const {
    return motion_ ? motion_->frame_name(std::min(frame, motion_->frame_count() - 1))
                   : std::filesystem::path(name_).filename().string();
  }
  void move_to(std::size_t frame, Workers& workers) {
    placed_ = motion_ ? motion_->frame(std::min(frame, motion_->frame_count() - 1)) : loaded_.mesh.positions;
    for (Vec3& p : placed_) p = transform_(p);
    if (const Status status = tree_.update(placed_, workers); !status) throw UsageError(message(status));
  }
  const SurfaceTree& tree() const { return tree_; }
  const std::string& name() const { return name_; }

 private:
  std::string name_;
  RigidTransform transform_;
  LoadedMesh loaded_;
  std::optional<Motion> motion_;
  std::vector<Vec3> placed_;
  SurfaceTree tree_;
};

}  // namespace morula::cli
