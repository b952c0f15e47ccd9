// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A rigid tool pushes a soft organ: one thread steps the tool at 1 kHz, with a penalty on its overlap with the newest
// state of the organ; another thread moves the organ at 25 Hz under the newest forces. A spring ties the tool to the
// pose of a haptic device. docs/how-to/responses.md says more.
//
// At the end device, tool and organ hold still: the spring's force, the contact's force on the tool and that on the
// organ, and the force that holds the organ's bottom have to be the same.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <morula/morula.hpp>
#include <numbers>
#include <thread>
#include <vector>

#include "../response/rigid_body.hpp"
#include "organ.hpp"

using morula::RigidTransform;
using morula::Vec3;
using Clock = std::chrono::steady_clock;

namespace {

constexpr double contact_stiffness = 3e8, contact_damping = 3e6;  // pressure per overlap, and per its growth
constexpr double spring = 400, spring_damping = 12, twist_spring = 40, twist_damping = 2;
constexpr double tool_mass = 0.2, tool_size = 0.8;
constexpr int moving_steps = 1200, resting_frames = 50, most_steps = 200000;
const Vec3 tool_inertia{0.002, 0.03, 0.03};  // along its axis, across

/// The rigid tool between device and organ.
struct Tool : response::RigidBody {
  using RigidBody::RigidBody;
  Vec3 contact_force, contact_torque, spring_force;  // on the tool, in the last step; torque about the origin
  double depth = 0;

  /// reaction: becomes the forces on the organ's vertices.
  bool step(OrganState& organ, const RigidTransform& device, double h, std::vector<Vec3>& reaction) {
    if (!organ.query.run()) return false;
    const auto patches = organ.query.patches();
    double growth = 0;  // of the overlap; the organ counts as still
    for (const morula::ContactPatch& patch : patches)
      growth += dot(patch.a.area_vector, velocity_at(patch.centroid)) + dot(patch.a.moment, spin);
    const double pressure = std::max(0.0, contact_stiffness * organ.query.volume() + contact_damping * growth);
    contact_force = {}, contact_torque = {}, depth = 0;
    std::fill(reaction.begin(), reaction.end(), Vec3{});
    for (const morula::ContactPatch& patch : patches) {
      const Vec3 force = -pressure * patch.a.area_vector;
      contact_force += force, depth = std::max(depth, patch.depth);
      contact_torque += cross(patch.centroid, force) - pressure * patch.a.moment;
      for (const morula::VertexGradient& g : patch.b.gradients) reaction[g.vertex] -= pressure * g.gradient;
    }
    const RigidTransform& pose = collider.transform();
    spring_force = spring * (device.translation - center()) - spring_damping * velocity;
    Vec3 turn;  // sine of the angle from tool to device, along the axis
    for (int i = 0; i < 3; ++i) {
      Vec3 axis;
      axis[i] = 1;
      turn += 0.5 * cross(pose.rotate(axis), device.rotate(axis));
    }
    const Vec3 torque = contact_torque - cross(center(), contact_force) + twist_spring * turn - twist_damping * spin;
    advance(h, contact_force + spring_force, torque);
    return true;
  }
};

/// The device: down into the organ, then aside while it tilts, then still.
RigidTransform device_pose(int step) {
  const double share = std::min(1.0, static_cast<double>(step) / moving_steps);
  const double down = std::min(1.0, 3 * share), aside = std::max(0.0, 1.5 * share - 0.5);
  return RigidTransform::from_axis({0, 1, 0}, std::numbers::pi / 2 + 0.2 * aside,
                                   {0.3 * aside, 0.1 * aside, 1.25 - 0.15 * down});
}

/// How far the forces on the organ's vertices are from the opposite of those on the tool: force and torque.
double imbalance(const Tool& tool, const std::vector<Vec3>& reaction, const OrganState& organ) {
  Vec3 force = tool.contact_force, torque = tool.contact_torque;
  for (std::size_t i = 0; i < reaction.size(); ++i)
    force += reaction[i], torque += cross(organ.positions[i], reaction[i]);
  return std::max(length(force), length(torque));
}

}  // namespace

int main() {
  morula::Mesh mesh = morula::sample_body("tool", 32);  // along x, its tip at +x
  const morula::Box extent = bounding_box(mesh);
  for (Vec3& p : mesh.positions) p = tool_size * (p - extent.center());
  Tool tool(mesh);
  tool.mass = tool_mass, tool.inertia = tool_inertia;
  tool.collider.set_transform(device_pose(0));
  Organ organ(tool.collider);
  organ.start();

  std::vector<double> shares;  // of the millisecond that each step uses
  int rest_frame = 0, touching = 0, faults = 0;
  double deepest = 0, strongest = 0, worst_imbalance = 0;
  const auto begin = Clock::now();
  for (int step = 0; step < most_steps; ++step) {
    std::this_thread::sleep_until(begin + std::chrono::milliseconds(step));
    const auto start = Clock::now();
    organ.states.refresh();
    OrganState& state = organ.states.front();
    std::vector<Vec3>& reaction = organ.reactions.back().force;
    if (!tool.step(state, device_pose(step), 0.001, reaction)) ++faults;
    shares.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
    worst_imbalance = std::max(worst_imbalance, imbalance(tool, reaction, state));
    organ.reactions.publish();
    touching += tool.depth > 0, deepest = std::max(deepest, tool.depth);
    strongest = std::max(strongest, length(tool.contact_force));
    // However slow the machine is, the organ has its time to come to rest.
    if (step == moving_steps) rest_frame = state.frame;
    if (step > moving_steps && state.frame > rest_frame + resting_frames) break;
  }
  const Vec3 held = organ.stop();

  const double force = length(tool.contact_force);
  std::printf("%zu facets of the organ, %zu of the tool; %zu steps, %d of them in contact, at most %.4f deep\n",
              organ.facet_count(), mesh.facet_count(), shares.size(), touching, deepest);
  const auto print = [](const char* name, const Vec3& f) {
    std::printf("%-34s %8.4f %8.4f %8.4f\n", name, f.x, f.y, f.z);
  };
  print("force of the organ on the tool", tool.contact_force);
  print("force of the device's spring", tool.spring_force);
  print("force that holds the organ", held);
  std::printf("strongest force %.3f; forces of a step on tool and organ differ by at most %.1e\n", strongest,
              worst_imbalance);
  std::sort(shares.begin(), shares.end());
  std::printf("a step used %.0f %% of its millisecond in the median, %.0f %% at 99 %%, at most %.0f %%\n",
              100 * shares[shares.size() / 2], 100 * shares[shares.size() * 99 / 100], 100 * shares.back());
  const bool is_balanced = length(tool.contact_force + tool.spring_force) < 0.01 * force &&
                           length(tool.contact_force - held) < 0.02 * force && worst_imbalance < 1e-9 * strongest;
  return faults == 0 && is_balanced && touching > moving_steps / 2 && deepest < 0.02 && force > 1 ? 0 : 1;
}
