// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <morula/geometry/inspect.hpp>
#include <morula/io/tree_file.hpp>
#include <morula/study/run.hpp>
#include <morula/version.hpp>
#include <mutex>
#include <toolbox/numbers.hpp>
#include <toolbox/stopwatch.hpp>

#include "run/cell.hpp"
#include "run/cell_store.hpp"
#include "run/own.hpp"
#include "run/press.hpp"

namespace morula::study {

using namespace toolbox;

namespace {

/// The progress of all threads.
class Counter {
 public:
  Counter(std::size_t total, const Progress& report) : total_(total), report_(report) {}
  void next(const std::string& label) {
    const std::lock_guard lock(mutex_);
    if (report_) report_(static_cast<double>(done_) / static_cast<double>(std::max<std::size_t>(total_, 1)), label);
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
  const Progress& report_;
};

Json tree_settings(const Plan& plan, const Mesh& mesh, const std::string& method) {
  return {{"format", cell_format}, {"morula", version},           {"mesh", hash_text(mesh_hash(mesh))},
          {"method", method},      {"branching", plan.branching}, {"depth", plan.depth},
          {"seed", plan.seed}};
}

Json rule_json(const FollowRule& rule) {
  Json levels = Json::array();
  for (const Rule r : rule.options.rules) levels.push_back(name(r));
  Json json{{"name", rule.name}, {"levels", levels}, {"conservative", rule.options.conservative}};
  if (rule.own) json["own"] = rule.own->version;
  return json;
}

Json cell_settings(const Plan& plan, const Source& source, const CoveredTree& model, const std::string& motion,
                   const FollowRule& rule, bool with_protrusion) {
  Json json = tree_settings(plan, plan.bodies[source.body].mesh, source.method);
  json["tree"] = hash_text(tree_hash(model.tree));
  json["motion"] = motion;
  json["rule"] = rule_json(rule);
  json["parameters"] = plan.parameters();
  json["at"] = rule.kind == fresh ? plan.fresh_samples(source) : plan.measured_samples();
  json["levels"] = plan.levels();
  json["resolution"] = plan.resolution;
  json["grids"] = {plan.measures.paper_grid, plan.measures.lattice};
  json["certificate"] = plan.measures.certificate;
  json["protrusion"] = with_protrusion ? Json(plan.protrusion_tolerance) : Json(nullptr);
  if (source.own) json["own"] = source.own->version;
  if (!plan.metrics.empty()) json["metrics"] = metrics_json(plan);
  return json;
}

Json press_settings(const Plan& plan, const Source& source, const CoveredTree& model, const FollowRule& rule) {
  Json json = tree_settings(plan, plan.bodies[source.body].mesh, source.method);
  json["tree"] = hash_text(tree_hash(model.tree));
  json["press"] = describe_all(plan.press_pose);
  json["rule"] = rule_json(rule);
  json["amounts"] = plan.press_amounts;
  json["budgets"] = plan.press_budgets;
  return json;
}

/// The data that all parts of a run share.
struct Context {
  const Plan& plan;
  const Cache* cache;
  Workers& workers;
  const std::stop_token& stop;
  Counter& counter;
  Result& result;

  /// The cached result for these settings, read by `parse`; otherwise the result of `measure`, which is then stored.
  template <class Parse, class Measure, class Write>
  auto cached(const std::string& stem, const Json& settings, const Parse& parse, const Measure& measure,
              const Write& write, bool has_version = true) const {
    const Cache* const kept = has_version ? cache : nullptr;
    if (const std::optional<Json> stored = find(kept, stem, settings)) {
      try {
        auto value = parse(*stored);
        counter.reused();
        return value;
      } catch (const Json::exception&) {  // foreign data: measured again
      }
    }
    auto value = measure();
    store(kept, stem, settings, write(value));
    return value;
  }
};

CoveredTree make_tree(const Context& c, const NamedMesh& body, const Source& source, Workers& workers) {
  const Plan& plan = c.plan;
  if (source.own) return make_own_tree(*source.own, body.mesh);
  if (!source.generator)
    return read_covered_tree(source.file, body.mesh, {.sph_origin = plan.sph_origin.of(body.mesh)}, workers);
  const std::string stem = fmt::format("{}-{}", body.name, source.method);
  const Json settings = tree_settings(plan, body.mesh, source.method);
  if (std::optional<CoveredTree> stored = find_tree(c.cache, stem, settings, body.mesh)) return std::move(*stored);
  CoveredTree model = build(body.mesh,
                            {.method = *source.generator,
                             .branching = plan.branching,
                             .depth = plan.depth,
                             .seed = plan.seed,
                             .stop = c.stop,
                             .progress = {}},
                            workers);
  store_tree(c.cache, stem, settings, model);
  return model;
}

struct CellTask {
  MotionRunKey key;
  std::size_t source;  // place among the body's sources
  std::size_t motion;  // place among the motions that it can make
  const FollowRule* rule;
  bool with_protrusion;
  MotionRun* result;
};

/// Everything about one body; its trees and poses are dropped at the end, unless the caller requests its trees.
class BodyRun {
 public:
  BodyRun(const Context& context, std::size_t body) : c_(context), body_(body) {
    for (std::size_t s = 0; s < c_.plan.sources.size(); ++s)
      if (c_.plan.sources[s].body == body) sources_.push_back(s);
  }

  void run() {
    make_trees();
    make_poses();
    run_cells();
    run_presses();
    if (body_ != 0 && !c_.plan.keep_trees) return;
    for (std::size_t s = 0; s < sources_.size(); ++s) c_.result.model[sources_[s]] = std::move(trees_[s]);
  }

 private:
  const NamedMesh& body() const { return c_.plan.bodies[body_]; }
  const Source& source(std::size_t s) const { return c_.plan.sources[sources_[s]]; }

  void make_trees() {
    trees_.resize(sources_.size());
    std::vector<TreeFigures> figures(sources_.size());
    const auto make = [&](std::size_t s, Workers& workers) {
      c_.counter.next(fmt::format("building {} {}", body().name, source(s).method));
      Stopwatch watch;
      trees_[s] = make_tree(c_, body(), source(s), workers);
      figures[s] = {sources_[s], {}, watch.lap()};
      figures[s].levels = tree_levels(body().mesh, trees_[s]);
    };
    if (c_.plan.measures.timed_updates > 0) {
      for (std::size_t s = 0; s < sources_.size(); ++s) make(s, c_.workers);
    } else {
      c_.workers.run(sources_.size(), [&](std::size_t s) { make(s, serial_workers()); });
    }
    for (TreeFigures& tree : figures) c_.result.trees[tree.source] = std::move(tree);
  }

  void make_poses() {
    const Plan& plan = c_.plan;
    for (MovedFrames& motion : move_frames(plan, body_, plan.motions, plan.parameters(), &c_.result.skipped))
      poses_.push_back({std::move(motion), {}});
    if (!plan.measures.protrusion || !inspect(body().mesh).has_volume()) return;
    for (Poses& poses : poses_) poses.distances.resize(plan.samples);
    c_.workers.run(poses_.size() * plan.samples, [&](std::size_t i) {
      Poses& poses = poses_[i / plan.samples];
      const std::size_t sample = i % plan.samples;
      poses.distances[sample] =
          std::make_unique<SignedDistance>(MeshView(poses.motion.frames[sample], body().mesh.facets));
    });
  }

  void run_cells() {
    const Plan& plan = c_.plan;
    std::vector<MotionRun> cells(sources_.size() * poses_.size() * plan.rules.size());
    std::vector<MotionRun> mixes(body_ == 0 && !sources_.empty() ? poses_.size() * plan.mixes.size() : 0);
    std::vector<CellTask> tasks;
    std::size_t next = 0;
    for (std::size_t s = 0; s < sources_.size(); ++s) {
      for (std::size_t m = 0; m < poses_.size(); ++m) {
        for (std::size_t r = 0; r < plan.rules.size(); ++r) {
          MotionRun* cell = &cells[next++];
          if (plan.rules[r].kind == fresh && !source(s).can_build()) continue;  // cannot be built again
          tasks.push_back({{sources_[s], poses_[m].motion.motion, r}, s, m, &plan.rules[r], true, cell});
        }
      }
    }
    for (std::size_t i = 0; i < mixes.size(); ++i) {
      const std::size_t m = i / plan.mixes.size(), r = i % plan.mixes.size();
      tasks.push_back({{sources_[0], poses_[m].motion.motion, r}, 0, m, &plan.mixes[r], false, &mixes[i]});
    }
    // The longest first: builds, then rebuilding.
    std::stable_sort(tasks.begin(), tasks.end(),
                     [](const CellTask& a, const CellTask& b) { return a.rule->kind > b.rule->kind; });
    c_.workers.run(tasks.size(), [&](std::size_t i) { run_task(tasks[i]); });
    if (plan.measures.timed_updates > 0) {
      for (const CellTask& task : tasks)
        task.result->update_seconds = time_cell(plan, task.key, trees_[task.source], poses_[task.motion], *task.rule);
    }
    for (std::vector<MotionRun>* part : {&cells, &mixes}) {
      std::vector<MotionRun>& all = part == &cells ? c_.result.cells : c_.result.mixes;
      for (MotionRun& cell : *part)
        if (!cell.samples.empty()) all.push_back(std::move(cell));
    }
  }

  void run_task(const CellTask& task) const {
    if (c_.stop.stop_requested()) throw BuildStopped();
    const Poses& poses = poses_[task.motion];
    const Source& of = source(task.source);
    const CoveredTree& model = trees_[task.source];
    c_.counter.next(fmt::format("{} {} {} {}", body().name, of.method, poses.motion.name, task.rule->name));
    *task.result = c_.cached(
        fmt::format("{}-{}-{}-{}", body().name, of.method, poses.motion.name, task.rule->name),
        cell_settings(c_.plan, of, model, poses.motion.name, *task.rule,
                      task.with_protrusion && !poses.distances.empty()),
        cell_from_json,
        [&] { return run_cell(c_.plan, task.key, model, poses, *task.rule, task.with_protrusion, c_.stop); },
        stored_json, has_version(c_.plan, of, *task.rule));
    task.result->key = task.key;
  }

  /// Runs presses for all trees, including trees that are made only for them.
  void run_presses() {
    const Plan& plan = c_.plan;
    if (plan.press_rules.empty() || sources_.empty()) return;
    std::optional<PressScene> scene = make_press(plan, body_, trees_.front(), c_.result.skipped);
    if (!scene) return;
    std::vector<std::size_t> pressed = sources_;
    for (std::size_t s = 0; s < plan.press_sources.size(); ++s)
      if (plan.press_sources[s].body == body_) pressed.push_back(plan.sources.size() + s);
    std::vector<CoveredTree> others(pressed.size() - sources_.size());
    c_.workers.run(others.size(), [&](std::size_t i) {
      others[i] = make_tree(c_, body(), plan.pressed(pressed[sources_.size() + i]), serial_workers());
    });
    const std::size_t rules = plan.press_rules.size();
    std::vector<PressCell> cells(pressed.size() * rules);
    c_.workers.run(cells.size(), [&](std::size_t i) {
      const std::size_t s = i / rules;
      const CoveredTree& model = s < sources_.size() ? trees_[s] : others[s - sources_.size()];
      cells[i] = press(*scene, pressed[s], i % rules, model);
    });
    for (PressCell& cell : cells) c_.result.presses.push_back(std::move(cell));
    c_.result.scenes.push_back(std::move(*scene));
  }

  PressCell press(const PressScene& scene, std::size_t source, std::size_t rule, const CoveredTree& model) const {
    if (c_.stop.stop_requested()) throw BuildStopped();
    const std::string& method = c_.plan.pressed(source).method;
    const FollowRule& follow = c_.plan.press_rules[rule];
    c_.counter.next(fmt::format("{} {} pressed, {}", body().name, method, follow.name));
    return c_.cached(
        fmt::format("{}-{}-press-{}", body().name, method, follow.name),
        press_settings(c_.plan, c_.plan.pressed(source), model, follow),
        [&](const Json& json) {
          return PressCell{source, rule, figures_from_json(json)};
        },
        [&] { return run_press(c_.plan, source, rule, model, scene, c_.stop); }, figures_json);
  }

  const Context& c_;
  std::size_t body_;
  std::vector<std::size_t> sources_;  // in the plan
  std::vector<CoveredTree> trees_;
  std::vector<Poses> poses_;
};

void run_needles(const Context& c) {
  const NamedMesh prism{"prism", needle_prism(c.plan.needle_sides)};
  std::vector<std::size_t> sources;
  for (std::size_t s = 0; s < c.plan.sources.size(); ++s)
    if (c.plan.sources[s].body == 0 && c.plan.sources[s].can_build()) sources.push_back(s);
  c.result.needles.resize(sources.size());
  c.workers.run(sources.size(), [&](std::size_t i) {
    const Source& source = c.plan.sources[sources[i]];
    c.counter.next(fmt::format("building {} {}", prism.name, source.method));
    const CoveredTree model = make_tree(c, prism, source, serial_workers());
    c.result.needles[i] = {sources[i], tree_levels(prism.mesh, model), 0};
  });
}

/// Rejects entries that refer to a part that is not in the plan.
void check(const Plan& plan) {
  const auto refuse = [](const std::string& what) { throw std::invalid_argument("study: " + what); };
  if (plan.bodies.empty() || plan.sources.empty()) refuse("a plan needs a body and a tree of it");
  if (plan.samples < 2) refuse("a motion needs two samples");
  if (plan.sources.front().body != 0) refuse("the first source must be of the first body");
  for (const std::vector<Source>* list : {&plan.sources, &plan.press_sources}) {
    for (std::size_t i = 0; i < list->size(); ++i) {
      if ((*list)[i].body >= plan.bodies.size()) refuse("a source names a body that is not there");
      if (i > 0 && (*list)[i].body < (*list)[i - 1].body) refuse("sources must be in the order of their bodies");
    }
  }
  for (const FollowRule& rule : plan.press_rules)
    if (rule.kind != RuleKey::Kind::update) refuse("bodies are pressed by update rules alone, not by " + rule.name);
  for (std::size_t i = 0; i < plan.measured.size(); ++i) {
    if (plan.measured[i] >= plan.samples) refuse("a measured sample is not there");
    if (i > 0 && plan.measured[i] <= plan.measured[i - 1]) refuse("measured samples must ascend");
  }
  check_own(plan);
}

std::size_t count_steps(const Plan& plan) {
  std::size_t total = plan.sources.size() * (1 + plan.motions.size() * plan.rules.size());
  total += plan.motions.size() * plan.mixes.size();
  total += (plan.sources.size() + plan.press_sources.size()) * plan.press_rules.size();
  if (plan.needle_sides > 0)
    total += static_cast<std::size_t>(std::count_if(plan.sources.begin(), plan.sources.end(),
                                                    [](const Source& s) { return s.body == 0 && s.can_build(); }));
  return total;
}

}  // namespace

Result run(const Plan& plan, Workers& workers, const RunOptions& options) {
  check(plan);
  Counter counter(count_steps(plan), options.progress);
  Result result;
  result.trees.resize(plan.sources.size());
  result.model.resize(plan.sources.size());
  const Context context{plan, options.cache, workers, options.stop, counter, result};
  try {
    for (std::size_t body = 0; body < plan.bodies.size(); ++body) BodyRun(context, body).run();
    if (plan.needle_sides > 0) run_needles(context);
  } catch (const BuildStopped&) {
    throw Stopped();
  }
  result.taken_from_cache = counter.reused_count();
  return result;
}

}  // namespace morula::study
