// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenario collide: a body against itself, turned by a right angle and moved aside: so far that there is about one
// contact per leaf, which is what is called moderate here, and deeper.
#include <algorithm>
#include <cmath>
#include <memory>
#include <morula/collide/contact_query.hpp>
#include <morula/collide/contacts.hpp>
#include <morula/geometry/reproducible.hpp>
#include <numbers>
#include <set>

#include "collide_sweep.hpp"
#include "resources.hpp"

namespace morula::bench {
namespace {

using Keys = std::set<std::pair<std::uint32_t, std::uint32_t>>;

Keys keys(const Contacts& contacts) {
  Keys nodes;
  for (const Contact& c : contacts.contacts) nodes.insert({c.node_a, c.node_b});
  return nodes;
}

/// Per call, in batches that a clock can measure: processor time of this thread.
template <class F>
std::vector<double> timed_calls(const Settings& settings, const F& f) {
  constexpr int calls = 50, batches = 20;
  std::vector<double> seconds;
  timed(settings, [&] {
    for (int batch = 0; batch < batches; ++batch) {
      const double start = thread_seconds();
      for (int i = 0; i < calls; ++i) f();
      seconds.push_back((thread_seconds() - start) / calls);
    }
  });
  return seconds;
}

Result result_of(std::string item, const Input& input) {
  return {.scenario = "collide", .item = std::move(item), .mesh = input.name};
}

// In double: leaves that overlap with all pairs above them. Those nearer to touching than `unsure` may go either way.
bool agrees_with_doubles(const Collider& a, const Collider& b, const Keys& found, double unsure) {
  const SphereTree& tree = a.tree();
  std::vector<Sphere> spheres_a, spheres_b;
  for (std::uint32_t i = 0; i < tree.node_count(); ++i) {
    spheres_a.push_back(a.sphere_state().sphere(i));
    spheres_b.push_back(b.sphere_state().sphere(i));
  }
  for (Sphere& s : spheres_a) s.center = a.transform()(s.center);
  for (Sphere& s : spheres_b) s.center = b.transform()(s.center);
  const auto reached = [&](std::uint32_t i, std::uint32_t j, double allowance) {
    for (;;) {
      const Sphere &s = spheres_a[i], &t = spheres_b[j];
      if (distance(s.center, t.center) > s.radius + t.radius + allowance) return false;
      if (i == 0 && j == 0) return true;
      const std::uint32_t level_i = tree.level_of(i), level_j = tree.level_of(j);
      if (level_i >= level_j) i = tree.parent[i];
      if (level_j >= level_i) j = tree.parent[j];
    }
  };
  const std::vector<std::uint32_t> leaves = level_set(tree, tree.level_count() - 1);
  std::size_t seen = 0;
  for (const std::uint32_t i : leaves)
    for (const std::uint32_t j : leaves) {
      const bool is_found = found.count({i, j}) > 0;
      seen += is_found;
      if (is_found ? !reached(i, j, unsure) : reached(i, j, 0)) return false;
    }
  return seen == found.size();
}

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

Result overrun(const Input& input, const Collider& a, const Collider& b, const Keys& all, double whole) {
  Result result = result_of("budget of time", input);
  // A third of what the whole query takes.
  const auto budget = std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 * whole / 3));
  std::vector<double> over;
  std::int64_t last_look = 0, first_look = 0;
  CollideOptions options{.budget = budget};
  // Processor time: when other programs get their turn is not the query's doing.
  options.clock = [&] {
    last_look = static_cast<std::int64_t>(1e9 * thread_seconds());
    if (first_look == 0) first_look = last_look;
    return std::chrono::nanoseconds(last_look);
  };
  ContactQuery query(options);
  query.add(a, b);
  require(query.run());  // its memory
  const Contacts& contacts = query.contacts();
  bool inside = true;
  std::size_t interrupted = 0;
  for (int i = 0; i < 5000; ++i) {
    first_look = 0;
    const double start = thread_seconds();
    require(query.run());
    result.seconds.push_back(thread_seconds() - start);
    over.push_back(1e-9 * static_cast<double>(last_look - first_look - budget.count()));
    interrupted += !contacts.finished;
    if (i % 500 == 0)
      for (const Contact& c : contacts.contacts)
        inside = inside && (!c.finished || all.count({c.node_a, c.node_b}) > 0);
  }
  result.expect(inside, "a finished contact that a whole query does not have");
  result.figures = {{"budget us", 1e-3 * static_cast<double>(budget.count())},
                    {"interrupted share", static_cast<double>(interrupted) / 5000.0},
                    {"last look late by us, 99.9 %", 1e6 * percentile(over, 0.999)},
                    {"last look late by us, 99 %", 1e6 * percentile(over, 0.99)},
                    {"last look late by us, median", 1e6 * percentile(over, 0.5)},
                    {"whole call us, 99.9 %", 1e6 * percentile(result.seconds, 0.999)}};
  return result;
}

// A query with surfaces that a budget of pair tests stops must not cost more than a whole one.
Result stopped(const Input& input, const Collider& a, const Collider& b, const Keys& all, const Settings& settings) {
  Result result = result_of("stopped with surfaces", input);
  ContactQuery query({.surfaces = true});
  query.add(a, b);
  const auto cost = [&] { return median(timed_calls(settings, [&] { require(query.run()); })); };
  const double whole = cost();
  const auto tests = static_cast<std::int64_t>(query.contacts().pair_tests);
  double largest = 0;
  for (const std::int64_t budget : {std::int64_t{1}, std::int64_t{65}, tests / 8, tests / 4, tests / 2, tests}) {
    query.set_options({.budget = budget, .surfaces = true});
    largest = std::max(largest, cost() / whole);
    const Contacts& found = query.contacts();
    bool sound = found.surfaces.size() == found.finished_count;
    for (const Contact& c : found.contacts) sound = sound && (!c.finished || all.contains({c.node_a, c.node_b}));
    result.expect(sound, "a finished contact that the whole query does not have, or without a surface");
  }
  result.seconds = {whole};
  result.figures = {{"whole us", 1e6 * whole}, {"largest cost over the whole query's", largest}};
  return result;
}

// The first call of a query, cold and warmed up, over later ones.
Result first_calls(const Input& input, const Collider& a, const Collider& b, const Keys& all) {
  Result result = result_of("first call", input);
  std::vector<double> cold, warm, later;
  for (int i = 0; i < 25; ++i)
    for (std::vector<double>* times : {&cold, &warm}) {
      ContactQuery query({.surfaces = true});
      query.add(a, b);
      if (times == &warm) require(query.warm_up());
      const double start = thread_seconds();
      require(query.start());
      const double first = thread_seconds();
      require(query.start());
      later.push_back(thread_seconds() - first);
      times->push_back(first - start);
      result.expect(keys(query.contacts()) == all, "other contacts");
    }
  result.seconds = warm;
  result.figures = {{"cold over later", median(cold) / median(later)},
                    {"warmed up over later", median(warm) / median(later)}};
  return result;
}

Result carried(std::string item, const Input& input, Body& body, Collider& a, const Collider& b, double shake,
               const Settings& settings) {
  Result result = result_of(std::move(item), input);
  ContactQuery query, fresh;
  query.add(a, b);
  fresh.add(a, b);
  const double size = bounding_box(input.mesh).diagonal();
  Random random(1);
  std::vector<Vec3> positions = input.mesh.positions;
  require(body.update(positions));
  require(query.start());
  std::size_t tests = 0, fresh_tests = 0;
  bool same = true;
  std::vector<double> fresh_seconds;
  timed(settings, [&] {
    for (int frame = 0; frame < 20; ++frame) {
      if (shake > 0)
        for (std::size_t i = 0; i < positions.size(); ++i)
          for (int axis = 0; axis < 3; ++axis)
            positions[i][axis] = input.mesh.positions[i][axis] + shake * size * random.uniform(-1, 1);
      require(body.update(positions));
      double start = thread_seconds();
      require(query.carry());
      result.seconds.push_back(thread_seconds() - start);
      start = thread_seconds();
      require(fresh.start());
      fresh_seconds.push_back(thread_seconds() - start);
      tests += query.contacts().pair_tests, fresh_tests += fresh.contacts().pair_tests;
      same = same && keys(query.contacts()) == keys(fresh.contacts());
    }
  });
  require(body.update(input.mesh.positions));
  result.expect(same, "other contacts than those of a fresh query");
  result.figures = {{"fresh tests per carried one", static_cast<double>(fresh_tests) / static_cast<double>(tests)},
                    {"fresh us", 1e6 * median(fresh_seconds)},
                    {"carried us", 1e6 * median(result.seconds)}};
  return result;
}

}  // namespace

std::vector<Result> run_collide(const Input& input, const Settings& settings) {
  std::vector<Result> results;
  const CoveredTree model = build(input.mesh, tree_options(settings), *settings.workers);
  Body body_a(input.mesh, model), body_b(input.mesh, model);
  Collider a(input.mesh, body_a), b(input.mesh, body_b);
  const Box box = bounding_box(input.mesh);
  RigidTransform transform = RigidTransform::from_axis({0, 0, 1}, 0.5 * std::numbers::pi);
  const Vec3 aligned = box.center() - transform(box.center());
  const auto shift = [&](double share) {
    transform.translation = aligned + share * Vec3{box.extent().x, 0, 0};
    b.set_transform(transform);
  };
  ContactQuery query;
  query.add(a, b);
  const Contacts& contacts = query.contacts();
  const double deep = 0.35;
  double moderate = deep;
  for (shift(moderate); moderate < 2; shift(moderate += 0.01)) {
    require(query.run());
    if (contacts.contacts.size() <= model.tree.leaf_count()) break;
  }

  const auto all_leaves = [&](std::string item) {
    Result leaves = result_of(std::move(item), input);
    leaves.seconds = timed_calls(settings, [&] { require(query.run()); });
    leaves.expect(agrees_with_doubles(a, b, keys(contacts), 1e-5 * box.diagonal()), "other pairs than in double");
    leaves.figures = {{"us", 1e6 * median(leaves.seconds)},
                      {"contacts", static_cast<double>(contacts.contacts.size())},
                      {"pair tests", static_cast<double>(contacts.pair_tests)},
                      {"leaves", static_cast<double>(model.tree.leaf_count())}};
    results.push_back(std::move(leaves));
  };
  shift(deep);
  all_leaves("all leaf contacts, deep");
  const double whole_deep = median(results.back().seconds);
  shift(moderate);
  all_leaves("all leaf contacts, moderate");
  const Keys all = keys(contacts);

  Result surfaces = result_of("all leaf contacts with surfaces", input);
  query.set_options({.surfaces = true});
  surfaces.seconds = timed_calls(settings, [&] { require(query.run()); });
  surfaces.expect(keys(contacts) == all && contacts.surfaces.size() == contacts.contacts.size(), "other contacts");
  surfaces.figures = {{"us", 1e6 * median(surfaces.seconds)}};
  results.push_back(std::move(surfaces));
  query.set_options({});

  results.push_back(stopped(input, a, b, all, settings));
  results.push_back(first_calls(input, a, b, all));

  Result first = result_of("first contact", input);
  bool found = false;
  first.seconds = timed_calls(settings, [&] { found = overlap(a, b); });
  first.expect(found == !all.empty(), "another answer than that of all contacts");
  first.figures = {{"us", 1e6 * median(first.seconds)}};
  results.push_back(std::move(first));

  results.push_back(carried("carried, at rest", input, body_a, a, b, 0, settings));
  results.push_back(carried("carried, trembling by 1e-5", input, body_a, a, b, 1e-5, settings));
  results.push_back(carried("carried, trembling by 1e-3", input, body_a, a, b, 1e-3, settings));
  shift(deep);
  require(query.run());
  results.push_back(overrun(input, a, b, keys(contacts), whole_deep));
  results.push_back(sweep_poses(settings.questions, settings));
  return results;
}

}  // namespace morula::bench
