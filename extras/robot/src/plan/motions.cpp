// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Checks of edges.
#include <cmath>
#include <stdexcept>
#include <string>

#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"
#include "plan/motion_search.hpp"

namespace morula::robot {
namespace {

constexpr std::size_t grain = 8;    // edges of a chunk
constexpr double most_steps = 1e9;  // of an edge at a resolution

void require_options(const MotionOptions& options) {
  const auto require = [](bool condition, const char* text) {
    if (!condition) throw std::invalid_argument(std::string("ConfigurationQuery::check_motions: ") + text);
  };
  require(options.resolution >= 0 && std::isfinite(options.resolution), "the resolution must be finite, and 0 or more");
  require(options.tolerance > 0 && std::isfinite(options.tolerance), "the tolerance must be finite and above 0");
}

void require_steps(std::span<const double> from, std::span<const double> to, double resolution) {
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (std::abs(to[i] - from[i]) > most_steps * resolution)
      throw std::invalid_argument(
          "ConfigurationQuery::check_motions: an edge has more than a billion configurations at this resolution");
  }
}

}  // namespace

void ConfigurationQuery::check_motions(std::span<const double> from, std::span<const double> to, const World& world,
                                       std::span<MotionVerdict> verdicts, const MotionOptions& options,
                                       WorkersOrAll workers) const {
  require_options(options);
  const Model& model = *model_;
  model.require_configurations(from, verdicts.size(), "check_motions");
  model.require_configurations(to, verdicts.size(), "check_motions");
  const bool is_certified = options.resolution == 0;
  if (!is_certified) require_steps(from, to, options.resolution);
  const World::Data* obstacles = options.world ? &world.data() : nullptr;
  parallel_for(workers, verdicts.size(), grain, [&](std::size_t begin, std::size_t end) {
    const detail::StandardFloats standard;
    MotionSearch search(model, obstacles, options);
    const std::size_t n = model.coordinates;
    for (std::size_t i = begin; i < end; ++i) {
      detail::check_interrupt();
      const auto a = from.subspan(i * n, n), b = to.subspan(i * n, n);
      verdicts[i] = is_certified ? search.certified(a, b) : search.discrete(a, b);
    }
  });
}

}  // namespace morula::robot
