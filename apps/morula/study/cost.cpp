// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "study/cost.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <morula/update/body.hpp>
#include <morula/update/kdop_tree.hpp>
#include <morula/version.hpp>

#include "shared/figures.hpp"
#include "shared/progress.hpp"

namespace morula::cli {
namespace {

/// The poses that are timed: a quarter, half and all of each motion.
std::vector<std::vector<Vec3>> timed_poses(const StudyPlan& plan, const NamedMesh& body) {
  std::vector<std::string> skipped;
  const std::vector<double> parameters{0.25, 0.5, 1.0};
  std::vector<std::vector<Vec3>> poses;
  for (MovedFrames& motion : move_frames(body, plan.motions, parameters, skipped))
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
      body.update(positions);
      times.push_back(1e9 * watch.lap() / vertices);
    }
  }
  cost.nanoseconds_per_vertex = times.empty() ? 0 : median(times);
  return cost;
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

std::vector<UpdateCost> list_from(const Json& json) {
  std::vector<UpdateCost> list;
  for (const Json& c : json) list.push_back({c.at("name"), c.at("nanoseconds_per_vertex"), c.at("points_per_vertex")});
  return list;
}

}  // namespace

const UpdateCost* StudyCost::find(std::string_view name) const {
  for (const std::vector<UpdateCost>* list : {&rules, &boxes, &mixes})
    for (const UpdateCost& cost : *list)
      if (cost.name == name) return &cost;
  return nullptr;
}

StudyCost measure_cost(const StudyPlan& plan, const StudyResult& result, const StudyCache& cache) {
  const NamedMesh& body = plan.bodies.front();
  const std::size_t chosen = shown_tree(plan, result);
  const Built& built = result.shown[chosen];
  StudyCost cost{body.name, result.trees[chosen].method, body.mesh.vertex_count(), {}, {}, {}};
  std::vector<StudyRule> rules;
  for (const Rule rule : position_rules()) rules.push_back(study_rule(std::string(name(rule))));
  Json settings{{"morula", version},
                {"mesh", hash_text(mesh_hash(body.mesh))},
                {"tree", hash_text(tree_hash(built.tree))},
                {"repeats", plan.cost_repeats},
                {"mixes", plan.mixes.size()}};
  const std::string stem = fmt::format("{}-{}-cost", body.name, cost.method);
  if (const std::optional<Json> stored = cache.find(stem, settings)) {
    try {
      cost.rules = list_from(stored->at("rules"));
      cost.boxes = list_from(stored->at("boxes"));
      cost.mixes = list_from(stored->at("mixes"));
      return cost;
    } catch (const Json::exception&) {  // not ours: measured anew
    }
  }
  const std::vector<std::vector<Vec3>> poses = timed_poses(plan, body);
  for (const StudyRule& rule : rules)
    cost.rules.push_back(time_updates(rule.name, Body(body.mesh, built, rule.options), poses, plan.cost_repeats));
  cost.boxes.push_back(time_updates("boxes", KDopTree(body.mesh, built, 6), poses, plan.cost_repeats));
  cost.boxes.push_back(time_updates("18-DOPs", KDopTree(body.mesh, built, 18), poses, plan.cost_repeats));
  const Built& first = result.shown.front();  // what the mixes are run on
  for (const StudyRule& mix : plan.mixes)
    cost.mixes.push_back(time_updates(mix.name, Body(body.mesh, first, mix.options), poses, plan.cost_repeats));
  cache.store(stem, settings, cost_json(cost));
  return cost;
}

Json cost_json(const StudyCost& cost) {
  return {{"note", "times: these, and what is marked timed, differ from run to run"},
          {"body", cost.body},
          {"method", cost.method},
          {"vertices", cost.vertices},
          {"rules", list_json(cost.rules)},
          {"boxes", list_json(cost.boxes)},
          {"mixes", list_json(cost.mixes)}};
}

}  // namespace morula::cli
