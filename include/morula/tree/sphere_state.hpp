// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Posed tree: a sphere tree with the spheres of one moment, which is what every query on spheres asks.
#pragma once

#include <cstdint>
#include <memory>
#include <morula/geometry/positions.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <optional>
#include <span>

namespace morula {

/// Borrowed from a source: a Body, a PosedSpheres, or something of the caller's own. The source keeps one SphereState
/// at one address and brings it up to date whenever its spheres move; queries read it there.
struct SphereState {
  const SphereTree* tree = nullptr;  ///< levels and children; its own spheres are those of rest
  std::span<const Spheref> spheres;  ///< one per node of the tree, about `origin`, mesh units
  Vec3 origin{};                     ///< mesh units
  std::uint64_t cover_id = 0;        ///< equal for poses of one tree with one cover
  std::uint64_t frame = 0;           ///< tells one pose of a source from the next; 0 at rest
  bool covers = false;               ///< every level's spheres contain the surface, whatever the motion
  bool nested = false;               ///< every sphere contains its children's, whatever the motion
  bool current = true;               ///< false: the last update was refused, and the spheres are of an older frame
  bool complete = true;              ///< false: a lazy update has left nodes behind
  std::optional<PositionView> positions{};  ///< the vertices that the spheres followed, where the source was given them
  bool ended = false;                       ///< the source is gone, or another was assigned to it
  /// What is borrowed here, of a source that shares it: who asks keeps it, so that the pose can say that it has ended.
  std::weak_ptr<const void> shared{};

  /// A sphere in mesh coordinates.
  Sphere sphere(std::uint32_t node) const {
    const Spheref& s = spheres[node];
    return {origin + Vec3(s.center), static_cast<double>(s.radius)};
  }
};

/// Posed spheres: spheres of the caller's own over a tree, to be asked as a body is. For imported trees and sphere
/// sets, spheres that were read back from elsewhere, and copies of a pose that is to be compared with a later one.
class PosedSpheres {
 public:
  /// At rest: the tree's own spheres, narrowed to float so that each contains what it was.
  ///
  /// covers: the caller vouches that every level contains the surface, now and after each set(); queries then call
  /// their misses proofs. Throws std::invalid_argument, with the first of its words, for a tree that fails validate(),
  /// and for spheres that reach 2^57 about the root's center. Cost: linear in nodes.
  explicit PosedSpheres(SphereTree tree, bool covers = false);
  /// A copy of a pose as it is now. The positions it followed are not copied. The tree is.
  explicit PosedSpheres(const SphereState& pose);
  ~PosedSpheres();
  PosedSpheres(const PosedSpheres&);
  PosedSpheres& operator=(const PosedSpheres&);
  PosedSpheres(PosedSpheres&&) noexcept;
  PosedSpheres& operator=(PosedSpheres&&) noexcept;

  /// Other spheres, one per node, about `origin`: the next frame. No allocation.
  /// Throws std::invalid_argument, and changes nothing, for a wrong count, and for a sphere that is not finite, has a
  /// negative radius, or reaches 2^57.
  void set(std::span<const Spheref> spheres, const Vec3& origin = {});
  /// The same in double, narrowed about the root's center so that each contains what it was.
  void set(std::span<const Sphere> spheres);

  /// At one address as long as this lives, also when it is moved. Assigning to this ends it (SphereState::ended).
  const SphereState& sphere_state() const;

 private:
  struct State;
  void end() noexcept;
  std::shared_ptr<State> state_;
};

/// The spheres about an origin in float, each so large that it contains what it was. Adds them to `narrow`.
/// Throws std::invalid_argument, naming the sphere, for one that reaches 2^57.
void narrow_spheres(std::span<const Sphere> spheres, const Vec3& origin, std::vector<Spheref>& narrow);

}  // namespace morula
