// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pairs of facets by facet, and their connected groups.
#pragma once

#include <cstdint>
#include <morula/surface/feature_pairs.hpp>
#include <span>
#include <vector>

#include "surface/layers/layer_mesh.hpp"

namespace morula::detail {

/// The facets of one side that have partners, ascending, each with its partners, ascending.
class LayerPartners {
 public:
  struct Partner {
    std::uint32_t facet, partner, number;  // number: of the pair
    std::uint8_t end;                      // `facet` is a (0) or b (1) of the pair
  };
  struct Run {
    std::uint32_t facet, begin, end;
  };
  /// end: 0 or 1 for the facets a or b of all pairs; 2 for both, of one surface with itself.
  void start(std::span<const FeaturePair> pairs, int end, std::size_t facet_count);
  std::span<const Run> runs() const { return runs_; }
  std::span<const Partner> partners(const Run& run) const {
    return std::span(partners_).subspan(run.begin, run.end - run.begin);
  }
  /// The run of a facet; null without partners.
  const Run* find(std::uint32_t facet) const {
    const std::uint32_t k = run_of_[facet];
    return k < runs_.size() && runs_[k].facet == facet ? &runs_[k] : nullptr;
  }

 private:
  std::vector<Partner> partners_;
  std::vector<Run> runs_;
  std::vector<std::uint32_t> run_of_;  // valid if that run is of the facet
};

/// The connected groups of near pairs (LayerPatch). For one surface with itself each pair has the
/// two nodes (a, b) and (b, a); their groups are mirrored, or the same.
class LayerGroups {
 public:
  static constexpr std::uint32_t none = 0xffffffffu;
  struct Place {
    std::uint32_t patch = none;  ///< none: the pair is not near
    bool swapped = false;        ///< facet a of the pair is on side b of the patch
  };
  /// is_near: by pair. partners: of both sides, the same of one surface with itself.
  void find(std::span<const std::uint8_t> is_near, const LayerPartners& of_a, const LayerMesh& a,
            const LayerPartners& of_b, const LayerMesh& b);
  std::size_t patch_count() const { return patch_count_; }
  const Place& operator[](std::size_t pair) const { return places_[pair]; }

 private:
  std::uint32_t root(std::uint32_t node);
  void unite(std::uint32_t i, std::uint32_t j);
  void unite_partners(std::span<const std::uint8_t> is_near, const LayerPartners& of, const LayerMesh& partners,
                      bool is_with_itself);

  std::vector<std::uint32_t> parent_, patch_of_root_;
  std::vector<Place> places_;
  std::size_t patch_count_ = 0;
  std::vector<std::uint32_t> last_node_;
  std::vector<std::uint64_t> last_run_;  // by vertex: the run in which last_node_ was set
  std::uint64_t run_ = 0;
};

}  // namespace morula::detail
