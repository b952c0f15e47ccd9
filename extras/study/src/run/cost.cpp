// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "run/cost.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <morula/study/cost.hpp>
#include <morula/update/body.hpp>
#include <morula/update/kdop_tree.hpp>
#include <morula/version.hpp>
#include <stdexcept>
#include <toolbox/numbers.hpp>
#include <toolbox/stopwatch.hpp>

#include "run/cell_store.hpp"
#include "run/poses.hpp"

namespace morula::study {

using namespace toolbox;

namespace {

/// The poses that are timed: a quarter, half and all of each motion.
std::vector<std::vector<Vec3>> timed_poses(const Plan& plan) {
  const std::vector<double> parameters{0.25, 0.5, 1.0};
  std::vector<std::vector<Vec3>> poses;
  for (MovedFrames& motion : move_frames(plan, 0, parameters, nullptr))
    for (std::vector<Vec3>& frame : motion.frames) poses.push_back(std::move(frame));
  return poses;
}

/// A tree that is updated, and its times.
struct Timed {
  UpdateCost cost{};
  std::function<UpdateStatus(const std::vector<Vec3>&)> update{};
  std::vector<double> nanoseconds{};
};

template <class Updated>
Timed timed(const std::string& name, Updated body) {
  auto kept = std::make_shared<Updated>(std::move(body));
  return {.cost = {.name = name}, .update = [kept](const std::vector<Vec3>& p) { return kept->update(p); }};
}

void time_once(Timed& tree, const std::vector<Vec3>& positions) {
  const auto vertices = static_cast<double>(positions.size());
  Stopwatch watch;
  const UpdateStatus status = tree.update(positions);
  tree.nanoseconds.push_back(1e9 * watch.lap() / vertices);
  if (!status) throw std::invalid_argument(message(status));
  tree.cost.points_per_vertex = static_cast<double>(status.points_tested) / vertices;
}

/// Every tree once in each round.
void time_in_turns(std::vector<Timed>& trees, const std::vector<std::vector<Vec3>>& poses, int rounds) {
  for (const std::vector<Vec3>& positions : poses) {
    for (Timed& tree : trees) time_once(tree, positions), tree.nanoseconds.pop_back();  // the first one warms caches
    for (int round = 0; round < rounds; ++round)
      for (Timed& tree : trees) time_once(tree, positions);
  }
  for (Timed& tree : trees) {
    std::vector<double>& times = tree.nanoseconds;
    if (times.empty()) continue;
    std::sort(times.begin(), times.end());
    tree.cost.nanoseconds_per_vertex = median(times);
    tree.cost.lower_quartile = times[times.size() / 4];
    tree.cost.upper_quartile = times[times.size() - 1 - times.size() / 4];
  }
}

/// The time of follow(); it also makes a tree in every frame.
UpdateCost time_own(const OwnRule& rule, const Mesh& mesh, const CoveredTree& model,
                    const std::vector<std::vector<Vec3>>& poses, int repeats) {
  const std::unique_ptr<OwnFollower> object = rule.make(mesh, model);
  std::vector<double> times;
  for (const std::vector<Vec3>& positions : poses) {
    object->follow(positions);
    for (int i = 0; i < repeats; ++i) {
      Stopwatch watch;
      object->follow(positions);
      times.push_back(1e9 * watch.lap() / static_cast<double>(positions.size()));
    }
  }
  if (times.empty()) return {.name = rule.name};
  std::sort(times.begin(), times.end());
  return {.name = rule.name,
          .nanoseconds_per_vertex = median(times),
          .lower_quartile = times[times.size() / 4],
          .upper_quartile = times[times.size() - 1 - times.size() / 4]};
}

/// Names and versions of one's own rules; no value if one has no version.
std::optional<Json> own_versions(const Plan& plan) {
  Json json = Json::array();
  for (const FollowRule& rule : plan.rules) {
    if (!rule.own) continue;
    if (rule.own->version.empty()) return std::nullopt;
    json.push_back({rule.own->name, rule.own->version});
  }
  return json;
}

std::vector<UpdateCost> list_from(const Json& json) {
  std::vector<UpdateCost> list;
  for (const Json& c : json)
    list.push_back({c.at("name"), c.at("nanoseconds_per_vertex"), c.at("lower_quartile"), c.at("upper_quartile"),
                    c.at("points_per_vertex")});
  return list;
}

Json list_json(const std::vector<UpdateCost>& list) {
  Json json = Json::array();
  for (const UpdateCost& c : list) {
    json.push_back({{"name", c.name},
                    {"nanoseconds_per_vertex", c.nanoseconds_per_vertex},
                    {"lower_quartile", c.lower_quartile},
                    {"upper_quartile", c.upper_quartile},
                    {"points_per_vertex", c.points_per_vertex}});
  }
  return json;
}

}  // namespace

const UpdateCost* Cost::find(std::string_view name) const {
  for (const std::vector<UpdateCost>* list : {&rules, &boxes, &mixes})
    for (const UpdateCost& cost : *list)
      if (cost.name == name) return &cost;
  return nullptr;
}

Cost measure_cost(const Plan& plan, const Result& result, const Cache* cache) {
  const std::optional<Json> own = own_versions(plan);
  if (!own) cache = nullptr;
  const NamedMesh& body = plan.bodies.front();
  const std::size_t chosen = shown_tree(plan);
  const CoveredTree& model = result.model[chosen];
  Cost cost{chosen, body.mesh.vertex_count(), {}, {}, {}};
  Json settings{{"format", cell_format},
                {"morula", version},
                {"mesh", hash_text(mesh_hash(body.mesh))},
                {"tree", hash_text(tree_hash(model.tree))},
                {"repeats", plan.cost_repeats},
                {"mixes", plan.mixes.size()}};
  if (own && !own->empty()) settings["own"] = *own;
  const std::string stem = fmt::format("{}-{}-cost", body.name, plan.sources[chosen].method);
  if (const std::optional<Json> stored = find(cache, stem, settings)) {
    try {
      cost.rules = list_from(stored->at("rules"));
      cost.boxes = list_from(stored->at("boxes"));
      cost.mixes = list_from(stored->at("mixes"));
      return cost;
    } catch (const Json::exception&) {  // foreign data: measured again
    }
  }
  std::vector<Timed> trees;
  for (const Rule r : position_rules()) {
    const FollowRule rule(r);
    trees.push_back(timed(rule.name, Body(body.mesh, model, rule.options)));
  }
  const std::size_t rules = trees.size();
  trees.push_back(timed("boxes", KDopTree(body.mesh, model, 6)));
  trees.push_back(timed("18-DOPs", KDopTree(body.mesh, model, 18)));
  const std::size_t boxes = trees.size();
  const CoveredTree& first = result.model.front();  // the model for the mixes
  for (const FollowRule& mix : plan.mixes) trees.push_back(timed(mix.name, Body(body.mesh, first, mix.options)));
  time_in_turns(trees, timed_poses(plan), plan.cost_repeats);
  for (std::size_t i = 0; i < trees.size(); ++i)
    (i < rules ? cost.rules : i < boxes ? cost.boxes : cost.mixes).push_back(trees[i].cost);
  for (const FollowRule& rule : plan.rules)
    if (rule.own) cost.rules.push_back(time_own(*rule.own, body.mesh, model, timed_poses(plan), plan.cost_repeats));
  store(cache, stem, settings, costs_json(cost));
  return cost;
}

Json costs_json(const Cost& cost) {
  return {{"rules", list_json(cost.rules)}, {"boxes", list_json(cost.boxes)}, {"mixes", list_json(cost.mixes)}};
}

}  // namespace morula::study
