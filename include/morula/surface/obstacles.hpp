// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Obstacles: a floor, a ball, a capsule, a convex hull or a distance field against the vertices or facets of a surface,
// at its present place or over a step.
//
// Obstacles are solid, and distances to them are signed: negative inside.
//
//   morula::SurfaceTree surface(mesh);
//   const morula::HalfSpace floor{.normal = {0, 0, 1}, .offset = 0};
//   morula::ObstacleQuery query;
//   if (!surface.update(positions) || !query.run(surface, floor)) std::puts("rejected");
//   std::printf("%zu vertices and facets are near the floor\n", query.contacts().size());
#pragma once

#include <functional>
#include <memory>
#include <morula/collide/primitives.hpp>
#include <morula/surface/feature_pairs.hpp>
#include <morula/surface/surface_tree.hpp>
#include <span>
#include <variant>
#include <vector>

namespace morula {

/// A solid that is defined by a function of points in the world: a SignedDistance, samples on a grid, a formula.
struct DistanceField {
  /// Signed distance, or any function that is negative inside and positive outside. Workers call it concurrently; it
  /// must give the same result for the same point. NaN counts as near.
  std::function<double(const Vec3&)> value{};
  /// Lipschitz constant of `value`: |value(x) - value(y)| <= lipschitz |x - y|. Every guarantee depends on it; 1 for a
  /// distance.
  double lipschitz = 1;
  /// Error of the least value on a facet, in the units of `value`; over a step, also the error of the gap between
  /// facets and the field. 0: an eighth of the facet's longest edge, times `lipschitz`. It costs (edge / tolerance)^2
  /// values.
  double tolerance = 0;
  /// Outward direction, of any length except 0. Empty: computed by differences of values.
  std::function<Vec3(const Vec3&)> gradient{};
};

/// The shape of an obstacle, which is borrowed until the last resume().
using Obstacle = std::variant<HalfSpace, Sphere, Capsule, ConvexHull, DistanceField>;

enum class ObstacleFeatures : std::uint8_t {
  vertices,  ///< vertices that facets use; sufficient for a floor, because vertices reach it first
  facets,    ///< also obstacles between vertices: an edge of a box, a thin capsule
};

/// The point of a vertex or facet that is deepest in an obstacle, or nearest to it.
struct ObstacleContact {
  std::uint32_t feature = 0;  ///< number of the vertex or facet
  double distance = 0;        ///< signed distance from the obstacle to `point`, mesh units; negative inside
  Vec3 point{};               ///< point of the surface
  Barycentric weights{};      ///< weights of the facet's vertices; {1, 0, 0} for a vertex
  Vec3 normal{};              ///< unit normal out of the obstacle
};

/// A vertex or a facet that may meet an obstacle within a step.
struct ObstacleImpact {
  std::uint32_t feature = 0;
  double time = 0;  ///< time before which no impact occurs: 0 to 1, never later than the true time
};

struct ObstacleOptions {
  /// Largest distance outside that counts as a contact or an impact, mesh units; finite, not negative.
  double margin = 0;
  ObstacleFeatures features = ObstacleFeatures::facets;
  /// Filter: returns true to keep a vertex or a facet. Workers call it concurrently.
  std::function<bool(std::uint32_t feature)> accepts{};
  /// Limit in time, or in tests: one per box of the tree, and eight per block of eight facets or vertices.
  Budget budget{};
  Clock clock{};
};

/// Obstacle query: repeated queries with kept memory. For one thread at a time; workers share its work.
///
/// Complete: every vertex or facet whose signed distance is at most the margin is found, up to 2^-44 of the largest
/// coordinate. With a field, these are every vertex with such a value and every facet with a point of such a value;
/// facets nearer than margin and tolerance may be found too. A surface in a step is tested at its beginning.
class ObstacleQuery {
 public:
  /// Throws std::invalid_argument for a margin that is negative or not finite, and for a negative budget.
  explicit ObstacleQuery(ObstacleOptions options = {});
  ~ObstacleQuery();
  ObstacleQuery(ObstacleQuery&&) noexcept;
  ObstacleQuery& operator=(ObstacleQuery&&) noexcept;
  void set_options(ObstacleOptions options);
  const ObstacleOptions& options() const;

  /// Finds the contacts. Rejected with bad_shape: an obstacle that is not finite or has no inside; a field without a
  /// function, with a constant that is not positive, or with a negative tolerance.
  SurfaceQueryStatus run(const SurfaceTree& surface, const Obstacle& obstacle, Workers& workers = serial_workers());
  /// Continues after a budget ended the query, with a new budget. Rejected with no_front if no query was started, with
  /// other_frame if the surface has moved since, and with other_options for another margin or other features than at
  /// the start.
  SurfaceQueryStatus resume(Workers& workers = serial_workers());

  /// Contacts in the order of features, each once. They are the same for any number of workers and interruptions.
  std::span<const ObstacleContact> contacts() const;
  /// Facets that an interrupted query has not tested: all missing contacts are on them or their vertices.
  const std::vector<std::span<const std::uint32_t>>& open() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Obstacle query over a step: vertices move by SurfaceTree::update(from, to); the obstacle moves on a straight line
/// without rotation.
///
/// Conservative: a vertex or facet is skipped only if it is proven to stay farther away than the margin; `time` is the
/// end of the proof. For convex obstacles directions prove it, as in SweptQuery: along a fixed direction the gap is at
/// least the least of linear functions of time; along a direction that rotates evenly, at least the least of three
/// Bernstein coefficients. In addition, a feature at distance g whose vertices move by at most s has no impact within g
/// / s of the step; for a field this is the only proof. Features that pass the obstacle within about 2^-24 of their
/// path may be found although they miss it; with fields, within a thousandth.
class SweptObstacleQuery {
 public:
  explicit SweptObstacleQuery(ObstacleOptions options = {});
  ~SweptObstacleQuery();
  SweptObstacleQuery(SweptObstacleQuery&&) noexcept;
  SweptObstacleQuery& operator=(SweptObstacleQuery&&) noexcept;
  void set_options(ObstacleOptions options);
  const ObstacleOptions& options() const;

  /// Finds the impacts. The obstacle starts at the given place and moves by `motion`. Rejects the same input as
  /// ObstacleQuery, and with bad_option a motion that is not finite or 2^100 or more. A surface that is in no step
  /// stands still.
  SurfaceQueryStatus run(const SurfaceTree& surface, const Obstacle& obstacle, const Vec3& motion = {},
                         Workers& workers = serial_workers());
  /// Continues like ObstacleQuery::resume().
  SurfaceQueryStatus resume(Workers& workers = serial_workers());

  std::span<const ObstacleImpact> impacts() const;
  const std::vector<std::span<const std::uint32_t>>& open() const;
  /// Share of the step without an impact among the tested features: the earliest time, 1 without impacts.
  double collision_free_step() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula
