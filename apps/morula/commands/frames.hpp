// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Where the frames of an update come from: files with positions, or the coordinates of a modal model.
#pragma once

#include <morula/io/modal_file.hpp>
#include <morula/io/motion_file.hpp>
#include <morula/update/body.hpp>
#include <optional>
#include <string>
#include <vector>

namespace morula::cli {

/// The paths as given; those that were not are empty.
struct FrameFiles {
  std::string motion;
  std::string modes;
  std::string coordinates;

  bool are_modal() const { return !modes.empty(); }
};
/// Throws UsageError unless there is either a motion, or modes and their coordinates.
void require_frames(const FrameFiles& files);

class Frames {
 public:
  /// mesh: at rest.
  Frames(const FrameFiles& files, const Mesh& mesh);

  /// For the options of the body that is to be moved; empty for positions from files.
  Modes take_modes() { return std::move(modes_); }
  std::size_t count() const { return motion_ ? motion_->frame_count() : coordinates_.frame_count(); }
  std::string name(std::size_t i) const;

  /// Reads frame i, or moves the mesh by its coordinates and the body's modes.
  const std::vector<Vec3>& load(std::size_t i, const Body& body, Workers& workers);
  /// Moves the body to the frame loaded last.
  UpdateStatus update(Body& body, Workers& workers) const;

 private:
  std::string modal_name_;
  std::optional<Motion> motion_;
  Modes modes_;
  ModalCoordinates coordinates_;
  std::vector<Vec3> rest_, positions_;
  std::size_t loaded_ = 0;
};

}  // namespace morula::cli
