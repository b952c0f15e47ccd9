// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <morula/robot/self_fit.hpp>
#include <numeric>
#include <stdexcept>
#include <string>

#include "fit/self_search.hpp"
#include "fit/sphere_group.hpp"

namespace morula::robot {

namespace {

constexpr std::array<std::size_t, 9> counts{1, 2, 3, 4, 6, 8, 12, 16, 32};  // of fits of whole links
constexpr std::size_t spheres_between = 8;  // spheres are left out each time when so many were added
constexpr double worth_of_sphere = 0.5;     // a sphere with less than this share of the next one's gain is left out
constexpr double bound_factor = 1.25;       // of the radius of a link's ball: no part reaches farther

/// The steps divide a number of spheres; these options take as many as they need.
void require_numbers_only(const FitOptions& fit) {
  const auto refuse = [](const char* option, bool is_set) {
    if (is_set)
      throw std::invalid_argument(std::string(option) +
                                  ": a fit for self-collision divides a number of spheres; use fit_spheres()");
  };
  refuse("max_protrusion", fit.max_protrusion.has_value());
  refuse("max_protrusion_share", fit.max_protrusion_share.has_value());
  refuse("max_radius", fit.max_radius.has_value());
  refuse("max_uncovered", fit.max_uncovered.has_value());
}

class Placer {
 public:
  Placer(const Robot& robot, const FitOptions& fit, const SelfFitOptions& options, Workers& workers)
      : robot_(robot), fit_(fit), o_(options), workers_(workers) {}

  SelfFit run() {
    require_numbers_only(fit_);
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
    options.link_spheres.clear();
    options.inner = 0;
    for (const auto& [name, spheres] : fixed_) options.fixed_spheres[name] = spheres;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      options.spheres = counts[i];
      const double at = static_cast<double>(i), step = 0.45 / static_cast<double>(counts.size());
      fits_.push_back(fitted(options, 0.15 + step * at, 0.15 + step * (at + 1)));
    }
  }

  void prepare() {
    const std::size_t links = fits_[0].links.size();
    std::vector<Sphere> bounds;
    for (std::size_t i = 0; i < links; ++i) {
      Sphere bound{fits_[0].links[i].spheres[0].center, 0};
      for (const RobotSpheres& fit : fits_)
        for (const Sphere& s : fit.links[i].spheres)
          bound.radius = std::max(bound.radius, distance(s.center, bound.center) + s.radius);
      bound.radius *= bound_factor;
      bounds.push_back(bound);
      volume_ += fits_[0].links[i].figures.solid.volume;
      makers_.push_back(std::make_unique<PieceMaker>(fits_[0].links[i], bound, fit_));
    }
    pieces_.resize(counts.size());
    for (std::size_t f = 0; f < counts.size(); ++f)
      for (std::size_t i = 0; i < links; ++i) pieces_[f].push_back(pieces_of(fits_[f].links[i], i));
    table_ = std::make_unique<OverlapTable>(pieces_[0], bounds);
    add_samples(bounds);
  }

  Pieces pieces_of(const LinkSpheres& link, std::size_t place) const {
    if (!stays_[place]) return makers_[place]->pieces_of(link);
    Pieces pieces;
    for (const Sphere& s : link.spheres)
      pieces.push_back(std::make_shared<Piece>(Piece{.sphere = s, .cover = s, .region = nullptr}));
    return pieces;
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

  void walk() {
    const std::size_t links = fits_[0].links.size();
    SelfSearch search{*table_, makers_, pieces_, stays_, o_.samples, volume_, fit_.stop};
    std::vector<std::size_t> all(links);
    std::iota(all.begin(), all.end(), std::size_t{0});
    std::vector<Candidate> candidates(links);
    std::vector<std::size_t> stale = all;
    keep();
    for (std::size_t next = count() + spheres_between;;) {
      workers_.run(stale.size(), [&](std::size_t i) {
        if (!fit_.stop.stop_requested()) candidates[stale[i]] = search.best_change(stale[i]);
      });
      stop_on_request();
      const Candidate best = *std::max_element(candidates.begin(), candidates.end(),
                                               [](const auto& a, const auto& b) { return a.score < b.score; });
      if (best.score <= 0 || count() + best.added > 2 * result_.total) break;
      table_->apply(best.change, workers_);
      stale = table_->neighbors(best.change.link);
      stale.push_back(best.change.link);
      if (best.added > 0 && count() >= next) {
        for (const std::size_t i : all) search.leave_out(i, worth_of_sphere * best.score, workers_);
        next = count() + spheres_between;
        stale = all;
      }
      keep();
      tell(0.6 + 0.15 * static_cast<double>(result_.steps.back().spheres) / static_cast<double>(result_.total),
           robot_.links[fits_[0].links[best.change.link].link].name);
    }
  }

  std::size_t count() const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < fits_[0].links.size(); ++i) count += table_->pieces(i).size();
    return count;
  }

  /// Records the state if no other with so few spheres has a lower rate, and its spheres if the total allows them.
  void keep() {
    const std::size_t count = this->count();
    const double share = static_cast<double>(table_->false_samples()) / static_cast<double>(o_.samples);
    std::vector<SelfFitStep>& steps = result_.steps;
    if (steps.empty() || count > steps.back().spheres) {
      steps.push_back({count, steps.empty() ? share : std::min(share, steps.back().false_share)});
    } else {
      steps.back().false_share = std::min(share, steps.back().false_share);
    }
    // mutant robot-self-total: `steps.back().spheres > result_.total` -> `false`
    if (!chosen_.empty() && (steps.back().spheres > result_.total || share > steps.back().false_share)) return;
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
  std::vector<RobotSpheres> fits_;                   // per entry of `counts`
  std::vector<std::vector<Pieces>> pieces_;          // those that each step considers, per link
  double volume_ = 0;                                // of all links in one sphere each
  std::vector<std::unique_ptr<PieceMaker>> makers_;  // per link
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
