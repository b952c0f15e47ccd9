// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Contacts of two bodies, against all facets with all others.
#pragma once

#include <morula/collide/contacts.hpp>
#include <optional>
#include <triangles.hpp>
#include <vector>

#include "record.hpp"
#include "shapes.hpp"

namespace morula::properties {

/// Two facets that meet, for certain.
struct Meeting {
  std::uint32_t facet_a, facet_b;
  std::optional<oracle::Point> at;  ///< a common point, where it was worked out
};

/// Two colliders where they are now. Their positions must be current.
class PairJudge {
 public:
  PairJudge(const Collider& a, const Collider& b, Dice& dice);

  const std::vector<Meeting>& meetings() const { return meetings_; }
  /// Every pair was decided, touching ones too, by whole numbers.
  bool exact() const { return exact_; }

  /// overlap(), crossings(), and the lower bound of distance().
  void judge_facets(Record& record) const;
  /// Is every meeting in a pair of nodes that own its facets, and within that pair's error bound? Is every pair of
  /// points that are nearer than the margin? bodies: which pair of the query this is.
  void judge_contacts(const Contacts& contacts, std::uint32_t bodies, double margin, Record& record,
                      const std::string& when) const;
  /// With CollideOptions::find_crossings, and all finished: the crossings are in the list.
  void judge_listed(const Contacts& contacts, std::uint32_t bodies, Record& record) const;

 private:
  struct NearPair {
    std::uint32_t facet_a, facet_b;
    oracle::Point middle;
    oracle::Real distance;
  };
  void judge_list(std::span<const Crossing> found, Record& record, const std::string& kind) const;
  void judge_surfaces(Record& record) const;

  const Collider &a_, &b_;
  std::vector<oracle::Triangle> facets_a_, facets_b_;
  std::vector<std::vector<bool>> owned_a_, owned_b_;  // by node and facet
  std::vector<Meeting> meetings_;
  std::vector<NearPair> near_;
  oracle::Real error_ = 0;  // by which the library's vertices, in the world, may be off ours
  bool exact_ = false;
};

/// A transform that brings some point of b onto one of a, turned or not; on_lattice: by quarters, and whole steps of
/// one.
RigidTransform touching_transform(const Collider& a, const Collider& b, Dice& dice, bool on_lattice = false);

}  // namespace morula::properties
