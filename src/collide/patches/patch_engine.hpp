// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The computation of the patches of two bodies, and the results that one pair of bodies keeps from run to run.
#pragma once

#include <array>
#include <cstdint>
#include <morula/collide/contact_patches.hpp>
#include <span>
#include <vector>

#include "collide/facets/facet_crossings.hpp"
#include "collide/patches/patch_matching.hpp"
#include "collide/patches/patch_points.hpp"
#include "collide/patches/self_regions.hpp"

namespace morula::detail {

/// All that the patches of a pair of bodies refer to.
struct PatchResult {
  std::vector<ContactPatch> patches;
  std::vector<KnownPatch> known;  // by patch
  std::array<SideResult, 2> sides;
  std::vector<PatchPoint> points;
  std::vector<std::size_t> points_begin;
  double volume = 0;

  void clear() noexcept;
  /// Makes the spans of all patches, when the vectors are complete.
  void link();
};

/// Two bodies with closed surfaces.
struct PatchBodies {
  std::array<const Collider*, 2> body;
  std::array<const ClosedSurface*, 2> surface;
  bool is_one = false;  ///< true: both are the same body, whose patches with itself are computed
};

/// ok and whether all patches were computed, or a rejection.
struct PatchStatus : Status {
  bool finished = false;
};

/// Computes patches. One engine serves any pairs of bodies, one after the other, and keeps its memory.
class PatchEngine {
 public:
  /// Computes all patches of both bodies from their overlapping pairs of leaves. earlier: patches of the last run,
  /// which lend their ids; others get numbers from next_id. meter: ends the computation; null: no limit. It is read
  /// before the facets of two leaves, and between steps whose cost is linear in the crossings, or that of one patch.
  /// result: valid if the status is ok and finished.
  PatchStatus find(const PatchBodies& bodies, std::span<const NodePair> leaves, const ContactPatchOptions& options,
                   Meter* meter, std::span<const KnownPatch> earlier, std::uint32_t& next_id, PatchResult& result);

  /// Computes all patches of a body with itself. sides: the facets of both sides in the result of the last run.
  PatchStatus find_self(const Collider& body, SelfSurface& surface, const ContactPatchOptions& options,
                        const SelfRegions::Earlier& sides, std::span<const KnownPatch> earlier, std::uint32_t& next_id,
                        PatchResult& result);

 private:
  PatchStatus find_in_regions(const PatchBodies& bodies, const ContactPatchOptions& options, Meter* meter,
                              std::span<const KnownPatch> earlier, std::uint32_t& next_id, PatchResult& result);
  Status measure(const PatchBodies& bodies, std::uint32_t patch, PatchResult& result);
  void recognize(const PatchBodies& bodies, std::span<const KnownPatch> earlier, PatchResult& result);
  void complete(const PatchBodies& bodies, std::uint32_t patch, const ContactPatchOptions& options,
                PatchResult& result);

  FacetCrossings crossings_;
  ContactLoops loops_;
  SelfLoops self_loops_;
  SelfRegions regions_;
  PatchIntegrator integrator_;
  ProjectedRegion projected_[2];
  PatchDepth depth_;
  PatchPoints points_;
  PatchMatching matching_;
  std::vector<double> diagonals_;  // of the boxes of patches
};

}  // namespace morula::detail
