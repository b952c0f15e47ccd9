// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "fit/self_pieces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <morula/geometry/box.hpp>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/tree/cover.hpp>

#include "fit/clip.hpp"
#include "fit/rounding.hpp"

namespace morula::robot {

namespace {

/// The smallest sphere around a center that contains all points of a mesh, with a radius rounded up.
Sphere sphere_around(const Mesh& region, const Vec3& center) {
  double squared = 0, extent = max_norm(center);
  for (const Vec3& p : region.positions) {
    squared = std::max(squared, squared_distance(p, center));
    extent = std::max(extent, max_norm(p));
  }
  return {center, rounded_up_radius(std::sqrt(squared), extent)};
}

/// The sphere around a region whose protrusion out of an object, bounded by radius + signed distance of the center, is
/// least, by a search from the smallest one.
Sphere least_protruding(const Mesh& region, const SignedDistance& object) {
  Sphere best = sphere_around(region, enclosing_sphere(region.positions).center);
  double least = best.radius + object(best.center), step = best.radius;
  const double smallest = 0.01 * best.radius;
  while (step > smallest) {
    bool moved = false;
    std::vector<Vec3> ways{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    const Vec3 from_surface = best.center - object.at(best.center).closest.point;
    if (const double away = length(from_surface); away > 0)
      ways.insert(ways.end(), {from_surface / away, -from_surface / away});
    for (const Vec3& way : ways) {
      const Sphere next = sphere_around(region, best.center + step * way);
      const double out = next.radius + object(next.center);
      if (!(out < least - 1e-3 * step)) continue;
      best = next, least = out, moved = true;
      break;
    }
    if (!moved) step /= 2;
  }
  return best;
}

/// Per sphere of a list, the parts of a mesh that it gets if all are shared by power; nullptr: none.
std::vector<std::shared_ptr<Mesh>> shared_by_power(const Mesh& mesh, const std::vector<Sphere>& spheres) {
  const CoveredTree shared = cover(mesh, tree_from_spheres(spheres), {}, serial_workers());
  std::vector<std::shared_ptr<Mesh>> regions(spheres.size());
  for (const std::uint32_t leaf : level_set(shared.tree, shared.tree.level_count() - 1)) {
    // Leaves come in an order of their own, and those that do not contain their region have other spheres.
    const Sphere& s = shared.tree.spheres[leaf];
    std::size_t nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      const double d = squared_distance(s.center, spheres[i].center) + std::abs(s.radius - spheres[i].radius) * 1e-9;
      if (d < least) nearest = i, least = d;
    }
    if (!regions[nearest]) regions[nearest] = std::make_shared<Mesh>();
    append_mesh(*regions[nearest], region_mesh(mesh, shared.cover, leaf));
  }
  return regions;
}

/// Equal spheres in a row, whose cells are slabs.
std::vector<Sphere> slabs_of(const Mesh& region, const Division& division) {
  Box box;
  for (const Vec3& p : region.positions) box.add(p);
  const Vec3 size = box.upper - box.lower, middle = 0.5 * (box.lower + box.upper);
  const std::array<Vec3, 3> edges{Vec3{size.x, 0, 0}, Vec3{0, size.y, 0}, Vec3{0, 0, size.z}};
  std::vector<Sphere> row;
  for (std::size_t k = 0; k < division.count; ++k) {
    const double along = (static_cast<double>(k) + 0.5) / static_cast<double>(division.count) - 0.5;
    row.push_back({middle + along * edges[division.axis], box.diagonal()});
  }
  return row;
}

std::vector<Sphere> covers_of(const Pieces& pieces) {
  std::vector<Sphere> covers;
  for (const auto& piece : pieces) covers.push_back(piece->cover);
  return covers;
}

}  // namespace

PieceMaker::PieceMaker(const LinkSpheres& link, const Sphere& bound, const FitOptions& options)
    : link_(link), o_(options), bound_(bound) {
  if (!link.surface.mesh.facets.empty()) object_ = std::make_unique<SignedDistance>(link.surface.mesh);
}

bool PieceMaker::is_in_bound(const Sphere& s) const {
  return distance(s.center, bound_.center) + s.radius <= bound_.radius;
}

std::shared_ptr<Piece> PieceMaker::made(const Sphere& cover, std::shared_ptr<const Mesh> region) const {
  const Sphere less = region ? reduced(cover, o_.tolerance) : cover;
  // The ball of the link decides how many decimals there are.
  std::vector<Sphere> rounded{{less.center, std::max(less.radius + o_.padding, o_.min_radius)}, bound_};
  round_outward(rounded);
  return std::make_shared<Piece>(Piece{.sphere = rounded[0], .cover = cover, .region = std::move(region)});
}

std::shared_ptr<Piece> PieceMaker::made_around(const Vec3& center, std::shared_ptr<const Mesh> region) const {
  const Sphere around = sphere_around(*region, center);
  return made(around, std::move(region));
}

Pieces PieceMaker::pieces_of(const LinkSpheres& fit) const {
  Pieces pieces;
  for (const Sphere& s : fit.surface.spheres) pieces.push_back(made(s, nullptr));
  if (!fit.tree) return pieces;
  const SphereTree& tree = fit.tree->tree;
  for (const std::uint32_t leaf : level_set(tree, tree.level_count() - 1)) {
    pieces.push_back(
        made(tree.spheres[leaf], std::make_shared<const Mesh>(region_mesh(fit.surface.mesh, fit.tree->cover, leaf))));
  }
  return pieces;
}

std::vector<std::shared_ptr<const Mesh>> PieceMaker::parts_of(const std::shared_ptr<const Mesh>& region,
                                                              const Division& division) const {
  if (division.count == 1) return {region};
  std::vector<std::shared_ptr<const Mesh>> regions;
  if (division.axis < 3) {
    for (auto& part : shared_by_power(*region, slabs_of(*region, division)))
      if (part) regions.push_back(std::move(part));
    return regions.size() < 2 ? std::vector<std::shared_ptr<const Mesh>>{} : regions;
  }
  const CoveredTree tree = build(*region,
                                 {.method = Method::grid,
                                  .branching = static_cast<int>(division.count),
                                  .depth = 1,
                                  .seed = o_.seed,
                                  .stop = o_.stop},
                                 serial_workers());
  if (tree.tree.leaf_count() < 2) return regions;
  for (const std::uint32_t leaf : level_set(tree.tree, tree.tree.level_count() - 1))
    regions.push_back(std::make_shared<const Mesh>(region_mesh(*region, tree.cover, leaf)));
  return regions;
}

const Pieces& PieceMaker::divided(Piece& piece, const Division& division) const {
  const auto [at, fresh] = piece.parts.try_emplace(division);
  if (!fresh || !piece.region || (division.count == 1 && piece.is_moved)) return at->second;
  Pieces all;
  for (const auto& region : parts_of(piece.region, division)) {
    all.push_back(made(least_protruding(*region, *object_), region));
    all.back()->is_moved = true;
    if (!is_in_bound(all.back()->sphere)) return at->second;
  }
  at->second = std::move(all);
  return at->second;
}

Pieces PieceMaker::moved_away(const Pieces& parts, const Vec3& toward, double shift) const {
  Pieces moved;
  for (const auto& part : parts) {
    const Sphere least = enclosing_sphere(part->region->positions);
    moved.push_back(made_around(least.center - (shift * least.radius) * toward, part->region));
    if (!is_in_bound(moved.back()->sphere)) return {};
  }
  return moved;
}

Pieces PieceMaker::reassigned(const Pieces& pieces) const {
  Pieces kept, shared;
  for (const auto& piece : pieces) (piece->region ? shared : kept).push_back(piece);
  if (shared.size() < 2) return pieces;
  const auto regions = shared_by_power(link_.surface.mesh, covers_of(shared));
  for (std::size_t i = 0; i < shared.size(); ++i) {
    if (!regions[i]) continue;
    kept.push_back(made_around(shared[i]->cover.center, regions[i]));
    if (!is_in_bound(kept.back()->sphere)) return pieces;
  }
  return kept;
}

Pieces PieceMaker::without(const Pieces& pieces, std::size_t left_out) const {
  Pieces rest, shared;
  if (!pieces[left_out]->region) return {};
  for (std::size_t i = 0; i < pieces.size(); ++i)
    if (i != left_out) (pieces[i]->region ? shared : rest).push_back(pieces[i]);
  if (shared.empty()) return {};
  const auto regions = shared_by_power(*pieces[left_out]->region, covers_of(shared));
  for (std::size_t i = 0; i < shared.size(); ++i) {
    if (!regions[i]) {
      rest.push_back(shared[i]);
      continue;
    }
    auto both = std::make_shared<Mesh>(*shared[i]->region);
    // mutant robot-self-left-out: `*regions[i]` -> `Mesh{}`
    append_mesh(*both, *regions[i]);
    const Sphere around = sphere_around(*both, shared[i]->cover.center);
    rest.push_back(made({around.center, std::max(around.radius, shared[i]->cover.radius)}, both));
    if (!is_in_bound(rest.back()->sphere)) return {};
  }
  return rest;
}

}  // namespace morula::robot
