// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// MuJoCo's XML: bodies become links, and joints of one body a chain. Default classes are looked up, not copied.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numbers>

#include "platform/path_text.hpp"
#include "read/assembly.hpp"
#include "read/mjcf/copies.hpp"
#include "read/mjcf/geoms.hpp"

namespace morula::robot {

namespace {

using tinyxml2::XMLElement;

constexpr int deepest_body = 500;

class MjcfReader {
 public:
  MjcfReader(const Xml& xml, const ReadOptions& options)
      : files_(xml, options.package_paths, assembly_.robot.included),
        values_(files_),
        geoms_(files_, values_, options, assembly_.robot.notes),
        copies_(files_, values_) {
    robot().file = xml.file();
    robot().format = Robot::Format::mjcf;
    const char* name = xml.root().Attribute("model");
    robot().name = name == nullptr || *name == '\0' ? platform::text_of(xml.file().stem()) : name;
  }

  Robot run() {
    const std::vector<const XMLElement*> sections = files_.children(files_.main().root());
    const auto each = [&](std::string_view name, const auto& read) {
      for (const XMLElement* at : sections) {
        if (at->Name() == name) read(*at);
      }
    };
    each("compiler", [&](const XMLElement& at) { values_.read_compiler(at); });
    each("default", [&](const XMLElement& at) { values_.read_default(at); });
    each("asset", [&](const XMLElement& at) { geoms_.read_assets(at); });
    each("deformable", [&](const XMLElement& at) { reject_children(at); });
    each("worldbody", [&](const XMLElement& at) { reserve_names(at, 0); });
    each("contact", [&](const XMLElement& at) { read_contacts(at); });
    Link world;
    world.name = "world";
    assembly_.reserve_link(world.name);
    world.line = files_.main().root().GetLineNum();
    robot().links.push_back(std::move(world));
    each("worldbody", [&](const XMLElement& at) { add_children(at, 0, {}, "main", 0); });
    if (robot().links.size() == 1) take_world(sections);
    each("equality", [&](const XMLElement& at) { read_equalities(at); });
    drop_world();
    if (scenery_ > 0) {
      robot().notes.push_back(fmt::format("{} of the world itself {} not part of the robot and skipped",
                                          scenery_ == 1 ? std::string("a geom") : fmt::format("{} geoms", scenery_),
                                          scenery_ == 1 ? "is" : "are"));
    }
    if (loops_ > 0) {
      robot().notes.push_back(fmt::format("{} of <equality> that close loops or tie bodies are not kept", loops_));
    }
    require_no_mimic_circle(robot());
    arrange(robot());
    return std::move(robot());
  }

 private:
  Robot& robot() { return assembly_.robot; }

  // Sections.

  void reject_children(const XMLElement& of) {
    for (const XMLElement* at : files_.children(of)) {
      if (std::string_view(at->Name()) == "skin") continue;  // is seen and touches nothing
      files_.fail(*at,
                  fmt::format("<{}> of <{}> is not supported: take it out of the robot's file", at->Name(), of.Name()));
    }
  }

  void read_contacts(const XMLElement& of) {
    for (const XMLElement* at : files_.children(of)) {
      const std::string_view kind = at->Name();
      if (kind == "exclude") {
        const Xml& file = files_.file_of(*at);
        for (const auto& [one, other] :
             copies_.pairs(*at, bodies_.of(file.text(*at, "body1")), bodies_.of(file.text(*at, "body2")))) {
          robot().ignored.push_back({one, other});
        }
      } else if (kind == "pair") {
        for (const char* side : {"geom1", "geom2"}) {
          if (const char* name = at->Attribute(side)) geoms_.set_paired(name);
        }
      }
    }
  }

  void reserve_names(const XMLElement& of, int depth) {
    if (depth > deepest_body) files_.fail(of, "bodies are nested more than 500 deep");
    for (const XMLElement* at : files_.children(of)) {
      const std::string_view kind = at->Name();
      copies_.count(*at);
      if (const std::string name = copies_.name_of(*at); !name.empty()) {
        MjcfNames* names = kind == "body" ? &bodies_ : kind == "joint" || kind == "freejoint" ? &joints_ : nullptr;
        if (names != nullptr && !names->add(at->Attribute("name"), copies_.name(name))) {
          files_.fail(*at, fmt::format("there are two {} {}", kind == "body" ? "bodies" : "joints", name));
        }
        if (kind == "body" && name == "world") files_.fail(*at, "a <body> is called world, as the world is");
        if (kind == "body") assembly_.reserve_link(name);
        if (names == &joints_) assembly_.reserve_joint(name);
      }
      if (kind == "body") reserve_names(*at, depth + 1);
      if (!MjcfCopies::is_frame(kind)) continue;
      copies_.each(*at, [&](const RigidTransform&) {
        copies_.count(*at);
        reserve_names(*at, depth + 1);
      });
    }
  }

  // Bodies.

  struct Body {
    std::size_t link;
    RigidTransform pose;
    std::vector<Movement> movements{};
    bool free = false;
    const XMLElement* aligned_by = nullptr;  // the free joint that turns its frame into that of its inertia
  };

  void add_body(const XMLElement& at, std::size_t parent, const RigidTransform& frame, std::string child_class,
                int depth) {
    if (const char* own = at.Attribute("childclass")) child_class = own;
    values_.require_class(at, child_class);
    Link link;
    const std::string name = copies_.name_of(at);
    link.name = name.empty() ? assembly_.fresh_link("body") : name;
    link.line = at.GetLineNum();
    Body body{robot().links.size(), composed(frame, values_.pose({at}))};
    robot().links.push_back(std::move(link));
    // Joints stand before the bodies below in the chain, wherever they are written.
    add_own(at, body, {}, child_class, depth);
    if (body.free) {
      if (parent != 0 || !body.movements.empty()) {
        files_.fail(at, "a free joint is the only joint of a body of the world itself, which this is not");
      }
      Joint joint;
      joint.name = assembly_.fresh_joint(robot().links[body.link].name + "_free");
      joint.kind = Joint::Kind::floating;
      joint.line = at.GetLineNum();
      joint.parent = parent, joint.child = body.link, joint.origin = body.pose;
      robot().links[body.link].joint = robot().joints.size();
      robot().joints.push_back(std::move(joint));
    } else {
      assembly_.carry(parent, body.link, body.pose, body.movements, at.GetLineNum());
    }
    const std::size_t links = robot().links.size();
    add_children(at, body.link, {}, child_class, depth);
    // MuJoCo keeps the frame of a body that carries others.
    if (body.aligned_by != nullptr && robot().links.size() == links) {
      files_.fail(
          *body.aligned_by,
          fmt::format("the frame of {} is aligned with its inertia (alignfree, or align of its free joint), which "
                      "is not computed: write align=\"false\" to keep the frame that is written",
                      robot().links[body.link].name));
    }
  }

  /// Joints, geoms and inertia of a body, those in frames included.
  void add_own(const XMLElement& of, Body& body, const RigidTransform& frame, const std::string& child_class,
               int depth) {
    if (depth > deepest_body) files_.fail(of, "frames are nested more than 500 deep");
    for (const XMLElement* at : files_.children(of)) {
      const std::string_view kind = at->Name();
      if (kind == "joint" || kind == "freejoint") {
        add_joint(*at, body, frame, child_class);
      } else if (kind == "geom") {
        geoms_.add(*at, robot().links[body.link], frame, child_class, copies_.suffix());
      } else if (kind == "inertial") {
        robot().links[body.link].inertial = inertial(*at, frame);
      } else if (MjcfCopies::is_frame(kind)) {
        const std::string inner = at->Attribute("childclass") == nullptr ? child_class : at->Attribute("childclass");
        values_.require_class(*at, inner);
        copies_.each(*at,
                     [&](const RigidTransform& pose) { add_own(*at, body, composed(frame, pose), inner, depth + 1); });
      } else if (kind != "body" && kind != "site" && kind != "camera" && kind != "light" && kind != "plugin") {
        files_.fail(*at, fmt::format("<{}> is not supported: write out the bodies and geoms that it stands for", kind));
      }
    }
  }

  /// The bodies of a body or of the world, those in frames included.
  void add_children(const XMLElement& of, std::size_t link, const RigidTransform& frame, const std::string& child_class,
                    int depth) {
    if (depth > deepest_body) files_.fail(of, "bodies are nested more than 500 deep");
    for (const XMLElement* at : files_.children(of)) {
      const std::string_view kind = at->Name();
      if (kind == "body") {
        add_body(*at, link, frame, child_class, depth + 1);
      } else if (MjcfCopies::is_frame(kind)) {
        const std::string inner = at->Attribute("childclass") == nullptr ? child_class : at->Attribute("childclass");
        values_.require_class(*at, inner);
        copies_.each(
            *at, [&](const RigidTransform& pose) { add_children(*at, link, composed(frame, pose), inner, depth + 1); });
      } else if (link == 0) {
        if (kind == "geom") {
          ++scenery_;
        } else if (kind != "site" && kind != "camera" && kind != "light" && kind != "plugin") {
          files_.fail(*at,
                      fmt::format("<{}> in the world is not supported: write out the bodies that it stands for", kind));
        }
      }
    }
  }

  void add_joint(const XMLElement& at, Body& body, const RigidTransform& frame, const std::string& child_class) {
    const MjcfElement e = values_.element(at, child_class);
    const char* given = std::string_view(at.Name()) == "freejoint" ? "free" : e.find("type");
    const std::string_view type = given == nullptr ? "hinge" : given;
    if (type == "free") {
      body.free = true;
      const char* align = at.Attribute("align");
      const bool own = align != nullptr && std::string_view(align) != "auto";
      if (own ? values_.is_true(MjcfElement{at}, "align", false) : values_.align_free()) body.aligned_by = &at;
      return;
    }
    if (type == "fixed") {
      // This is not MuJoCo's: other simulators read it in MuJoCo's files. A body without a joint is fixed anyway.
      robot().notes.push_back(fmt::format("a joint in {} (line {}) is fixed, which MuJoCo does not know: it is skipped",
                                          robot().links[body.link].name, at.GetLineNum()));
      return;
    }
    if (type != "hinge" && type != "slide" && type != "ball") {
      files_.fail(at, fmt::format("a joint is {}: hinge, slide, ball and free are known", type));
    }
    const std::string own = copies_.name_of(at);
    const std::string name = own.empty() ? assembly_.fresh_joint(robot().links[body.link].name + "_joint") : own;
    const Vec3 anchor = frame(values_.vector(e, "pos", {}));
    if (type == "ball") {
      for (Movement& m : ball_movements(name, anchor, at.GetLineNum())) {
        m.name = assembly_.fresh_joint(m.name);
        body.movements.push_back(std::move(m));
      }
      if (e.find("range") != nullptr) {
        robot().notes.push_back(
            fmt::format("joint {} (line {}) is a ball with a limit, which three turns do not have: it turns freely",
                        name, at.GetLineNum()));
      }
      return;
    }
    const bool slides = type == "slide";
    Movement m{.name = name,
               .axis = frame.rotate(values_.vector(e, "axis", {0, 0, 1})),
               .anchor = anchor,
               .line = at.GetLineNum()};
    if (!(length(m.axis) > 0)) files_.fail(at, fmt::format("joint {} has an axis of length 0", name));
    m.axis = normalized(m.axis);
    const auto in_unit = [&](double value) { return slides ? value : values_.angle(value); };
    m.reference = in_unit(values_.number(e, "ref", 0));
    joint_references_[name] = m.reference;
    std::vector<double> range{0, 0};
    if (e.find("range") != nullptr) range = values_.numbers(e, "range", 2);
    bool limited = values_.auto_limits() && range[0] != range[1];
    if (const char* text = e.find("limited"); text != nullptr && std::string_view(text) != "auto") {
      limited = values_.is_true(e, "limited", false);
    }
    if (limited) {
      m.kind = slides ? Joint::Kind::prismatic : Joint::Kind::revolute;
      m.lower = in_unit(range[0]), m.upper = in_unit(range[1]);
      if (!(m.lower < m.upper))
        files_.fail(at, fmt::format("range=\"{} {}\" of joint {} is empty", range[0], range[1], name));
    } else if (slides) {
      m.kind = Joint::Kind::prismatic;
      m.range_known = false;
      robot().notes.push_back(fmt::format("joint {} (line {}) has no limits and is taken to stay at 0", name, m.line));
    } else {
      m.kind = Joint::Kind::continuous;
      m.lower = -std::numbers::pi, m.upper = std::numbers::pi;
    }
    body.movements.push_back(std::move(m));
  }

  Inertial inertial(const XMLElement& at, const RigidTransform& frame) const {
    const MjcfElement e{at};
    Inertial result;
    result.mass = values_.numbers(e, "mass", 1)[0];
    result.origin = composed(frame, values_.pose(e));
    if (e.find("fullinertia") != nullptr) {
      const std::vector<double> m = values_.numbers(e, "fullinertia", 6);
      result.inertia = {m[0], m[3], m[4], m[1], m[5], m[2]};
    } else if (e.find("diaginertia") != nullptr) {
      const std::vector<double> m = values_.numbers(e, "diaginertia", 3);
      result.inertia = {m[0], 0, 0, m[1], 0, m[2]};
    }
    return result;
  }

  void read_equalities(const XMLElement& of) {
    for (const XMLElement* at : files_.children(of)) {
      const MjcfElement e{*at};
      if (!values_.is_true(e, "active", true)) continue;
      if (std::string_view(at->Name()) != "joint" || at->Attribute("joint1") == nullptr ||
          at->Attribute("joint2") == nullptr) {
        ++loops_;
        continue;
      }
      std::vector<double> c{0, 1, 0, 0, 0};
      if (e.find("polycoef") != nullptr) {
        const std::vector<double> given = values_.numbers(e, "polycoef", 1, 5);
        std::copy(given.begin(), given.end(), c.begin());
      }
      for (const auto& [joint, led_by] :
           copies_.pairs(*at, joints_.of(at->Attribute("joint1")), joints_.of(at->Attribute("joint2")))) {
        add_mimic(*at, joint, led_by, c);
      }
    }
  }
  void add_mimic(const XMLElement& at, const std::string& joint, const std::string& led_by,
                 const std::vector<double>& c) {
    // Fixed joints are the reader's own, and the joint of a free body may be dropped: in the file neither is a joint
    // that others follow.
    const auto find = [&](const std::string& name) {
      const std::size_t found = robot().find_joint(name);
      const bool moves = found != none && robot().joints[found].kind != Joint::Kind::fixed &&
                         robot().joints[found].kind != Joint::Kind::floating;
      return moves ? found : none;
    };
    const std::size_t follower = find(joint), leader = find(led_by);
    const bool curved = c[2] != 0 || c[3] != 0 || c[4] != 0;
    if (follower == none || leader == none || curved || robot().joints[follower].mimic) {
      robot().notes.push_back(fmt::format("joint {} (line {}) follows {} {}: it moves by itself", joint,
                                          at.GetLineNum(), led_by,
                                          curved ? "along a curve" : "in a way that is not kept"));
      return;
    }
    const double offset = c[0] + joint_references_[joint] - c[1] * joint_references_[led_by];
    robot().joints[follower].mimic = Joint::Mimic{leader, c[1], offset};
  }

  /// Reads the world of a file without bodies: a part or a prop, which other files place.
  void take_world(const std::vector<const XMLElement*>& sections) {
    Body world{0, {}};
    for (const XMLElement* at : sections) {
      if (std::string_view(at->Name()) == "worldbody") add_own(*at, world, {}, "main", 0);
    }
    const Link& link = robot().links[0];
    if (!world.movements.empty() || world.free)
      files_.fail(files_.main().root(), "there is a joint of the world itself");
    if (link.collision.empty() && link.visual.empty())
      files_.fail(files_.main().root(), "there is no <body> in a <worldbody>");
    robot().notes.push_back("there is no body: geoms of the world itself are taken for the only link");
    scenery_ = 0;
  }

  /// The world is left out if the robot is one body in its origin, or a free one.
  void drop_world() {
    Robot& r = robot();
    if (r.joints.empty()) return;
    const auto on_world = std::count_if(r.joints.begin(), r.joints.end(), [](const Joint& j) { return j.parent == 0; });
    const Joint& first = r.joints[0];
    const bool free = first.kind == Joint::Kind::floating;
    if (on_world != 1 || first.parent != 0 ||
        (!free && (first.kind != Joint::Kind::fixed || !(first.origin == RigidTransform{})))) {
      return;
    }
    if (free) {
      r.notes.push_back(fmt::format("{} moves freely: poses are given in its axes", r.links[first.child].name));
    }
    r.links.erase(r.links.begin());
    r.joints.erase(r.joints.begin());
    for (Joint& joint : r.joints) {
      --joint.parent, --joint.child;
      if (joint.mimic) --joint.mimic->joint;
    }
    for (Link& link : r.links) link.joint = link.joint == none || link.joint == 0 ? none : link.joint - 1;
  }

  Assembly assembly_;
  MjcfFiles files_;
  MjcfValues values_;
  MjcfGeoms geoms_;
  MjcfCopies copies_;
  MjcfNames bodies_, joints_;
  std::map<std::string, double> joint_references_;
  std::size_t scenery_ = 0, loops_ = 0;
};

}  // namespace

Robot read_mjcf(const Xml& xml, const ReadOptions& options) {
  return MjcfReader(xml, options).run();
}

}  // namespace morula::robot
