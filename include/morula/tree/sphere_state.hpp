// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Sphere state: a sphere tree with the spheres of one frame, which all queries on spheres read.
#pragma once

#include <cstdint>
#include <memory>
#include <morula/geometry/positions.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <optional>
#include <span>

namespace morula {
namespace detail {
class PosedVertices;
}

/// A sphere state is borrowed from a source: a Body, a PosedSpheres, or a source of the caller. The source keeps one
/// SphereState at one address and updates it whenever its spheres move; queries read it there.
struct SphereState {
  const SphereTree* tree = nullptr;  ///< levels and children; its own spheres are the rest spheres
  std::span<const Spheref> spheres;  ///< one per node of the tree, about `origin`, mesh units
  Vec3 origin{};                     ///< mesh units
  std::uint64_t cover_id = 0;        ///< equal for states of one tree with one cover
  std::uint64_t frame = 0;           ///< number that changes with every new state of a source; 0 at rest
  bool covers = false;               ///< every level's spheres contain the surface, in any motion
  bool nested = false;               ///< every sphere contains its children's: of a body in any motion, of
                                     ///< PosedSpheres in this frame
  bool current = true;               ///< false: the last update was rejected, and the spheres belong to an older frame
  bool complete = true;              ///< false: a lazy update has left nodes behind
  std::optional<PositionView> positions{};  ///< vertices that the spheres followed; no value if the source had none
  /// Vertices that a body without `positions` computes one by one, when queries read them; nullptr for other sources,
  /// and at rest.
  const detail::PosedVertices* vertices = nullptr;
  bool ended = false;  ///< the source was destroyed or assigned to
  /// Shared ownership of the borrowed data, if the source shares it. A user that keeps it can still read `ended`.
  std::weak_ptr<const void> shared{};

  /// A sphere in mesh coordinates.
  Sphere sphere(std::uint32_t node) const {
    const Spheref& s = spheres[node];
    return {origin + Vec3(s.center), static_cast<double>(s.radius)};
  }
};

/// Posed spheres: the caller's own spheres over a tree, for the same queries as a body. They serve imported trees and
/// sphere sets, spheres that were read from elsewhere, and copies of a state for a later comparison.
class PosedSpheres {
 public:
  /// Posed spheres at rest: the tree's own spheres, narrowed to float so that each contains the original sphere.
  ///
  /// covers: the caller guarantees that every level contains the surface, after construction and after each set();
  /// queries then report their misses as proven. Throws std::invalid_argument, with the first message of validate(),
  /// for a tree that fails validate(), and for spheres that reach 2^57 about the root's center. Cost: linear in nodes.
  explicit PosedSpheres(SphereTree tree, bool covers = false);
  /// A copy of a state. It copies the tree, but not the positions that the spheres followed.
  explicit PosedSpheres(const SphereState& pose);
  ~PosedSpheres();
  PosedSpheres(const PosedSpheres&);
  PosedSpheres& operator=(const PosedSpheres&);
  PosedSpheres(PosedSpheres&&) noexcept;
  PosedSpheres& operator=(PosedSpheres&&) noexcept;

  /// Sets the spheres of the next frame, one per node, about `origin`. Allocates nothing. Throws std::invalid_argument,
  /// and changes nothing, for a wrong count, and for a sphere that is not finite, has a negative radius, or reaches
  /// 2^57.
  void set(std::span<const Spheref> spheres, const Vec3& origin = {});
  /// The same in double, narrowed about the root's center so that each sphere contains the original one.
  void set(std::span<const Sphere> spheres);

  /// The state, at one address during the lifetime of this object, even if it is moved. Assignment to this object ends
  /// the state (SphereState::ended).
  const SphereState& sphere_state() const;

 private:
  struct State;
  void end() noexcept;
  std::shared_ptr<State> state_;
};

/// Appends the spheres about an origin to `narrow` in float, each large enough to contain the original sphere. Throws
/// std::invalid_argument, naming the sphere, if one reaches 2^57.
void narrow_spheres(std::span<const Sphere> spheres, const Vec3& origin, std::vector<Spheref>& narrow);

}  // namespace morula
