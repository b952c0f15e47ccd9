// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/query/signed_distance.hpp>
#include <morula/robot/self_fit.hpp>
#include <stdexcept>

#include "fit/clip.hpp"
#include "fit/rounding.hpp"
#include "fit/self_table.hpp"
#include "fit/sphere_group.hpp"

namespace morula::robot {

namespace {

constexpr std::array<std::size_t, 9> counts{1, 2, 3, 4, 6, 8, 12, 16, 32};  // of fits of whole links
constexpr std::array<std::size_t, 4> parts{1, 2, 3, 4};  // that replace one sphere; 1: it moves inward
constexpr std::size_t divided_at_once = 4;               // parts of a link that each step considers
constexpr double bound_factor = 1.25;                    // of the radius of a link's ball: no part reaches farther
constexpr double weight_of_volume =
    0.4;  // of a false overlap in every sample per volume of all links in one sphere each

/// The sphere around points whose protrusion out of an object, bounded by radius + signed distance of the center, is
/// least, by a search from the given center.
Sphere least_protruding(const Mesh& region, const SignedDistance& object, Vec3 center) {
  double extent = 0;
  for (const Vec3& p : region.positions) extent = std::max(extent, max_norm(p));
  const auto radius_at = [&](const Vec3& c) {
    double squared = 0;
    for (const Vec3& p : region.positions) squared = std::max(squared, squared_distance(p, c));
    return rounded_up_radius(std::sqrt(squared), std::max(extent, max_norm(c)));
  };
  double r = radius_at(center), least = r + object(center), step = r;
  const double smallest = 0.01 * r;
  while (step > smallest) {
    bool moved = false;
    std::vector<Vec3> ways{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    const Vec3 from_surface = center - object.at(center).closest.point;
    if (const double away = length(from_surface); away > 0)
      ways.insert(ways.end(), {from_surface / away, -from_surface / away});
    for (const Vec3& way : ways) {
      const Vec3 next = center + step * way;
      const double larger = radius_at(next), out = larger + object(next);
      if (!(out < least - 1e-3 * step)) continue;
      center = next, r = larger, least = out, moved = true;
      break;
    }
    if (!moved) step /= 2;
  }
  return {center, r};
}

/// A change that may be the next step.
struct Candidate {
  Change change{};
  std::size_t added = 0;  // number of spheres
  double score = -1;
};

class Placer {
 public:
  Placer(const Robot& robot, const FitOptions& fit, const SelfFitOptions& options, Workers& workers)
      : robot_(robot), fit_(fit), o_(options), workers_(workers) {}

  SelfFit run() {
    if (o_.samples == 0) throw std::invalid_argument("a fit for self-collision needs at least 1 sampled configuration");
    const RobotSpheres evenly = fitted(fit_, 0, 0.15);
    result_.total = fit_.max_total.value_or(evenly.sphere_count());
    if (evenly.links.empty()) {
      result_.spheres = evenly;
      return std::move(result_);
    }
    choose_fixed(evenly);
    fit_counts();
    ignored_ = find_ignored(robot_, evenly, {.samples = 0, .given = o_.given, .stop = fit_.stop}, workers_).ignored;
    std::erase_if(ignored_, [](const IgnoredPair& p) { return p.reason == IgnoreReason::apart; });
    prepare();
    walk();
    finish(evenly);
    return std::move(result_);
  }

 private:
  void stop_on_request() const {
    if (fit_.stop.stop_requested()) throw BuildStopped();
  }
  void tell(double share, const std::string& link) const {
    stop_on_request();
    if (fit_.progress) fit_.progress(share, link);
  }

  /// fit_spheres() with a part of the progress.
  RobotSpheres fitted(FitOptions options, double begin, double end) const {
    if (fit_.progress) {
      options.progress = [=, this](double share, const std::string& link) {
        fit_.progress(begin + (end - begin) * share, link);
      };
    }
    return fit_spheres(robot_, options, workers_);
  }

  void choose_fixed(const RobotSpheres& evenly) {
    for (const LinkSpheres& link : evenly.links) {
      const std::string& name = robot_.links[link.link].name;
      const bool stays = fit_.fixed_spheres.count(name) != 0 || fit_.link_spheres.count(name) != 0 ||
                         (fit_.clip_margin && fit_.clip.count(name) != 0);
      stays_.push_back(stays);
      if (stays) fixed_[name] = link.spheres;
    }
  }

  void fit_counts() {
    FitOptions options = fit_;
    options.max_total.reset();
    options.max_protrusion.reset();
    options.max_protrusion_share.reset();
    options.link_spheres.clear();
    options.inner = 0;
    for (const auto& [name, spheres] : fixed_) options.fixed_spheres[name] = spheres;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      options.spheres = counts[i];
      const double at = static_cast<double>(i), step = 0.45 / static_cast<double>(counts.size());
      fits_.push_back(fitted(options, 0.15 + step * at, 0.15 + step * (at + 1)));
    }
  }

  Pieces pieces_of(const LinkSpheres& link, bool stays) const {
    Pieces pieces;
    for (const Sphere& s : link.spheres)
      pieces.push_back(std::make_shared<Piece>(Piece{.sphere = s, .region = nullptr}));
    if (stays || !link.tree) return pieces;
    // The leaves are the last spheres.
    const SphereTree& tree = link.tree->tree;
    const std::vector<std::uint32_t> leaves = level_set(tree, tree.level_count() - 1);
    const std::size_t own = pieces.size() - leaves.size();
    for (std::size_t i = 0; i < leaves.size(); ++i) {
      pieces[own + i]->region =
          std::make_shared<const Mesh>(region_mesh(link.surface.mesh, link.tree->cover, leaves[i]));
    }
    return pieces;
  }

  void prepare() {
    const std::size_t links = fits_[0].links.size();
    std::vector<Sphere> bounds;
    pieces_.resize(counts.size());
    for (std::size_t f = 0; f < counts.size(); ++f)
      for (std::size_t i = 0; i < links; ++i) pieces_[f].push_back(pieces_of(fits_[f].links[i], stays_[i]));
    for (std::size_t i = 0; i < links; ++i) {
      Sphere bound{fits_[0].links[i].spheres[0].center, 0};
      for (const RobotSpheres& fit : fits_)
        for (const Sphere& s : fit.links[i].spheres)
          bound.radius = std::max(bound.radius, distance(s.center, bound.center) + s.radius);
      bound.radius *= bound_factor;
      bounds.push_back(bound);
      volume_ += fits_[0].links[i].figures.solid.volume;
    }
    for (const LinkSpheres& link : fits_[0].links)
      objects_.push_back(link.tree ? std::make_unique<SignedDistance>(link.surface.mesh) : nullptr);
    table_ = std::make_unique<OverlapTable>(pieces_[0], bounds);
    add_samples(bounds);
  }

  /// Fills the table with the samples in which no shapes collide.
  void add_samples(const std::vector<Sphere>& bounds) {
    const RobotSpheres& finest = fits_.back();
    const LinkSolids solids(finest, workers_);
    std::vector<SphereGroup> groups;
    for (const LinkSpheres& link : finest.links) groups.push_back(group_of(link.spheres));
    const std::vector<PlacePair> pairs = tested_pairs(finest, ignored_);
    const auto poses = sampled_poses(robot_, finest, o_.samples, fit_.seed);
    std::vector<std::vector<std::size_t>> collisions(poses.size());  // per sample: places in pairs
    parallel_for(workers_, poses.size(), 16, [&](std::size_t begin, std::size_t end) {
      std::size_t tests = 0;
      for (std::size_t k = begin; k < end && !fit_.stop.stop_requested(); ++k) {
        for (std::size_t p = 0; p < pairs.size(); ++p) {
          const RigidTransform& at_a = poses[k][finest.links[pairs[p].first].link];
          const RigidTransform& at_b = poses[k][finest.links[pairs[p].second].link];
          if (groups_meet(groups[pairs[p].first], at_a, groups[pairs[p].second], at_b, tests) &&
              solids.collide(pairs[p].first, at_a, pairs[p].second, at_b))
            collisions[k].push_back(p);
        }
      }
    });
    stop_on_request();
    const std::vector<bool> counted = counted_pairs(collisions, pairs.size());
    std::vector<char> free(poses.size(), 1);
    for (std::size_t k = 0; k < poses.size(); ++k)
      for (const std::size_t p : collisions[k])
        if (counted[p]) free[k] = 0;
    for (std::size_t p = 0; p < pairs.size(); ++p) {
      if (!counted[p]) continue;
      const auto [a, b] = pairs[p];
      std::size_t number = 0;
      for (std::size_t k = 0; k < poses.size(); ++k) {
        if (free[k] == 0) continue;
        const RigidTransform to_b = relative_to(poses[k][finest.links[b].link], poses[k][finest.links[a].link]);
        const double reach = bounds[a].radius + bounds[b].radius;
        if (distance(to_b(bounds[a].center), bounds[b].center) <= reach) table_->add(a, b, number, to_b);
        ++number;
      }
    }
    table_->complete(static_cast<std::size_t>(std::count(free.begin(), free.end(), 1)), workers_);
  }

  /// The parts that replace one; empty: there are none.
  const Pieces& divided(Piece& piece, std::size_t link, std::size_t count) const {
    const auto [at, fresh] = piece.parts.try_emplace(count);
    if (!fresh || !piece.region || (count == 1 && piece.is_moved)) return at->second;
    const Sphere& bound = table_->bound(link);
    Pieces made;
    std::vector<std::shared_ptr<const Mesh>> regions;
    if (count == 1) {
      regions.push_back(piece.region);
    } else {
      const CoveredTree tree = build(*piece.region,
                                     {.method = Method::grid,
                                      .branching = static_cast<int>(count),
                                      .depth = 1,
                                      .seed = fit_.seed,
                                      .stop = fit_.stop},
                                     serial_workers());
      if (tree.tree.leaf_count() < 2) return at->second;
      for (const std::uint32_t leaf : level_set(tree.tree, tree.tree.level_count() - 1))
        regions.push_back(std::make_shared<const Mesh>(region_mesh(*piece.region, tree.cover, leaf)));
    }
    for (const auto& region : regions) {
      // The ball of the link decides how many decimals there are.
      std::vector<Sphere> rounded{
          least_protruding(*region, *objects_[link], enclosing_sphere(region->positions).center), bound};
      rounded[0].radius = std::max(rounded[0].radius + fit_.padding, fit_.min_radius);
      round_outward(rounded);
      const Sphere& s = rounded[0];
      if (distance(s.center, bound.center) + s.radius > bound.radius) return at->second;
      made.push_back(std::make_shared<Piece>(Piece{.sphere = s, .region = region, .is_moved = true}));
    }
    at->second = std::move(made);
    return at->second;
  }

  /// The best change of a link that does not make more samples false.
  Candidate best_change(std::size_t link) const {
    Candidate best;
    const Pieces& own = table_->pieces(link);
    const double present = volume_of(own);
    const auto consider = [&](Candidate candidate) {
      Pieces then = candidate.change.added;
      for (std::size_t i = 0; candidate.change.removed != none && i < own.size(); ++i)
        if (i != candidate.change.removed) then.push_back(own[i]);
      candidate.added = then.size() - own.size();
      const OverlapTable::Effect effect = table_->effect(candidate.change);
      if (effect.more_false > 0) return;
      const double gain =
          effect.gain / static_cast<double>(o_.samples) + weight_of_volume * (present - volume_of(then)) / volume_;
      candidate.score = candidate.added == 0 ? 1e6 * gain : gain / static_cast<double>(candidate.added);
      if (candidate.score > best.score && gain > 0) best = std::move(candidate);
    };
    if (stays_[link]) return best;
    for (std::size_t f = 0; f < counts.size(); ++f)
      if (pieces_[f][link].size() > own.size()) consider({.change = {link, none, pieces_[f][link]}});
    const std::vector<double> blame = table_->blame(link);
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < blame.size(); ++i)
      if (blame[i] > 0) order.push_back(i);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return blame[a] > blame[b]; });
    order.resize(std::min(order.size(), divided_at_once));
    for (const std::size_t i : order) {
      for (const std::size_t count : parts) {
        const Pieces& made = divided(*own[i], link, count);
        if (!made.empty()) consider({.change = {link, i, made}});
      }
    }
    return best;
  }
  static double volume_of(const Pieces& pieces) {
    std::vector<Sphere> spheres;
    for (const auto& piece : pieces) spheres.push_back(piece->sphere);
    return union_mass(spheres, 40).volume;
  }

  void walk() {
    const std::size_t links = fits_[0].links.size();
    std::vector<Candidate> candidates(links);
    std::vector<std::size_t> stale(links);
    for (std::size_t i = 0; i < links; ++i) stale[i] = i;
    std::size_t count = 0;
    for (std::size_t i = 0; i < links; ++i) count += table_->pieces(i).size();
    keep(count);
    for (;;) {
      workers_.run(stale.size(), [&](std::size_t i) {
        if (!fit_.stop.stop_requested()) candidates[stale[i]] = best_change(stale[i]);
      });
      const auto best = std::max_element(candidates.begin(), candidates.end(),
                                         [](const Candidate& a, const Candidate& b) { return a.score < b.score; });
      if (best == candidates.end() || best->score <= 0) break;
      count += best->added;
      if (count > 2 * result_.total) break;
      const std::size_t link = best->change.link;
      table_->apply(best->change, workers_);
      keep(count);
      stale = table_->neighbors(link);
      stale.push_back(link);
      const double limit = static_cast<double>(2 * result_.total);
      tell(0.6 + 0.3 * static_cast<double>(count) / limit, robot_.links[fits_[0].links[link].link].name);
    }
    stop_on_request();
  }

  /// Records a step, and the spheres if the total allows them.
  void keep(std::size_t count) {
    result_.steps.push_back({count, static_cast<double>(table_->false_samples()) / static_cast<double>(o_.samples)});
    if (count > result_.total && !chosen_.empty()) return;
    chosen_.clear();
    for (std::size_t i = 0; i < fits_[0].links.size(); ++i) chosen_.push_back(table_->pieces(i));
  }

  void finish(const RobotSpheres& evenly) {
    FitOptions options = fit_;
    for (std::size_t i = 0; i < chosen_.size(); ++i) {
      std::vector<Sphere>& spheres = options.fixed_spheres[robot_.links[fits_[0].links[i].link].name];
      spheres.clear();
      for (const auto& piece : chosen_[i]) spheres.push_back(piece->sphere);
    }
    result_.spheres = fitted(options, 0.9, 0.98);
    const SelfRateOptions rate{.samples = o_.samples, .seed = fit_.seed, .stop = fit_.stop, .progress = {}};
    result_.evenly = self_collision_rates(robot_, evenly, ignored_, rate, workers_);
    result_.rates = self_collision_rates(robot_, result_.spheres, ignored_, rate, workers_);
    if (!result_.spheres.links.empty()) tell(1, robot_.links[result_.spheres.links.back().link].name);
  }

  const Robot& robot_;
  const FitOptions& fit_;
  const SelfFitOptions& o_;
  Workers& workers_;
  SelfFit result_;
  std::vector<IgnoredPair> ignored_;
  std::vector<bool> stays_;  // per link
  std::map<std::string, std::vector<Sphere>> fixed_;
  std::vector<RobotSpheres> fits_;                        // per entry of `counts`
  std::vector<std::vector<Pieces>> pieces_;               // those that each step considers, per link
  double volume_ = 0;                                     // of all links in one sphere each
  std::vector<std::unique_ptr<SignedDistance>> objects_;  // per link; nullptr: it has no mesh
  std::unique_ptr<OverlapTable> table_;
  std::vector<Pieces> chosen_;
};

}  // namespace

SelfFit fit_for_self_collision(const Robot& robot, const FitOptions& fit, const SelfFitOptions& options,
                               WorkersOrAll given) {
  Workers& workers = given;
  return Placer(robot, fit, options, workers).run();
}

}  // namespace morula::robot
