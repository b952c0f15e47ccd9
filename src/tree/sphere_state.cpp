// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <morula/geometry/scale.hpp>
#include <morula/tree/sphere_state.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/exact_predicates.hpp"
#include "geometry/rounded_up.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;

void narrow_spheres(std::span<const Sphere> spheres, const Vec3& origin, std::vector<Spheref>& narrow) {
  for (const Sphere& s : spheres) {
    const Vec3 center = s.center - origin;
    // Adding zero makes a negative zero positive, as the rules do.
    const Vec3f nearest = Vec3f(center) + Vec3f{};
    // mutant narrowed-center: `s.radius + scaled_length(Vec3(nearest) - center)` -> `s.radius`
    narrow.push_back({nearest, rounded_up(s.radius + scaled_length(Vec3(nearest) - center))});
    if (!(is_finite(nearest) && max_norm(nearest) <= largest_local_coordinate &&
          narrow.back().radius <= largest_local_coordinate))
      throw std::invalid_argument("sphere " + std::to_string(narrow.size() - 1) +
                                  " is too large for an update: scale "
                                  "mesh and tree so that coordinates about the center stay below 1e17");
  }
}

struct PosedSpheres::State {
  SphereTree tree;
  std::vector<Spheref> spheres, next;
  SphereState pose;

  static std::shared_ptr<State> make() {
    auto state = std::make_shared<State>();
    state->pose.shared = state;
    return state;
  }

  void show(std::uint64_t frame, const Vec3& origin) {
    pose.tree = &tree;
    pose.spheres = spheres;
    pose.origin = origin;
    pose.frame = frame;
  }

  /// Whether every sphere contains its children's, decided exactly.
  bool is_nested() const {
    const auto wide = [&](std::uint32_t node) { return Sphere{Vec3(spheres[node].center), spheres[node].radius}; };
    for (std::uint32_t node = 1; node < tree.node_count(); ++node)
      if (!encloses(wide(tree.parent[node]), wide(node))) return false;
    return true;
  }
};

PosedSpheres::PosedSpheres(SphereTree tree, bool covers) : state_(State::make()) {
  const StandardFloats standard;
  if (const std::vector<std::string> faults = validate(tree); !faults.empty())
    throw std::invalid_argument("the tree is none: " + faults.front());
  if (tree.node_count() == 0) throw std::invalid_argument("the tree has no nodes");
  State& s = *state_;
  s.tree = std::move(tree);
  narrow_spheres(s.tree.spheres, s.tree.spheres[0].center, s.spheres);
  s.pose.cover_id = tree_hash(s.tree);
  s.pose.covers = covers;
  s.show(0, s.tree.spheres[0].center);
  s.pose.nested = s.is_nested();
}

PosedSpheres::PosedSpheres(const SphereState& pose) : state_(State::make()) {
  State& s = *state_;
  s.tree = *pose.tree;
  s.spheres.assign(pose.spheres.begin(), pose.spheres.end());
  s.pose = pose;
  s.pose.positions.reset();
  // mutant posed-by-another: `s.pose.vertices = nullptr;` -> ``
  s.pose.vertices = nullptr;
  s.pose.ended = false;
  s.pose.shared = state_;
  s.show(pose.frame, pose.origin);
}

// Callers may keep the state for longer: it must not look like one at rest.
void PosedSpheres::end() noexcept {
  // mutant spheres-assigned-to: `if (state_) state_->pose.current = false, state_->pose.ended = true` -> ``
  if (state_) state_->pose.current = false, state_->pose.ended = true;
}

PosedSpheres::~PosedSpheres() {
  end();
}
PosedSpheres::PosedSpheres(const PosedSpheres& other) : PosedSpheres(other.sphere_state()) {}
PosedSpheres& PosedSpheres::operator=(const PosedSpheres& other) {
  return *this = PosedSpheres(other);
}
PosedSpheres::PosedSpheres(PosedSpheres&&) noexcept = default;
PosedSpheres& PosedSpheres::operator=(PosedSpheres&& other) noexcept {
  if (this == &other) return *this;
  end();
  state_ = std::move(other.state_);
  return *this;
}

void PosedSpheres::set(std::span<const Spheref> spheres, const Vec3& origin) {
  const StandardFloats standard;
  State& s = *state_;
  if (spheres.size() != s.spheres.size())
    throw std::invalid_argument(std::to_string(spheres.size()) + " spheres for a tree of " +
                                std::to_string(s.spheres.size()) + " nodes");
  if (!(is_finite(origin) && max_norm(origin) <= largest_origin_coordinate))
    throw std::invalid_argument("the origin of the spheres is not finite, or 1e30 or more from (0, 0, 0)");
  for (std::size_t i = 0; i < spheres.size(); ++i)
    if (!(is_finite(spheres[i].center) && max_norm(spheres[i].center) <= largest_local_coordinate &&
          spheres[i].radius >= 0 && spheres[i].radius <= largest_radius))
      throw std::invalid_argument("sphere " + std::to_string(i) +
                                  " is not finite, has a negative radius, or reaches 1e17 about the origin");
  s.spheres.assign(spheres.begin(), spheres.end());
  s.show(s.pose.frame + 1, origin);
  // mutant posed-stays-nested: `s.pose.nested = s.is_nested();` -> ``
  s.pose.nested = s.is_nested();
}

void PosedSpheres::set(std::span<const Sphere> spheres) {
  const StandardFloats standard;
  State& s = *state_;
  s.next.clear();
  const Vec3 origin = spheres.empty() ? Vec3{} : spheres[0].center;
  narrow_spheres(spheres, origin, s.next);
  set(s.next, origin);
}

const SphereState& PosedSpheres::sphere_state() const {
  return state_->pose;
}

}  // namespace morula
