// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Delaunay tetrahedra of lattice points that are inserted one by one [bowyer1981, watson1981], every decision exact.
//
// Coordinates are integers up to 2²⁰, so an orientation is an exact sum of products below 2⁶³, and an in-sphere test
// one below 2¹⁰⁶. "In conflict" means strictly inside the circumsphere. With exact signs that alone is enough for any
// input, also for lattices and cospherical points: if a tetrahedron T is in conflict and its neighbor N is not, the new
// point is strictly on T's side of their facet. (On the facet's plane the two circumspheres have the same circle, and
// beyond it N's sphere contains every point that T's contains; either way N would be in conflict as well.) So no new
// tetrahedron is flat or inverted, and no point except a duplicate is ever rejected.
#pragma once

#include <array>
#include <cstdint>
#include <morula/geometry/vector.hpp>
#include <vector>

namespace morula::detail {

using LatticePoint = std::array<std::int32_t, 3>;

class Delaunay {
 public:
  static constexpr std::int32_t lattice_size = 1 << 20;
  static constexpr std::uint32_t no_point = 0xffffffffu;

  /// Outward facets of the hull have ghosts behind them: tetrahedra whose vertices[3] is no_point. So every facet has
  /// two sides, and the outside needs no case of its own.
  struct Tetrahedron {
    std::array<std::uint32_t, 4>
        vertices;  ///< positively oriented; in a ghost, with a point outside in the place of no_point
    std::array<std::uint32_t, 4> neighbors;  ///< slots; neighbors[k] is across from vertices[k]
  };

  /// Inserts a point. Returns false for a duplicate, and nothing changes. Coordinates in [0, lattice_size]. Until four
  /// points are not in one plane there are no tetrahedra, and the points wait. Cost: 4 to 13 µs a point.
  bool insert(const LatticePoint& p);

  const std::vector<LatticePoint>& points() const { return points_; }
  const std::vector<Tetrahedron>& slots() const { return tetrahedra_; }
  bool is_alive(std::uint32_t slot) const { return tetrahedra_[slot].vertices[0] != no_point; }
  bool is_ghost(std::uint32_t slot) const { return tetrahedra_[slot].vertices[3] == no_point; }
  /// Slots that the last successful insert freed, and slots that it filled: no slot is in both. Ghosts are included.
  const std::vector<std::uint32_t>& removed() const { return cavity_; }
  const std::vector<std::uint32_t>& created() const { return created_; }

  /// Center of a finite tetrahedron's circumsphere minus the point vertices[0], in lattice units: an exact fraction,
  /// rounded once a coordinate.
  Vec3 circumcenter_offset(std::uint32_t slot) const;

 private:
  struct Side {
    std::uint32_t tetrahedron;
    std::uint32_t facet;  // facet across from this corner
  };
  bool wait_for_space(const LatticePoint& p);
  void start(std::uint32_t apex);
  bool insert_in_space(std::uint32_t point);
  std::uint32_t walk_start(const LatticePoint& p) const;
  std::uint32_t locate(const LatticePoint& p) const;
  bool in_conflict(std::uint32_t slot, const LatticePoint& p) const;
  void find_cavity(std::uint32_t first, const LatticePoint& p);
  void fill_cavity(std::uint32_t point);
  Side around_edge(Side from, std::uint32_t& pivot) const;
  std::uint32_t take_slot();

  std::vector<LatticePoint> points_;
  std::vector<std::uint32_t> simplex_;  // the first points in general position, up to three; four: in space
  std::vector<Tetrahedron> tetrahedra_;
  std::vector<std::uint32_t> free_;
  std::vector<std::uint32_t> at_point_;  // a finite tetrahedron at each point
  std::vector<std::uint32_t> cavity_, created_;

  // Marks of one insertion, per slot.
  std::vector<std::uint32_t> mark_;  // stamp_: in conflict; stamp_ + 1: tested, and not in conflict
  std::vector<std::array<std::uint32_t, 4>> replacements_;  // tetrahedra built on the facets of each slot in the cavity
  std::vector<Side> border_;
  std::uint32_t stamp_ = 0;
};

}  // namespace morula::detail
