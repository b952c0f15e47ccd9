// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/body_state.hpp"

#include <algorithm>

namespace morula {

UpdateStatus Body::State::counted(const UpdateStatus& status) noexcept {
  current = static_cast<bool>(status);
  frames += current;
  if (current) lazy = false;
  return status;
}

void Body::State::show() noexcept {
  posed.tree = &built->tree;
  posed.spheres = spheres;
  posed.origin = origin;
  posed.ownership = ownership;
  posed.frame = frames;
  posed.current = current;
  posed.complete = !lazy;
}

UpdateStatus Body::State::shown(const UpdateStatus& status, const PositionView* positions) noexcept {
  show();
  if (!status) return status;
  posed.positions.reset();
  if (positions != nullptr)
    posed.positions = *positions;
  else if (!moved_positions.empty())
    posed.positions = PositionView(moved_positions);
  return status;
}

// The exact rule reads points alone, those of the papers their children: all levels of the first, then level by level
// upwards. Modal levels have been written before. Radii are raised last: what the rules make of their children is the
// rules' own.
void Body::State::write_spheres(const LocalPoints::Frame& frame, Workers& workers) noexcept {
  if (exact) exact->update(local.points(), frame.rounding, spheres, workers);
  if (paper)
    for (std::size_t level = built->tree.level_count(); level-- > 0;)
      paper->update_level(level, local.points(), frame.rounding, spheres, workers);
  if (raised) raise(frame.rounding, workers);
  origin = frame.origin;
}

void Body::State::raise(const Rounding& rounding, Workers& workers) noexcept {
  raised->measure(local.points(), spheres, workers);
  for (std::size_t k = 0; k < raised->nodes().size(); ++k) {
    Spheref& sphere = spheres[raised->nodes()[k]];
    sphere.radius = std::max(sphere.radius, rounding.covering_radius(raised->squared_reach(k), sphere.center));
  }
}

UpdateStatus Body::State::follow(const PositionView& positions, Workers& workers) noexcept {
  if (modal) return {.code = UpdateStatus::Code::needs_coordinates};
  if (positions.size() != built->cover.vertex_count) return {.code = UpdateStatus::Code::wrong_vertex_count};
  const LocalPoints::Frame at = local.move(positions, workers);
  followed = at.finite;
  if (!at.finite) return {.code = UpdateStatus::Code::non_finite_position, .first_bad_vertex = at.first_bad_vertex};
  write_spheres(at, workers);
  return work;
}

UpdateStatus Body::State::follow(const PositionView& positions, std::span<const VertexRange> changed,
                                 Workers& workers) noexcept {
  if (modal) return {.code = UpdateStatus::Code::needs_coordinates};
  if (positions.size() != built->cover.vertex_count) return {.code = UpdateStatus::Code::wrong_vertex_count};
  for (const VertexRange& range : changed)
    if (range.begin > range.end || range.end > positions.size()) return {.code = UpdateStatus::Code::bad_range};
  const bool all_local = exact && !raised && (!paper || paper->only_wraps());
  if (!all_local || !followed || !local.keeps_origin(positions)) return follow(positions, workers);

  const LocalPoints::Frame at = local.move_changed(positions, changed);
  followed = at.finite;
  if (!at.finite) return {.code = UpdateStatus::Code::non_finite_position, .first_bad_vertex = at.first_bad_vertex};
  UpdateStatus status = work;
  status.vertices_read = local.changed_vertices();
  status.cut_points_moved = local.changed_cut_points();
  status.points_tested = exact->update_changed(local.points(), local.changed_blocks(), at.rounding, spheres);
  if (paper)
    for (std::size_t level = built->tree.level_count(); level-- > 0;)
      paper->update_level(level, local.points(), at.rounding, spheres, workers);
  return status;
}

// Good coordinates give a good status.
UpdateStatus Body::State::refused_coordinates(std::span<const double> coordinates) const noexcept {
  if (!motion) return {.code = UpdateStatus::Code::no_modes};
  if (coordinates.size() != motion->mode_count()) return {.code = UpdateStatus::Code::wrong_coordinate_count};
  if (std::size_t bad = 0; !motion->accepts(coordinates, bad))
    return {.code = UpdateStatus::Code::bad_coordinate, .first_bad_coordinate = bad};
  return {};
}

UpdateStatus Body::State::follow(std::span<const double> coordinates, Workers& workers) noexcept {
  if (const UpdateStatus refused = refused_coordinates(coordinates); !refused) return refused;
  const ModalPose pose = motion->pose(coordinates);
  if (moved_positions.empty()) {
    modal->update(pose, spheres, workers);
    origin = pose.origin;
    return work;
  }
  move_by_modes(options.modes, rest_positions, coordinates, moved_positions, workers);
  const LocalPoints::Frame at = local.move(moved_positions, workers);
  followed = at.finite;
  if (!at.finite) return {.code = UpdateStatus::Code::non_finite_position, .first_bad_vertex = at.first_bad_vertex};
  if (modal) modal->update(pose, spheres, workers);
  write_spheres(at, workers);
  return work;
}

std::size_t Body::State::nodes_to_level(std::size_t level) const noexcept {
  const auto& begin = built->tree.level_begin;
  return begin[std::min(level, built->tree.level_count() - 1) + 1];
}

UpdateStatus Body::State::follow_lazily(const PositionView& positions, std::size_t nodes, Workers& workers) noexcept {
  if (positions.size() != built->cover.vertex_count) return {.code = UpdateStatus::Code::wrong_vertex_count};
  const LocalPoints::Frame at = local.move(positions, workers);
  followed = false;  // a partial update cannot start from spheres that are not there
  if (!at.finite) return {.code = UpdateStatus::Code::non_finite_position, .first_bad_vertex = at.first_bad_vertex};
  exact->update_first(nodes, local.points(), at.rounding, spheres, workers);
  origin = at.origin;
  return work;
}

UpdateStatus Body::State::follow_lazily(std::span<const double> coordinates, std::size_t nodes) noexcept {
  if (const UpdateStatus refused = refused_coordinates(coordinates); !refused) return refused;
  std::copy(coordinates.begin(), coordinates.end(), coordinates_reached.begin());
  const ModalPose pose = motion->pose(coordinates_reached);
  for (std::uint32_t node = 0; node < nodes; ++node) spheres[node] = modal->sphere(node, pose);
  origin = pose.origin;
  return work;
}

UpdateStatus Body::State::counted_lazily(UpdateStatus status, std::size_t nodes) noexcept {
  status = counted(status);
  if (!status || nodes == reached.size()) return status;
  lazy = true;
  unreached = reached.size() - nodes;
  std::fill(reached.begin(), reached.end(), std::uint8_t{0});
  std::fill_n(reached.begin(), nodes, std::uint8_t{1});
  status.nodes_updated = nodes;
  status.points_tested = 0;
  if (exact)
    for (std::size_t k = 0; k < nodes; ++k) status.points_tested += exact->walk().points_of(k);
  return status;
}

std::size_t Body::State::reach(std::uint32_t node) noexcept {
  // The points are lost when an update was refused since.
  if (!lazy || !current || built->tree.is_leaf(node)) return 0;
  std::size_t brought = 0;
  const std::uint32_t first = built->tree.first_child[node];
  for (std::uint32_t child = first; child < first + built->tree.child_count[node]; ++child) {
    if (reached[child] != 0) continue;
    if (exact)
      exact->update_one(child, local.points(), spheres);
    else
      spheres[child] = modal->sphere(child, motion->pose(coordinates_reached));
    reached[child] = 1;
    ++brought;
  }
  unreached -= brought;
  lazy = unreached > 0;
  return brought;
}

}  // namespace morula
