// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/accuracy/measure.hpp>
#include <morula/geometry/scale.hpp>
#include <stdexcept>

#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;

std::vector<LevelMeasure> measure(const MeshView& mesh, const SphereTree& tree, const MeasureOptions& options,
                                  Workers& workers) {
  const StandardFloats standard;
  require_usable(mesh);
  require_usable_scale(mesh);
  if (const std::vector<std::string> faults = validate(tree); !faults.empty())
    throw std::invalid_argument("measure: the tree is broken: " + faults.front());

  const LoosenessMeter meter(mesh);
  std::optional<SignedDistance> object;
  if (options.with_protrusion && meter.has_volume()) object.emplace(mesh, workers);

  std::vector<LevelMeasure> measures;
  for (std::size_t level = 0; level < tree.level_count(); ++level) {
    const std::vector<Sphere> spheres = level_set_spheres(tree, level);
    LevelMeasure& m = measures.emplace_back();
    m.level = level;
    m.spheres = spheres.size();
    m.looseness = meter.measure(mesh.positions, spheres, options.grid, workers);
    m.coverage = coverage(mesh, spheres, workers);
    if (object) m.protrusion = protrusion(*object, spheres, options.protrusion_tolerance, workers);
  }
  return measures;
}

}  // namespace morula
