// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/accuracy/measure.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sampling.hpp>
#include <morula/geometry/scale.hpp>

#include "accuracy/usable_spheres.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

constexpr std::size_t samples_per_chunk = 64;

// Samples are drawn round by round, so that workers can test a round; the kept samples do not depend on the number of
// workers.
std::vector<Vec3> interior_samples(const SignedDistance& object, const Box& box, const SampleCounts& counts,
                                   Workers& workers) {
  constexpr std::size_t most_rounds = 100;
  std::vector<Vec3> kept, drawn(counts.interior);
  std::vector<std::uint8_t> inside(counts.interior);
  Random random(counts.seed);
  for (std::size_t round = 0; round < most_rounds && kept.size() < counts.interior; ++round) {
    for (Vec3& p : drawn)
      for (int axis = 0; axis < 3; ++axis) p[axis] = random.uniform(box.lower[axis], box.upper[axis]);
    parallel_for(workers, drawn.size(), samples_per_chunk, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) inside[i] = object.is_inside(drawn[i]) ? 1 : 0;
    });
    for (std::size_t i = 0; i < drawn.size() && kept.size() < counts.interior; ++i)
      if (inside[i] != 0) kept.push_back(drawn[i]);
  }
  return kept;
}

double distance_to_spheres(const Vec3& p, std::span<const Sphere> spheres) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Sphere& s : spheres) nearest = std::min(nearest, distance(p, s.center) - s.radius);
  return nearest;
}

double mean_of(std::span<const double> values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

// The percentile, interpolated linearly between two values, as numpy and torch do. Values are sorted.
double p95_of(std::span<const double> values) {
  if (values.empty()) return 0;
  const double at = 0.95 * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (at - static_cast<double>(below)) * (values[above] - values[below]);
}

}  // namespace

FitSampler::FitSampler(const MeshView& mesh, const SampleCounts& counts, Workers& workers) : counts_(counts) {
  const StandardFloats standard;
  require_usable(mesh);
  require_usable_scale(mesh);
  for (const SurfacePoint& sample : sample_surface(mesh, counts.surface, counts.seed)) surface_.push_back(sample.point);
  const MeshReport report = inspect(mesh);
  volume_ = std::abs(report.volume);
  if (!report.has_volume() || !(volume_ > 0)) return;
  object_.emplace(mesh, workers);
  interior_ = interior_samples(*object_, report.box, counts, workers);
}

SampledFit FitSampler::measure(std::span<const Sphere> spheres, Workers& workers) const {
  const StandardFloats standard;
  require_some_usable(spheres, "sampled fit");
  SampledFit fit;

  std::vector<double> gaps(surface_.size());
  parallel_for(workers, surface_.size(), samples_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) gaps[i] = std::max(0.0, distance_to_spheres(surface_[i], spheres));
  });
  std::sort(gaps.begin(), gaps.end());
  fit.surface_gap_mean = mean_of(gaps);
  fit.surface_gap_p95 = p95_of(gaps);
  fit.surface_gap_max = gaps.empty() ? 0 : gaps.back();
  if (!object_) return fit;

  std::vector<std::uint8_t> covered(interior_.size());
  parallel_for(workers, interior_.size(), samples_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) covered[i] = distance_to_spheres(interior_[i], spheres) < 0 ? 1 : 0;
  });
  if (!interior_.empty())
    fit.coverage = static_cast<double>(std::count(covered.begin(), covered.end(), std::uint8_t{1})) /
                   static_cast<double>(interior_.size());

  const std::vector<Vec3> directions = fibonacci_directions(counts_.of_a_sphere);
  std::vector<double> distances(spheres.size() * directions.size());
  parallel_for(workers, spheres.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t k = 0; k < directions.size(); ++k)
        distances[i * directions.size() + k] = (*object_)(spheres[i].center + spheres[i].radius * directions[k]);
  });
  const std::size_t samples = distances.size();
  std::erase_if(distances, [](double d) { return !(d > 0); });
  std::sort(distances.begin(), distances.end());
  fit.protrusion = samples == 0 ? 0 : static_cast<double>(distances.size()) / static_cast<double>(samples);
  fit.protrusion_mean = mean_of(distances);
  fit.protrusion_p95 = p95_of(distances);
  fit.protrusion_max = distances.empty() ? 0 : distances.back();
  double volumes = 0;
  for (const Sphere& s : spheres) volumes += volume(s);
  fit.volume_ratio = volumes / volume_;
  return fit;
}

}  // namespace morula
