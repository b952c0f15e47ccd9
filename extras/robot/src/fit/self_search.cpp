// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "fit/self_search.hpp"

#include <algorithm>
#include <array>

namespace morula::robot {

namespace {

/// Divisions of one sphere; the first one moves it.
constexpr std::array<Division, 8> divisions{{{1}, {2, 0}, {2, 1}, {2, 2}, {3, 0}, {3, 1}, {3, 2}, {4}}};
constexpr std::array<double, 4> shifts{0.5, 1, 2, 4};  // of the centers of parts, in their radii
constexpr std::size_t divided_at_once = 4;             // parts of a link that each step considers
constexpr std::size_t left_out_at_once = 3;            // changes that leave out a sphere
constexpr double least_gain = 1e-4;                    // of a change that adds no sphere
/// Of a false overlap in every sample, per volume of all links in one sphere each.
constexpr double weight_of_volume = 0.4;

double volume_of(const Pieces& pieces) {
  std::vector<Sphere> spheres;
  for (const auto& piece : pieces) spheres.push_back(piece->sphere);
  return union_mass(spheres, 40).volume;
}

double sum_of_radii(const Pieces& pieces) {
  double sum = 0;
  for (const auto& piece : pieces) sum += piece->sphere.radius;
  return sum;
}

}  // namespace

OverlapTable::Effect SelfSearch::effect_of(const Change& change, double& present) const {
  const Pieces& own = table.pieces(change.link);
  if (present < 0) present = volume_of(own);
  Pieces then = change.added;
  for (std::size_t i = 0; change.removed != none && i < own.size(); ++i)
    if (i != change.removed) then.push_back(own[i]);
  OverlapTable::Effect effect = table.effect(change);
  effect.gain = effect.gain / static_cast<double>(samples) + weight_of_volume * (present - volume_of(then)) / volume;
  return effect;
}

Candidate SelfSearch::best_change(std::size_t link) const {
  Candidate best;
  if (stays[link]) return best;
  const Pieces& own = table.pieces(link);
  double present = -1;
  const auto consider = [&](Change change) {
    const std::size_t added = change.added.size() - (change.removed == none ? own.size() : 1);
    const auto [gain, more_false] = effect_of(change, present);
    const double score = added == 0 ? 1e6 * gain : gain / static_cast<double>(added);
    // Once no configuration is false, none becomes false.
    if (more_false > 0 && table.false_samples() == 0) return;
    if (score > best.score && gain > (added == 0 ? least_gain : 0)) best = {std::move(change), added, score};
  };
  for (const std::vector<Pieces>& fit : fits)
    if (fit[link].size() > own.size()) consider({link, none, fit[link]});
  for (const auto& [i, toward] : most_blamed(link)) {
    for (const Division& division : divisions) {
      const Pieces& made = makers[link]->divided(*own[i], division);
      if (!made.empty()) consider({link, i, made});
      // One part that protrudes least already has the region of the piece.
      const Pieces same{own[i]};
      const Pieces& parts = made.empty() && division.count == 1 ? same : made;
      for (const double shift : shifts) {
        Pieces away = makers[link]->moved_away(parts, toward, shift);
        if (!away.empty()) consider({link, i, std::move(away)});
      }
    }
  }
  return best;
}

/// The parts that may be divided and cause most, and the unit vectors to the spheres that they overlap.
std::vector<std::pair<std::size_t, Vec3>> SelfSearch::most_blamed(std::size_t link) const {
  const std::vector<OverlapTable::Blame> blame = table.blame(link);
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < blame.size(); ++i)
    if (blame[i].cost > 0 && table.pieces(link)[i]->region) order.push_back(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return blame[a].cost > blame[b].cost; });
  order.resize(std::min(order.size(), divided_at_once));
  std::vector<std::pair<std::size_t, Vec3>> result;
  for (const std::size_t i : order) {
    const double size = length(blame[i].toward);
    result.emplace_back(i, size > 0 ? blame[i].toward / size : Vec3{0, 0, 1});
  }
  return result;
}

void SelfSearch::leave_out(std::size_t link, double worth, Workers& workers) {
  if (stays[link] || table.pieces(link).size() < 2) return;
  double present = -1;
  const Change again{link, none, makers[link]->reassigned(table.pieces(link))};
  if (effect_of(again, present).gain > 0) table.apply(again, workers);
  while (!stop.stop_requested()) {
    const Change change = cheapest_without(link, worth, workers);
    if (change.added.empty()) break;
    table.apply(change, workers);
  }
}

/// No added parts: leaving out any sphere costs `worth` or more.
Change SelfSearch::cheapest_without(std::size_t link, double worth, Workers& workers) const {
  const Pieces& own = table.pieces(link);
  Change best{link};
  if (own.size() < 2) return best;
  std::vector<std::pair<double, Pieces>> fewer(own.size());  // by the growth of the other radii
  workers.run(own.size(), [&](std::size_t i) {
    Pieces rest = makers[link]->without(own, i);
    fewer[i] = {sum_of_radii(rest) + own[i]->sphere.radius, std::move(rest)};
  });
  std::erase_if(fewer, [](const auto& entry) { return entry.second.empty(); });
  std::stable_sort(fewer.begin(), fewer.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  fewer.resize(std::min(fewer.size(), left_out_at_once));
  double least = worth, present = -1;
  for (auto& [growth, rest] : fewer) {
    Change change{link, none, std::move(rest)};
    const auto [gain, more_false] = effect_of(change, present);
    if ((more_false <= 0 || table.false_samples() > 0) && -gain < least) least = -gain, best = std::move(change);
  }
  return best;
}

}  // namespace morula::robot
