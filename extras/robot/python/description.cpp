// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The description of a robot: links, joints, shapes.
#include <morula/robot/robot.hpp>
#include <string>

#include "records.hpp"
#include "robots.hpp"

namespace morula::python {

void bind_robot_description(nb::module_& m) {
  using robot::Inertial;
  using robot::Joint;
  using robot::Link;
  using robot::Robot;
  using robot::Shape;
  Record<Shape>(m, "Shape", doc::Shape)
      .property("kind", [](const Shape& s) { return std::string(name(s.kind)); })
      .field("origin", &Shape::origin, doc::Shape_origin)
      .field("size", &Shape::size, doc::Shape_size)
      .field("radius", &Shape::radius, doc::Shape_radius)
      .field("length", &Shape::length, doc::Shape_length)
      .field("file_name", &Shape::file_name, doc::Shape_file_name)
      .field("file", &Shape::file, doc::Shape_file)
      .field("scale", &Shape::scale, doc::Shape_scale)
      .field("line", &Shape::line, doc::Shape_line)
      .field("before", &Shape::before, doc::Shape_before)
      .field("part", &Shape::part, doc::Shape_part)
      .field("part_centered", &Shape::part_centered, doc::Shape_part_centered)
      .field("described_in", &Shape::described_in, doc::Shape_described_in);
  Record<Inertial>(m, "Inertial", "Mass and inertia of a link in the robot's file.")
      .field("mass", &Inertial::mass)
      .field("origin", &Inertial::origin)
      .field("inertia", &Inertial::inertia, doc::Inertial_inertia);
  Record<Link>(m, "Link", "A link with its shapes.")
      .field("name", &Link::name)
      .field("collision", &Link::collision)
      .field("visual", &Link::visual)
      .field("inertial", &Link::inertial)
      .property(
          "joint", [](const Link& l) { return index_or_none(l.joint); }, "The joint to the parent; None: the root.")
      .field("line", &Link::line)
      .shown({"name", "collision", "visual", "joint"});
  Record<Joint::Mimic>(m, "Mimic",
                       "The joint whose value another joint follows: value = multiplier * its value + offset.")
      .property("joint", [](const Joint::Mimic& j) { return index_or_none(j.joint); })
      .field("multiplier", &Joint::Mimic::multiplier)
      .field("offset", &Joint::Mimic::offset);
  Record<Joint>(m, "Joint", "A joint between two links.")
      .field("name", &Joint::name)
      .property("kind", [](const Joint& j) { return std::string(name(j.kind)); })
      .property(
          "parent", [](const Joint& j) { return index_or_none(j.parent); }, "A link.")
      .property(
          "child", [](const Joint& j) { return index_or_none(j.child); }, "A link.")
      .field("origin", &Joint::origin, doc::Joint_origin)
      .field("axis", &Joint::axis, doc::Joint_axis)
      .field("range_known", &Joint::range_known, doc::Joint_range_known)
      .field("lower", &Joint::lower, doc::Joint_lower)
      .field("upper", &Joint::upper, doc::Joint_lower)
      .field("velocity", &Joint::velocity, doc::Joint_velocity)
      .field("effort", &Joint::effort, doc::Joint_velocity)
      .field("mimic", &Joint::mimic)
      .field("line", &Joint::line)
      .python()
      .def_prop_ro(
          "moves", [](const Joint& j) { return j.moves(); }, "True for a revolute, continuous or prismatic joint.");
  Record<Robot>(m, "Robot", "Links with their shapes, and the joints between them; read_robot() reads them.")
      .field("name", &Robot::name)
      .field("file", &Robot::file)
      .property("format",
                [](const Robot& r) -> std::string {
                  return r.format == Robot::Format::urdf ? "urdf" : r.format == Robot::Format::mjcf ? "mjcf" : "sdf";
                })
      .field("links", &Robot::links)
      .field("joints", &Robot::joints)
      .property(
          "root", [](const Robot& r) { return index_or_none(r.root); }, doc::Robot_root)
      .field("order", &Robot::order, doc::Robot_order)
      .field("independent_joints", &Robot::independent_joints, doc::Robot_independent_joints)
      .field("notes", &Robot::notes, doc::Robot_notes)
      .field("included", &Robot::included, doc::Robot_included)
      .field("expanded", &Robot::expanded, doc::Robot_expanded)
      .field("ignored", &Robot::ignored, doc::Robot_ignored)
      .shown({"name", "format", "links", "joints", "independent_joints"})
      .python()
      .def(
          "find_link", [](const Robot& r, std::string_view name) { return index_or_none(r.find_link(name)); },
          nb::arg("name"), "The index of a link; None if there is none of this name.")
      .def(
          "find_joint", [](const Robot& r, std::string_view name) { return index_or_none(r.find_joint(name)); },
          nb::arg("name"), "The index of a joint; None if there is none of this name.");
}

}  // namespace morula::python
