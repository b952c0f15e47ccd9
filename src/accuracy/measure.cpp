// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/accuracy/measure.hpp>
#include <morula/geometry/scale.hpp>
#include <stdexcept>

#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;

namespace {

/// Data that all levels share.
class LevelMeter {
 public:
  LevelMeter(const MeshView& mesh, const MeasureOptions& options, Workers& workers)
      : mesh_(mesh), options_(options), workers_(workers), looseness_(mesh) {
    if (options.with_protrusion && looseness_.has_volume()) object_.emplace(mesh, workers);
    if (options.with_sampled_fit) sampler_.emplace(mesh, SampleCounts{}, workers);
  }

  LevelMeasure measure(std::size_t level, std::span<const Sphere> spheres) const {
    LevelMeasure m;
    m.level = level;
    m.spheres = spheres.size();
    m.looseness = options_.open_by_winding ? looseness_.measure_open(mesh_.positions, spheres, options_.grid, workers_)
                                           : looseness_.measure(mesh_.positions, spheres, options_.grid, workers_);
    m.coverage = coverage(mesh_, spheres, workers_);
    if (object_) m.protrusion = protrusion(*object_, spheres, options_.protrusion_tolerance, workers_);
    if (sampler_) m.sampled = sampler_->measure(spheres, workers_);
    return m;
  }

 private:
  const MeshView& mesh_;
  const MeasureOptions& options_;
  Workers& workers_;
  LoosenessMeter looseness_;
  std::optional<SignedDistance> object_;
  std::optional<FitSampler> sampler_;
};

}  // namespace

std::vector<LevelMeasure> measure(const MeshView& mesh, const SphereTree& tree, const MeasureOptions& options,
                                  WorkersOrAll given) {
  Workers& workers = given;
  const StandardFloats standard;
  require_usable(mesh);
  require_usable_scale(mesh);
  if (const std::vector<std::string> faults = validate(tree); !faults.empty())
    throw std::invalid_argument("measure: the tree is broken: " + faults.front());

  const LevelMeter meter(mesh, options, workers);
  std::vector<LevelMeasure> measures;
  for (std::size_t level = 0; level < tree.level_count(); ++level)
    measures.push_back(meter.measure(level, level_set_spheres(tree, level)));
  return measures;
}

LevelMeasure measure_spheres(const MeshView& mesh, std::span<const Sphere> spheres, const MeasureOptions& options,
                             WorkersOrAll given) {
  Workers& workers = given;
  const StandardFloats standard;
  require_usable(mesh);
  require_usable_scale(mesh);
  return LevelMeter(mesh, options, workers).measure(0, spheres);
}

}  // namespace morula
