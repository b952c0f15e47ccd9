// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A robot put together link by link: what the readers of all formats share.
#pragma once

#include <morula/robot/robot.hpp>
#include <set>
#include <string>
#include <vector>

#include "read/xml.hpp"

namespace morula::robot {

/// One movement between a link and what carries it. A chain of them stands for joints that turn in several ways.
struct Movement {
  std::string name;
  Joint::Kind kind = Joint::Kind::revolute;
  Vec3 axis{0, 0, 1};  ///< unit, in the child's axes
  Vec3 anchor{};       ///< where the axis passes, in the child
  double lower = 0, upper = 0;
  bool range_known = true;  ///< as Joint::range_known
  double velocity = 0, effort = 0;
  double reference = 0;  ///< the value at which the child stands at its pose
  int line = 0;
};

/// The three turns that any turn is made of, about x, then y, then z as they have moved.
std::vector<Movement> ball_movements(const std::string& name, const Vec3& anchor, int line);

class Assembly {
 public:
  Robot robot;

  /// Names that the file gives: those that are made up keep clear of them.
  void reserve_link(const std::string& name) { links_.insert(name); }
  void reserve_joint(const std::string& name) { joints_.insert(name); }
  std::string fresh_link(const std::string& wanted) { return fresh(links_, wanted); }
  std::string fresh_joint(const std::string& wanted) { return fresh(joints_, wanted); }

  /// The child, which stands at `pose` in the parent when all values are at their reference. No movement: fixed. Links
  /// without shapes are added where there are several movements, or one whose axis passes beside the child's origin.
  void carry(std::size_t parent, std::size_t child, const RigidTransform& pose, const std::vector<Movement>& movements,
             int line);

 private:
  static std::string fresh(std::set<std::string>& taken, const std::string& wanted);
  std::size_t add_empty_link(const std::string& wanted, int line);
  void add_joint(Joint joint);

  std::set<std::string> links_, joints_;
};

/// Once all links and joints are there: root, order, own. Throws FileError for what is no tree.
void arrange(Robot& robot);
/// Throws FileError where joints follow each other in a circle.
void require_no_mimic_circle(const Robot& robot);

/// What is said of a plane among a link's shapes.
std::string endless_plane_note(const std::string& link, int line);
/// What is said of a <geometry> that holds more than the shape that is taken, its first; nothing where it does not.
void note_other_shapes(const tinyxml2::XMLElement& taken, const std::string& link, std::vector<std::string>& notes);
/// What is said of a shape that nobody asks for and that cannot be read.
std::string unread_shape_note(const std::string& link, const FileError& error);

/// Has the shape a surface? One of no size, or of size in one direction alone, has none and is passed over; one that is
/// flat is a plate, and both sides of it are covered. Where the shape is needed, either is told in `notes`.
bool has_surface(const Shape& shape, const std::string& link, bool needed, std::vector<std::string>& notes);

Robot read_urdf(const Xml& xml, const ReadOptions& options);
Robot read_mjcf(const Xml& xml, const ReadOptions& options);
Robot read_sdf(const Xml& xml, const ReadOptions& options);

}  // namespace morula::robot
