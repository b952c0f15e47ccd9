// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Obstacles: a floor, a ball, a capsule, a convex hull or a distance field against the vertices or the facets of a
// surface, where it is or over a step.
//
// Distances are signed: negative inside the obstacle, which is solid.
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

/// A solid known by a function of points in the world: a SignedDistance, samples on a grid, a formula.
struct DistanceField {
  /// Signed distance, or whatever is negative inside and positive outside. Called by workers at the same time; the same
  /// answer for the same point. A value that is not a number counts as near.
  std::function<double(const Vec3&)> value{};
  /// |value(x) - value(y)| <= lipschitz |x - y|, and every promise hangs on it: 1 for a distance.
  double lipschitz = 1;
  /// The least value on a facet is found within so much, and in steps so much is left out of every gap between facets
  /// and the field. 0: an eighth of the facet's longest edge, times `lipschitz`. It costs (edge / tolerance)^2 values.
  double tolerance = 0;
  /// Leads out; of any length but 0. None: by differences of values.
  std::function<Vec3(const Vec3&)> gradient{};
};

/// An obstacle is borrowed until the last resume().
using Obstacle = std::variant<HalfSpace, Sphere, Capsule, ConvexHull, DistanceField>;

enum class ObstacleFeatures : std::uint8_t {
  vertices,  ///< those that facets use; enough for a floor, which no facet reaches before its vertices do
  facets,    ///< also what comes between vertices: an edge of a box, a thin capsule
};

/// Where a vertex or a facet is deepest in an obstacle, or nearest to it.
struct ObstacleContact {
  std::uint32_t feature = 0;  ///< a vertex or a facet of the mesh
  double distance = 0;        ///< from the obstacle to `point`, negative inside
  Vec3 point{};               ///< of the surface
  Barycentric weights{};      ///< of the facet's vertices; {1, 0, 0} for a vertex
  Vec3 normal{};              ///< out of the obstacle, unit
};

/// A vertex or a facet that may meet an obstacle within a step.
struct ObstacleImpact {
  std::uint32_t feature = 0;
  double time = 0;  ///< no impact comes before: 0 to 1, never later than the truth
};

struct ObstacleOptions {
  double margin = 0;  ///< what is this far outside counts too, and as an impact; mesh units, finite, not negative
  ObstacleFeatures features = ObstacleFeatures::facets;
  /// Keeps a vertex or a facet when it returns true. Called by workers at the same time.
  std::function<bool(std::uint32_t feature)> accepts{};
  Budget budget{};  ///< in tests: boxes of the tree, and eight for eight facets or vertices
  Clock clock{};
};

/// Obstacle query: asks again and again, and keeps its memory. For one thread at a time; workers share its work.
///
/// Complete: every vertex or facet whose signed distance is at most the margin is found, but for 2^-44 of the largest
/// coordinate; with a field, every vertex whose value is and every facet on which there is such a value. Facets nearer
/// than margin and tolerance may be found too. Surfaces that are in a step are asked where it begins.
class ObstacleQuery {
 public:
  /// Throws std::invalid_argument for a margin that is negative or not finite, and for a negative budget.
  explicit ObstacleQuery(ObstacleOptions options = {});
  ~ObstacleQuery();
  ObstacleQuery(ObstacleQuery&&) noexcept;
  ObstacleQuery& operator=(ObstacleQuery&&) noexcept;
  void set_options(ObstacleOptions options);
  const ObstacleOptions& options() const;

  /// Refused with bad_shape: an obstacle that is not finite or has no inside; a field without a function, with a
  /// constant that is not positive, or with a negative tolerance.
  SurfaceQueryStatus run(const SurfaceTree& surface, const Obstacle& obstacle, Workers& workers = serial_workers());
  /// Goes on where a budget ended it, with a new one. Refused with no_front when nothing was started, with other_frame
  /// when the surface has moved since, and with other_options for another margin or other features than it began with.
  SurfaceQueryStatus resume(Workers& workers = serial_workers());

  /// In the order of features, each once. The same for any number of workers and however often it was interrupted.
  std::span<const ObstacleContact> contacts() const;
  /// Facets that an interrupted query has not looked at: what is missing is of them or their vertices.
  const std::vector<std::span<const std::uint32_t>>& open() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The same over a step: vertices go as SurfaceTree::update(from, to) says, the obstacle on a straight line without
/// turning.
///
/// Conservative: a vertex or facet is left out only when it is proven to stay more than the margin away; `time` is as
/// far as the proof reaches. Against convex obstacles, as in SweptQuery, directions prove it: along one the gap is
/// never less than the least of linear functions of time, along one that turns evenly than the least of three Bernstein
/// coefficients. Besides, a feature whose distance is g and whose vertices go no farther than s meets nothing in g / s
/// of the step; against a field nothing else is used. What passes within some 2^-24 of its way is found though it
/// misses, and against fields what passes nearer than a thousandth.
class SweptObstacleQuery {
 public:
  explicit SweptObstacleQuery(ObstacleOptions options = {});
  ~SweptObstacleQuery();
  SweptObstacleQuery(SweptObstacleQuery&&) noexcept;
  SweptObstacleQuery& operator=(SweptObstacleQuery&&) noexcept;
  void set_options(ObstacleOptions options);
  const ObstacleOptions& options() const;

  /// The obstacle begins where it is given, and moves by `motion`. Refused as ObstacleQuery is, and with bad_option for
  /// a motion that is not finite or 2^100 or more. A surface that is in no step stands still.
  SurfaceQueryStatus run(const SurfaceTree& surface, const Obstacle& obstacle, const Vec3& motion = {},
                         Workers& workers = serial_workers());
  /// As ObstacleQuery::resume().
  SurfaceQueryStatus resume(Workers& workers = serial_workers());

  std::span<const ObstacleImpact> impacts() const;
  const std::vector<std::span<const std::uint32_t>>& open() const;
  /// Which share of the step all may go without an impact, of what was looked at: the earliest time, 1 without any.
  double collision_free_step() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula
