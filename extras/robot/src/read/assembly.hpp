// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The assembly of a robot link by link, shared by the readers of all formats.
#pragma once

#include <morula/robot/robot.hpp>
#include <set>
#include <string>
#include <vector>

#include "read/xml.hpp"

namespace morula::robot {

/// One movement between a link and the link that carries it. A chain of them stands for joints that turn in several
/// ways.
struct Movement {
  std::string name;
  Joint::Kind kind = Joint::Kind::revolute;
  Vec3 axis{0, 0, 1};  ///< unit, in the child's axes
  Vec3 anchor{};       ///< a point of the axis, in the child's axes
  double lower = 0, upper = 0;
  bool range_known = true;  ///< whether the range is known, like Joint::range_known
  double velocity = 0, effort = 0;
  double reference = 0;  ///< the value at which the child has its pose
  int line = 0;
};

/// The three turns that any turn is made of, about x, then y, then z as they have moved.
std::vector<Movement> ball_movements(const std::string& name, const Vec3& anchor, int line);

class Assembly {
 public:
  Robot robot;

  /// Reserves names of the file, so that made-up names differ from them.
  void reserve_link(const std::string& name) { links_.insert(name); }
  void reserve_joint(const std::string& name) { joints_.insert(name); }
  std::string fresh_link(const std::string& wanted) { return fresh(links_, wanted); }
  std::string fresh_joint(const std::string& wanted) { return fresh(joints_, wanted); }

  /// Attaches the child, which stands at `pose` in the parent when all values are at their reference. No movement:
  /// fixed. Links without shapes are added where there are several movements, or one whose axis does not pass through
  /// the child's origin.
  void carry(std::size_t parent, std::size_t child, const RigidTransform& pose, const std::vector<Movement>& movements,
             int line);

 private:
  static std::string fresh(std::set<std::string>& taken, const std::string& wanted);
  std::size_t add_empty_link(const std::string& wanted, int line);
  void add_joint(Joint joint);

  std::set<std::string> links_, joints_;
};

/// Sets the root, the order and the independent joints, once all links and joints are there. Throws FileError if the
/// links form no tree.
void arrange(Robot& robot);
/// Throws FileError if joints follow each other in a cycle.
void require_no_mimic_circle(const Robot& robot);

/// The note on a plane among a link's shapes.
std::string endless_plane_note(const std::string& link, int line);
/// Adds the note on a <geometry> that holds more than its first shape, which is taken.
void note_other_shapes(const tinyxml2::XMLElement& taken, const std::string& link, std::vector<std::string>& notes);
/// The note on a shape that is not needed and cannot be read.
std::string unread_shape_note(const std::string& link, const FileError& error);

/// Whether the shape has a surface. A shape without extent, or with extent in only one direction, has none and is
/// skipped; a flat shape is a plate, and both of its sides are covered. If the shape is needed, `notes` reports either
/// case.
bool has_surface(const Shape& shape, const std::string& link, bool needed, std::vector<std::string>& notes);

Robot read_urdf(const Xml& xml, const ReadOptions& options);
Robot read_mjcf(const Xml& xml, const ReadOptions& options);
Robot read_sdf(const Xml& xml, const ReadOptions& options);

}  // namespace morula::robot
