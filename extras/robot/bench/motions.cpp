// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Motions: certified edges of an arm, short ones and ones between random configurations, one call each, against the
// check of configurations along them. Verdicts are judged by configurations that are closer to each other.
#include <algorithm>
#include <cmath>
#include <morula/robot/configurations.hpp>

#include "planning.hpp"

namespace morula::bench {
namespace {

using robot::ConfigurationQuery;
using robot::ConfigurationVerdict;
using robot::MotionResult;
using robot::MotionVerdict;

constexpr double resolution = 0.01;     // radians between configurations of the peer
constexpr double close_samples = 1e-3;  // and of the judge

/// Ends of edges, one configuration after the other.
struct Edges {
  std::vector<double> from, to;
};

/// Free configurations in their order: each starts an edge to the next one, or to a place on the way to it, at most a
/// radian away.
Edges edges_between(const std::vector<double>& free, std::size_t coordinates, bool is_short) {
  Edges edges;
  for (std::size_t i = 0; i + 2 * coordinates <= free.size(); i += coordinates) {
    const std::span from = std::span(free).subspan(i, coordinates),
                    next = std::span(free).subspan(i + coordinates, coordinates);
    double longest = 0;
    for (std::size_t k = 0; k < coordinates; ++k) longest = std::max(longest, std::abs(next[k] - from[k]));
    const double share = is_short ? std::min(1.0, 1 / longest) : 1;
    for (std::size_t k = 0; k < coordinates; ++k) {
      edges.from.push_back(from[k]);
      edges.to.push_back(from[k] + share * (next[k] - from[k]));
    }
  }
  return edges;
}

/// Whether a configuration of the edge up to a time has a contact, by check() in steps.
bool touches_before(const ConfigurationQuery& query, const robot::World& world, std::span<const double> from,
                    std::span<const double> to, double time, double step) {
  double longest = 0;
  for (std::size_t k = 0; k < from.size(); ++k) longest = std::max(longest, std::abs(to[k] - from[k]));
  const auto steps = static_cast<std::size_t>(std::ceil(time * longest / step)) + 1;
  std::vector<double> values;
  for (std::size_t i = 0; i < steps; ++i) {
    const double at = time * static_cast<double>(i) / static_cast<double>(steps);
    for (std::size_t k = 0; k < from.size(); ++k) values.push_back(from[k] + at * (to[k] - from[k]));
  }
  std::vector<ConfigurationVerdict> verdicts(steps);
  query.check(values, world, verdicts, serial_workers());
  return std::any_of(verdicts.begin(), verdicts.end(), [](const auto& v) { return !v.is_free(); });
}

}  // namespace

Result run_motions(std::size_t configurations, const Settings& settings, bool is_short) {
  const ArmAmongObstacles given(std::max<std::size_t>(configurations / 10, 10), settings);
  const ConfigurationQuery query(given.robot, given.spheres, given.self);
  const std::size_t n = query.coordinates(), count = given.values.size() / n;
  std::vector<ConfigurationVerdict> at_ends(count);
  query.check(given.values, given.world, at_ends, serial_workers());
  std::vector<double> free;
  for (std::size_t i = 0; i < count; ++i) {
    const std::span values = std::span(given.values).subspan(i * n, n);
    if (at_ends[i].is_free()) free.insert(free.end(), values.begin(), values.end());
  }
  const Edges edges = edges_between(free, n, is_short);
  const std::size_t edge_count = edges.from.size() / n;
  std::vector<MotionVerdict> certified(edge_count), sampled(edge_count);
  std::vector<double> each(edge_count, std::numeric_limits<double>::infinity()), each_sampled = each;
  const auto of = [&](const std::vector<double>& ends, std::size_t i) { return std::span(ends).subspan(i * n, n); };
  Result result{
      .scenario = "motions", .item = is_short ? "edges of up to 1 rad" : "edges between random poses", .mesh = "arm"};
  // In turn, so that what disturbs one disturbs the others.
  for (int repeat = 0; repeat < settings.repeats; ++repeat) {
    double total = 0;
    for (std::size_t i = 0; i < edge_count; ++i) {
      const auto time = [&](std::vector<MotionVerdict>& verdicts, const robot::MotionOptions& options) {
        return seconds_of([&] {
          query.check_motions(of(edges.from, i), of(edges.to, i), given.world, {&verdicts[i], 1}, options,
                              serial_workers());
        });
      };
      const double own = time(certified, {}), peer = time(sampled, {.resolution = resolution});
      each[i] = std::min(each[i], own), each_sampled[i] = std::min(each_sampled[i], peer);
      total += own;
    }
    result.seconds.push_back(total);
  }
  std::size_t wrong = 0, kinds[3]{}, missed = 0;
  for (std::size_t i = 0; i < edge_count; ++i) {
    const MotionVerdict& verdict = certified[i];
    ++kinds[static_cast<std::size_t>(verdict.result)];
    const auto from = of(edges.from, i), to = of(edges.to, i);
    if (verdict.result == MotionResult::free) wrong += touches_before(query, given.world, from, to, 1, close_samples);
    if (verdict.result == MotionResult::touches) {
      std::vector<double> values;
      for (std::size_t k = 0; k < n; ++k)
        values.push_back(verdict.time == 1 ? to[k] : from[k] + verdict.time * (to[k] - from[k]));
      ConfigurationVerdict there;
      query.check(values, given.world, {&there, 1}, serial_workers());
      wrong += there.is_free();
      missed += sampled[i].result == MotionResult::free;
    }
  }
  const double all = static_cast<double>(edge_count);
  result.figures = {{"us an edge, median", 1e6 * median(each)},
                    {"0.01 rad / certified, median", median(each_sampled) / median(each)},
                    {"share that touches", static_cast<double>(kinds[1]) / all},
                    {"share that is undecided", static_cast<double>(kinds[2]) / all},
                    {"share that 0.01 rad misses", static_cast<double>(missed) / all}};
  result.expect(wrong == 0, "a verdict and configurations along its edge disagree");
  result.expect(kinds[0] > 0 && kinds[1] > 0, "edges are all of one kind");
  result.expect(200 * kinds[2] <= edge_count, "more than 0.5 % are undecided");
  return result;
}

}  // namespace morula::bench
