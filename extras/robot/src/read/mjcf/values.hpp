// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The values of elements: their own, or of the default classes, in the units of <compiler>.
#pragma once

#include <map>
#include <morula/geometry/rigid_transform.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "read/mjcf/files.hpp"

namespace morula::robot {

struct MjcfDefault {
  const char* value;
  const tinyxml2::XMLElement* at;
};
using MjcfAttributes = std::map<std::string_view, MjcfDefault>;

/// An element, and the class that has its default values.
struct MjcfElement {
  const tinyxml2::XMLElement& own;
  const MjcfAttributes* defaults = nullptr;

  const char* find(const char* attribute) const {
    if (const char* value = own.Attribute(attribute)) return value;
    if (defaults == nullptr) return nullptr;
    const auto found = defaults->find(attribute);
    return found == defaults->end() ? nullptr : found->second.value;
  }
};

/// The least turn that takes z to a direction.
RigidTransform turn_z_to(const Vec3& direction);

class MjcfValues {
 public:
  explicit MjcfValues(MjcfFiles& files) : files_(files) { classes_["main"]; }

  void read_compiler(const tinyxml2::XMLElement& at);
  /// The outermost <default>, and the classes in it.
  void read_default(const tinyxml2::XMLElement& at) { read_default(at, "main", 0); }

  /// The element with the class that it names, or with the class of the element around it.
  MjcfElement element(const tinyxml2::XMLElement& at, const std::string& child_class) const;
  void require_class(const tinyxml2::XMLElement& at, const std::string& name) const;

  std::vector<double> numbers(const MjcfElement& e, const char* attribute, std::size_t least, std::size_t most) const;
  std::vector<double> numbers(const MjcfElement& e, const char* attribute, std::size_t count) const {
    return numbers(e, attribute, count, count);
  }
  Vec3 vector(const MjcfElement& e, const char* attribute, const Vec3& fallback) const;
  double number(const MjcfElement& e, const char* attribute, double fallback) const;
  bool is_true(const MjcfElement& e, const char* attribute, bool fallback) const;
  /// An angle in radians.
  double angle(double value) const;
  /// By angles as they are written, about the axes of eulerseq.
  RigidTransform turn_by_euler(const Vec3& angles) const;
  RigidTransform turn(const MjcfElement& e) const;
  RigidTransform pose(const MjcfElement& e) const;

  /// A joint with a range is limited, even without an attribute for that.
  bool auto_limits() const { return auto_limits_; }
  /// Bodies that move freely and carry no other stand in the axes of their inertia, if their joint has no attribute for
  /// that.
  bool align_free() const { return align_free_; }
  /// The name of a mesh's file, as <compiler> has it.
  std::string mesh_name(const std::string& file) const;

 private:
  /// The default values of a class by element name, including the values of the classes around it.
  using Class = std::map<std::string_view, MjcfAttributes>;

  void read_default(const tinyxml2::XMLElement& at, const std::string& parent, int depth);

  MjcfFiles& files_;
  std::map<std::string, Class> classes_;
  std::string sequence_ = "xyz", mesh_folder_;
  bool degrees_ = true, auto_limits_ = true, strip_path_ = false, align_free_ = false;
};

}  // namespace morula::robot
