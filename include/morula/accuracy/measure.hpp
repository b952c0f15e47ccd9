// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Measurements of a tree, level by level.
#pragma once

#include <morula/accuracy/coverage.hpp>
#include <morula/accuracy/looseness.hpp>
#include <morula/accuracy/protrusion.hpp>
#include <morula/accuracy/sampled_fit.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <optional>
#include <vector>

namespace morula {

struct LevelMeasure {
  std::size_t level = 0;
  std::size_t spheres = 0;  ///< of the level set, early leaves included
  Looseness looseness;
  Coverage coverage;
  std::optional<Protrusion> protrusion;  ///< not taken when switched off or on a mesh without inside
  std::optional<SampledFit> sampled{};   ///< when asked for
};

struct MeasureOptions {
  VoxelGrid grid{};
  bool with_protrusion = true;
  double protrusion_tolerance = 1e-2;  ///< share of each radius
  bool with_sampled_fit = false;       ///< cuRobo's figures as well
  bool open_by_winding = false;        ///< looseness of open meshes by LoosenessMeter::measure_open
};

/// One entry per level. tree: in mesh coordinates, at rest or of a frame whose positions the mesh has.
std::vector<LevelMeasure> measure(const MeshView& mesh, const SphereTree& tree, const MeasureOptions& options = {},
                                  WorkersOrAll workers = {});

/// The same of spheres that are in no tree, as one level, 0. At least one.
LevelMeasure measure_spheres(const MeshView& mesh, std::span<const Sphere> spheres, const MeasureOptions& options = {},
                             WorkersOrAll workers = {});

}  // namespace morula
