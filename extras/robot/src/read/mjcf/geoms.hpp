// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Geoms, and the meshes that they name.
#pragma once

#include <map>
#include <morula/robot/robot.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "read/mjcf/values.hpp"

namespace morula::robot {

class MjcfGeoms {
 public:
  /// `notes` reports skipped geoms.
  MjcfGeoms(MjcfFiles& files, const MjcfValues& values, const ReadOptions& options, std::vector<std::string>& notes)
      : files_(files), values_(values), options_(options), notes_(notes) {}

  /// The meshes of an <asset>.
  void read_assets(const tinyxml2::XMLElement& of);
  /// A geom of this name collides, whatever its masks are.
  void set_paired(const std::string& name) { paired_.insert(name); }
  /// Adds a geom to the shapes of a link, if it collides or is visible. suffix: the end of its name in this copy.
  void add(const tinyxml2::XMLElement& at, Link& link, const RigidTransform& frame, const std::string& child_class,
           const std::string& suffix);

 private:
  struct Mesh {
    std::string file;
    Vec3 scale{1, 1, 1};
    RigidTransform before{};
    bool operator==(const Mesh&) const = default;
  };

  /// None for a geom that is infinite, or that is not needed and names no file.
  std::optional<Shape> shape_of(const MjcfElement& e, const std::string& link, const RigidTransform& frame,
                                bool needed);
  /// The first `count` numbers of size, none below 0.
  std::vector<double> sizes(const MjcfElement& e, std::size_t count) const;
  void set_mesh(Shape& shape, const Mesh& mesh, const tinyxml2::XMLElement& at, bool needed) const;

  MjcfFiles& files_;
  const MjcfValues& values_;
  const ReadOptions& options_;
  std::vector<std::string>& notes_;
  std::map<std::string, std::pair<Mesh, const tinyxml2::XMLElement*>> meshes_;
  std::set<std::string> paired_;
};

}  // namespace morula::robot
