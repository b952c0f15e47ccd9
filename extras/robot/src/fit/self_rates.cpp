// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <morula/parallel/threads.hpp>
#include <morula/robot/self_fit.hpp>
#include <mutex>
#include <stdexcept>

#include "fit/self_samples.hpp"
#include "fit/sphere_group.hpp"

namespace morula::robot {

SelfRates self_collision_rates(const Robot& robot, const RobotSpheres& spheres, std::span<const IgnoredPair> ignored,
                               const SelfRateOptions& o, WorkersOrAll given) {
  Workers& workers = given;
  if (o.samples == 0) throw std::invalid_argument("rates need at least 1 sampled configuration");
  const std::vector<PlacePair> pairs = tested_pairs(spheres, ignored);
  const std::vector<std::vector<RigidTransform>> poses = sampled_poses(robot, spheres, o.samples, o.seed);
  const LinkSolids solids(spheres, workers);
  std::vector<SphereGroup> groups;
  for (const LinkSpheres& link : spheres.links) groups.push_back(group_of(link.spheres));

  // Per sample the pairs whose spheres overlap, and whether their shapes collide.
  std::vector<std::vector<std::pair<std::size_t, bool>>> met(o.samples);
  detail::Mutex one_call;
  std::size_t done = 0;
  parallel_for(workers, o.samples, 16, [&](std::size_t begin, std::size_t end) {
    if (o.stop.stop_requested()) return;
    std::size_t tests = 0;
    for (std::size_t k = begin; k < end; ++k) {
      for (std::size_t p = 0; p < pairs.size(); ++p) {
        const auto [a, b] = pairs[p];
        const RigidTransform &at_a = poses[k][spheres.links[a].link], &at_b = poses[k][spheres.links[b].link];
        if (!groups_meet(groups[a], at_a, groups[b], at_b, tests)) continue;
        met[k].emplace_back(p, solids.collide(a, at_a, b, at_b));
      }
    }
    const std::lock_guard lock(one_call);
    done += end - begin;
    if (o.progress) o.progress(static_cast<double>(done) / static_cast<double>(o.samples));
  });
  if (o.stop.stop_requested()) throw BuildStopped();

  SelfRates rates;
  rates.samples = o.samples;
  const double share = 1 / static_cast<double>(o.samples);
  std::vector<std::size_t> overlaps(pairs.size(), 0), collisions(pairs.size(), 0);
  std::vector<std::vector<std::size_t>> colliding(o.samples);
  for (std::size_t k = 0; k < o.samples; ++k) {
    for (const auto& [p, collide] : met[k]) {
      ++overlaps[p];
      collisions[p] += collide ? 1 : 0;
      if (collide) colliding[k].push_back(p);
    }
  }
  const std::vector<bool> counted = counted_pairs(colliding, pairs.size());
  std::size_t by_spheres = 0, by_surfaces = 0;
  for (const auto& sample : met) {
    by_spheres +=
        std::any_of(sample.begin(), sample.end(), [&](const auto& pair) { return counted[pair.first]; }) ? 1 : 0;
    by_surfaces +=
        std::any_of(sample.begin(), sample.end(), [&](const auto& pair) { return counted[pair.first] && pair.second; })
            ? 1
            : 0;
  }
  rates.spheres = share * static_cast<double>(by_spheres);
  rates.surfaces = share * static_cast<double>(by_surfaces);
  rates.false_share = share * static_cast<double>(by_spheres - by_surfaces);
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    if (overlaps[p] == 0) continue;
    rates.pairs.push_back({spheres.links[pairs[p].first].link, spheres.links[pairs[p].second].link,
                           share * static_cast<double>(overlaps[p]), share * static_cast<double>(collisions[p]),
                           share * static_cast<double>(overlaps[p] - collisions[p]), !counted[p]});
  }
  std::stable_sort(rates.pairs.begin(), rates.pairs.end(),
                   [](const SelfPairRate& a, const SelfPairRate& b) { return a.false_share > b.false_share; });
  return rates;
}

}  // namespace morula::robot
