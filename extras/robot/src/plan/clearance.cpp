// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>

#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"
#include "plan/clearance_search.hpp"

namespace morula::robot {

void ConfigurationQuery::clearance(std::span<const double> configurations, const World& world,
                                   std::span<Clearance> clearances, std::span<double> gradients,
                                   const ClearanceOptions& options, WorkersOrAll workers) const {
  using detail::StandardFloats;
  const StandardFloats standard_here;
  const Model& model = *model_;
  model.require_configurations(configurations, clearances.size(), "clearance");
  if (!(options.limit > 0)) throw std::invalid_argument("ConfigurationQuery::clearance: the limit must be above 0");
  if (!gradients.empty() && gradients.size() != configurations.size())
    throw std::invalid_argument("ConfigurationQuery::clearance: gradients need one number per coordinate");
  const ClearancePlan plan(model, world.data(), options);
  constexpr std::size_t grain = 64;
  Workers& crew = workers;
  parallel_for(crew, clearances.size(), grain, [&](std::size_t begin, std::size_t end) {
    const StandardFloats standard;
    detail::check_interrupt();
    ClearanceSearch search(plan);
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t at = i * model.coordinates;
      clearances[i] = search(configurations.subspan(at, model.coordinates));
      if (!gradients.empty()) search.gradient(gradients.subspan(at, model.coordinates));
    }
  });
}

}  // namespace morula::robot
