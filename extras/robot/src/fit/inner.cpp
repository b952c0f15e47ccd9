// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "fit/inner.hpp"

#include <algorithm>
#include <memory>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/repair.hpp>
#include <morula/medial/medial_balls.hpp>
#include <numeric>

#include "fit/clip.hpp"
#include "fit/rounding.hpp"

namespace morula::robot {

namespace {

constexpr std::size_t candidates_of_a_shape = 3000, least_candidates = 40;

/// A closed surface with the query of its inside.
struct Solid {
  Mesh mesh;
  std::unique_ptr<SignedDistance> object;
  double area = 0;

  /// The length by which the ball could grow and stay inside; below 0: it may be outside.
  double room(const Sphere& s) const {
    const double depth = -(*object)(s.center);
    const bool wound = object->orientation() * object->bvh().winding_number(s.center) > 0.5;
    return wound ? depth - s.radius : -s.radius;
  }
};

Mesh submesh(const Mesh& mesh, const std::vector<std::uint32_t>& facets) {
  constexpr std::uint32_t unplaced = 0xffffffffu;
  std::vector<std::uint32_t> places(mesh.positions.size(), unplaced);
  Mesh part;
  for (const std::uint32_t facet : facets) {
    Facet corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& place = places[mesh.facets[facet][k]];
      if (place == unplaced) {
        place = static_cast<std::uint32_t>(part.positions.size());
        part.positions.push_back(mesh.positions[mesh.facets[facet][k]]);
      }
      corners[k] = place;
    }
    part.facets.push_back(corners);
  }
  return part;
}

/// The closed components of a shape: each by itself if all face outwards, together if some are cavities of others.
std::vector<Solid> solids_of(const Mesh& given) {
  const Mesh mesh = repair(given).mesh;
  const Components components = components_by_vertices(mesh);
  std::vector<std::vector<std::uint32_t>> facets(components.count);
  for (std::uint32_t f = 0; f < mesh.facet_count(); ++f) facets[components.of_facet[f]].push_back(f);
  std::vector<Solid> solids;
  bool cavities = false;
  for (const std::vector<std::uint32_t>& list : facets) {
    Solid solid{.mesh = submesh(mesh, list), .object = nullptr};
    const MeshReport report = inspect(solid.mesh);
    if (!report.has_volume() || report.volume == 0) continue;
    solid.area = report.area;
    cavities = cavities || report.volume < 0;
    solids.push_back(std::move(solid));
  }
  if (cavities && solids.size() > 1) {
    Solid together;
    for (const Solid& solid : solids) {
      append_mesh(together.mesh, solid.mesh);
      together.area += solid.area;
    }
    solids.clear();
    solids.push_back(std::move(together));
  }
  for (Solid& solid : solids) solid.object = std::make_unique<SignedDistance>(solid.mesh);
  return solids;
}

}  // namespace

std::vector<Sphere> inner_spheres(const std::filesystem::path& robot_file, std::span<const Shape> shapes,
                                  std::span<const ClipPlane> planes, std::size_t count, std::uint64_t seed,
                                  const StopToken& stop) {
  std::vector<Solid> solids;
  std::vector<Sphere> own, balls;
  for (const Shape& shape : shapes) {
    LinkSurface surface = surface_of(robot_file, std::span(&shape, 1), RoundShapes::inside);
    own.insert(own.end(), surface.spheres.begin(), surface.spheres.end());
    if (surface.mesh.facets.empty()) continue;
    std::vector<Solid> found = solids_of(surface.mesh);
    const double area = std::accumulate(found.begin(), found.end(), 0.0,
                                        [](double sum, const Solid& solid) { return sum + solid.area; });
    for (Solid& solid : found) {
      const auto part = static_cast<std::size_t>(candidates_of_a_shape * solid.area / area);
      const std::vector<Sphere> more = inner_ball_candidates(
          solid.mesh, *solid.object, {.candidates = std::max(least_candidates, part), .seed = seed}, serial_workers());
      balls.insert(balls.end(), more.begin(), more.end());
      solids.push_back(std::move(solid));
    }
  }
  balls.insert(balls.end(), own.begin(), own.end());
  for (Sphere& ball : balls) {
    // mutant robot-clip-inner: `reach_beyond` -> `0 * reach_beyond`
    for (const ClipPlane& plane : planes) ball.radius = std::min(ball.radius, ball.radius - reach_beyond(ball, plane));
  }
  std::erase_if(balls, [](const Sphere& ball) { return !(ball.radius > 0); });

  std::vector<Sphere> chosen = fullest_balls(balls, count, stop);
  round_inward(chosen);
  const double allowance = float_allowance(extent_of(chosen));
  const auto is_inside = [&](const Sphere& s) {
    const auto in_sphere = [&](const Sphere& o) {
      return distance(s.center, o.center) + s.radius + allowance <= o.radius;
    };
    const auto in_solid = [&](const Solid& solid) { return solid.room(s) >= allowance; };
    return !(reach_beyond(std::span(&s, 1), planes, allowance) > 0) &&
           (std::any_of(own.begin(), own.end(), in_sphere) || std::any_of(solids.begin(), solids.end(), in_solid));
  };
  std::erase_if(chosen, [&](const Sphere& s) { return !is_inside(s); });
  return chosen;
}

}  // namespace morula::robot
