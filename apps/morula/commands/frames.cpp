// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "commands/frames.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "shared/command.hpp"

namespace morula::cli {

void require_frames(const FrameFiles& files) {
  if (files.modes.empty() != files.coordinates.empty()) {
    throw UsageError(files.modes.empty() ? "--coords needs the modes they belong to: add --modes FILE"
                                         : "--modes needs a coordinate per frame and mode: add --coords FILE");
  }
  if (files.motion.empty() == files.modes.empty()) {
    throw UsageError(files.motion.empty()
                         ? "MOTION is missing: name positions, or a modal model with --modes and --coords"
                         : fmt::format("both positions ({}) and --modes: leave out one of them", files.motion));
  }
}

Frames::Frames(const FrameFiles& files, const Mesh& mesh) {
  if (!files.are_modal()) {
    motion_.emplace(files.motion, mesh);
    return;
  }
  modes_ = read_modes(files.modes, mesh);
  coordinates_ = read_coordinates(files.coordinates, modes_.mode_count);
  modal_name_ = std::filesystem::path(files.coordinates).filename().string();
  rest_ = mesh.positions;
  positions_ = rest_;
}

std::string Frames::name(std::size_t i) const {
  return motion_ ? motion_->frame_name(i) : fmt::format("{} frame {}", modal_name_, i);
}

const std::vector<Vec3>& Frames::load(std::size_t i, const Body& body, Workers& workers) {
  loaded_ = i;
  if (motion_) {
    positions_ = motion_->frame(i);
  } else {
    move_by_modes(body.options().modes, rest_, coordinates_.frame(i), positions_, workers);
  }
  return positions_;
}

UpdateStatus Frames::update(Body& body, Workers& workers) const {
  return motion_ ? body.update(positions_, workers) : body.update_modal(coordinates_.frame(loaded_), workers);
}

}  // namespace morula::cli
