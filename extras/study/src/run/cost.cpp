// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "run/cost.hpp"

#include <fmt/format.h>

#include <algorithm>
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
  for (MovedFrames& motion : move_frames(plan, 0, plan.motions, parameters, nullptr))
    for (std::vector<Vec3>& frame : motion.frames) poses.push_back(std::move(frame));
  return poses;
}

template <class Updated>
UpdateCost time_updates(const std::string& name, Updated&& body, const std::vector<std::vector<Vec3>>& poses,
                        int repeats) {
  UpdateCost cost{name, 0, 0};
  std::vector<double> times;
  for (const std::vector<Vec3>& positions : poses) {
    const auto vertices = static_cast<double>(positions.size());
    cost.points_per_vertex = static_cast<double>(body.update(positions).points_tested) / vertices;
    for (int i = 0; i < repeats; ++i) {
      Stopwatch watch;
      const UpdateStatus status = body.update(positions);
      times.push_back(1e9 * watch.lap() / vertices);
      if (!status) throw std::invalid_argument(message(status));
    }
  }
  cost.nanoseconds_per_vertex = times.empty() ? 0 : median(times);
  return cost;
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
  return {rule.name, times.empty() ? 0 : median(times), 0};
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
  for (const Json& c : json) list.push_back({c.at("name"), c.at("nanoseconds_per_vertex"), c.at("points_per_vertex")});
  return list;
}

Json list_json(const std::vector<UpdateCost>& list) {
  Json json = Json::array();
  for (const UpdateCost& c : list) {
    json.push_back({{"name", c.name},
                    {"nanoseconds_per_vertex", c.nanoseconds_per_vertex},
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
  Json settings{{"morula", version},
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
  const std::vector<std::vector<Vec3>> poses = timed_poses(plan);
  for (const Rule r : position_rules()) {
    const FollowRule rule(r);
    cost.rules.push_back(time_updates(rule.name, Body(body.mesh, model, rule.options), poses, plan.cost_repeats));
  }
  for (const FollowRule& rule : plan.rules)
    if (rule.own) cost.rules.push_back(time_own(*rule.own, body.mesh, model, poses, plan.cost_repeats));
  cost.boxes.push_back(time_updates("boxes", KDopTree(body.mesh, model, 6), poses, plan.cost_repeats));
  cost.boxes.push_back(time_updates("18-DOPs", KDopTree(body.mesh, model, 18), poses, plan.cost_repeats));
  const CoveredTree& first = result.model.front();  // the model for the mixes
  for (const FollowRule& mix : plan.mixes)
    cost.mixes.push_back(time_updates(mix.name, Body(body.mesh, first, mix.options), poses, plan.cost_repeats));
  store(cache, stem, settings, costs_json(cost));
  return cost;
}

Json costs_json(const Cost& cost) {
  return {{"rules", list_json(cost.rules)}, {"boxes", list_json(cost.boxes)}, {"mixes", list_json(cost.mixes)}};
}

}  // namespace morula::study
