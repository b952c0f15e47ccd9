// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The spheres of a link that a fit for self-collision may divide, move, or leave out.
#pragma once

#include <map>
#include <memory>
#include <morula/query/signed_distance.hpp>
#include <morula/robot/fit.hpp>
#include <tuple>
#include <vector>

namespace morula::robot {

/// A division of a part of the surface: into slabs along an axis of the link, or into cells of a grid.
struct Division {
  std::size_t count = 1;  // largest number of parts; 1: the part stays whole
  std::size_t axis = 3;   // 0 to 2; 3: a grid
  bool operator<(const Division& o) const { return std::tie(count, axis) < std::tie(o.count, o.axis); }
};

/// A sphere of a link, and the part of the link's surface that it covers.
struct Piece {
  Sphere sphere;                       // in the decimals of files
  Sphere cover{};                      // contains the region: without tolerance, padding and rounding
  std::shared_ptr<const Mesh> region;  // nullptr: the sphere stays as it is
  /// The parts that replace it and protrude least, by division. Filled on demand.
  std::map<Division, std::vector<std::shared_ptr<Piece>>> parts{};
  bool is_moved = false;  // it protrudes least already
};
using Pieces = std::vector<std::shared_ptr<Piece>>;

/// Makes the pieces of one link. One thread at a time may call divided(); the other functions are safe at any time.
class PieceMaker {
 public:
  /// link: a fit of the link; borrowed. bound: a ball that contains all pieces. Borrows the options.
  PieceMaker(const LinkSpheres& link, const Sphere& bound, const FitOptions& options);

  /// The spheres of a fit of this link as pieces.
  Pieces pieces_of(const LinkSpheres& fit) const;
  /// Pieces over the region of one, each with the center from which it protrudes least. Empty: there are none that are
  /// new.
  const Pieces& divided(Piece& piece, const Division& division) const;
  /// The same regions, with the centers moved from those of the smallest spheres against the unit vector `toward`, by
  /// `shift` times the radius of each: the spheres become flatter on that side. Empty if one leaves the bound.
  Pieces moved_away(const Pieces& parts, const Vec3& toward, double shift) const;
  /// The same centers, where each point of the surface goes to the sphere in which it lies deepest: apart from rounding
  /// no sphere becomes larger, and those that get no surface are left out. The given pieces if one leaves the bound.
  Pieces reassigned(const Pieces& pieces) const;
  /// The pieces without one, whose region goes to the others, which grow as required. Empty if it has no region, or no
  /// other one has.
  Pieces without(const Pieces& pieces, std::size_t left_out) const;

 private:
  std::shared_ptr<Piece> made(const Sphere& cover, std::shared_ptr<const Mesh> region) const;
  std::shared_ptr<Piece> made_around(const Vec3& center, std::shared_ptr<const Mesh> region) const;
  std::vector<std::shared_ptr<const Mesh>> parts_of(const std::shared_ptr<const Mesh>& region,
                                                    const Division& division) const;
  bool is_in_bound(const Sphere& s) const;

  const LinkSpheres& link_;
  const FitOptions& o_;
  Sphere bound_;
  std::unique_ptr<SignedDistance> object_;  // nullptr: the link has no mesh
};

}  // namespace morula::robot
