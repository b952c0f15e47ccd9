// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "study/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <morula/io/tree_file.hpp>
#include <morula/version.hpp>
#include <mutex>

#include "shared/options.hpp"

namespace morula::cli {
namespace {

/// To be raised when the same settings give other figures than before.
constexpr int format = 1;

/// What is under way, for all threads.
class Counter {
 public:
  Counter(std::size_t total, const std::function<void(double, std::string)>& report) : total_(total), report_(report) {}
  void next(std::string label) {
    const std::lock_guard lock(mutex_);
    report_(static_cast<double>(done_) / static_cast<double>(std::max<std::size_t>(total_, 1)), std::move(label));
    ++done_;
  }
  void reused() {
    const std::lock_guard lock(mutex_);
    ++reused_;
  }
  std::size_t reused_count() const { return reused_; }

 private:
  std::mutex mutex_;
  std::size_t done_ = 0;
  std::size_t reused_ = 0;
  std::size_t total_;
  const std::function<void(double, std::string)>& report_;
};

Json tree_settings(const StudyPlan& plan, const Mesh& mesh, const std::string& method) {
  return {{"format", format}, {"morula", version},           {"mesh", hash_text(mesh_hash(mesh))},
          {"method", method}, {"branching", plan.branching}, {"depth", plan.depth},
          {"seed", plan.seed}};
}

Json rule_json(const StudyRule& rule) {
  Json levels = Json::array();
  for (const Rule r : rule.options.rules) levels.push_back(name(r));
  return {{"name", rule.name}, {"levels", levels}, {"conservative", rule.options.conservative}};
}

Json cell_settings(const StudyPlan& plan, const StudySource& source, const Built& built, const std::string& motion,
                   const StudyRule& rule, bool with_protrusion) {
  Json json = tree_settings(plan, plan.bodies[source.body].mesh, source.method);
  json["tree"] = hash_text(tree_hash(built.tree));
  json["motion"] = motion;
  json["rule"] = rule_json(rule);
  json["samples"] = plan.samples;
  if (rule.kind == StudyRule::Kind::fresh) json["at"] = plan.fresh_samples(source);
  json["levels"] = plan.levels();
  json["resolution"] = plan.resolution;
  json["protrusion"] = with_protrusion ? Json(plan.protrusion_tolerance) : Json(nullptr);
  return json;
}

Json press_settings(const StudyPlan& plan, const NamedMesh& body, const std::string& method, const Built& built,
                    const StudyRule& rule) {
  Json json = tree_settings(plan, body.mesh, method);
  json["tree"] = hash_text(tree_hash(built.tree));
  json["press"] = describe_all(plan.press_pose);
  json["rule"] = rule_json(rule);
  json["amounts"] = plan.press_amounts;
  json["budgets"] = plan.press_budgets;
  return json;
}

Built make_tree(const StudyPlan& plan, const StudyCache& cache, const NamedMesh& body, const StudySource& source,
                const std::stop_token& stop) {
  if (!source.generator) return read_built(source.file, body.mesh, parse_sph_origin(plan.sph_origin, &body.mesh));
  const std::string stem = fmt::format("{}-{}", body.name, source.method);
  const Json settings = tree_settings(plan, body.mesh, source.method);
  if (std::optional<Built> stored = cache.find_tree(stem, settings, body.mesh)) return std::move(*stored);
  Built built = build(body.mesh, {.method = *source.generator,
                                  .branching = plan.branching,
                                  .depth = plan.depth,
                                  .seed = plan.seed,
                                  .stop = stop,
                                  .progress = {}});
  cache.store_tree(stem, settings, built);
  return built;
}

struct CellTask {
  std::size_t source;  // among the body's
  std::size_t motion;
  const StudyRule* rule;
  bool with_protrusion;
  StudyCell* result;
};

/// Everything about one body; its trees and poses are dropped at the end, except the first body's trees.
class BodyRun {
 public:
  BodyRun(const StudyPlan& plan, std::size_t body, const StudyCache& cache, Workers& workers,
          const std::stop_token& stop, Counter& counter, StudyResult& result)
      : plan_(plan), body_(body), cache_(cache), workers_(workers), stop_(stop), counter_(counter), result_(result) {
    for (const StudySource& source : plan.sources)
      if (source.body == body) sources_.push_back(&source);
  }

  void run() {
    make_trees();
    make_poses();
    std::vector<StudyCell> cells(sources_.size() * poses_.size() * plan_.rules.size());
    std::vector<StudyCell> mixes(body_ == 0 && !sources_.empty() ? poses_.size() * plan_.mixes.size() : 0);
    std::vector<CellTask> tasks;
    std::size_t next = 0;
    for (std::size_t s = 0; s < sources_.size(); ++s) {
      for (std::size_t m = 0; m < poses_.size(); ++m) {
        for (const StudyRule& rule : plan_.rules) {
          StudyCell* cell = &cells[next++];
          if (rule.kind == StudyRule::Kind::fresh && !sources_[s]->generator) continue;  // cannot be built anew
          tasks.push_back({s, m, &rule, true, cell});
        }
      }
    }
    for (std::size_t i = 0; i < mixes.size(); ++i) {
      tasks.push_back({0, i / plan_.mixes.size(), &plan_.mixes[i % plan_.mixes.size()], false, &mixes[i]});
    }
    // The longest first: builds, then re-fitting.
    std::stable_sort(tasks.begin(), tasks.end(),
                     [](const CellTask& a, const CellTask& b) { return a.rule->kind > b.rule->kind; });
    workers_.run(tasks.size(), [&](std::size_t i) { run_task(tasks[i]); });
    for (std::vector<StudyCell>* part : {&cells, &mixes}) {
      std::vector<StudyCell>& all = part == &cells ? result_.cells : result_.mixes;
      for (StudyCell& cell : *part)
        if (!cell.samples.empty()) all.push_back(std::move(cell));
    }
    run_presses();
    if (body_ == 0) result_.shown = std::move(trees_);
  }

 private:
  const NamedMesh& body() const { return plan_.bodies[body_]; }

  void make_trees() {
    trees_.resize(sources_.size());
    std::vector<StudyTree> figures(sources_.size());
    workers_.run(sources_.size(), [&](std::size_t s) {
      const StudySource& source = *sources_[s];
      counter_.next(fmt::format("building {} {}", body().name, source.method));
      trees_[s] = make_tree(plan_, cache_, body(), source, stop_);
      figures[s] = {body().name, source.method, tree_levels(body().mesh, trees_[s])};
    });
    for (StudyTree& tree : figures) result_.trees.push_back(std::move(tree));
  }

  void make_poses() {
    std::vector<MovedFrames> moved = move_frames(body(), plan_.motions, plan_.parameters(), result_.skipped);
    for (MovedFrames& motion : moved) poses_.push_back({std::move(motion), {}});
    if (!inspect(body().mesh).has_volume()) return;
    for (StudyPoses& poses : poses_) poses.distances.resize(plan_.samples);
    workers_.run(poses_.size() * plan_.samples, [&](std::size_t i) {
      StudyPoses& poses = poses_[i / plan_.samples];
      const std::size_t sample = i % plan_.samples;
      poses.distances[sample] =
          std::make_unique<SignedDistance>(MeshView(poses.motion.frames[sample], body().mesh.facets));
    });
  }

  /// All trees, and those that are made for this alone.
  void run_presses() {
    if (plan_.press_rules.empty() || sources_.empty()) return;
    const std::optional<PressScene> scene = make_press(plan_, body(), trees_.front(), result_.skipped);
    if (!scene) return;
    result_.truths.push_back(truths_json(body().name, *scene));
    std::vector<const StudySource*> more;
    for (const StudySource& source : plan_.press_sources)
      if (source.body == body_) more.push_back(&source);
    std::vector<Built> others(more.size());
    workers_.run(more.size(), [&](std::size_t i) { others[i] = make_tree(plan_, cache_, body(), *more[i], stop_); });
    const std::size_t rules = plan_.press_rules.size();
    std::vector<PressCell> cells((sources_.size() + more.size()) * rules);
    workers_.run(cells.size(), [&](std::size_t i) {
      const std::size_t s = i / rules;
      const bool ours = s < sources_.size();
      const std::string& method = ours ? sources_[s]->method : more[s - sources_.size()]->method;
      const Built& built = ours ? trees_[s] : others[s - sources_.size()];
      cells[i] = press(*scene, method, built, plan_.press_rules[i % rules]);
    });
    for (PressCell& cell : cells) result_.presses.push_back(std::move(cell));
  }

  PressCell press(const PressScene& scene, const std::string& method, const Built& built, const StudyRule& rule) const {
    if (stop_.stop_requested()) throw BuildStopped();
    counter_.next(fmt::format("{} {} pressed, {}", body().name, method, rule.name));
    const std::string stem = fmt::format("{}-{}-press-{}", body().name, method, rule.name);
    const Json settings = press_settings(plan_, body(), method, built, rule);
    if (const std::optional<Json> stored = cache_.find(stem, settings)) {
      try {
        PressCell cell = press_from_json(*stored);
        cell.body = body().name;
        counter_.reused();
        return cell;
      } catch (const Json::exception&) {  // not ours: measured anew
      }
    }
    PressCell cell = run_press(plan_, body(), method, built, scene, rule, stop_);
    cache_.store(stem, settings, press_json(cell));
    return cell;
  }

  void run_task(const CellTask& task) const {
    if (stop_.stop_requested()) throw BuildStopped();
    const StudySource& source = *sources_[task.source];
    const StudyPoses& poses = poses_[task.motion];
    const std::string stem = fmt::format("{}-{}-{}-{}", body().name, source.method, poses.motion.name, task.rule->name);
    counter_.next(fmt::format("{} {} {} {}", body().name, source.method, poses.motion.name, task.rule->name));
    const Json settings = cell_settings(plan_, source, trees_[task.source], poses.motion.name, *task.rule,
                                        task.with_protrusion && !poses.distances.empty());
    if (const std::optional<Json> stored = cache_.find(stem, settings)) {
      try {
        *task.result = cell_from_json(*stored);
        task.result->body = body().name;
        counter_.reused();
        return;
      } catch (const Json::exception&) {  // not ours: measured anew
      }
    }
    *task.result = run_cell(plan_, source, trees_[task.source], poses, *task.rule, task.with_protrusion, stop_);
    cache_.store(stem, settings, cell_json(*task.result));
  }

  const StudyPlan& plan_;
  std::size_t body_;
  const StudyCache& cache_;
  Workers& workers_;
  const std::stop_token& stop_;
  Counter& counter_;
  StudyResult& result_;
  std::vector<const StudySource*> sources_;
  std::vector<Built> trees_;
  std::vector<StudyPoses> poses_;
};

void run_needles(const StudyPlan& plan, const StudyCache& cache, Workers& workers, const std::stop_token& stop,
                 Counter& counter, StudyResult& result) {
  const NamedMesh prism{"prism", needle_prism(plan.needle_sides)};
  std::vector<const StudySource*> sources;
  for (const StudySource& source : plan.sources)
    if (source.body == 0 && source.generator) sources.push_back(&source);
  result.needles.resize(sources.size());
  workers.run(sources.size(), [&](std::size_t s) {
    counter.next(fmt::format("building {} {}", prism.name, sources[s]->method));
    const Built built = make_tree(plan, cache, prism, *sources[s], stop);
    result.needles[s] = {prism.name, sources[s]->method, tree_levels(prism.mesh, built)};
  });
}

}  // namespace

StudyResult run_study(const StudyPlan& plan, const StudyCache& cache, Workers& workers, const std::stop_token& stop,
                      const std::function<void(double, std::string)>& progress) {
  std::size_t total = plan.sources.size() * (1 + plan.motions.size() * plan.rules.size());
  total += plan.motions.size() * plan.mixes.size();
  total += (plan.sources.size() + plan.press_sources.size()) * plan.press_rules.size();
  if (plan.needle_sides > 0)
    total += static_cast<std::size_t>(std::count_if(plan.sources.begin(), plan.sources.end(),
                                                    [](const StudySource& s) { return s.body == 0 && s.generator; }));
  Counter counter(total, progress);
  StudyResult result;
  try {
    for (std::size_t body = 0; body < plan.bodies.size(); ++body)
      BodyRun(plan, body, cache, workers, stop, counter, result).run();
    if (plan.needle_sides > 0) run_needles(plan, cache, workers, stop, counter, result);
  } catch (const BuildStopped&) {
    throw StudyStopped();
  }
  result.taken_from_cache = counter.reused_count();
  return result;
}

}  // namespace morula::cli
