// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A soft body of Bullet's falls on another one: with Bullet's own collisions, and with Morula's contacts and two
// responses, by penalty forces and by positions (PBD). All runs are watched by exact tests. docs/how-to/responses.md
// explains them.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <morula/morula.hpp>
#include <vector>

#include "response.hpp"
#include "soft_bodies.hpp"

constexpr int steps = 960;

struct Outcome {
  int first_contact = 0, most_contacts = 0;
  std::size_t most_crossings = 0, last_crossings = 0;
  double deepest = 0, last_deepest = 0, last_distance = 0;
  double imbalance = 0, energy_begin = 0, energy_most = 0, most_motion = 0, last_motion = 0, microseconds = 0;
  int compared = 0, differ = 0;
  std::size_t pairs_compared = 0;
};

Outcome run(Response response, const Model& below, const Model& above) {
  World world;
  Soft lower(world, below, response), upper(world, above, response);
  morula::ContactQuery query({.margin = skin, .surfaces = true, .find_crossings = true, .containment = true});
  query.add(upper.collider(), lower.collider());

  Outcome outcome;
  if (!query.start()) {
    ++outcome.differ;
    return outcome;
  }
  outcome.energy_begin = outcome.energy_most = upper.energy() + lower.energy();
  std::vector<double> times;
  for (int step = 1; step <= steps; ++step) {
    world.world.stepSimulation(btScalar(step_seconds), 0);
    const auto start = std::chrono::steady_clock::now();
    if (!upper.follow() || !lower.follow() || !query.carry()) {
      ++outcome.differ;
      break;
    }
    times.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());

    const morula::Contacts& found = query.contacts();
    int contacts = upper.soft().m_scontacts.size() + lower.soft().m_scontacts.size();
    if (response != Response::bullet)
      contacts = static_cast<int>(std::count_if(found.surfaces.begin(), found.surfaces.end(),
                                                [](const morula::ContactSurface& s) { return shortfall(s) > 0; }));
    if (contacts > 0 && outcome.first_contact == 0) outcome.first_contact = step;
    outcome.most_contacts = std::max(outcome.most_contacts, contacts);
    outcome.most_crossings = std::max(outcome.most_crossings, found.crossings.size());
    outcome.last_crossings = found.crossings.size();
    outcome.energy_most = std::max(outcome.energy_most, upper.energy() + lower.energy());
    outcome.last_motion = upper.kinetic_energy() + lower.kinetic_energy();
    outcome.most_motion = std::max(outcome.most_motion, outcome.last_motion);
    if (step % 10 == 0) {  // against all facets with all others
      ++outcome.compared;
      const std::vector<morula::Crossing> all = morula::brute_force::crossings(upper.collider(), lower.collider());
      outcome.differ += found.crossings != all;
      outcome.pairs_compared += all.size();
      const morula::MutualContainment& inside = found.containment[0];
      const bool apart = found.crossings.empty() && !inside.a_in_b.any() && !inside.b_in_a.any();
      outcome.last_deepest = apart ? 0 : std::max(lower.deepest(upper), upper.deepest(lower));
      outcome.deepest = std::max(outcome.deepest, outcome.last_deepest);
    }
    double imbalance = 0;
    if (response == Response::penalty) imbalance = push_apart(upper, lower, found);
    if (response == Response::positions) imbalance = move_apart(upper, lower, found);
    outcome.imbalance = std::max(outcome.imbalance, imbalance);
  }
  outcome.last_distance = morula::distance(upper.collider(), lower.collider()).lower;
  std::sort(times.begin(), times.end());
  outcome.microseconds = times.empty() ? 0 : times[times.size() / 2];
  return outcome;
}

int main() {
  const Model below("torus", 28, 0.38), above("blob", 20, 2.2);
  const Outcome bullet = run(Response::bullet, below, above), penalty = run(Response::penalty, below, above),
                positions = run(Response::positions, below, above);
  std::printf("%-50s %10s %10s %10s\n", "", "Bullet", "penalty", "positions");
  const auto row = [&](const char* what, auto figure) {
    std::printf("%-50s %10.4g %10.4g %10.4g\n", what, double(bullet.*figure), double(penalty.*figure),
                double(positions.*figure));
  };
  row("first contact, step", &Outcome::first_contact);
  row("most contacts in a step", &Outcome::most_contacts);
  row("pairs of facets that cross: most", &Outcome::most_crossings);
  row("  at the end", &Outcome::last_crossings);
  row("deepest vertex inside the other body: worst", &Outcome::deepest);
  row("  at the end", &Outcome::last_deepest);
  row("distance at the end", &Outcome::last_distance);
  row("energy of motion and height: at the beginning", &Outcome::energy_begin);
  row("  most", &Outcome::energy_most);
  row("energy of motion: most", &Outcome::most_motion);
  row("  at the end", &Outcome::last_motion);
  row("sum of pushes over that of their amounts: most", &Outcome::imbalance);
  row("update and query, median, us", &Outcome::microseconds);
  row("steps compared with brute force", &Outcome::compared);
  row("  crossing pairs of facets in them", &Outcome::pairs_compared);
  row("  steps that differ", &Outcome::differ);

  constexpr double thickness = 0.7;  // of the torus's tube
  int faults = 0;
  const auto check = [&](bool good, const char* what) {
    faults += !good, std::printf("%s: %s\n", good ? "ok" : "FAILED", what);
  };
  check(bullet.differ + penalty.differ + positions.differ == 0, "no crossing is missed, none is made up");
  check(penalty.pairs_compared > 0, "some facets crossed");
  check(penalty.imbalance < 1e-5, "forces on one body are those on the other, turned round");
  check(positions.imbalance < 1e-5, "and so are impulses, beyond what rounding positions to float explains");
  for (const Outcome* own : {&penalty, &positions}) {
    check(own->first_contact > 0 && own->most_contacts > 0, "the bodies touched");
    check(own->energy_most < 1.01 * own->energy_begin, "no energy out of nothing");
    check(own->last_motion < 0.05 * own->most_motion, "they come nearly to rest");
    check(own->deepest < 0.1 * thickness && own->last_crossings == 0, "never deep in each other, and apart in the end");
  }
  return faults == 0 ? 0 : 1;
}
