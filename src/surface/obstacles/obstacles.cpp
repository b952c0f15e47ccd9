// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/surface/obstacles.hpp>

#include "geometry/object_call.hpp"
#include "surface/obstacles/obstacle_search.hpp"
#include "surface/obstacles/obstacle_way.hpp"
#include "surface/pairs/feature_query.hpp"

namespace morula {
using namespace detail;
namespace {

template <class Visit>
auto with_shape(const Obstacle& obstacle, const Visit& visit) {
  return std::visit(
      [&](const auto& shape) {
        using Shape = std::remove_cvref_t<decltype(shape)>;
        if constexpr (std::same_as<Shape, HalfSpace>) {
          return visit(PlacedHalfSpace(shape));
        } else if constexpr (std::same_as<Shape, Sphere>) {
          return visit(PlacedCapsule(shape.center, shape.center, shape.radius));
        } else if constexpr (std::same_as<Shape, Capsule>) {
          return visit(PlacedCapsule(shape.p, shape.q, shape.radius));
        } else if constexpr (std::same_as<Shape, ConvexHull>) {
          return visit(PlacedHull(shape));
        } else {
          return visit(PlacedField(shape));
        }
      },
      obstacle);
}

bool is_usable_obstacle(const Obstacle& obstacle) {
  return std::visit([](const auto& shape) { return is_usable(shape); }, obstacle);
}

template <class Shape>
double size_of(const Shape& shape) {
  if constexpr (is_field<Shape>) {
    return 0;
  } else {
    return shape.size();
  }
}

void require_usable(const ObstacleOptions& options) {
  require_length(options.margin, "ObstacleOptions::margin");
  require_budget(options.budget);
}

/// Positions of a feature's vertices at the beginning of a step and, less the obstacle's motion, at its end.
struct Corners {
  std::array<Vec3, 3> from, to;
  std::size_t size;

  Corners(const SurfaceTreeState& s, std::span<const std::uint32_t> vertices) : size(vertices.size()) {
    for (std::size_t i = 0; i < size; ++i) from[i] = s.from_of(vertices[i]);
  }
  void move(const SurfaceTreeState& s, std::span<const std::uint32_t> vertices, const Vec3& motion) {
    for (std::size_t i = 0; i < size; ++i) to[i] = s.to_of(vertices[i]) - motion;
  }
  std::span<const Vec3> points() const { return {from.data(), size}; }
  /// A sphere that contains the feature at the beginning of the step.
  Sphere sphere() const { return size == 1 ? Sphere{from[0], 0} : sphere_about({from[0], from[1], from[2]}); }
};

/// The parameters of a query. A query with others cannot be continued.
struct Parameters {
  double margin = 0;
  ObstacleFeatures features = ObstacleFeatures::facets;
  explicit Parameters(const ObstacleOptions& options) : margin(options.margin), features(options.features) {}
  bool operator==(const Parameters&) const = default;
};

}  // namespace

struct ObstacleQuery::State {
  CallState call;
  ObstacleOptions options;
  Parameters started_with{options};
  const Obstacle* obstacle = nullptr;
  ObstacleSearch<ObstacleContact> search;

  void forget() noexcept {
    search.forget();
    obstacle = nullptr;
  }
  SurfaceQueryStatus go_on(Workers& workers) {
    const double margin = options.margin;
    const SurfaceTreeState& s = search.surface();
    return with_shape(*obstacle, [&](const auto& shape) {
      using Shape = std::remove_cvref_t<decltype(shape)>;
      return search.run(
          options, workers, [&](const Vec3& center, const Vec3& half) { return shape.bound(center, half) > margin; },
          [&](std::span<const std::uint32_t> vertices, std::optional<ObstacleContact>& contact) {
            const Corners corners(s, vertices);
            if (corners.size == 3 && shape.bound(corners.sphere()) > margin) return false;
            const FoundOnShape found = nearest_on(shape, corners.points(), margin);
            if ((is_field<Shape> ? found.lower : found.distance) > margin) return true;
            contact = {0, found.distance, found.point, found.barycentric,
                       normal_of(shape, corners.points(), found.point)};
            return true;
          });
    });
  }
};

ObstacleQuery::ObstacleQuery(ObstacleOptions options) : state_(std::make_unique<State>()) {
  set_options(std::move(options));
}
ObstacleQuery::~ObstacleQuery() = default;
ObstacleQuery::ObstacleQuery(ObstacleQuery&&) noexcept = default;
ObstacleQuery& ObstacleQuery::operator=(ObstacleQuery&&) noexcept = default;

void ObstacleQuery::set_options(ObstacleOptions options) {
  require_idle(state_->call);
  require_usable(options);
  state_->options = std::move(options);
}
const ObstacleOptions& ObstacleQuery::options() const {
  return state_->options;
}

SurfaceQueryStatus ObstacleQuery::run(const SurfaceTree& surface, const Obstacle& obstacle, Workers& workers) {
  const StandardFloats standard;
  ObjectCall own(*state_, CallKind::begins);
  if (!own.status()) return {own.status()};
  if (!is_usable_obstacle(obstacle)) return {{.code = Status::Code::bad_shape}};
  if (const Status status = state_of(surface).askable(0); !status) return {status};
  state_->obstacle = &obstacle;
  state_->started_with = Parameters(state_->options);
  state_->search.start(state_of(surface), workers);
  const SurfaceQueryStatus status = state_->go_on(workers);
  own.finish(status);
  return status;
}
SurfaceQueryStatus ObstacleQuery::resume(Workers& workers) {
  const StandardFloats standard;
  ObjectCall own(*state_, CallKind::goes_on);
  if (!own.status()) return {own.status()};
  if (!state_->search.is_started()) return {{.code = Status::Code::no_front}};
  if (!state_->search.is_current()) return {{.code = Status::Code::other_frame}};
  if (!(state_->started_with == Parameters(state_->options))) return {{.code = Status::Code::other_options}};
  const SurfaceQueryStatus status = state_->go_on(workers);
  own.finish(status);
  return status;
}

std::span<const ObstacleContact> ObstacleQuery::contacts() const {
  return state_->search.found();
}
const std::vector<std::span<const std::uint32_t>>& ObstacleQuery::open() const {
  return state_->search.open();
}

struct SweptObstacleQuery::State {
  CallState call;
  ObstacleOptions options;
  Parameters started_with{options};
  const Obstacle* obstacle = nullptr;
  Vec3 motion;
  ObstacleSearch<ObstacleImpact> search;

  void forget() noexcept {
    search.forget();
    obstacle = nullptr;
  }
  SurfaceQueryStatus go_on(Workers& workers) {
    const double margin = options.margin;
    const SurfaceTreeState& s = search.surface();
    // In the frame in which the obstacle stands still, vertices also move by −motion: a box is lengthened by that.
    const Vec3 shift = motion * -0.5, longer = detail::abs(shift);
    return with_shape(*obstacle, [&](const auto& shape) {
      using Shape = std::remove_cvref_t<decltype(shape)>;
      const double reach = max_norm(s.origin) + search.boxes().extent + max_norm(motion) + size_of(shape);
      return search.run(
          options, workers,
          [&](const Vec3& center, const Vec3& half) {
            const double pad = 0x1p-50 * reach;
            return shape.bound(center + shift, half + longer + Vec3{pad, pad, pad}) > margin;
          },
          [&](std::span<const std::uint32_t> vertices, std::optional<ObstacleImpact>& impact) {
            Corners corners(s, vertices);
            corners.move(s, vertices, motion);
            Box swept;
            for (std::size_t i = 0; i < corners.size; ++i) swept.add(corners.from[i]), swept.add(corners.to[i]);
            const double pad = 0x1p-50 * reach;
            if (shape.bound(swept.center(), swept.extent() * 0.5 + Vec3{pad, pad, pad}) > margin) return false;
            const double time =
                ObstacleWay<Shape>(shape, corners.from, corners.to, corners.size, margin, reach).advance();
            if (time <= 1) impact = {0, time};
            return true;
          });
    });
  }
};

SweptObstacleQuery::SweptObstacleQuery(ObstacleOptions options) : state_(std::make_unique<State>()) {
  set_options(std::move(options));
}
SweptObstacleQuery::~SweptObstacleQuery() = default;
SweptObstacleQuery::SweptObstacleQuery(SweptObstacleQuery&&) noexcept = default;
SweptObstacleQuery& SweptObstacleQuery::operator=(SweptObstacleQuery&&) noexcept = default;

void SweptObstacleQuery::set_options(ObstacleOptions options) {
  require_idle(state_->call);
  require_usable(options);
  state_->options = std::move(options);
}
const ObstacleOptions& SweptObstacleQuery::options() const {
  return state_->options;
}

SurfaceQueryStatus SweptObstacleQuery::run(const SurfaceTree& surface, const Obstacle& obstacle, const Vec3& motion,
                                           Workers& workers) {
  const StandardFloats standard;
  ObjectCall own(*state_, CallKind::begins);
  if (!own.status()) return {own.status()};
  if (!is_usable_obstacle(obstacle)) return {{.code = Status::Code::bad_shape}};
  if (const Status status = state_of(surface).askable(0); !status) return {status};
  if (!is_finite(motion) || !(max_norm(motion) < greatest_usable_scale)) return {{.code = Status::Code::bad_option}};
  state_->obstacle = &obstacle;
  state_->started_with = Parameters(state_->options);
  state_->motion = motion;
  state_->search.start(state_of(surface), workers);
  const SurfaceQueryStatus status = state_->go_on(workers);
  own.finish(status);
  return status;
}
SurfaceQueryStatus SweptObstacleQuery::resume(Workers& workers) {
  const StandardFloats standard;
  ObjectCall own(*state_, CallKind::goes_on);
  if (!own.status()) return {own.status()};
  if (!state_->search.is_started()) return {{.code = Status::Code::no_front}};
  if (!state_->search.is_current()) return {{.code = Status::Code::other_frame}};
  if (!(state_->started_with == Parameters(state_->options))) return {{.code = Status::Code::other_options}};
  const SurfaceQueryStatus status = state_->go_on(workers);
  own.finish(status);
  return status;
}

std::span<const ObstacleImpact> SweptObstacleQuery::impacts() const {
  return state_->search.found();
}
const std::vector<std::span<const std::uint32_t>>& SweptObstacleQuery::open() const {
  return state_->search.open();
}

double SweptObstacleQuery::collision_free_step() const {
  double step = 1;
  for (const ObstacleImpact& impact : impacts()) step = std::min(step, impact.time);
  return step;
}

}  // namespace morula
