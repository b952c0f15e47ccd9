// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// MJCF and SDF: the robot in the formats of simulators, with masses that the spheres do not change.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "read/xml.hpp"
#include "write/inertia.hpp"
#include "write/text.hpp"

namespace morula::robot {

namespace {

using tinyxml2::XMLElement;

/// w, x, y, z.
std::array<double, 4> quaternion(const RigidTransform& pose) {
  const auto& r = pose.rows;
  // The largest of the four is computed first, so that no divisor is small.
  const std::array<double, 4> squares{1 + r[0].x + r[1].y + r[2].z, 1 + r[0].x - r[1].y - r[2].z,
                                      1 - r[0].x + r[1].y - r[2].z, 1 - r[0].x - r[1].y + r[2].z};
  const auto largest = static_cast<std::size_t>(std::max_element(squares.begin(), squares.end()) - squares.begin());
  const double a = r[2].y - r[1].z, b = r[0].z - r[2].x, c = r[1].x - r[0].y;
  const double d = r[1].x + r[0].y, e = r[0].z + r[2].x, f = r[2].y + r[1].z;
  std::array<double, 4> q{};
  switch (largest) {
    case 0:
      q = {squares[0], a, b, c};
      break;
    case 1:
      q = {a, squares[1], d, e};
      break;
    case 2:
      q = {b, d, squares[2], f};
      break;
    default:
      q = {c, e, f, squares[3]};
      break;
  }
  double norm = 0;
  for (const double part : q) norm += part * part;
  for (double& part : q) part /= std::sqrt(norm);
  return q;
}

bool has_limits(const Joint& joint) {
  return joint.kind != Joint::Kind::continuous && joint.range_known;
}
/// Whether MJCF has the joint: an empty range would mean no limits there, so that joint is not written.
bool is_written(const Joint& joint) {
  return joint.moves() && (!has_limits(joint) || joint.lower < joint.upper);
}

class Mjcf {
 public:
  explicit Mjcf(const Description& d) : d_(d), below_(d.robot.links.size()) {
    for (const std::size_t i : d.robot.order) below_[d.robot.joints[i].parent].push_back(i);
  }

  std::string text() {
    tinyxml2::XMLDocument document;
    XMLElement* root = add_element(&document, "mujoco");
    set(root, "model", d_.robot.name);
    XMLElement* compiler = add_element(root, "compiler");
    set(compiler, "angle", "radian");
    set(compiler, "autolimits", "true");
    add_body(add_element(root, "worldbody"), d_.robot.root);
    root->InsertEndChild(document.NewComment(fmt::format(" {} ", ignored_note(d_)).c_str()));
    XMLElement* contact = add_element(root, "contact");
    // MuJoCo rejects unknown attributes, so the reasons are comments.
    for (const IgnoreReason reason :
         {IgnoreReason::given, IgnoreReason::adjacent, IgnoreReason::rest, IgnoreReason::apart, IgnoreReason::never}) {
      add_excludes(contact, reason);
    }
    XMLElement* equality = add_element(root, "equality");
    for (const Joint& joint : d_.robot.joints) {
      if (!joint.mimic || !is_written(joint) || !is_written(d_.robot.joints[joint.mimic->joint])) continue;
      XMLElement* at = add_element(equality, "joint");
      set(at, "joint1", joint.name);
      set(at, "joint2", d_.robot.joints[joint.mimic->joint].name);
      set(at, "polycoef", fmt::format("{} {} 0 0 0", joint.mimic->offset, joint.mimic->multiplier));
    }
    return xml_text(document, d_);
  }

 private:
  /// "world" is the name of the body that carries all others.
  std::string body_name(std::size_t link) const {
    const std::string& own = d_.robot.links[link].name;
    return own == "world" ? "world_link" : own;
  }

  void add_excludes(XMLElement* contact, IgnoreReason reason) const {
    bool is_first = true;
    for (const IgnoredPair& pair : d_.self_collision.ignored) {
      if (pair.reason != reason) continue;
      if (is_first) {
        const std::string text = fmt::format(" {} ", reason_text(d_, reason));
        contact->InsertEndChild(contact->GetDocument()->NewComment(text.c_str()));
      }
      is_first = false;
      XMLElement* exclude = add_element(contact, "exclude");
      set(exclude, "body1", body_name(pair.a));
      set(exclude, "body2", body_name(pair.b));
    }
  }

  void add_body(XMLElement* parent, std::size_t link) {
    XMLElement* body = add_element(parent, "body");
    set(body, "name", body_name(link));
    const std::size_t carrier = d_.robot.links[link].joint;
    bool moves = false;
    if (carrier != none) {
      const Joint& joint = d_.robot.joints[carrier];
      const auto q = quaternion(joint.origin);
      set(body, "pos", words(joint.origin.translation));
      set(body, "quat", fmt::format("{} {} {} {}", q[0], q[1], q[2], q[3]));
      moves = is_written(joint);
      if (moves) add_joint(body, joint);
    }
    add_inertial(body, link, moves && !carries_mass(link));
    if (const LinkSpheres* spheres = d_.spheres.of(link)) {
      for (const Sphere& s : spheres->spheres) {
        XMLElement* geom = add_element(body, "geom");
        set(geom, "type", "sphere");
        set(geom, "size", fmt::format("{}", s.radius));
        set(geom, "pos", words(s.center));
        // Overlapping spheres would count the mass of overlaps several times.
        set(geom, "mass", "0");
        set(geom, "group", "3");
      }
    }
    for (const std::size_t i : below_[link]) add_body(body, d_.robot.joints[i].child);
  }

  static void add_joint(XMLElement* body, const Joint& joint) {
    XMLElement* at = add_element(body, "joint");
    set(at, "name", joint.name);
    set(at, "type", joint.kind == Joint::Kind::prismatic ? "slide" : "hinge");
    set(at, "axis", words(joint.axis));
    if (has_limits(joint)) set(at, "range", fmt::format("{} {}", joint.lower, joint.upper));
  }

  /// MuJoCo requires a mass for a moving body, its own or that of a body fixed to it.
  bool carries_mass(std::size_t link) const {
    if (body_inertia(d_, link)) return true;
    return std::any_of(below_[link].begin(), below_[link].end(), [&](std::size_t joint) {
      return !is_written(d_.robot.joints[joint]) && carries_mass(d_.robot.joints[joint].child);
    });
  }

  void add_inertial(XMLElement* body, std::size_t link, bool needs_mass) const {
    const std::optional<BodyInertia> inertia = body_inertia(d_, link);
    if (!inertia && !needs_mass) return;
    XMLElement* at = add_element(body, "inertial");
    set(at, "pos", words(inertia ? inertia->center : Vec3{}));
    set(at, "mass", fmt::format("{}", inertia ? inertia->mass : token_mass));
    if (!inertia) {
      set(at, "diaginertia", words({token_moment, token_moment, token_moment}));
    } else if (inertia->matrix_is_safe) {
      const auto [xx, xy, xz, yy, yz, zz] = inertia->matrix;
      set(at, "fullinertia", fmt::format("{} {} {} {} {} {}", xx, yy, zz, xy, xz, yz));
    } else {
      const auto q = quaternion(inertia->axes);
      set(at, "quat", fmt::format("{} {} {} {}", q[0], q[1], q[2], q[3]));
      set(at, "diaginertia", words(inertia->moments));
    }
  }

  const Description& d_;
  std::vector<std::vector<std::size_t>> below_;
};

void add_text(XMLElement* parent, const char* name, const std::string& text) {
  add_element(parent, name)->SetText(text.c_str());
}

std::string pose_words(const RigidTransform& pose) {
  return words(pose.translation) + " " + words(roll_pitch_yaw(pose));
}

void add_pose(XMLElement* parent, const RigidTransform& pose, const std::string& relative_to) {
  XMLElement* at = add_element(parent, "pose");
  if (!relative_to.empty()) set(at, "relative_to", relative_to);
  at->SetText(pose_words(pose).c_str());
}

/// SDF has no joint of this kind: its link stands where it does at rest and is held by none.
bool is_free(const Joint& joint) {
  return joint.kind == Joint::Kind::floating || joint.kind == Joint::Kind::planar;
}

void add_sdf_link(XMLElement* model, const Description& d, std::size_t link) {
  XMLElement* at = add_element(model, "link");
  const Link& own = d.robot.links[link];
  set(at, "name", own.name);
  if (own.joint != none) {
    const Joint& joint = d.robot.joints[own.joint];
    if (is_free(joint)) {
      add_pose(at, joint.origin, d.robot.links[joint.parent].name);
    } else {
      add_pose(at, {}, joint.name);
    }
  }
  // A link without an inertia has mass 1 in SDF.
  constexpr BodyInertia token{.mass = token_mass, .matrix = {token_moment, 0, 0, token_moment, 0, token_moment}};
  const BodyInertia inertia = body_inertia(d, link).value_or(token);
  XMLElement* inertial = add_element(at, "inertial");
  add_pose(inertial, {.translation = inertia.center}, "");
  add_text(inertial, "mass", fmt::format("{}", inertia.mass));
  XMLElement* matrix = add_element(inertial, "inertia");
  constexpr std::array names{"ixx", "ixy", "ixz", "iyy", "iyz", "izz"};
  for (std::size_t i = 0; i < 6; ++i) add_text(matrix, names[i], fmt::format("{}", inertia.matrix[i]));
  const LinkSpheres* spheres = d.spheres.of(link);
  for (std::size_t i = 0; spheres != nullptr && i < spheres->spheres.size(); ++i) {
    XMLElement* collision = add_element(at, "collision");
    set(collision, "name", fmt::format("{}_sphere_{}", own.name, i));
    add_pose(collision, {.translation = spheres->spheres[i].center}, "");
    add_text(add_element(add_element(collision, "geometry"), "sphere"), "radius",
             fmt::format("{}", spheres->spheres[i].radius));
  }
}

void add_sdf_joint(XMLElement* model, const Description& d, const Joint& joint) {
  if (is_free(joint)) return;
  XMLElement* at = add_element(model, "joint");
  set(at, "name", joint.name);
  set(at, "type", std::string(name(joint.kind)));
  add_pose(at, joint.origin, d.robot.links[joint.parent].name);
  add_text(at, "parent", d.robot.links[joint.parent].name);
  add_text(at, "child", d.robot.links[joint.child].name);
  if (!joint.moves()) return;
  XMLElement* axis = add_element(at, "axis");
  add_text(axis, "xyz", words(joint.axis));
  if (!has_limits(joint)) return;
  XMLElement* limit = add_element(axis, "limit");
  add_text(limit, "lower", fmt::format("{}", joint.lower));
  add_text(limit, "upper", fmt::format("{}", joint.upper));
}

}  // namespace

std::vector<OutputFile> write_mjcf(const Description& d) {
  return {{identifier(d.robot.name) + ".mjcf.xml", Mjcf(d).text()}};
}

std::vector<OutputFile> write_sdf(const Description& d) {
  tinyxml2::XMLDocument document;
  XMLElement* root = add_element(&document, "sdf");
  set(root, "version", "1.9");
  XMLElement* model = add_element(root, "model");
  set(model, "name", d.robot.name);
  for (std::size_t i = 0; i < d.robot.links.size(); ++i) add_sdf_link(model, d, i);
  for (const std::size_t i : d.robot.order) add_sdf_joint(model, d, d.robot.joints[i]);
  return {{identifier(d.robot.name) + ".sdf", xml_text(document, d)}};
}

}  // namespace morula::robot
