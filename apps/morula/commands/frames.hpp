// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Frames of an update: files with positions, the coordinates of a modal model, or the bones of a skin, with morph
// targets or without.
#pragma once

#include <morula/io/modal_file.hpp>
#include <morula/io/motion_file.hpp>
#include <morula/io/skin_file.hpp>
#include <morula/update/body.hpp>
#include <optional>
#include <string>
#include <vector>

#include "shared/files.hpp"

namespace morula::cli {

/// The paths as given; empty if not given.
struct FrameFiles {
  std::string motion;
  std::string modes;
  std::string coordinates;
  std::string skin;
  std::string transforms;
  MotionOptions animation;

  RuleTraits::Follows follow() const;
  bool are_modal() const { return follow() == RuleTraits::Follows::modes; }
  bool are_skinned() const { return follow() == RuleTraits::Follows::bones; }
  /// The file with the data that change from frame to frame.
  const std::string& moving() const;
};
/// Throws UsageError unless there is either a motion, or modes and their coordinates, or a skin and its transforms.
/// With a skin, modes are its morph targets.
void require_frames(const FrameFiles& files);
/// Throws UsageError if a rule follows data that the files do not have. A glTF file in the place of a motion serves as
/// the skin and the transforms that a rule needs.
void require_rules_followed(const std::vector<Rule>& rules, FrameFiles& files);

class Frames {
 public:
  /// mesh: at rest. Throws UsageError for modes of a welded mesh.
  Frames(const FrameFiles& files, const LoadedMesh& mesh);

  /// The modes or morph targets, for the options of the moving body; empty if nothing moves by any.
  Modes take_modes() { return std::move(modes_); }
  Skin take_skin() { return std::move(skin_); }
  /// The transforms of all frames of a skin, frame after frame.
  const std::vector<AffineTransform>& transforms() const { return bones_.transforms; }
  std::size_t count() const;
  std::string name(std::size_t i) const;

  /// Reads frame i, or moves the mesh by its coordinates and the body's modes, by its transforms and the body's skin,
  /// or by both.
  const std::vector<Vec3>& load(std::size_t i, const Body& body, Workers& workers);
  /// Moves the body to the frame loaded last.
  UpdateStatus update(Body& body, Workers& workers) const;

 private:
  void read_bones(const FrameFiles& files, const LoadedMesh& mesh);

  RuleTraits::Follows follow_;
  std::string file_name_;
  std::optional<Motion> motion_;
  Modes modes_;
  ModalCoordinates coordinates_;
  Skin skin_;
  BoneFrames bones_;
  std::vector<Vec3> rest_, positions_;
  std::size_t loaded_ = 0;
};

}  // namespace morula::cli
