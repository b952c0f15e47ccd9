// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "fit/uncovered.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/accuracy/measure.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/query/signed_distance.hpp>
#include <stdexcept>
#include <utility>

#include "fit/partial_cover.hpp"
#include "fit/rounding.hpp"

namespace morula::robot {

namespace {

constexpr int first_rounds = 6, rounds_of_a_step = 2, worth_steps = 14, most_proofs = 8, most_corrections = 3;
constexpr double worth_precision = 1.04, worth_range = 1000, sampled_part = 0.985;

void require_sense(const FitOptions& o) {
  if (!(*o.max_uncovered > 0 && *o.max_uncovered <= 1))
    throw std::invalid_argument(fmt::format("max_uncovered: {} is no share above 0", *o.max_uncovered));
  if (!(o.tolerance > 0))
    throw std::invalid_argument(
        "max_uncovered: set the tolerance also, the distance within which spheres have to cover");
  if (o.max_protrusion || o.max_protrusion_share) {
    throw std::invalid_argument(
        "max_uncovered: spheres are placed for little outside volume, whatever they protrude; leave out "
        "max_protrusion");
  }
}

/// The outside volume of the links where it is known.
double known_outside(const RobotSpheres& spheres) {
  double sum = 0;
  for (const LinkSpheres& link : spheres.links) sum += link.figures.outside_volume.value_or(0);
  return sum;
}

/// The spheres of one link, and how much of its surface they leave.
struct UncoveredPart {
  std::size_t link = 0;  // of RobotSpheres::links
  double links = 1;      // links that share the spheres
  PartialCover cover;
  std::vector<Sphere> start, other_start, best{}, last{};  // last: as in files
  double uncovered_area = 0;                               // of the last ones, exact
};

class UncoveredFit {
 public:
  UncoveredFit(const Robot& robot, const FitOptions& options, Workers& workers)
      : robot_(robot), o_(options), workers_(workers) {}

  RobotSpheres run() {
    FitOptions whole = with_progress(0, 0.3);
    whole.tolerance = whole.padding = whole.min_radius = 0;
    whole.inner = 0;
    if (o_.max_radius) whole.max_radius = std::max(*o_.max_radius - o_.padding, 1e-3 * *o_.max_radius);
    covering_ = fit_spheres(robot_, whole, workers_);
    within_ = fit_spheres(robot_, with_progress(0.3, 0.6), workers_);
    make_parts();
    if (!parts_.empty()) place();
    return measured();
  }

 private:
  /// The options without the share, for a part of the progress.
  FitOptions with_progress(double begin, double end) const {
    FitOptions options = o_;
    options.max_uncovered.reset();
    if (o_.progress) {
      options.progress = [=, this](double share, const std::string& link) {
        o_.progress(begin + (end - begin) * share, link);
      };
    }
    return options;
  }

  const std::string& name_of(const LinkSpheres& link) const { return robot_.links[link.link].name; }
  /// Given spheres stay as they are; planes leave no inside; balls among the shapes are their own spheres.
  bool stays(const LinkSpheres& link) const {
    return o_.fixed_spheres.count(name_of(link)) != 0 || o_.clip.count(name_of(link)) != 0 ||
           !link.surface.spheres.empty();
  }

  void make_parts() {
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < covering_.links.size(); ++i)
      if (covering_.links[i].same_shape_as == none && !stays(covering_.links[i])) places.push_back(i);
    std::vector<std::optional<UncoveredPart>> parts(places.size());
    const double most_radius =
        o_.max_radius ? std::max(0.0, *o_.max_radius - o_.padding) : std::numeric_limits<double>::infinity();
    workers_.run(places.size(), [&](std::size_t k) {
      const LinkSpheres& link = covering_.links[places[k]];
      const SignedDistance object(link.surface.mesh);
      parts[k] = {places[k], 1,
                  PartialCover(link.surface.mesh, object, link.spheres, o_.tolerance, most_radius, o_.seed),
                  link.spheres, within_.links[places[k]].spheres};
    });
    for (std::optional<UncoveredPart>& part : parts) {
      for (const LinkSpheres& link : covering_.links)
        if (link.same_shape_as == covering_.links[part->link].link) ++part->links;
      area_ += part->links * part->cover.area();
      parts_.push_back(std::move(*part));
    }
    for (const LinkSpheres& link : within_.links) {
      if (!stays(link)) continue;
      const double area = inspect(link.surface.mesh).area;
      area_ += area;
      others_uncovered_ += area * link.figures.uncovered_share;
    }
  }

  /// Moves all spheres for a worth, and returns the share of the surface that they leave, and the outside volume.
  std::pair<double, double> improve(double worth, int rounds) {
    workers_.run(parts_.size(), [&](std::size_t k) { parts_[k].cover.improve(worth, rounds, o_.stop); });
    if (o_.stop.stop_requested()) throw BuildStopped();
    double uncovered = others_uncovered_, outside = 0;
    for (const UncoveredPart& part : parts_) {
      uncovered += part.links * part.cover.uncovered_area();
      outside += part.links * part.cover.outside_volume();
    }
    return {uncovered / area_, outside};
  }

  /// Starts a part from the spheres that cover, or from those of the tolerance: from those that are worth more when
  /// moved.
  void start(UncoveredPart& part) const {
    part.cover.improve(first_worth_, first_rounds, o_.stop);
    const std::vector<Sphere> one(part.cover.spheres().begin(), part.cover.spheres().end());
    const double cost = part.cover.cost(first_worth_);
    const std::size_t given = part.other_start.size();
    for (std::size_t k = 0; part.other_start.size() < one.size(); ++k)
      part.other_start.push_back(part.other_start[k % given]);
    part.cover.set_spheres(part.other_start);
    part.cover.improve(first_worth_, first_rounds, o_.stop);
    if (cost < part.cover.cost(first_worth_)) part.cover.set_spheres(one);
  }

  /// Searches the worth at which the spheres leave the share by the samples, and the best spheres that leave no more.
  void search(double share) {
    double low = 0, high = std::numeric_limits<double>::infinity(), least = high;
    for (UncoveredPart& part : parts_) part.best.clear();  // those of an earlier search may leave more
    for (int step = 0; step < worth_steps; ++step) {
      const auto [uncovered, outside] = improve(worth_, rounds_of_a_step);
      const bool enough = uncovered <= share;
      if (enough && outside < least) {
        least = outside;
        for (UncoveredPart& part : parts_) part.best.assign(part.cover.spheres().begin(), part.cover.spheres().end());
      }
      (enough ? high : low) = worth_;
      if (low > 0 && high < low * worth_precision) break;
      worth_ = low == 0 ? 0.5 * high : std::isinf(high) ? 2 * low : std::sqrt(low * high);
      if (worth_ < first_worth_ / worth_range || worth_ > first_worth_ * worth_range) break;
    }
    for (UncoveredPart& part : parts_) part.cover.set_spheres(part.best.empty() ? part.start : part.best);
  }

  std::vector<Sphere> as_in_files(std::span<const Sphere> spheres) const {
    std::vector<Sphere> result(spheres.begin(), spheres.end());
    for (Sphere& s : result) s.radius = std::max(s.radius + o_.padding, o_.min_radius);
    round_outward(result);
    return result;
  }

  /// Enlarges spheres until they are proven to cover within the tolerance; takes those that cover if that does not
  /// help.
  void prove(UncoveredPart& part) const {
    const Mesh& mesh = covering_.links[part.link].surface.mesh;
    double tolerance = o_.tolerance;
    for (int k = 0;; ++k) {
      part.last = as_in_files(k < most_proofs ? part.cover.spheres() : std::span<const Sphere>(part.start));
      std::vector<Sphere> certified = part.last, grown;
      const double allowance = float_allowance(extent_of(part.last));
      for (Sphere& s : certified) s.radius = std::max(0.0, s.radius - allowance);
      grown = certified;
      // mutant robot-uncovered-not-certified: `s.radius += o_.tolerance` -> `s.radius += 2 * o_.tolerance`
      for (Sphere& s : grown) s.radius += o_.tolerance;
      const Coverage within = coverage(mesh, grown, serial_workers());
      if (within.covered || k == most_proofs) {
        part.uncovered_area = coverage(mesh, certified, serial_workers()).uncovered_area * part.cover.area();
        return;
      }
      tolerance = std::max(0.0, tolerance - 1.2 * (within.uncovered_distance_upper + within.tolerance));
      part.cover.set_tolerance(tolerance);
    }
  }

  void place() {
    double outside = 0;
    for (const UncoveredPart& part : parts_) outside += part.links * part.cover.outside_volume();
    worth_ = first_worth_ = outside > 0 ? outside / area_ : 0.01 * std::sqrt(area_);
    workers_.run(parts_.size(), [&](std::size_t i) { start(parts_[i]); });
    double share = sampled_part * *o_.max_uncovered;
    for (int k = 0; k <= most_corrections; ++k) {
      search(share);
      workers_.run(parts_.size(), [&](std::size_t i) { prove(parts_[i]); });
      double uncovered = others_uncovered_;
      for (const UncoveredPart& part : parts_) uncovered += part.links * part.uncovered_area;
      if (uncovered <= *o_.max_uncovered * area_) return;
      share = std::max(0.0, share - 1.2 * (uncovered / area_ - *o_.max_uncovered));
    }
  }

  /// The spheres with all figures, which the fit finds for given ones. If the fit for the tolerance alone keeps the
  /// share and has less outside volume, it is the result.
  RobotSpheres measured() const {
    FitOptions given = with_progress(0.9, 1);
    for (std::size_t i = 0; i < covering_.links.size(); ++i) {
      const LinkSpheres& link = covering_.links[i];
      if (stays(link)) {
        given.skip.insert(name_of(link));
        continue;
      }
      for (const UncoveredPart& part : parts_) {
        const std::size_t first = covering_.links[part.link].link;
        if (link.link == first || link.same_shape_as == first) given.fixed_spheres[name_of(link)] = part.last;
      }
    }
    RobotSpheres result = within_;
    const RobotSpheres placed = fit_spheres(robot_, given, workers_);
    for (std::size_t i = 0; i < result.links.size(); ++i) {
      const LinkSpheres* const link = placed.of(result.links[i].link);
      if (link == nullptr) continue;
      result.links[i] = *link;
      result.links[i].same_shape_as = covering_.links[i].same_shape_as;
      result.links[i].tree = covering_.links[i].tree;
      std::vector<std::string>& notes = result.links[i].notes;
      notes.insert(notes.begin(), covering_.links[i].notes.begin(), covering_.links[i].notes.end());
    }
    if (within_.uncovered_share() <= *o_.max_uncovered && known_outside(within_) < known_outside(result))
      return within_;
    if (result.uncovered_share() > *o_.max_uncovered) {
      result.notes.push_back(fmt::format("{:.3g} % of the surface are in no sphere, more than {:.3g} %",
                                         100 * result.uncovered_share(), 100 * *o_.max_uncovered));
    }
    return result;
  }

  const Robot& robot_;
  const FitOptions& o_;
  Workers& workers_;
  RobotSpheres covering_, within_;  // fitted to cover, and for the tolerance alone
  std::vector<UncoveredPart> parts_;
  double area_ = 0, others_uncovered_ = 0, worth_ = 0, first_worth_ = 0;
};

}  // namespace

RobotSpheres fit_uncovered(const Robot& robot, const FitOptions& options, Workers& workers) {
  require_sense(options);
  return UncoveredFit(robot, options, workers).run();
}

}  // namespace morula::robot
