// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// SDFormat: poses in frames that are relative to each other are resolved first, joints are made from them then.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <numbers>

#include "read/assembly.hpp"

namespace morula::robot {

namespace {

using tinyxml2::XMLElement;

constexpr double no_limit = 1e15;  // value in files that mean no limit

class SdfReader {
 public:
  SdfReader(const Xml& xml, const ReadOptions& options) : xml_(xml), options_(options) {
    robot().file = xml.file();
    robot().format = Robot::Format::sdf;
  }

  Robot run() {
    version_ = version();
    const XMLElement& model = find_model();
    robot().name = xml_.text(model, "name");
    for (const XMLElement* at = model.FirstChildElement(); at != nullptr; at = at->NextSiblingElement()) {
      const std::string_view kind = at->Name();
      if (kind == "include" || kind == "model") {
        xml_.fail(*at, fmt::format("<{}> in a model is not supported: write its links and joints into this one, as "
                                   "`gz sdf -p` does for <include>",
                                   kind));
      }
      if (kind == "link" || kind == "joint" || kind == "frame") add_frame(*at, kind);
    }
    if (links_.empty()) xml_.fail(model, "there is no link");
    for (const auto& [name, frame] : frames_) resolve(name, *frame.at);
    for (const XMLElement* at : links_) add_link(*at);
    for (const XMLElement* at : joints_) add_joint(*at);
    leave_out_loops();
    for (const XMLElement* at : joints_) add_mimics(*at);
    require_no_mimic_circle(robot());
    arrange(robot());
    const std::string& root = robot().links[robot().root].name;
    if (root != "world" && !(frames_.at(root).pose == RigidTransform{})) {
      robot().notes.push_back(
          fmt::format("{} does not stand in the model's origin: poses are given in its axes", root));
    }
    return std::move(robot());
  }

 private:
  struct Frame {
    const XMLElement* at = nullptr;
    std::string_view kind;
    RigidTransform pose{};  // in the model
    enum class State { waiting, at_work, done } state = State::waiting;
  };

  /// A joint that waits until the others are joined.
  struct Loop {
    const XMLElement* joint;
    std::size_t parent, child;
  };

  Robot& robot() { return assembly_.robot; }

  const XMLElement& find_model() const {
    const XMLElement* model = nullptr;
    const auto visit = [&](const XMLElement& in) {
      for (const XMLElement* at = in.FirstChildElement("model"); at != nullptr; at = at->NextSiblingElement("model")) {
        if (model != nullptr) {
          xml_.fail(*at, fmt::format("there are two models, {} and {}: a robot is one; save them apart",
                                     xml_.text(*model, "name"), xml_.text(*at, "name")));
        }
        model = at;
      }
    };
    visit(xml_.root());
    for (const XMLElement* world = xml_.root().FirstChildElement("world"); world != nullptr;
         world = world->NextSiblingElement("world")) {
      visit(*world);
    }
    if (model == nullptr) xml_.fail(xml_.root(), "there is no <model>");
    return *model;
  }

  // Text of elements.

  std::string text(const XMLElement& of, const char* name, const char* fallback = nullptr) const {
    const XMLElement* at = of.FirstChildElement(name);
    const char* value = at == nullptr ? nullptr : at->GetText();
    if (value == nullptr && fallback == nullptr) xml_.fail(of, fmt::format("<{}> has no <{}>", of.Name(), name));
    std::string result = value == nullptr ? fallback : value;
    const std::size_t begin = result.find_first_not_of(" \t\r\n");
    if (begin == std::string::npos) {
      if (fallback == nullptr) xml_.fail(of, fmt::format("<{}> of <{}> is empty", name, of.Name()));
      return fallback;
    }
    return result.substr(begin, result.find_last_not_of(" \t\r\n") + 1 - begin);
  }

  std::vector<double> numbers_in(const XMLElement& at, std::size_t count) const {
    std::vector<double> values;
    const char* given = at.GetText();
    if (given == nullptr || !read_numbers(given, values) || values.size() != count) {
      xml_.fail(at, fmt::format("<{}> holds \"{}\", which is not {}", at.Name(), given == nullptr ? "" : given,
                                count == 1 ? std::string("a number") : fmt::format("{} numbers", count)));
    }
    return values;
  }

  double number(const XMLElement& of, const char* name, double fallback) const {
    const XMLElement* at = of.FirstChildElement(name);
    return at == nullptr ? fallback : numbers_in(*at, 1)[0];
  }

  Vec3 vector(const XMLElement& of, const char* name, const Vec3& fallback) const {
    const XMLElement* at = of.FirstChildElement(name);
    if (at == nullptr) return fallback;
    const std::vector<double> v = numbers_in(*at, 3);
    return {v[0], v[1], v[2]};
  }

  /// Limits may be infinite.
  double limit(const XMLElement& of, const char* name, double fallback) const {
    const XMLElement* at = of.FirstChildElement(name);
    if (at == nullptr || at->GetText() == nullptr) return fallback;
    const std::string word = text(of, name, "");
    if (word == "inf" || word == "+inf" || word == "-inf") return word[0] == '-' ? -2 * no_limit : 2 * no_limit;
    return numbers_in(*at, 1)[0];
  }

  double not_below_zero(const XMLElement& of, const char* name) const {
    const XMLElement* at = of.FirstChildElement(name);
    if (at == nullptr) xml_.fail(of, fmt::format("<{}> has no <{}>", of.Name(), name));
    const double value = numbers_in(*at, 1)[0];
    if (!(value >= 0)) xml_.fail(*at, fmt::format("<{}> of <{}> is {}, which is below 0", name, of.Name(), value));
    return value;
  }

  bool is_true(const XMLElement& of, const char* name) const {
    const std::string value = text(of, name, "false");
    if (value != "true" && value != "false" && value != "1" && value != "0") {
      xml_.fail(of, fmt::format("<{}> of <{}> is {}, neither true nor false", name, of.Name(), value));
    }
    return value == "true" || value == "1";
  }

  /// The pose as written; base_of() returns the frame to which it is relative.
  RigidTransform own_pose(const XMLElement& of) const {
    const XMLElement* at = of.FirstChildElement("pose");
    if (at == nullptr || at->GetText() == nullptr) return {};
    const char* format = at->Attribute("rotation_format");
    if (format != nullptr && std::string_view(format) == "quat_xyzw") {
      const std::vector<double> v = numbers_in(*at, 7);
      if (!(v[3] * v[3] + v[4] * v[4] + v[5] * v[5] + v[6] * v[6] > 0)) xml_.fail(*at, "a quaternion is 0");
      return RigidTransform::from_quaternion(v[6], v[3], v[4], v[5], {v[0], v[1], v[2]});
    }
    if (format != nullptr && std::string_view(format) != "euler_rpy") {
      xml_.fail(*at, fmt::format("rotation_format=\"{}\" is neither euler_rpy nor quat_xyzw", format));
    }
    std::vector<double> v = numbers_in(*at, 6);
    const char* degrees = at->Attribute("degrees");
    if (degrees != nullptr && (std::string_view(degrees) == "true" || std::string_view(degrees) == "1")) {
      for (std::size_t i = 3; i < 6; ++i) v[i] *= std::numbers::pi / 180;
    }
    return from_roll_pitch_yaw({v[3], v[4], v[5]}, {v[0], v[1], v[2]});
  }

  std::string relative_name(const XMLElement& of) const {
    const XMLElement* at = of.FirstChildElement("pose");
    const char* name = at == nullptr ? nullptr : at->Attribute("relative_to");
    return name == nullptr ? "" : name;
  }

  // Frames.

  void add_frame(const XMLElement& at, std::string_view kind) {
    const std::string name = xml_.text(at, "name");
    // A link of this name may stand where the model does, which is where others take it to be.
    const bool stands_for_world =
        name == "world" && kind == "link" && relative_name(at).empty() && own_pose(at) == RigidTransform{};
    if ((name == "world" && !stands_for_world) || name.starts_with("__")) {
      xml_.fail(at, fmt::format("{} is no name that may be given", name));
    }
    const auto [found, fresh] = frames_.emplace(name, Frame{.at = &at, .kind = kind});
    if (!fresh) {
      xml_.fail(at, found->second.kind == kind
                        ? fmt::format("there are two {}s {}", kind, name)
                        : fmt::format("a {} and a {} are both called {}", found->second.kind, kind, name));
    }
    if (kind == "link") {
      links_.push_back(&at);
      assembly_.reserve_link(name);
    } else if (kind == "joint") {
      joints_.push_back(&at);
      assembly_.reserve_joint(name);
    }
  }

  /// The frame to which the pose of a frame is relative; "" is the model.
  std::string base_of(const Frame& frame) const {
    const std::string given = relative_name(*frame.at);
    if (!given.empty()) return given == "__model__" ? "" : given;
    if (frame.kind == "joint") {
      const std::string child = text(*frame.at, "child");
      return child == "__model__" ? "" : child;
    }
    const char* attached = frame.kind == "frame" ? frame.at->Attribute("attached_to") : nullptr;
    return attached == nullptr || std::string_view(attached) == "__model__" ? "" : attached;
  }

  /// Resolves the poses of a frame and of all frames that it is relative to, without recursion: chains may be long.
  void resolve(const std::string& name, const XMLElement& referrer) {
    std::vector<std::string> chain;
    for (std::string at = name; !at.empty();) {
      const auto found = frames_.find(at);
      if (found == frames_.end()) {
        const XMLElement& by = chain.empty() ? referrer : *frames_.at(chain.back()).at;
        xml_.fail(by, fmt::format("there is no frame {}{}", at,
                                  at.find("::") == std::string::npos ? "" : ": models in models are not supported"));
      }
      Frame& frame = found->second;
      if (frame.state == Frame::State::done) break;
      if (frame.state == Frame::State::at_work) {
        xml_.fail(*frame.at, fmt::format("the pose of {} is relative to itself, through others", at));
      }
      frame.state = Frame::State::at_work;
      chain.push_back(at);
      at = base_of(frame);
    }
    for (auto it = chain.rbegin(); it != chain.rend(); ++it) {
      Frame& frame = frames_.at(*it);
      const std::string base = base_of(frame);
      frame.pose = own_pose(*frame.at);
      if (!base.empty()) frame.pose = composed(frames_.at(base).pose, frame.pose);
      frame.state = Frame::State::done;
    }
  }

  RigidTransform pose_of(const std::string& name, const XMLElement& referrer) const {
    if (name.empty() || name == "__model__" || name == "world") return {};
    const auto found = frames_.find(name);
    if (found == frames_.end()) xml_.fail(referrer, fmt::format("there is no frame {}", name));
    return found->second.pose;
  }

  /// The link that a frame moves with.
  std::string link_under(std::string name, const XMLElement& referrer) const {
    for (std::size_t steps = 0; steps <= frames_.size(); ++steps) {
      if (name == "world") return name;
      if (name == "__model__" || name.empty()) {
        const char* canonical = links_[0]->Parent()->ToElement()->Attribute("canonical_link");
        return canonical == nullptr ? xml_.text(*links_[0], "name") : canonical;
      }
      const auto found = frames_.find(name);
      if (found == frames_.end()) xml_.fail(referrer, fmt::format("there is no link {}", name));
      const Frame& frame = found->second;
      if (frame.kind == "link") return name;
      if (frame.kind == "joint") {
        name = text(*frame.at, "child");
      } else {
        const char* attached = frame.at->Attribute("attached_to");
        name = attached == nullptr ? "" : attached;
      }
    }
    xml_.fail(referrer, fmt::format("frame {} is attached to itself, through others", name));
  }

  // Links.

  void add_link(const XMLElement& at) {
    Link link;
    link.name = xml_.text(at, "name");
    link.line = at.GetLineNum();
    for (const XMLElement* it = at.FirstChildElement(); it != nullptr; it = it->NextSiblingElement()) {
      const std::string_view kind = it->Name();
      if (kind == "collision") add_shape(link.collision, *it, link.name, options_.needs(link.name, false));
      if (kind == "visual") add_shape(link.visual, *it, link.name, options_.needs(link.name, true));
      if (kind == "inertial") link.inertial = inertial(*it, link.name);
    }
    robot().links.push_back(std::move(link));
  }

  /// The pose in the link, for any frame to which it is relative.
  RigidTransform pose_in_link(const XMLElement& of, const std::string& link) const {
    const std::string base = relative_name(of);
    if (base.empty() || base == link) return own_pose(of);
    return relative_to(pose_of(link, of), composed(pose_of(base, of), own_pose(of)));
  }

  Inertial inertial(const XMLElement& of, const std::string& link) const {
    Inertial result;
    result.origin = pose_in_link(of, link);
    result.mass = number(of, "mass", 1);
    constexpr std::array names{"ixx", "ixy", "ixz", "iyy", "iyz", "izz"};
    result.inertia = {1, 0, 0, 1, 0, 1};
    if (const XMLElement* matrix = of.FirstChildElement("inertia")) {
      for (std::size_t i = 0; i < 6; ++i) result.inertia[i] = number(*matrix, names[i], result.inertia[i]);
    }
    return result;
  }

  /// Only a shape that is needed can cause a rejection.
  void add_shape(std::vector<Shape>& shapes, const XMLElement& of, const std::string& link, bool needed) {
    try {
      std::optional<Shape> shape = shape_of(of, link, needed);
      if (shape && has_surface(*shape, link, needed, robot().notes)) shapes.push_back(std::move(*shape));
    } catch (const FileError& error) {
      if (needed) throw;
      robot().notes.push_back(unread_shape_note(link, error));
    }
  }

  /// None for a shape without a surface that could be covered, with a note if it is needed.
  std::optional<Shape> shape_of(const XMLElement& of, const std::string& link, bool needed) {
    const XMLElement* geometry = of.FirstChildElement("geometry");
    const XMLElement* at = geometry == nullptr ? nullptr : geometry->FirstChildElement();
    if (at == nullptr) xml_.fail(of, fmt::format("<{}> has no geometry", of.Name()));
    if (needed) note_other_shapes(*at, link, robot().notes);
    Shape shape;
    shape.line = of.GetLineNum();
    shape.origin = pose_in_link(of, link);
    const std::string_view kind = at->Name();
    if (kind == "empty") return std::nullopt;
    if (kind == "plane") {
      if (needed) robot().notes.push_back(endless_plane_note(link, at->GetLineNum()));
      return std::nullopt;
    }
    if (kind == "mesh") {
      shape.file_name = text(*at, "uri");
      shape.scale = vector(*at, "scale", {1, 1, 1});
      if (const XMLElement* part = at->FirstChildElement("submesh")) {
        shape.part = text(*part, "name");
        shape.part_centered = is_true(*part, "center");
      }
      if (needed) shape.file = find_mesh(shape.file_name, xml_.file(), options_.package_paths, at->GetLineNum());
    } else if (kind == "box") {
      shape.kind = Shape::Kind::box;
      shape.size = vector(*at, "size", {1, 1, 1});
      if (!(shape.size.x >= 0 && shape.size.y >= 0 && shape.size.z >= 0)) xml_.fail(*at, "a box has an edge below 0");
    } else if (kind == "ellipsoid") {
      shape.kind = Shape::Kind::ellipsoid;
      shape.size = 2 * vector(*at, "radii", {1, 1, 1});
      if (!(shape.size.x >= 0 && shape.size.y >= 0 && shape.size.z >= 0))
        xml_.fail(*at, "an ellipsoid has a radius below 0");
    } else if (kind == "sphere") {
      shape.kind = Shape::Kind::sphere;
      shape.radius = not_below_zero(*at, "radius");
    } else if (kind == "cylinder" || kind == "capsule") {
      shape.kind = kind == "cylinder" ? Shape::Kind::cylinder : Shape::Kind::capsule;
      shape.radius = not_below_zero(*at, "radius");
      shape.length = not_below_zero(*at, "length");
    } else if (needed) {
      xml_.fail(*at,
                fmt::format("<{}> is no geometry that is known: mesh, box, sphere, cylinder, capsule and ellipsoid are",
                            kind));
    } else {
      return std::nullopt;
    }
    return shape;
  }

  // Joints.

  std::size_t link_at(const std::string& name) {
    if (name == "world" && robot().find_link(name) == none) {
      Link world;
      world.name = name;
      world.line = xml_.root().GetLineNum();
      robot().links.push_back(std::move(world));
    }
    if (link_place_.size() != robot().links.size()) {
      link_place_.clear();
      for (std::size_t i = 0; i < robot().links.size(); ++i) link_place_[robot().links[i].name] = i;
    }
    return link_place_.at(name);
  }

  /// A degree of freedom by <axis> or <axis2>, in the child's axes.
  Movement movement(const XMLElement& joint, const XMLElement& at, const std::string& name, bool slides, bool endless,
                    const RigidTransform& joint_pose, const RigidTransform& child_pose) {
    Movement m{
        .name = name, .kind = slides ? Joint::Kind::prismatic : Joint::Kind::revolute, .line = joint.GetLineNum()};
    const Vec3 axis = vector(at, "xyz", {0, 0, 1});
    if (!(length(axis) > 0)) xml_.fail(at, fmt::format("joint {} has an axis of length 0", name));
    RigidTransform base = joint_pose;
    const XMLElement* words = at.FirstChildElement("xyz");
    const char* expressed = words == nullptr ? nullptr : words->Attribute("expressed_in");
    if (expressed != nullptr && *expressed != '\0') {
      base = pose_of(expressed, at);
    } else if (is_true(at, "use_parent_model_frame") || version_ < 1.5) {
      base = {};
    }
    m.axis = normalized(child_pose.inverse_rotate(base.rotate(axis)));
    m.lower = -2 * no_limit, m.upper = 2 * no_limit;
    if (const XMLElement* limits = at.FirstChildElement("limit")) {
      m.lower = limit(*limits, "lower", m.lower);
      m.upper = limit(*limits, "upper", m.upper);
      const double velocity = limit(*limits, "velocity", 0), effort = limit(*limits, "effort", 0);
      m.velocity = velocity > 0 && velocity < no_limit ? velocity : 0;
      m.effort = effort > 0 && effort < no_limit ? effort : 0;
    }
    const bool open = m.lower <= -no_limit || m.upper >= no_limit;
    if (!slides && (endless || open)) {
      m.kind = Joint::Kind::continuous;
      m.lower = -std::numbers::pi, m.upper = std::numbers::pi;
    } else if (open) {
      m.lower = m.upper = 0;
      m.range_known = false;
      robot().notes.push_back(fmt::format("joint {} (line {}) has no limits and is taken to stay at 0", name, m.line));
    } else if (m.lower > m.upper) {
      xml_.fail(at, fmt::format("joint {} has a lower limit above its upper one", name));
    }
    return m;
  }

  double version() const {
    std::vector<double> numbers;
    const std::string given = xml_.text(xml_.root(), "version");
    // 1.10 comes after 1.9.
    const std::size_t point = given.find('.');
    if (point == std::string::npos || !read_numbers(given.substr(point + 1), numbers) || numbers.size() != 1 ||
        given.substr(0, point) != "1") {
      xml_.fail(xml_.root(), fmt::format("version=\"{}\" of <sdf> is none of 1.x", given));
    }
    return numbers[0] < 10 ? 1 + 0.1 * numbers[0] : 2;
  }

  void add_joint(const XMLElement& at) {
    const std::string name = xml_.text(at, "name"), type = xml_.text(at, "type");
    const std::string parent = link_under(text(at, "parent"), at), child = link_under(text(at, "child"), at);
    if (child == "world") xml_.fail(at, fmt::format("joint {} carries the world: exchange parent and child", name));
    if (parent == child) xml_.fail(at, fmt::format("joint {} joins link {} to itself", name, child));
    const std::size_t parent_link = link_at(parent), child_link = link_at(child);
    Link& carried = robot().links[child_link];
    // mutant robot-loop-closed: `none || carrier_of_all(parent_link) == carrier_of_all(child_link)` -> `none`
    if (carried.joint != none || carrier_of_all(parent_link) == carrier_of_all(child_link)) {
      loops_.push_back({&at, parent_link, child_link});
      return;
    }
    carriers_[carrier_of_all(child_link)] = carrier_of_all(parent_link);
    const RigidTransform joint_pose = pose_of(name, at), child_pose = pose_of(child, at);
    const RigidTransform in_parent = relative_to(pose_of(parent, at), child_pose);
    Vec3 anchor = child_pose.inverse_rotate(joint_pose.translation - child_pose.translation);
    // Poses that are given in the other direction meet up to rounding.
    const double size = max_norm(joint_pose.translation) + max_norm(child_pose.translation);
    if (max_norm(anchor) <= 1e-14 * size) anchor = {};
    const XMLElement *axis = at.FirstChildElement("axis"), *second = at.FirstChildElement("axis2");
    const auto require_axis = [&](const XMLElement* given, const char* element) {
      if (given == nullptr) xml_.fail(at, fmt::format("joint {} is {} and has no <{}>", name, type, element));
    };
    std::vector<Movement> movements;
    if (type == "revolute" || type == "continuous" || type == "prismatic") {
      require_axis(axis, "axis");
      movements.push_back(movement(at, *axis, name, type == "prismatic", type == "continuous", joint_pose, child_pose));
    } else if (type == "universal" || type == "revolute2") {
      require_axis(axis, "axis");
      require_axis(second, "axis2");
      movements.push_back(movement(at, *axis, name, false, false, joint_pose, child_pose));
      movements.push_back(
          movement(at, *second, assembly_.fresh_joint(name + "_2"), false, false, joint_pose, child_pose));
    } else if (type == "ball") {
      movements = ball_movements(name, anchor, at.GetLineNum());
      for (Movement& m : movements) m.name = assembly_.fresh_joint(m.name);
    } else if (type != "fixed") {
      xml_.fail(at, fmt::format("joint {} is {}, which is not supported: fixed, revolute, continuous, prismatic, ball, "
                                "universal and revolute2 are",
                                name, type));
    }
    for (Movement& m : movements) m.anchor = anchor;
    if (movements.empty()) {
      Joint joint;
      joint.name = name;
      joint.line = at.GetLineNum();
      joint.parent = parent_link, joint.child = child_link, joint.origin = in_parent;
      carried.joint = robot().joints.size();
      robot().joints.push_back(std::move(joint));
    } else {
      assembly_.carry(parent_link, child_link, in_parent, movements, at.GetLineNum());
    }
  }

  /// One link that represents all links joined so far, in either direction.
  std::size_t carrier_of_all(std::size_t link) const {
    for (auto found = carriers_.find(link); found != carriers_.end(); found = carriers_.find(link))
      link = found->second;
    return link;
  }

  /// A joint between links that others join anyway closes a loop: a robot is the tree of the joints before it.
  void leave_out_loops() {
    for (const Loop& loop : loops_) {
      const std::string name = xml_.text(*loop.joint, "name");
      const Link &parent = robot().links[loop.parent], &child = robot().links[loop.child];
      if (carrier_of_all(loop.parent) != carrier_of_all(loop.child)) {
        xml_.fail(*loop.joint, fmt::format("link {} is carried by two joints, {} and {}: a robot is a tree", child.name,
                                           robot().joints[child.joint].name, name));
      }
      robot().ignored.push_back({parent.name, child.name});
      robot().notes.push_back(fmt::format(
          "joint {} (line {}) closes a loop and is left out: {} and {} come apart in poses that do not keep "
          "it closed, and are not tested against each other",
          name, loop.joint->GetLineNum(), parent.name, child.name));
    }
  }

  void add_mimics(const XMLElement& at) {
    const XMLElement* axis = at.FirstChildElement("axis");
    const XMLElement* mimic = axis == nullptr ? nullptr : axis->FirstChildElement("mimic");
    if (mimic == nullptr) return;
    const std::size_t leader = robot().find_joint(xml_.text(*mimic, "joint"));
    const std::size_t follower = robot().find_joint(xml_.text(at, "name"));
    const char* which = mimic->Attribute("axis");
    if (leader == none || follower == none || (which != nullptr && std::string_view(which) != "axis")) {
      robot().notes.push_back(fmt::format("joint {} (line {}) follows {} in a way that is not kept: it moves by itself",
                                          xml_.text(at, "name"), at.GetLineNum(), xml_.text(*mimic, "joint")));
      return;
    }
    const double multiplier = number(*mimic, "multiplier", 1);
    robot().joints[follower].mimic =
        Joint::Mimic{leader, multiplier, number(*mimic, "offset", 0) - multiplier * number(*mimic, "reference", 0)};
  }

  const Xml& xml_;
  const ReadOptions& options_;
  Assembly assembly_;
  double version_ = 2;
  std::map<std::string, Frame> frames_;
  std::vector<const XMLElement*> links_, joints_;
  std::map<std::string, std::size_t> link_place_;
  std::map<std::size_t, std::size_t> carriers_;  // of a link, another one of the same tree
  std::vector<Loop> loops_;
};

}  // namespace

Robot read_sdf(const Xml& xml, const ReadOptions& options) {
  return SdfReader(xml, options).run();
}

}  // namespace morula::robot
