// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "commands/frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <morula/update/skin_morphs.hpp>

#include "shared/command.hpp"
#include "shared/files.hpp"

namespace morula::cli {

using Follows = RuleTraits::Follows;

Follows FrameFiles::follow() const {
  return !skin.empty() ? Follows::bones : !modes.empty() ? Follows::modes : Follows::positions;
}

const std::string& FrameFiles::moving() const {
  return are_modal() ? coordinates : are_skinned() ? transforms : motion;
}

void require_frames(const FrameFiles& files) {
  if (files.modes.empty() != files.coordinates.empty()) {
    throw UsageError(files.modes.empty() ? "--coords needs the modes they belong to: add --modes FILE"
                                         : "--modes needs a coordinate per frame and mode: add --coords FILE");
  }
  if (files.skin.empty() != files.transforms.empty()) {
    throw UsageError(files.skin.empty() ? "--transforms needs the skin they move: add --skin FILE"
                                        : "--skin needs a transform per frame and bone: add --transforms FILE");
  }
  const bool has_model = !files.modes.empty() || !files.skin.empty();
  if (files.motion.empty() == !has_model) {
    throw UsageError(files.motion.empty()
                         ? "MOTION is missing: name positions, or a modal model with --modes and --coords, or a skin "
                           "with --skin and --transforms"
                         : fmt::format("both positions ({}) and {}: leave out one of them", files.motion,
                                       files.modes.empty() ? "--skin" : "--modes"));
  }
}

void require_rules_followed(const std::vector<Rule>& rules, FrameFiles& files) {
  for (const Rule rule : rules) {
    const Follows wanted = traits(rule).follows;
    if (wanted == Follows::positions || wanted == files.follow()) continue;
    if (wanted == Follows::modes) {
      throw UsageError(
          fmt::format("--rule {} needs a modal model: give --modes and --coords instead of MOTION", name(rule)));
    }
    const std::string ending = extension(files.motion);
    if (ending != ".gltf" && ending != ".glb") {
      throw UsageError(fmt::format("--rule {} needs a skin: give --skin and --transforms, or a .gltf or .glb as MOTION",
                                   name(rule)));
    }
    files.skin = files.transforms = files.motion;
    files.motion.clear();
  }
}

Frames::Frames(const FrameFiles& files, const LoadedMesh& loaded) : follow_(files.follow()) {
  const Mesh& mesh = loaded.mesh;
  MotionOptions animation = files.animation;
  animation.weld = loaded.merged();
  file_name_ = std::filesystem::path(files.moving()).filename().string();
  switch (follow_) {
    case Follows::positions:
      motion_.emplace(files.motion, mesh, animation);
      return;
    case Follows::modes:
      modes_ = loaded.weld ? read_modes(files.modes, mesh, *loaded.weld) : read_modes(files.modes, mesh);
      coordinates_ = read_coordinates(files.coordinates, modes_.mode_count);
      break;
    case Follows::bones:
      read_bones(files, loaded);
      break;
  }
  rest_ = mesh.positions;
  positions_ = rest_;
}

// The morph targets are those of --modes, or those of a glTF that has skin and transforms.
void Frames::read_bones(const FrameFiles& files, const LoadedMesh& loaded) {
  const Mesh& mesh = loaded.mesh;
  skin_ = loaded.weld ? read_skin(files.skin, mesh, *loaded.weld) : read_skin(files.skin, mesh);
  const bool has_own = files.modes.empty() && files.skin == files.transforms;
  if (const std::string& targets = has_own ? files.skin : files.modes; !targets.empty())
    modes_ = loaded.weld ? read_modes(targets, mesh, *loaded.weld) : read_modes(targets, mesh);
  if (has_own) {
    bones_ = read_bone_frames(files.transforms, skin_.bone_count, modes_.mode_count, files.animation);
    coordinates_ = std::move(bones_.morphs);
  } else {
    bones_ = read_bone_frames(files.transforms, skin_.bone_count, files.animation);
    if (!files.modes.empty()) coordinates_ = read_coordinates(files.coordinates, modes_.mode_count);
  }
  if (!modes_.empty() && coordinates_.frame_count() != bones_.frame_count())
    throw UsageError(fmt::format("{} has {} frames, but {} has {}", files.coordinates, coordinates_.frame_count(),
                                 files.transforms, bones_.frame_count()));
  const auto is_zero = [](double q) { return q == 0; };
  if (std::all_of(coordinates_.coordinates.begin(), coordinates_.coordinates.end(), is_zero)) {
    modes_ = {};
    coordinates_ = {};
  }
}

std::size_t Frames::count() const {
  return motion_                     ? motion_->frame_count()
         : follow_ == Follows::bones ? bones_.frame_count()
                                     : coordinates_.frame_count();
}

std::string Frames::name(std::size_t i) const {
  return motion_ ? motion_->frame_name(i) : fmt::format("{} frame {}", file_name_, i);
}

const std::vector<Vec3>& Frames::load(std::size_t i, const Body& body, Workers& workers) {
  loaded_ = i;
  if (motion_) {
    positions_ = motion_->frame(i);
  } else if (follow_ == Follows::bones) {
    move_by_skin(body.options().skin, body.options().modes, rest_, bones_.frame(i), coordinates_.frame(i), positions_,
                 workers);
  } else {
    move_by_modes(body.options().modes, rest_, coordinates_.frame(i), positions_, workers);
  }
  return positions_;
}

UpdateStatus Frames::update(Body& body, Workers& workers) const {
  if (motion_) return body.update(positions_, workers);
  return follow_ == Follows::bones ? body.update_skinned(bones_.frame(loaded_), coordinates_.frame(loaded_), workers)
                                   : body.update_modal(coordinates_.frame(loaded_), workers);
}

}  // namespace morula::cli
