// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/reduce/reduce.hpp"

#include <algorithm>
#include <limits>
#include <morula/geometry/reproducible.hpp>

namespace morula::detail {
namespace {

// Enough to steer a search; cover never depends on samples.
constexpr std::size_t samples_by_area = 320;
constexpr std::size_t most_corner_samples = 128;

Vec3 unit_normal(const Triangle& t, double orientation) {
  const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
  const double size = length(n);
  return size > 0 ? n * (orientation / size) : Vec3{};
}

}  // namespace

RegionSamples region_samples(const MeshView& mesh, const Region& region, double orientation, std::uint64_t seed) {
  RegionSamples samples;
  const auto add = [&](const Vec3& point, const Vec3& normal) {
    samples.points.push_back(point);
    samples.normals.push_back(normal);
  };
  const std::size_t step = std::max<std::size_t>(1, region.corner_count() / most_corner_samples);
  std::vector<double> area_up_to(region.size());
  double total = 0;
  std::size_t corner = 0, next_sample = 0;
  for (std::size_t k = 0; k < region.size(); ++k) {
    total = area_with(total, mesh, region, k);
    area_up_to[k] = total;
    each_corner(mesh, region, k, [&](const Vec3& p) {
      if (corner++ != next_sample) return;
      add(p, unit_normal(mesh.corners(region.facet[k]), orientation));
      next_sample += step;
    });
  }
  if (!(total > 0)) return samples;
  Random random(seed);
  std::size_t k = 0;
  for (std::size_t i = 0; i < samples_by_area; ++i) {
    const double at = (static_cast<double>(i) + random.uniform()) / samples_by_area * total;
    while (k + 1 < region.size() && area_up_to[k] <= at) ++k;
    // A random convex combination: it is not uniform on a polygon, but patches are small compared with the region.
    const Triangle t = mesh.corners(region.facet[k]);
    Vec3 point{};
    double sum = 0;
    for (const Barycentric& b : region.polygon(k)) {
      const double weight = random.uniform() + 1e-9;
      point += at_barycentric(t, b) * weight;
      sum += weight;
    }
    add(point / sum, unit_normal(t, orientation));
  }
  return samples;
}

namespace {

class ReducerDivider {
 public:
  ReducerDivider(const FitInput& input, const BuildRun& run, Reducer reducer, const ReduceSettings& settings,
                 Demand demand)
      : input_(input),
        branching_(static_cast<std::size_t>(run.branching)),
        depth_(run.depth),
        reducer_(std::move(reducer)),
        settings_(settings),
        demand_(std::move(demand)) {}

  Division operator()(const BuildNode& node) const {
    const RegionSamples samples = region_samples(input_.mesh, node.region, input_.shape.orientation(), node.seed);
    const Proposals proposals =
        reducer_({samples.points, samples.normals, node.sphere, branching_, node.seed, input_.shape});
    if (proposals.empty()) return {};
    double mean_radius = 0, count = 0;
    for (const Proposal& proposal : proposals)
      for (const Sphere& s : proposal.spheres) mean_radius += s.radius, ++count;
    const RegionPoints points = region_points(input_, node, branching_, settings_.fit.spacing);
    NodeFit fit(input_, node, points, branching_, mean_radius / std::max(1.0, count), fit_settings(node.level),
                demand_);
    ChildFit& children = fit.children();

    std::vector<Start> starts = judged(children, proposals);
    NodeFit::Exact exact;
    std::string_view winner;
    // A loss at the root's children is a loss of all levels, and the root is one node among many: every start there
    // goes all the way.
    const std::size_t tries = settings_.all_on_root && node.level == 0 ? starts.size() : 1;
    for (std::size_t k = 0; k < tries; ++k) {
      settle(children, starts[k], node.level);
      NodeFit::Exact now = fit.exact();
      // One ball that is as good as many (the region of a ball, say) is still divided: parts that move apart have to be
      // parts.
      if (now.spheres.size() < 2) now = fit.divided_anyway(starts[k].proposal->spheres);
      if (k > 0 && !(now.cost < exact.cost)) continue;
      exact = std::move(now);
      winner = starts[k].proposal->reducer;
    }
    Division division = division_of(std::move(exact));
    division.reducer = winner;
    return division;
  }

 private:
  static constexpr float overlap_weight = 0.15F;
  static constexpr int sweeps_for_winner = 2, inscribed_sweeps = 4, sweeps_after = 4;

  // A proposal and its result after a sweep.
  struct Start {
    const Proposal* proposal;
    std::vector<Sphere> spheres;
    double cost;
  };
  static std::vector<Start> judged(ChildFit& children, const Proposals& proposals) {
    std::vector<Start> starts;
    for (const Proposal& proposal : proposals) {
      children.start_from(proposal.spheres, proposal.fill_places);
      children.sweep(overlap_weight, true);
      const double cost = children.objective();
      starts.push_back({&proposal, children.spheres(), cost});
    }
    std::stable_sort(starts.begin(), starts.end(), [](const Start& a, const Start& b) { return a.cost < b.cost; });
    return starts;
  }

  void settle(ChildFit& children, const Start& start, int level) const {
    children.start_from(start.spheres, start.proposal->fill_places);
    for (int i = 0; i < sweeps_for_winner; ++i) children.sweep(overlap_weight, true);
    children.try_inscribed(inscribed_sweeps, sweeps_after);
    children.try_changes(settings_.changes[static_cast<std::size_t>(std::min(level, 2))], settings_.move_every);
  }

  NodeFit::Settings fit_settings(int level) const {
    NodeFit::Settings settings = settings_.fit;
    if (level < 2 && level < depth_ - 1) settings.balance = settings_.balance[static_cast<std::size_t>(level)];
    return settings;
  }

  const FitInput& input_;
  std::size_t branching_;
  int depth_;
  Reducer reducer_;
  ReduceSettings settings_;
  Demand demand_;
};

}  // namespace

Divider divide_by(const FitInput& input, const BuildRun& run, Reducer reducer, const ReduceSettings& settings,
                  Demand demand) {
  return ReducerDivider(input, run, std::move(reducer), settings, std::move(demand));
}

}  // namespace morula::detail
