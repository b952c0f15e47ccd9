// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The two sides of `morula collide`: meshes with their trees, motions and places.
#pragma once

#include <morula/collide/collider.hpp>
#include <morula/io/motion_file.hpp>
#include <optional>
#include <string>

#include "shared/files.hpp"

namespace morula::cli {

/// The files as given; empty if not given.
struct SideFiles {
  char letter = 'a';  // of its options, for messages
  std::string mesh{};
  std::string tree{};
  std::string motion{};
  std::string translate{};
  std::string rotate{};
  bool weld = false;
};

/// A rigid motion from "x,y,z" and "x,y,z,degrees": turned about the axis through the origin, then moved.
RigidTransform parse_transform(const SideFiles& files);

/// One body, frame after frame. It cannot be copied or moved, because its collider borrows the other members.
class Side {
 public:
  /// Reads everything, so that missing files are reported ahead of any build.
  Side(const SideFiles& files, const std::string& sph_origin, Workers& workers);
  /// Called once: builds the tree if none was given, and the body. rules: by level.
  void prepare(const std::vector<Rule>& rules, Workers& workers);
  Side(const Side&) = delete;
  Side& operator=(const Side&) = delete;

  /// 1 without a motion.
  std::size_t frame_count() const { return motion_ ? motion_->frame_count() : 1; }
  /// The name of a frame; the last one's beyond the end.
  std::string frame_name(std::size_t frame) const;
  /// Beyond the end of its motion a body stays where it is. Throws UsageError for positions that cannot be used.
  void move_to(std::size_t frame, Workers& workers);

  const Collider& collider() const { return *collider_; }
  const Mesh& mesh() const { return loaded_.mesh; }  // at rest
  const std::string& name() const { return files_.mesh; }
  /// The name of the mesh's file without folder and extension.
  std::string stem() const;
  bool tree_was_built() const { return files_.tree.empty(); }

 private:
  SideFiles files_;
  RigidTransform transform_;
  LoadedMesh loaded_;
  std::optional<Motion> motion_;
  std::optional<CoveredTree> built_;  // as read, until the body has it
  std::optional<Body> body_;
  std::optional<Collider> collider_;
  std::vector<Vec3> positions_;
  std::optional<std::size_t> frame_;
};

}  // namespace morula::cli
