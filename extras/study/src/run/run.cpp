// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <morula/geometry/inspect.hpp>
#include <morula/io/tree_file.hpp>
#include <morula/study/run.hpp>
#include <morula/version.hpp>
#include <mutex>
#include <numeric>
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

Json tree_settings(const Plan& plan, const Mesh& mesh, const Source& source) {
  return {{"format", cell_format},       {"morula", version},           {"mesh", hash_text(mesh_hash(mesh))},
          {"method", source.method},     {"branching", plan.branching}, {"depth", plan.depth},
          {"seed", json_of(source.seed)}};
}

/// "limb-medial", "limb-medial-2": of later seeds with the seed.
std::string stem_of(const Plan& plan, const std::string& body, const Source& source) {
  const std::string stem = fmt::format("{}-{}", body, source.method);
  return plan.is_first_seed(source) ? stem : fmt::format("{}-{}", stem, *source.seed);
}

Json rule_json(const FollowRule& rule) {
  Json levels = Json::array();
  for (const Rule r : rule.options.rules) levels.push_back(name(r));
  Json json{{"name", rule.name}, {"levels", levels}, {"conservative", rule.options.conservative}};
  if (rule.own) json["own"] = rule.own->version;
  return json;
}

/// A hash of all positions of a recorded motion, which no words describe.
std::string frames_hash(const MovedFrames& motion) {
  std::uint64_t hash = 0;
  for (const std::vector<Vec3>& frame : motion.frames) hash = 31 * hash + mesh_hash({frame, {}});
  return hash_text(hash);
}

Json cell_settings(const Plan& plan, const Source& source, const CoveredTree& model, const Poses& motion,
                   const FollowRule& rule, bool with_protrusion) {
  const Measures measures = plan.measures_of(source);
  Json json = tree_settings(plan, plan.bodies[source.body].mesh, source);
  json["tree"] = hash_text(tree_hash(model.tree));
  json["motion"] = motion.motion.name;
  if (motion.motion.motion >= plan.motions.size()) json["frames"] = frames_hash(motion.motion);
  json["rule"] = rule_json(rule);
  json["parameters"] = plan.parameters();
  json["at"] = rule.kind == fresh ? plan.fresh_samples(source) : plan.measured_samples(source);
  json["levels"] = plan.levels();
  json["resolution"] = plan.resolution;
  json["grids"] = {measures.paper_grid, measures.half_grid, measures.lattice};
  json["certificate"] = plan.measures.certificate;
  json["protrusion"] = with_protrusion ? Json(plan.protrusion_tolerance) : Json(nullptr);
  if (source.own) json["own"] = source.own->version;
  if (!plan.metrics.empty()) json["metrics"] = metrics_json(plan);
  return json;
}

Json press_settings(const Plan& plan, const Source& source, const CoveredTree& model, const FollowRule& rule) {
  Json json = tree_settings(plan, plan.bodies[source.body].mesh, source);
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
  const StopToken& stop;
  Counter& counter;
  Result& result;
  RunShard shard;

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

/// build_seconds: where the time of a build goes, if not null; a tree from a file or from the cache leaves it as it is.
CoveredTree make_tree(const Context& c, const NamedMesh& body, const Source& source, Workers& workers,
                      double* build_seconds = nullptr) {
  const Plan& plan = c.plan;
  if (source.own) return make_own_tree(*source.own, body.mesh);
  if (!source.generator)
    return read_covered_tree(source.file, body.mesh, {.sph_origin = plan.sph_origin.of(body.mesh)}, workers);
  const std::string stem = stem_of(plan, body.name, source);
  const Json settings = tree_settings(plan, body.mesh, source);
  if (std::optional<CoveredTree> stored = find_tree(c.cache, stem, settings, body.mesh)) return std::move(*stored);
  Stopwatch watch;
  CoveredTree model = build(body.mesh,
                            {.method = *source.generator,
                             .branching = plan.branching,
                             .depth = plan.depth,
                             .seed = source.seed.value_or(plan.seeds.front()),
                             .stop = c.stop,
                             .progress = {}},
                            workers);
  if (build_seconds != nullptr) *build_seconds = watch.lap();
  store_tree(c.cache, stem, settings, model);
  return model;
}

/// Trees with a higher rank take longer to build (research/notes/study-speed.md); one's own may take any time.
int build_rank(const Source& source) {
  if (source.own) return 3;
  switch (source.named().value_or(Method::octree)) {
    case Method::combined:
    case Method::hubbard:
    case Method::medial:
    case Method::optimized:
      return 2;
    case Method::grid:
    case Method::spawn:
      return 1;
    case Method::octree:
      break;
  }
  return 0;
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
  BodyRun(const Context& context, std::size_t body) : c_(context), body_(body), meter_(context.plan.bodies[body].mesh) {
    for (std::size_t s = 0; s < c_.plan.sources.size(); ++s)
      if (c_.plan.sources[s].body == body && c_.shard.has(s)) sources_.push_back(s);
  }

  void run() {
    if (!sources_.empty()) {  // a part may have no tree of this body
      make_trees();
      make_poses();
      run_cells();
    }
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
      double seconds = 0;
      trees_[s] = make_tree(c_, body(), source(s), workers, c_.plan.measures.timed_updates > 0 ? &seconds : nullptr);
      figures[s] = {.source = sources_[s], .levels = {}, .build_seconds = seconds};
      figures[s].levels = tree_levels(body().mesh, trees_[s]);
      figures[s].counts = count_updates(body().mesh, trees_[s]);
    };
    if (c_.plan.measures.timed_updates > 0) {
      for (std::size_t s = 0; s < sources_.size(); ++s) make(s, c_.workers);
    } else {
      // The longest first, so that no thread waits for one at the end.
      std::vector<std::size_t> order(sources_.size());
      std::iota(order.begin(), order.end(), std::size_t{0});
      std::stable_sort(order.begin(), order.end(),
                       [&](std::size_t a, std::size_t b) { return build_rank(source(a)) > build_rank(source(b)); });
      c_.workers.run(order.size(), [&](std::size_t i) { make(order[i], serial_workers()); });
    }
    for (TreeFigures& tree : figures) c_.result.trees[tree.source] = std::move(tree);
  }

  void make_poses() {
    const Plan& plan = c_.plan;
    for (MovedFrames& motion : move_frames(plan, body_, plan.parameters(), &c_.result.skipped))
      poses_.push_back({std::move(motion), {}});
    for (Poses& poses : poses_) poses.measured = poses_.front().measured;
    const bool is_needed = std::any_of(sources_.begin(), sources_.end(),
                                       [&](std::size_t s) { return plan.measures_of(plan.sources[s]).protrusion; });
    if (!is_needed || !inspect(body().mesh).has_volume()) return;
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
    const bool has_first = !sources_.empty() && sources_.front() == 0;
    std::vector<MotionRun> mixes(has_first ? poses_.size() * plan.mixes.size() : 0);
    std::vector<CellTask> tasks;
    std::size_t next = 0;
    for (std::size_t s = 0; s < sources_.size(); ++s) {
      for (std::size_t m = 0; m < poses_.size(); ++m) {
        for (std::size_t r = 0; r < plan.rules.size(); ++r) {
          MotionRun* cell = &cells[next++];
          if (!plan.has_cells(source(s), plan.rules[r])) continue;
          const bool protrusion = plan.measures_of(source(s)).protrusion;
          tasks.push_back({{sources_[s], poses_[m].motion.motion, r}, s, m, &plan.rules[r], protrusion, cell});
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
        fmt::format("{}-{}-{}", stem_of(c_.plan, body().name, of), poses.motion.name, task.rule->name),
        cell_settings(c_.plan, of, model, poses, *task.rule, task.with_protrusion && !poses.distances.empty()),
        cell_from_json,
        [&] { return run_cell(c_.plan, task.key, model, poses, *task.rule, meter_, task.with_protrusion, c_.stop); },
        stored_json, has_version(c_.plan, of, *task.rule));
    task.result->key = task.key;
  }

  /// Runs presses for all trees, including trees that are made only for them.
  void run_presses() {
    const Plan& plan = c_.plan;
    if (plan.press_rules.empty()) return;
    std::vector<std::size_t> pressed;
    for (std::size_t s = 0; s < plan.sources.size() + plan.press_sources.size(); ++s) {
      const Source& source = plan.pressed(s);
      if (source.body == body_ && c_.shard.has(s) && (plan.is_first_seed(source) || plan.later.presses))
        pressed.push_back(s);
    }
    if (pressed.empty()) return;
    std::vector<CoveredTree> others(pressed.size());  // trees that are only pressed
    c_.workers.run(others.size(), [&](std::size_t i) {
      if (pressed[i] >= plan.sources.size())
        others[i] = make_tree(c_, body(), plan.pressed(pressed[i]), serial_workers());
    });
    const auto tree_of = [&](std::size_t i) -> const CoveredTree& {
      const auto at = std::find(sources_.begin(), sources_.end(), pressed[i]);
      return at == sources_.end() ? others[i] : trees_[static_cast<std::size_t>(at - sources_.begin())];
    };
    std::optional<PressScene> scene = scene_of_body();
    if (!scene) return;
    const std::size_t rules = plan.press_rules.size();
    std::vector<PressCell> cells(pressed.size() * rules);
    c_.workers.run(cells.size(),
                   [&](std::size_t i) { cells[i] = press(*scene, pressed[i / rules], i % rules, tree_of(i / rules)); });
    for (PressCell& cell : cells) c_.result.presses.push_back(std::move(cell));
    c_.result.scenes.push_back(std::move(*scene));
  }

  /// The scene, by the body's first tree, also in a shard without it: its distances end within a rounding that depends
  /// on the tree.
  std::optional<PressScene> scene_of_body() const {
    const Plan& plan = c_.plan;
    std::size_t first = 0;
    while (plan.sources[first].body != body_) ++first;
    if (!sources_.empty() && sources_.front() == first)
      return make_press(plan, body_, trees_.front(), c_.result.skipped);
    return make_press(plan, body_, make_tree(c_, body(), plan.sources[first], c_.workers), c_.result.skipped);
  }

  PressCell press(const PressScene& scene, std::size_t source, std::size_t rule, const CoveredTree& model) const {
    if (c_.stop.stop_requested()) throw BuildStopped();
    const std::string stem = stem_of(c_.plan, body().name, c_.plan.pressed(source));
    const FollowRule& follow = c_.plan.press_rules[rule];
    c_.counter.next(fmt::format("{} pressed, {}", stem, follow.name));
    return c_.cached(
        fmt::format("{}-press-{}", stem, follow.name), press_settings(c_.plan, c_.plan.pressed(source), model, follow),
        [&](const Json& json) {
          return PressCell{source, rule, figures_from_json(json)};
        },
        [&] { return run_press(c_.plan, source, rule, model, scene, c_.stop); }, figures_json);
  }

  const Context& c_;
  std::size_t body_;
  LoosenessMeter meter_;
  std::vector<std::size_t> sources_;  // in the plan
  std::vector<CoveredTree> trees_;
  std::vector<Poses> poses_;
};

/// True for the generated trees of the first body, each method once.
bool has_needle(const Plan& plan, std::size_t source) {
  const Source& s = plan.sources[source];
  return s.body == 0 && s.can_build() && plan.is_first_seed(s);
}

void run_needles(const Context& c) {
  const NamedMesh prism{"prism", needle_prism(c.plan.needle_sides)};
  std::vector<std::size_t> sources;
  for (std::size_t s = 0; s < c.plan.sources.size(); ++s)
    if (has_needle(c.plan, s) && c.shard.has(s)) sources.push_back(s);
  c.result.needles.resize(sources.size());
  c.workers.run(sources.size(), [&](std::size_t i) {
    const Source& source = c.plan.sources[sources[i]];
    c.counter.next(fmt::format("building {} {}", prism.name, source.method));
    const CoveredTree model = make_tree(c, prism, source, serial_workers());
    c.result.needles[i] = {.source = sources[i], .levels = tree_levels(prism.mesh, model)};
  });
}

/// Rejects entries that refer to a part that is not in the plan.
void check(const Plan& plan) {
  const auto refuse = [](const std::string& what) { throw std::invalid_argument("study: " + what); };
  if (plan.seeds.empty()) refuse("a plan needs a seed");
  for (const RecordedMotion& motion : plan.recorded) {
    if (motion.body >= plan.bodies.size()) refuse("a motion is of a body that is not there");
    if (motion.frames.empty()) refuse("a motion needs a frame");
    for (const std::vector<Vec3>& frame : motion.frames)
      if (frame.size() != plan.bodies[motion.body].mesh.vertex_count())
        refuse("a frame of " + motion.name + " has another number of vertices than its body");
  }
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
  const std::vector<std::size_t> measured = plan.measured_samples();
  for (std::size_t i = 0; i < plan.decisive.size(); ++i) {
    if (std::find(measured.begin(), measured.end(), plan.decisive[i]) == measured.end())
      refuse("a deciding sample is not measured");
    if (i > 0 && plan.decisive[i] <= plan.decisive[i - 1]) refuse("deciding samples must ascend");
  }
  check_own(plan);
}

std::size_t count_steps(const Plan& plan, const RunShard& shard) {
  std::size_t total = shard.has(0) ? plan.motions.size() * plan.mixes.size() : 0;
  for (std::size_t s = 0; s < plan.sources.size() + plan.press_sources.size(); ++s) {
    if (!shard.has(s)) continue;
    const bool is_first = plan.is_first_seed(plan.pressed(s));
    if (is_first || plan.later.presses) total += plan.press_rules.size();
    if (s >= plan.sources.size()) continue;
    total += 1;
    for (const FollowRule& rule : plan.rules)
      if (plan.has_cells(plan.sources[s], rule)) total += plan.motion_count();
    if (plan.needle_sides > 0 && has_needle(plan, s)) ++total;
  }
  return total;
}

}  // namespace

Result run(const Plan& plan, Workers& workers, const RunOptions& options) {
  check(plan);
  if (options.shard.number < 1 || options.shard.number > options.shard.count)
    throw std::invalid_argument("study: there is no such part of the study");
  if (options.shard.count > 1 && options.cache == nullptr)
    throw std::invalid_argument("study: a part of a study needs a folder of finished cells");
  Counter counter(count_steps(plan, options.shard), options.progress);
  Result result;
  result.trees.resize(plan.sources.size());
  result.model.resize(plan.sources.size());
  const Context context{plan, options.cache, workers, options.stop, counter, result, options.shard};
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
