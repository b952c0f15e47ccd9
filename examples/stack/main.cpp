// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Five soft boxes fall onto a plate and onto each other, and come to rest. Contact is a constraint of XPBD: the volume
// of each sector of a contact patch is 0. docs/how-to/responses.md says more.
//
//   stack [--steps N] [--aligned]    aligned: boxes exactly above each other; otherwise each turned by 0.1 more
//
// After the first 6,000 steps the stack has to be at rest: the plate carries the weight, no box moves, and energy does
// not grow.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <morula/morula.hpp>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "../response/rigid_body.hpp"
#include "../response/soft_body.hpp"
#include "../response/xpbd.hpp"

using morula::Vec3;
using response::SoftBody;

namespace {

constexpr int box_count = 5, settling_steps = 6000;
constexpr double h = 0.001, gravity = 9.81, stiffness = 20000, friction = 0.5, drag = 6;  // seconds, kg, meters

class Stack {
 public:
  explicit Stack(double turn) {
    for (int i = 0; i < box_count; ++i) {
      const auto place = morula::RigidTransform::from_axis({0, 0, 1}, turn * i, {0.2 * turn * i, 0, 1.01 * i + 0.01});
      boxes.push_back(
          std::make_unique<SoftBody>(std::array<std::uint32_t, 3>{3, 3, 3}, 1.0, [&](auto x, auto y, auto z) {
            return place(Vec3{x / 3.0 - 0.5, y / 3.0 - 0.5, z / 3.0});
          }));
      queries.emplace_back(boxes.back()->collider, i == 0 ? plate.collider : below(i)->collider);
    }
  }

  void step() {
    for (const auto& box : boxes) {
      response::predict(*box, h, gravity);
      response::solve_springs(*box, h, stiffness);
      box->update_surface();
    }
    for (int i = 0; i < box_count; ++i) {
      force[i] = {};
      if (const morula::Status status = queries[i].run(); !status) throw std::runtime_error(message(status));
      for (const morula::ContactPatch& patch : queries[i].patches())
        force[i] += response::solve_points(patch, boxes[i].get(), below(i), friction) / (h * h);
      boxes[i]->update_surface();  // for the contact with the box above
    }
    for (const auto& box : boxes) response::end_step(*box, h, drag);
  }

  std::vector<Vec3> centers() const {
    std::vector<Vec3> all;
    for (const auto& box : boxes) all.push_back(box->center());
    return all;
  }
  double kinetic_energy() const {
    double sum = 0;
    for (const auto& box : boxes) sum += box->kinetic_energy();
    return sum;
  }
  double energy() const {
    double sum = kinetic_energy();
    for (const auto& box : boxes) sum += box->elastic_energy(stiffness) + gravity * box->total_mass() * box->center().z;
    return sum;
  }
  /// How far any box reaches below the top of what it stands on, from points alone.
  double overlap() const {
    double most = 0, top = 0;
    for (const auto& box : boxes) {
      const auto [low, high] =
          std::minmax_element(box->x.begin(), box->x.end(), [](const Vec3& p, const Vec3& q) { return p.z < q.z; });
      most = std::max(most, top - low->z), top = high->z;
    }
    return most;
  }

  std::vector<std::unique_ptr<SoftBody>> boxes;
  std::array<Vec3, box_count> force;  // on each box by what it stands on, in the last step

 private:
  SoftBody* below(int i) const { return i == 0 ? nullptr : boxes[static_cast<std::size_t>(i - 1)].get(); }

  response::RigidBody plate{response::box({-2, -2, -1}, {2, 2, 0})};
  std::vector<morula::ContactPatchQuery> queries;
};

}  // namespace

int main(int argc, char** argv) {
  int steps = settling_steps + 2000;
  bool is_aligned = false;
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--aligned") is_aligned = true;
    if (std::string_view(argv[i]) == "--steps" && i + 1 < argc)
      steps = std::max(settling_steps + 1, std::atoi(argv[i + 1]));
  }
  Stack stack(is_aligned ? 0 : 0.1);
  for (int k = 0; k < settling_steps; ++k) stack.step();

  const std::vector<Vec3> settled = stack.centers();
  const double energy = stack.energy();
  double drift = 0, growth = 0, moving = 0, unbalanced = 0;
  for (int k = settling_steps; k < steps; ++k) {
    stack.step();
    for (int i = 0; i < box_count; ++i) {
      drift = std::max(drift, distance(stack.boxes[i]->center(), settled[i]));
      const double weight = gravity * (box_count - i);  // of this box and of those above
      unbalanced = std::max(unbalanced, length(stack.force[i] - Vec3{0, 0, weight}) / weight);
    }
    growth = std::max(growth, stack.energy() / energy - 1);
    moving = std::max(moving, stack.kinetic_energy());
  }
  for (int i = 0; i < box_count; ++i)
    std::printf("box %d: center %.4f %.4f %.4f, carried with a force of %.4f, weight of all above %.4f\n", i,
                stack.boxes[i]->center().x, stack.boxes[i]->center().y, stack.boxes[i]->center().z, stack.force[i].z,
                gravity * (box_count - i));
  std::printf(
      "steps %d to %d: drift %.2e of a box, energy grows by at most %.1e of itself, kinetic energy at most %.1e\n",
      settling_steps, steps, drift, growth, moving);
  std::printf("forces differ from weights by at most %.1e of the weight; overlap %.2e of a box\n", unbalanced,
              stack.overlap());
  return drift < 1e-4 && growth < 1e-6 && moving < 1e-6 && unbalanced < 1e-3 && stack.overlap() < 4e-3 ? 0 : 1;
}
