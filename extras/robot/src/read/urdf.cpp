// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <map>
#include <morula/robot/robot.hpp>
#include <numbers>

#include "platform/path_text.hpp"
#include "read/assembly.hpp"

namespace morula::robot {

namespace {

using tinyxml2::XMLElement;

struct UrdfReader {
  const Xml& xml;
  const ReadOptions& options;
  Robot robot;
  std::map<std::string, std::size_t, std::less<>> link_of, joint_of;

  RigidTransform origin(const XMLElement& of) const {
    const XMLElement* at = of.FirstChildElement("origin");
    if (at == nullptr) return {};
    return from_roll_pitch_yaw(xml.vector(*at, "rpy", {}), xml.vector(*at, "xyz", {}));
  }

  double not_below_zero(const XMLElement& at, const char* attribute) const {
    const double value = xml.number(at, attribute);
    if (!(value >= 0)) xml.fail(at, fmt::format("{}=\"{}\" of <{}> is below 0", attribute, value, at.Name()));
    return value;
  }

  /// None for shapes that cannot be covered and need not be, with a note. Only a shape that is needed can cause a
  /// rejection.
  std::optional<Shape> shape(const XMLElement& of, const std::string& link, bool needed) {
    try {
      std::optional<Shape> read = shape_of(of, link, needed);
      if (read && !has_surface(*read, link, needed, robot.notes)) read.reset();
      return read;
    } catch (const FileError& error) {
      if (needed) throw;
      robot.notes.push_back(unread_shape_note(link, error));
      return std::nullopt;
    }
  }

  std::optional<Shape> shape_of(const XMLElement& of, const std::string& link, bool needed) {
    Shape shape{.origin = origin(of), .file_name = {}, .file = {}, .line = of.GetLineNum()};
    const XMLElement* geometry = of.FirstChildElement("geometry");
    const XMLElement* at = geometry == nullptr ? nullptr : geometry->FirstChildElement();
    if (at == nullptr) xml.fail(of, fmt::format("<{}> has no geometry", of.Name()));
    if (needed) note_other_shapes(*at, link, robot.notes);
    const std::string kind = at->Name();
    if (kind == "mesh") {
      shape.file_name = xml.text(*at, "filename");
      shape.scale = xml.vector(*at, "scale", {1, 1, 1});
      if (needed) shape.file = find_mesh(shape.file_name, xml.file(), options.package_paths, at->GetLineNum());
    } else if (kind == "box") {
      shape.kind = Shape::Kind::box;
      xml.text(*at, "size");
      shape.size = xml.vector(*at, "size", {});
      if (!(shape.size.x >= 0 && shape.size.y >= 0 && shape.size.z >= 0)) xml.fail(*at, "a box has an edge below 0");
    } else if (kind == "sphere") {
      shape.kind = Shape::Kind::sphere;
      shape.radius = not_below_zero(*at, "radius");
    } else if (kind == "cylinder" || kind == "capsule") {
      shape.kind = kind == "cylinder" ? Shape::Kind::cylinder : Shape::Kind::capsule;
      shape.radius = not_below_zero(*at, "radius");
      shape.length = not_below_zero(*at, "length");
    } else if (kind == "plane") {
      if (needed) robot.notes.push_back(endless_plane_note(link, at->GetLineNum()));
      return std::nullopt;
    } else {
      xml.fail(*at,
               fmt::format("<{}> is no geometry that is known: mesh, box, sphere, cylinder and capsule are", kind));
    }
    return shape;
  }

  void add_link(const XMLElement& at) {
    Link link{.name = xml.text(at, "name"), .collision = {}, .visual = {}, .inertial = {}, .line = at.GetLineNum()};
    if (!link_of.emplace(link.name, robot.links.size()).second) {
      xml.fail(at, fmt::format("there are two links {}", link.name));
    }
    for (const XMLElement* it = at.FirstChildElement(); it != nullptr; it = it->NextSiblingElement()) {
      const std::string_view name = it->Name();
      if (name == "collision" || name == "visual") {
        std::optional<Shape> read = shape(*it, link.name, options.needs(link.name, name == "visual"));
        if (read) (name == "visual" ? link.visual : link.collision).push_back(std::move(*read));
      }
      if (name == "inertial") link.inertial = inertial(*it);
    }
    robot.links.push_back(std::move(link));
  }

  Inertial inertial(const XMLElement& of) const {
    Inertial result{.origin = origin(of)};
    if (const XMLElement* mass = of.FirstChildElement("mass")) result.mass = xml.number(*mass, "value");
    if (const XMLElement* at = of.FirstChildElement("inertia")) {
      constexpr std::array names{"ixx", "ixy", "ixz", "iyy", "iyz", "izz"};
      for (std::size_t i = 0; i < 6; ++i) result.inertia[i] = xml.number(*at, names[i], 0);
    }
    return result;
  }

  Joint::Kind kind(const XMLElement& at) {
    const std::string type = xml.text(at, "type");
    if (type == "spherical") {
      robot.notes.push_back(fmt::format("joint {} (line {}) is spherical, which URDF does not have: it is held at 0",
                                        xml.text(at, "name"), at.GetLineNum()));
      return Joint::Kind::floating;
    }
    using enum Joint::Kind;
    for (const Joint::Kind known : {fixed, revolute, continuous, prismatic, floating, planar}) {
      if (type == name(known)) return known;
    }
    xml.fail(at,
             fmt::format("a joint is {}: fixed, revolute, continuous, prismatic, floating and planar are known", type));
  }

  std::size_t link_at(const XMLElement& joint, const char* side) const {
    const XMLElement* at = joint.FirstChildElement(side);
    if (at == nullptr) xml.fail(joint, fmt::format("joint {} has no {}", xml.text(joint, "name"), side));
    const std::string name = xml.text(*at, "link");
    const auto found = link_of.find(name);
    if (found == link_of.end()) xml.fail(*at, fmt::format("there is no link {}", name));
    return found->second;
  }

  void add_joint(const XMLElement& at) {
    Joint joint{.name = xml.text(at, "name"), .kind = kind(at), .origin = origin(at), .line = at.GetLineNum()};
    if (!joint_of.emplace(joint.name, robot.joints.size()).second) {
      xml.fail(at, fmt::format("there are two joints {}", joint.name));
    }
    joint.parent = link_at(at, "parent");
    joint.child = link_at(at, "child");
    Link& child = robot.links[joint.child];
    if (child.joint != none) {
      xml.fail(at, fmt::format("link {} is carried by two joints, {} and {}: a robot is a tree", child.name,
                               robot.joints[child.joint].name, joint.name));
    }
    child.joint = robot.joints.size();
    if (const XMLElement* axis = at.FirstChildElement("axis")) {
      joint.axis = xml.vector(*axis, "xyz", {1, 0, 0});
      if (joint.moves() && !(length(joint.axis) > 0)) {
        xml.fail(*axis, fmt::format("joint {} has an axis of length 0", joint.name));
      }
      joint.axis = normalized(joint.axis);
    }
    limits(at, joint);
    robot.joints.push_back(std::move(joint));
  }

  void limits(const XMLElement& at, Joint& joint) {
    const XMLElement* limit = at.FirstChildElement("limit");
    const bool needs_range = joint.kind == Joint::Kind::revolute || joint.kind == Joint::Kind::prismatic;
    joint.range_known =
        !needs_range ||
        (limit != nullptr && (limit->FindAttribute("lower") != nullptr || limit->FindAttribute("upper") != nullptr));
    if (limit != nullptr) {
      joint.lower = xml.number(*limit, "lower", 0);
      joint.upper = xml.number(*limit, "upper", 0);
      joint.velocity = xml.number(*limit, "velocity", 0);
      joint.effort = xml.number(*limit, "effort", 0);
    } else if (needs_range) {
      robot.notes.push_back(
          fmt::format("joint {} (line {}) has no limits and is taken to stay at 0", joint.name, joint.line));
    }
    if (joint.kind == Joint::Kind::continuous) joint.lower = -std::numbers::pi, joint.upper = std::numbers::pi;
    if (joint.lower > joint.upper) {
      robot.notes.push_back(
          fmt::format("joint {} (line {}) has its limits the wrong way round: exchanged", joint.name, joint.line));
      std::swap(joint.lower, joint.upper);
    }
  }

  /// Once all joints are known.
  void add_mimic(const XMLElement& at) {
    const XMLElement* mimic = at.FirstChildElement("mimic");
    if (mimic == nullptr) return;
    const std::string name = xml.text(*mimic, "joint");
    const auto found = joint_of.find(name);
    if (found == joint_of.end()) {
      robot.notes.push_back(fmt::format("joint {} (line {}) follows {}, which is not there: it moves by itself",
                                        xml.text(at, "name"), at.GetLineNum(), name));
      return;
    }
    robot.joints[joint_of.find(xml.text(at, "name"))->second].mimic =
        Joint::Mimic{found->second, xml.number(*mimic, "multiplier", 1), xml.number(*mimic, "offset", 0)};
  }
};

}  // namespace

Robot read_urdf(const Xml& xml, const ReadOptions& options) {
  UrdfReader reader{xml, options, {}, {}, {}};
  reader.robot.file = xml.file();
  const char* name = xml.root().Attribute("name");
  reader.robot.name = name == nullptr ? "" : name;
  if (reader.robot.name.empty()) {
    reader.robot.name = platform::text_of(xml.file().stem());
    reader.robot.notes.push_back(fmt::format("<robot> has no name and is called {}, as its file", reader.robot.name));
  }
  const auto each = [&](const char* element, const auto& read) {
    for (const XMLElement* at = xml.root().FirstChildElement(element); at != nullptr;
         at = at->NextSiblingElement(element))
      read(*at);
  };
  for (const XMLElement* at = xml.root().FirstChildElement(); at != nullptr; at = at->NextSiblingElement()) {
    if (std::string_view(at->Name()).starts_with("xacro:")) {
      xml.fail(*at, fmt::format("<{}> is not expanded: run xacro on the file first", at->Name()));
    }
  }
  each("link", [&](const XMLElement& at) { reader.add_link(at); });
  if (reader.robot.links.empty()) xml.fail(xml.root(), "there is no link");
  each("joint", [&](const XMLElement& at) { reader.add_joint(at); });
  each("joint", [&](const XMLElement& at) { reader.add_mimic(at); });
  reader.robot.notes.insert(reader.robot.notes.end(), xml.notes().begin(), xml.notes().end());
  require_no_mimic_circle(reader.robot);
  arrange(reader.robot);
  return std::move(reader.robot);
}

}  // namespace morula::robot
