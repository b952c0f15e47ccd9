// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <morula/geometry/scale.hpp>
#include <morula/surface/haptic_tool.hpp>
#include <stdexcept>
#include <string>

#include "parallel/float_environment.hpp"
#include "surface/haptic/tool_follower.hpp"
#include "surface/haptic/tool_neighbors.hpp"

namespace morula {
using namespace detail;
namespace {

constexpr std::size_t reserved_tool_moves = 256;  // moves whose places are reserved before the first step

void require_tool_number(double value, const char* name) {
  if (!(value >= 0) || !std::isfinite(value))
    throw std::invalid_argument(std::string("HapticToolOptions::") + name + " must be finite and at least 0, not " +
                                std::to_string(value));
}

const HapticToolOptions& usable(const HapticToolOptions& options) {
  require_tool_number(options.stiffness, "stiffness");
  if (options.rotation_stiffness) require_tool_number(*options.rotation_stiffness, "rotation_stiffness");
  if (options.skin) {
    require_tool_number(*options.skin, "skin");
    if (*options.skin == 0) throw std::invalid_argument("HapticToolOptions::skin must be more than 0");
  }
  if (options.max_moves == 0) throw std::invalid_argument("HapticToolOptions::max_moves must be 1 or more");
  return options;
}

std::span<const Sphere> usable(std::span<const Sphere> balls) {
  if (balls.empty()) throw std::invalid_argument("HapticTool: a tool needs at least one ball");
  for (std::size_t k = 0; k < balls.size(); ++k)
    if (!(max_norm(balls[k].center) <= 0x1p100) || !(balls[k].radius >= 0) || !(balls[k].radius <= 0x1p100) ||
        !is_finite(balls[k].center))
      throw std::invalid_argument("HapticTool: ball " + std::to_string(k) +
                                  " must be finite, within 2^100, with a radius of at least 0");
  return balls;
}

}  // namespace

std::vector<Sphere> leaf_spheres(const SphereState& state) {
  std::vector<Sphere> balls;
  for (std::uint32_t node = 0; node < state.spheres.size(); ++node)
    if (state.tree->is_leaf(node)) balls.push_back(state.sphere(node));
  return balls;
}

struct HapticTool::State {
  State(std::span<const Sphere> balls, const HapticToolOptions& given) : options(usable(given)), shape(usable(balls)) {}

  HapticToolStep step(const Collider& placed, const RigidTransform& device);
  Status start(const Collider& body);
  bool find_place(const Collider& body, const ToolPose& goal, HapticToolStep& result);
  bool is_clear(const Collider& body, const ToolPose& at, HapticToolStep& result);
  void follow(const Collider& body, HapticToolStep& result);
  void approach(const Collider& body, const ToolPose& goal, HapticToolStep& result);
  std::optional<RigidMotion> far_motion(const Collider& body, const RigidMotion& direct) const;
  std::optional<RigidMotion> near_motion(const Collider& body, const RigidMotion& direct);
  double largest_turn() const;
  bool advance(const Collider& body, const RigidMotion& move);
  void report(const Collider& placed, const ToolPose& goal, HapticToolStep& result);

  ToolPose pose_of(const RigidTransform& t) const { return {Rotation::from_rows(t), t(shape.center())}; }
  RigidTransform transform_of(const ToolPose& p) const {
    RigidTransform t = p.rotation.rows();
    t.translation = p.center - t.rotate(shape.center());
    return t;
  }

  HapticToolOptions options;
  ToolShape shape;
  std::optional<Collider> resting;  // the body of the present step, without its transform
  bool is_started = false;          // there is a body and a skin
  bool has_place = false;           // the pose is off the surface, on a side that is kept
  bool was_placed = false;          // the pose is that of a proxy, though it may be jammed
  ToolPose pose;                    // in the body's coordinates
  double skin = 0;
  ToolFollower surface;
  ToolNeighbors neighbors;
  ToolConstraints constraints;
  TouchQuery touch;
  std::vector<Vec3> centers, ends;
  std::vector<BallContact> found;
  std::vector<ToolContact> contacts;
  std::vector<RigidTransform> path;
};

// Everything that may throw precedes the change of is_started.
Status HapticTool::State::start(const Collider& body) {
  using Code = Status::Code;
  const SurfaceMotion& motion = surface.motion;
  if (is_started && (motion.vertex_count() != body.vertex_count() || motion.facet_count() != body.mesh_facets().size()))
    return {Code::other_bodies};
  const Sphere root = body.sphere_state().sphere(0);
  const double size = max_norm(root.center) + root.radius + 2 * shape.reach();
  const double own = std::max(0x1p-12 * std::min(shape.reach(), root.radius), 0x1p-22 * size);
  const double wanted_skin = is_started ? skin : options.skin.value_or(own);
  if (!(wanted_skin > 0x1p-24 * size)) return {Code::bad_option};
  if (is_started) return {};
  surface.motion.start(body);
  neighbors.clear();
  path.reserve(std::min(options.max_moves, reserved_tool_moves) + 2);
  skin = wanted_skin, is_started = true, has_place = was_placed = false;
  return {};
}

bool HapticTool::State::is_clear(const Collider& body, const ToolPose& at, HapticToolStep& result) {
  shape.place(at, centers);
  for (std::size_t k = 0; k < shape.size(); ++k) {
    const Touch& found_here = touch.run(body, Sphere{centers[k], shape.radius(k) + skin / 2});
    result.sphere_tests += found_here.sphere_tests, result.facet_tests += found_here.facet_tests;
    if (!found_here.proven_clear) return false;
  }
  return true;
}

// The pose at which the step begins: that of the proxy; after a jam, if it is off the surface, or else the device's.
bool HapticTool::State::find_place(const Collider& body, const ToolPose& goal, HapticToolStep& result) {
  neighbors.clear();
  has_place = was_placed && is_clear(body, pose, result);
  if (has_place) return true;
  if (!is_clear(body, goal, result)) return false;
  pose = goal;
  return has_place = was_placed = true;
}

void HapticTool::State::follow(const Collider& body, HapticToolStep& result) {
  const bool had_place = has_place;
  const ToolFollower::Followed followed = surface.follow(body, shape, skin, pose);
  result.sphere_tests += surface.sphere_tests, result.facet_tests += surface.facet_tests;
  if (!followed.moved) return;
  surface.motion.accept(body);
  neighbors.clear();
  if (!had_place) return;
  pose = followed.pose, has_place = !followed.jammed;
}

// All facets are in the root's sphere, and the tool in a ball about its center. A direct motion is free if that ball
// passes beside the root's sphere. A tool far away first comes near on the line to the middle of the body, so that the
// rounding of its places is below the skin.
std::optional<RigidMotion> HapticTool::State::far_motion(const Collider& body, const RigidMotion& direct) const {
  const Sphere root = body.sphere_state().sphere(0);
  const Vec3 away = pose.center - root.center;
  const double reach = root.radius + shape.reach() + 2 * skin, squared = squared_length(direct.shift);
  const Vec3 nearest = (squared > 0 ? std::clamp(-dot(away, direct.shift) / squared, 0.0, 1.0) : 0) * direct.shift;
  const double pad = 0x1p-44 * (max_norm(pose.center) + length(nearest) + reach);
  // mutant haptic-tool-far: `> reach + pad` -> `> root.radius`
  if (length(away + nearest) > reach + pad) return direct;
  const double now = length(away);
  if (now > 4 * (reach + pad)) return RigidMotion{away * (2 * (reach + pad) / now - 1), direct.turn};
  return {};
}

// The largest rotation for which the ways of balls deviate from segments by less than the least gap allows.
double HapticTool::State::largest_turn() const {
  double gap = skin, room = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < shape.size(); ++k) room = std::min(room, ToolNeighbors::lookahead(shape.radius(k), skin));
  for (const BallContact& contact : found) {
    const double own = contact.at.distance - shape.radius(contact.ball);
    gap = std::min(gap, own), room = std::min(room, own - skin);
  }
  return shape.turn_of_sag(std::max(gap / 64, room / 16));
}

// Nearest to the direct motion beyond the planes of contact, shortened so that linear planes hold. None if a query
// rejects the balls.
std::optional<RigidMotion> HapticTool::State::near_motion(const Collider& body, const RigidMotion& direct) {
  shape.place(pose, centers);
  if (!neighbors.gather(body, shape, skin, centers, centers)) return {};
  neighbors.find_contacts(shape, skin, centers, found);
  const RigidTransform rows = pose.rotation.rows();
  constraints.clear();
  for (const BallContact& contact : found)
    constraints.add(shape.row(contact.ball, contact.at.normal, rows),
                    shape.radius(contact.ball) + skin - contact.at.distance);
  // Rounding of a goal far away may exceed the skin: a nearer one in its direction has the same motions at rest.
  const double way = shape.displacement(direct), farthest = 0x1p38 * skin;
  const RigidMotion goal = way > farthest ? (farthest / way) * direct : direct;
  const NearestMotion nearest = constraints.nearest(shape.to_metric(goal, rows), skin);
  if (!nearest.exists) return {};
  const RigidMotion move = nearest.active_count == 0 ? direct : shape.from_metric(nearest.motion, rows);
  const Sphere root = body.sphere_state().sphere(0);
  const double most = 2 * (root.radius + shape.reach() + skin), turn = length(move.turn), most_turn = largest_turn();
  const double share = std::min(most / std::max(length(move.shift), most), turn > most_turn ? most_turn / turn : 1.0);
  if (share == 1) return move;
  // A share of the motion, but the whole of what keeps the distances: both are permitted, so what is between them is.
  const NearestMotion least = constraints.nearest({}, skin);
  if (!least.exists) return {};
  const RigidMotion kept = shape.from_metric(least.motion, rows);
  return RigidMotion{kept.shift + share * (move.shift - kept.shift), kept.turn + share * (move.turn - kept.turn)};
}

// Moves by the share of a motion that is free and proven to be. False if there is none.
bool HapticTool::State::advance(const Collider& body, const RigidMotion& move) {
  shape.place(pose.moved(move), ends);
  if (!neighbors.gather(body, shape, skin, centers, ends)) return false;
  double share = neighbors.free_share(shape, skin, shape.sag(move), centers, ends);
  for (int halvings = 0; halvings < 8 && share > 0; ++halvings, share /= 2) {
    const RigidMotion part = share * move;
    const ToolPose end = pose.moved(part);
    shape.place(end, ends);
    if (!neighbors.is_proven_free(shape, skin, shape.sag(part), centers, ends)) continue;
    pose = end;
    return true;
  }
  return false;
}

void HapticTool::State::approach(const Collider& body, const ToolPose& goal, HapticToolStep& result) {
  for (;; ++result.moves) {
    found.clear();
    const RigidMotion direct = pose.motion_to(goal);
    const std::optional<RigidMotion> far = far_motion(body, direct);
    const std::optional<RigidMotion> move = far ? far : near_motion(body, direct);
    if (!move) return;
    // mutant haptic-tool-loose-turn: `std::max(shape.reach(), skin)` -> `0.0`
    result.settled = length(move->shift) + std::max(shape.reach(), skin) * length(move->turn) <= skin / 64;
    if (result.settled || result.moves == options.max_moves) return;
    if (!far && !advance(body, *move)) return;
    if (far) pose = far->shift == direct.shift ? goal : pose.moved(*far);
    path.push_back(transform_of(pose));
  }
}

void HapticTool::State::report(const Collider& placed, const ToolPose& goal, HapticToolStep& result) {
  const RigidTransform& world = placed.transform();
  const RigidTransform at = transform_of(result.jammed && !was_placed ? goal : pose);
  for (std::size_t row = 0; row < 3; ++row) {
    const Vec3& r = world.rows[row];
    result.proxy.rows[row] = r.x * at.rows[0] + r.y * at.rows[1] + r.z * at.rows[2];
  }
  result.proxy.translation = world(at.translation);
  if (result.jammed) return;
  for (const BallContact& contact : found) {
    const ProxyContact& near = contact.at;
    if (near.distance > KeptDistances(shape.radius(contact.ball), skin).touching) continue;
    contacts.push_back(
        {contact.ball, {near.facet, near.barycentric, world(near.point)}, world.rotate(near.normal), near.distance});
  }
  result.touches = !contacts.empty(), result.contacts = contacts;
  const RigidMotion back = goal.motion_to(pose);
  const Vec3 torque = options.rotation_stiffness ? *options.rotation_stiffness * back.turn
                                                 : options.stiffness * shape.inertia(back.turn, pose.rotation.rows());
  result.force = world.rotate(options.stiffness * back.shift), result.torque = world.rotate(torque);
}

HapticToolStep HapticTool::State::step(const Collider& placed, const RigidTransform& device) {
  HapticToolStep result;
  result.status = askable(placed);
  if (result.status &&
      !(deviation_from_rigid(device) <= largest_float_deviation && max_norm(device.translation) < 0x1p200))
    result.status = {Status::Code::bad_shape};
  if (!result.status) return result;
  // In its own coordinates a body that moves rigidly rests, and the device moves instead.
  if (resting) {
    *resting = placed;  // a copy would allocate
  } else {
    resting.emplace(placed);
  }
  Collider& body = *resting;
  body.set_transform({});
  const ToolPose goal = pose_of(relative_to(placed.transform(), device));
  result.status = start(body);
  if (!result.status) return result;
  result.certified = body.sphere_state().covers;
  path.clear(), contacts.clear(), found.clear();
  const bool had_place = has_place;
  if (had_place) path.push_back(transform_of(pose));
  follow(body, result);
  if (!had_place && find_place(body, goal, result)) path.push_back(transform_of(pose));
  result.jammed = !has_place;
  if (has_place) {
    neighbors.sphere_tests = neighbors.facet_tests = 0;
    path.push_back(transform_of(pose));
    approach(body, goal, result);
    result.sphere_tests += neighbors.sphere_tests, result.facet_tests += neighbors.facet_tests;
  }
  report(placed, goal, result);
  return result;
}

HapticTool::HapticTool(std::span<const Sphere> balls, HapticToolOptions options)
    : state_(std::make_unique<State>(balls, options)) {}
HapticTool::~HapticTool() = default;
HapticTool::HapticTool(HapticTool&&) noexcept = default;
HapticTool& HapticTool::operator=(HapticTool&&) noexcept = default;

const HapticToolOptions& HapticTool::options() const {
  return state_->options;
}

HapticToolStep HapticTool::step(const Collider& body, const RigidTransform& device) {
  const StandardFloats standard;
  return state_->step(body, device);
}

void HapticTool::reset() {
  state_->is_started = false;
  state_->resting.reset();
  state_->path.clear();
}

Vec3 HapticTool::center() const {
  return state_->shape.center();
}

std::span<const RigidTransform> HapticTool::path() const {
  return state_->path;
}

}  // namespace morula
