// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A hand squeezes a soft ball: three rigid fingers close on it, above a palm that carries it. Contact is a penalty on
// the overlap V of each pair, of the energy k V² / 2, in steps of semi-implicit Euler. docs/how-to/responses.md says
// more.
//
// During the motion the work of the fingers has to be the energy that arrives and the heat of damping; at rest all
// contact forces have to balance the weight of the ball.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <morula/morula.hpp>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "../response/rigid_body.hpp"
#include "../response/soft_body.hpp"

using morula::Vec3;
using response::SoftBody;

namespace {

constexpr int finger_count = 3, closing_steps = 4000, steps = 10000;
constexpr double h = 0.00025, gravity = 9.81, stiffness = 400, damping = 0.3, contact_stiffness = 2e5,
                 contact_damping = 4e3, drag = 5;
constexpr double ball_radius = 0.5, finger_radius = 0.2, closed_by = 0.15;

morula::Mesh scaled(morula::Mesh mesh, double factor) {
  for (Vec3& p : mesh.positions) p *= factor;
  return mesh;
}

/// A rigid part of the hand and its contact with the ball.
struct Part {
  Part(morula::Mesh mesh, const SoftBody& ball) : rigid(std::move(mesh)), query(ball.collider, rigid.collider) {}

  response::RigidBody rigid;
  morula::ContactPatchQuery query;
  Vec3 force;         // of the contact on this part
  double energy = 0;  // of the contact
  double heat = 0;    // of its damping, since the beginning

  /// Adds the forces on the ball's points.
  void press(const SoftBody& ball, std::vector<Vec3>& forces) {
    if (!query.run({.max_points = 0, .depths = false})) throw std::runtime_error("a rejected query");
    // One pressure for all patches of the pair, so that nothing jumps where patches meet. It never pulls.
    double growth = 0;  // of the overlap, per time
    for (const morula::ContactPatch& patch : query.patches()) {
      for (const morula::VertexGradient& g : patch.a.gradients) growth += dot(g.gradient, ball.v[ball.point(g.vertex)]);
      growth += dot(patch.b.area_vector, rigid.velocity);
    }
    const double elastic = contact_stiffness * query.volume();
    const double pressure = std::max(0.0, elastic + contact_damping * growth);
    energy = elastic * query.volume() / 2;
    heat += (pressure - elastic) * growth * h;
    force = {};
    for (const morula::ContactPatch& patch : query.patches()) {
      for (const morula::VertexGradient& g : patch.a.gradients) forces[ball.point(g.vertex)] -= pressure * g.gradient;
      force -= pressure * patch.b.area_vector;
    }
  }
};

class Hand {
 public:
  Hand()
      : ball({5, 5, 5}, 1.0, [](double i, double j, double k) {
          return ball_radius * response::on_ball({i / 2.5 - 1, j / 2.5 - 1, k / 2.5 - 1});
        }) {
    for (int i = 0; i < finger_count; ++i)
      parts.push_back(std::make_unique<Part>(scaled(morula::sample_body("capsule", 16), 2 * finger_radius), ball));
    const double floor = -ball_radius;
    parts.push_back(std::make_unique<Part>(response::box({-1, -1, floor - 0.2}, {1, 1, floor}), ball));
  }

  /// Moves the fingers, then the ball.
  void step(int k) {
    const double share = std::min(1.0, (k + 1.0) / closing_steps);
    const double closed = closed_by * (1 - std::cos(std::numbers::pi * share)) / 2;
    std::vector<Vec3> forces(ball.x.size());
    ball.update_surface();
    for (int i = 0; i < finger_count; ++i) {
      const double angle = 2 * std::numbers::pi * i / finger_count;
      const Vec3 out{std::cos(angle), std::sin(angle), 0};
      const Vec3 at = (ball_radius + finger_radius - closed) * out;
      morula::Collider& finger = parts[i]->rigid.collider;
      const Vec3 move = k == 0 ? Vec3{} : at - finger.transform().translation;
      work -= dot(parts[i]->force, move);
      parts[i]->rigid.velocity = move / h;
      finger.set_transform(morula::RigidTransform::from_axis({0, 1, 0}, std::numbers::pi / 2, at));  // upright
    }
    for (const auto& part : parts) part->press(ball, forces);
    lost += h * ball.add_spring_forces(stiffness, damping, forces);
    for (std::size_t p = 0; p < ball.x.size(); ++p) {
      lost += drag * ball.mass[p] * squared_length(ball.v[p]) * h;
      ball.v[p] += h * (forces[p] / ball.mass[p] - drag * ball.v[p] - Vec3{0, 0, gravity});
      ball.x[p] += h * ball.v[p];
    }
  }

  double energy() const {
    double sum = ball.kinetic_energy() + ball.elastic_energy(stiffness) + gravity * ball.total_mass() * ball.center().z;
    for (const auto& part : parts) sum += part->energy;
    return sum;
  }

  double heat() const {
    double sum = lost;
    for (const auto& part : parts) sum += part->heat;
    return sum;
  }

  SoftBody ball;
  std::vector<std::unique_ptr<Part>> parts;  // fingers, then the palm
  double work = 0, lost = 0;                 // of the fingers; by springs and drag
};

}  // namespace

int main() {
  Hand hand;
  const double before = hand.energy();
  double worst_balance = 0, most_work = 0;
  for (int k = 0; k < steps; ++k) {
    hand.step(k);
    most_work = std::max(most_work, hand.work);
    worst_balance = std::max(worst_balance, std::abs(hand.work - hand.heat() - (hand.energy() - before)));
    if ((k + 1) % 2000 != 0) continue;
    std::printf("%.2f s: work %.4f, energy %+.4f, heat %.4f; volumes", h * (k + 1), hand.work, hand.energy() - before,
                hand.heat());
    for (const auto& part : hand.parts) std::printf(" %.5f", part->query.volume());
    std::printf(", kinetic energy %.1e\n", hand.ball.kinetic_energy());
  }
  Vec3 sum;
  double pressing = 0;
  for (const auto& part : hand.parts) sum += part->force, pressing += length(part->force);
  const double weight = gravity * hand.ball.total_mass();
  const double unbalanced = length(sum + Vec3{0, 0, weight});
  std::printf("forces of the ball on fingers and palm: %.2f in all, their sum (%.4f, %.4f, %.4f), weight %.4f\n",
              pressing, sum.x, sum.y, sum.z, weight);
  std::printf("work - heat - energy: at most %.1e of the work\n", worst_balance / most_work);
  return unbalanced < 0.01 * weight && worst_balance < 0.02 * most_work && pressing > 3 * weight ? 0 : 1;
}
