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
#include "collide/patches/patch_points.hpp"

namespace morula::detail {

/// A patch of the last run, by which the next run recognizes it: its centroid in the coordinates of both bodies, and
/// the axis of a's coordinates from which its sectors are counted.
struct KnownPatch {
  std::uint32_t id;
  std::array<Vec3, 2> centroid;
  double size;  // square root of its area
  int axis;
};

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

 private:
  Status measure(std::uint32_t patch, PatchResult& result);
  void recognize(const PatchBodies& bodies, std::span<const KnownPatch> earlier, PatchResult& result);
  void complete(const PatchBodies& bodies, std::uint32_t patch, const ContactPatchOptions& options,
                PatchResult& result);

  FacetCrossings crossings_;
  ContactLoops loops_;
  PatchRegions regions_;
  PatchIntegrator integrator_;
  ProjectedRegion projected_[2];
  PatchDepth depth_;
  PatchPoints points_;
  // For recognize().
  struct Candidate {
    double distance;
    std::uint32_t known, patch;
  };
  std::vector<Candidate> candidates_;
  std::vector<std::uint8_t> taken_;
};

}  // namespace morula::detail
