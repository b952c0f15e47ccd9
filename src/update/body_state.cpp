// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/body_state.hpp"

#include <algorithm>
#include <morula/update/skin_morphs.hpp>

#include "update/rules/exact.hpp"

namespace morula {
using namespace detail;

UpdateStatus Body::State::counted(const UpdateStatus& status) noexcept {
  posed.current = static_cast<bool>(status);
  posed.frame += posed.current;
  if (posed.current) lazy.complete();
  return status;
}

void Body::State::show() noexcept {
  posed.tree = &model->tree;
  posed.spheres = spheres;
  posed.origin = origin;
  posed.complete = lazy.is_complete();
  if (models.vertices) {
    models.vertices->bind(*options);
    // mutant posed-at-rest: `posed.frame > 0` -> `true`
    posed.vertices = posed.frame > 0 ? &*models.vertices : nullptr;
  }
}

UpdateStatus Body::State::shown(const UpdateStatus& status, const PositionView* positions) noexcept {
  show();
  if (!status) return status;
  posed.positions.reset();
  if (positions != nullptr)
    posed.positions = *positions;
  else if (!models.moved_positions.empty())
    posed.positions = PositionView(models.moved_positions);
  return status;
}

// Such a body has one engine.
void Body::State::fit_leaves(Workers& workers) {
  static_cast<ExactRule&>(engines[0]).fit_leaves(depth_first_leaves(model->tree), local.points(), spheres, workers);
}

// Nodes that read no other sphere come first, then, level by level upwards, nodes that read their children. Radii are
// raised last: rules compute with unraised radii of children.
void Body::State::write_spheres(const RuleFrame& frame, Workers& workers) noexcept {
  for (const auto& engine : engines) engine->update(frame, spheres.size(), spheres, workers);
  write_levels(frame, workers);
  if (raising) raise(frame.rounding, workers);
  origin = frame.origin;
}

void Body::State::write_levels(const RuleFrame& frame, Workers& workers) noexcept {
  for (std::size_t level = model->tree.level_count(); level-- > 0;)
    for (const auto& engine : engines) engine->update_level(level, frame, spheres, workers);
}

void Body::State::raise(const Rounding& rounding, Workers& workers) noexcept {
  CornerWalk& walk = raising->walk;
  walk.measure(local.points(), spheres, workers);
  const SphereTree& tree = model->tree;
  // Children come behind their parents: children of a wrapped node have been raised before it.
  for (std::size_t k = walk.nodes().size(); k-- > 0;) {
    const std::uint32_t node = walk.nodes()[k];
    Spheref& sphere = spheres[node];
    // mutant raised-to-less: `rounding.covering_radius` -> `0.9f * rounding.covering_radius`
    float radius = std::max(sphere.radius, rounding.covering_radius(walk.squared_reach(k), sphere.center));
    // mutant raised-children-stick-out: `raising->wraps[node] != 0` -> `false`
    if (raising->wraps[node] != 0) {
      const auto children = std::span(spheres).subspan(tree.first_child[node], tree.child_count[node]);
      radius = std::max(radius, rounding.wrapping_radius(children, sphere.center));
    }
    sphere.radius = radius;
  }
}

// The status is ok if all levels follow positions alone.
static UpdateStatus wrong_kind_of_frame(RuleTraits::Follows followed) noexcept {
  switch (followed) {
    case RuleTraits::Follows::modes:
      return refused(Status::Code::needs_coordinates);
    case RuleTraits::Follows::bones:
      return refused(Status::Code::needs_transforms);
    case RuleTraits::Follows::positions:
      break;
  }
  return {};
}

// Good input gives a good status, here and below.
UpdateStatus Body::State::check_positions(const PositionView& positions) const noexcept {
  if (const UpdateStatus fault = wrong_kind_of_frame(models.follows); !fault) return fault;
  if (positions.size() != model->cover.vertex_count) return refused(Status::Code::wrong_vertex_count);
  return {};
}

UpdateStatus Body::State::check_coordinates(std::span<const double> coordinates) const noexcept {
  if (!models.modal) return refused(Status::Code::no_modes);
  if (models.follows == RuleTraits::Follows::bones) return wrong_kind_of_frame(models.follows);
  if (coordinates.size() != models.modal->mode_count()) return refused(Status::Code::wrong_coordinate_count);
  if (std::size_t bad = 0; !models.modal->accepts(coordinates, bad)) return refused(Status::Code::bad_coordinate, bad);
  return {};
}

UpdateStatus Body::State::check_transforms(std::span<const AffineTransform> transforms,
                                           std::optional<std::span<const double>> morphs,
                                           MorphedRest& morphed) const noexcept {
  if (!models.skin) return refused(Status::Code::no_skin);
  if (morphs && !morphs->empty() && !models.modal) return refused(Status::Code::no_modes);
  if (models.follows == RuleTraits::Follows::modes) return wrong_kind_of_frame(models.follows);
  if (transforms.size() != options->skin.bone_count) return refused(Status::Code::wrong_transform_count);
  std::size_t bad = 0;
  morphed = models.skin->unmorphed();
  if (morphs && models.modal) {
    if (morphs->size() != models.modal->mode_count()) return refused(Status::Code::wrong_coordinate_count);
    if (!models.modal->accepts(*morphs, bad)) return refused(Status::Code::bad_coordinate, bad);
    morphed = models.modal->morphed(*morphs);
  }
  if (!models.skin->accepts(transforms, morphed, bad)) return refused(Status::Code::bad_transform, bad);
  return {};
}

UpdateStatus Body::State::follow(const PositionView& positions, Workers& workers) noexcept {
  if (const UpdateStatus fault = check_positions(positions); !fault) return fault;
  const LocalPoints::Frame at = local.move(positions, workers);
  followed = at.finite;
  if (!at.finite) return refused(Status::Code::non_finite_position, at.first_bad_vertex);
  write_spheres({.origin = at.origin, .points = local.points(), .rounding = at.rounding}, workers);
  return work;
}

UpdateStatus Body::State::follow(const PositionView& positions, std::span<const VertexRange> changed,
                                 Workers& workers) noexcept {
  if (const UpdateStatus fault = check_positions(positions); !fault) return fault;
  for (const VertexRange& range : changed)
    if (range.begin > range.end || range.end > positions.size()) return refused(Status::Code::bad_range);
  const bool all_local = !raising && std::all_of(engines.begin(), engines.end(),
                                                 [](const auto& engine) { return engine->follows_changes(); });
  if (!all_local || !followed || !local.keeps_origin(positions)) return follow(positions, workers);

  const LocalPoints::Frame at = local.move_changed(positions, changed);
  followed = at.finite;
  if (!at.finite) return refused(Status::Code::non_finite_position, at.first_bad_vertex);
  const RuleFrame frame{.origin = at.origin, .points = local.points(), .rounding = at.rounding};
  UpdateStatus status = work;
  status.vertices_read = local.changed_vertices();
  status.cut_points_moved = local.changed_cut_points();
  status.points_tested = 0;
  for (const auto& engine : engines)
    status.points_tested += engine->update_changed(frame, local.changed_blocks(), spheres);
  write_levels(frame, workers);
  return status;
}

template <class MovePositions>
UpdateStatus Body::State::follow_model(RuleFrame frame, const MovePositions& move_positions,
                                       Workers& workers) noexcept {
  if (!models.moved_positions.empty()) {
    move_positions();
    const LocalPoints::Frame at = local.move(models.moved_positions, workers);
    followed = at.finite;
    if (!at.finite) return refused(Status::Code::non_finite_position, at.first_bad_vertex);
    frame.origin = at.origin;
    frame.points = local.points();
    frame.rounding = at.rounding;
  }
  write_spheres(frame, workers);
  return work;
}

UpdateStatus Body::State::follow(std::span<const double> coordinates, Workers& workers) noexcept {
  if (const UpdateStatus fault = check_coordinates(coordinates); !fault) return fault;
  const ModalPose pose = models.modal->pose(coordinates);
  const auto move = [&] {
    move_by_modes(options->modes, models.rest_positions, coordinates, models.moved_positions, workers);
  };
  if (models.vertices) models.vertices->begin({}, coordinates);
  return follow_model({.origin = pose.origin, .modes = &pose}, move, workers);
}

UpdateStatus Body::State::follow(std::span<const AffineTransform> transforms,
                                 std::optional<std::span<const double>> morphs, Workers& workers) noexcept {
  MorphedRest rest;
  if (const UpdateStatus fault = check_transforms(transforms, morphs, rest); !fault) return fault;
  const BonePose pose = models.skin->pose(options->skin, transforms, rest);
  const auto move = [&] {
    move_by_skin(options->skin, options->modes, models.rest_positions, transforms, rest.morphs, models.moved_positions,
                 workers);
  };
  if (models.vertices) models.vertices->begin(transforms, rest.morphs);
  return follow_model({.origin = pose.origin, .bones = &pose}, move, workers);
}

std::size_t Body::State::nodes_to_level(std::size_t level) const noexcept {
  const auto& begin = model->tree.level_begin;
  return begin[std::min(level, model->tree.level_count() - 1) + 1];
}

bool Body::State::is_lazy(RuleTraits::Follows wanted) const noexcept {
  return models.follows == wanted && !raising && engines.size() == 1 && engines[0].is_lazy();
}

UpdateStatus Body::State::follow_lazily(const PositionView& positions, std::size_t nodes, Workers& workers) noexcept {
  if (const UpdateStatus fault = check_positions(positions); !fault) return fault;
  const LocalPoints::Frame at = local.move(positions, workers);
  followed = false;  // a partial update cannot start from missing spheres
  if (!at.finite) return refused(Status::Code::non_finite_position, at.first_bad_vertex);
  engines[0].update({.origin = at.origin, .points = local.points(), .rounding = at.rounding}, nodes, spheres, workers);
  origin = at.origin;
  return work;
}

UpdateStatus Body::State::follow_lazily(std::span<const double> coordinates, std::size_t nodes) noexcept {
  if (const UpdateStatus fault = check_coordinates(coordinates); !fault) return fault;
  lazy.keep(coordinates);
  const ModalPose pose = models.modal->pose(lazy.coordinates());
  engines[0].update({.origin = pose.origin, .modes = &pose}, nodes, spheres, serial_workers());
  origin = pose.origin;
  if (models.vertices) models.vertices->begin({}, coordinates);
  return work;
}

UpdateStatus Body::State::counted_lazily(UpdateStatus status, std::size_t nodes) noexcept {
  status = counted(status);
  if (!status || nodes == spheres.size()) return status;
  lazy.begin(nodes);
  status.nodes_updated = nodes;
  status.points_tested = engines[0].tested_points(nodes);
  return status;
}

std::size_t Body::State::refresh_children(std::uint32_t node) noexcept {
  // The points are lost if an update was rejected since.
  if (lazy.is_complete() || !posed.current || model->tree.is_leaf(node)) return 0;
  std::size_t brought = 0;
  ModalPose pose;
  RuleFrame frame{.origin = origin, .points = local.points()};
  if (models.follows == RuleTraits::Follows::modes) {
    pose = models.modal->pose(lazy.coordinates());
    frame.modes = &pose;
  }
  const std::uint32_t first = model->tree.first_child[node];
  for (std::uint32_t child = first; child < first + model->tree.child_count[node]; ++child) {
    if (lazy.has(child)) continue;
    engines[0].update_one(child, frame, spheres);
    lazy.add(child);
    ++brought;
  }
  return brought;
}

}  // namespace morula
