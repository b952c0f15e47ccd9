// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "run/cell.hpp"

#include <algorithm>
#include <cmath>
#include <morula/update/body.hpp>
#include <morula/update/rebuilt_body.hpp>
#include <stdexcept>
#include <toolbox/numbers.hpp>
#include <toolbox/stopwatch.hpp>

#include "run/own.hpp"

namespace morula::study {

using namespace toolbox;

namespace {

/// Follows a motion: positions in, the current tree out.
class Follower {
 public:
  virtual ~Follower() = default;
  virtual SphereTree follow(const std::vector<Vec3>& positions) = 0;
  virtual std::optional<std::uint64_t> hash() const = 0;
  /// The certificate of the levels that guarantee cover; none when no level does.
  virtual std::optional<Certificate> certificate(const std::vector<Vec3>&) const { return std::nullopt; }
};

class UpdatedTree final : public Follower {
 public:
  UpdatedTree(const Mesh& mesh, const CoveredTree& model, const UpdateOptions& options) : body_(mesh, model, options) {}
  SphereTree follow(const std::vector<Vec3>& positions) override {
    if (!body_.update(positions)) throw std::logic_error("the study's own motion was rejected by update");
    return body_.current_tree();
  }
  std::optional<std::uint64_t> hash() const override { return body_.hash(); }
  std::optional<Certificate> certificate(const std::vector<Vec3>& positions) const override {
    if (!any_promises_cover(body_)) return std::nullopt;
    return certify_promised_levels(body_, positions);
  }

 private:
  Body body_;
};

/// It works on the caller's thread, so that every run gives the same bits.
class RebuiltTree final : public Follower {
 public:
  RebuiltTree(const Mesh& mesh, const CoveredTree& model, PoseTrees& trees)
      : body_(mesh, model,
              {.check_every = 1,
               .thread = RebuildThread::caller,
               .executor = {},
               .builder = [&trees](const MeshView& posed, const BuildOptions& options) {
                 return trees.build(posed, options);
               }}) {}
  SphereTree follow(const std::vector<Vec3>& positions) override {
    if (!body_.update(positions)) throw std::logic_error("the study's own motion was rejected by update");
    return body_.body().current_tree();
  }
  std::optional<std::uint64_t> hash() const override { return body_.body().hash(); }

 private:
  RebuiltBody body_;
};

class FreshTree final : public Follower {
 public:
  FreshTree(const Mesh& mesh, const CoveredTree& model, BuildOptions options)
      : mesh_(mesh), rest_(model.tree), options_(std::move(options)) {}
  SphereTree follow(const std::vector<Vec3>& positions) override {
    if (positions == mesh_.positions) return rest_;
    return build({positions, mesh_.facets}, options_, serial_workers()).tree;
  }
  std::optional<std::uint64_t> hash() const override { return std::nullopt; }

 private:
  const Mesh& mesh_;
  const SphereTree& rest_;
  BuildOptions options_;
};

class OwnTree final : public Follower {
 public:
  OwnTree(const Mesh& mesh, const CoveredTree& model, const OwnRule& rule)
      : rule_(rule), nodes_(model.tree.node_count()), object_(rule.make(mesh, model)) {}
  SphereTree follow(const std::vector<Vec3>& positions) override {
    SphereTree tree = object_->follow(positions);
    require_sound(rule_, tree, nodes_);
    hash_ = tree_hash(tree);
    return tree;
  }
  std::optional<std::uint64_t> hash() const override { return hash_; }

 private:
  const OwnRule& rule_;
  std::size_t nodes_;
  std::unique_ptr<OwnFollower> object_;
  std::uint64_t hash_ = 0;
};

/// Builds the tree of a generator of one's own at each pose.
class FreshOwnTree final : public Follower {
 public:
  FreshOwnTree(const Mesh& mesh, const CoveredTree& model, const OwnGenerator& generator)
      : mesh_(mesh), rest_(model.tree), generator_(generator) {}
  SphereTree follow(const std::vector<Vec3>& positions) override {
    if (positions == mesh_.positions) return rest_;
    return make_own_tree(generator_, {positions, mesh_.facets}).tree;
  }
  std::optional<std::uint64_t> hash() const override { return std::nullopt; }

 private:
  const Mesh& mesh_;
  const SphereTree& rest_;
  const OwnGenerator& generator_;
};

std::unique_ptr<Follower> make_follower(const Plan& plan, const Source& source, const CoveredTree& model,
                                        const FollowRule& rule, PoseTrees& trees, const StopToken& stop) {
  const Mesh& mesh = plan.bodies[source.body].mesh;
  switch (rule.kind) {
    case rebuilt:
      return std::make_unique<RebuiltTree>(mesh, model, trees);
    case RuleKey::Kind::own:
      return std::make_unique<OwnTree>(mesh, model, *rule.own);
    case fresh: {
      if (source.own) return std::make_unique<FreshOwnTree>(mesh, model, *source.own);
      BuildOptions options{.method = source.generator.value(),
                           .branching = plan.branching,
                           .depth = plan.depth,
                           .seed = source.seed.value_or(plan.seeds.front()),
                           .stop = stop,
                           .progress = {}};
      return std::make_unique<FreshTree>(mesh, model, std::move(options));
    }
    case RuleKey::Kind::update:
      break;
  }
  return std::make_unique<UpdatedTree>(mesh, model, rule.options);
}

double box_volume(const Mesh& mesh) {
  const Vec3 extent = bounding_box(mesh).extent();
  return extent.x * extent.y * extent.z;
}

LevelFigures measure_level(const Plan& plan, const Measures& measures, const Mesh& rest, const LoosenessMeter& meter,
                           const Mesh& deformed, const SphereTree& tree, std::size_t level,
                           const SignedDistance* distance) {
  const std::vector<Sphere> spheres = level_set_spheres(tree, std::min(level, tree.level_count() - 1));
  LevelFigures figures;
  figures.level = level;
  figures.spheres = spheres.size();
  figures.diagonal = bounding_box(rest).diagonal();
  figures.box_volume = box_volume(rest);
  const auto grid = [&](int resolution) -> VoxelGrid {
    return {.kind = VoxelGrid::Kind::level, .resolution = resolution, .voxel_edge = 0};
  };
  if (measures.paper_grid) figures.grid = meter.measure(deformed.positions, spheres, grid(plan.resolution));
  if (measures.half_grid)
    figures.half_grid = meter.measure(deformed.positions, spheres, grid(std::max(8, plan.resolution / 2)));
  if (measures.lattice) {
    figures.lattice = meter.measure(deformed.positions, spheres,
                                    {.kind = VoxelGrid::Kind::fixed, .voxel_edge = figures.diagonal / plan.resolution});
  }
  figures.coverage = coverage(deformed, spheres, serial_workers());
  if (distance != nullptr && distance->has_volume())
    figures.protrusion = protrusion(*distance, spheres, plan.protrusion_tolerance, serial_workers());
  for (const OwnMetric& metric : plan.metrics) {
    const double value = metric.value(deformed, spheres, level);
    figures.metrics.push_back(std::isfinite(value) ? std::optional(value) : std::nullopt);
  }
  return figures;
}

MeasuredTrees::Key measured_key(const Mesh& deformed, const SphereTree& tree, const Measures& measures,
                                bool with_distance) {
  const unsigned parts = (measures.paper_grid ? 1u : 0u) | (measures.half_grid ? 2u : 0u) |
                         (measures.lattice ? 4u : 0u) | (with_distance ? 8u : 0u);
  return {mesh_hash(deformed), tree_hash(tree), parts};
}

/// The samples at which a cell measures its body.
std::vector<std::size_t> wanted_samples(const Plan& plan, const Source& source, const FollowRule& rule) {
  return rule.kind == fresh ? plan.fresh_samples(source) : plan.measured_samples(source);
}

void add(std::optional<Certificate>& all, const std::optional<Certificate>& one) {
  if (!one) return;
  if (!all || one->worst_excess > all->worst_excess) {
    const bool covered = !all || all->covered;
    all = one;
    all->covered = covered && one->covered;
  } else {
    all->covered = all->covered && one->covered;
  }
}

Json loose_json(const std::optional<Looseness>& l) {
  if (!l) return nullptr;
  return {json_of(l->looseness), json_of(l->missed_volume), l->outside_volume,
          l->object_volume,      l->union_volume,           l->voxels,
          l->voxel_edge};
}

std::optional<Looseness> loose_from(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return Looseness{
      value_from(json.at(0)), value_from(json.at(1)), json.at(2), json.at(3), json.at(4), json.at(5), json.at(6)};
}

}  // namespace

MotionRun run_cell(const Plan& plan, const MotionRunKey& key, const CoveredTree& model, const Poses& poses,
                   const FollowRule& rule, const LoosenessMeter& meter, bool with_protrusion, const StopToken& stop) {
  const Source& source = plan.sources[key.source];
  const Mesh& rest = plan.bodies[source.body].mesh;
  MotionRun cell;
  cell.key = key;
  const std::unique_ptr<Follower> follower = make_follower(plan, source, model, rule, *poses.trees, stop);
  const Measures measures = plan.measures_of(source);
  const std::vector<double> parameters = plan.parameters();
  const std::vector<std::size_t> wanted = wanted_samples(plan, source, rule);
  std::optional<std::uint64_t> first_hash;
  Mesh deformed = rest;
  for (std::size_t i = 0; i < plan.samples; ++i) {
    const bool is_wanted = std::find(wanted.begin(), wanted.end(), i) != wanted.end();
    if (!is_wanted && rule.kind == fresh) continue;
    if (stop.stop_requested()) throw BuildStopped();
    deformed.positions = poses.motion.frames[i];
    const SphereTree tree = follower->follow(deformed.positions);
    if (i == 0) first_hash = follower->hash();
    if (plan.measures.certificate) add(cell.certificate, follower->certificate(deformed.positions));
    if (!is_wanted) continue;
    const SignedDistance* distance = !with_protrusion || poses.distances.empty() ? nullptr : poses.distances[i].get();
    const auto measure = [&] {
      MeasuredTrees::Levels levels;
      for (const std::size_t level : plan.levels())
        levels.push_back(measure_level(plan, measures, rest, meter, deformed, tree, level, distance));
      return levels;
    };
    const bool is_shared = plan.metrics.empty();  // one's own metrics may depend on anything
    cell.samples.push_back(
        {i, parameters[i],
         is_shared ? poses.measured->find(measured_key(deformed, tree, measures, distance != nullptr), measure)
                   : measure()});
  }
  if (first_hash) {
    follower->follow(poses.motion.frames.front());
    cell.returns_to_rest = follower->hash() == first_hash;
  }
  return cell;
}

std::optional<double> time_cell(const Plan& plan, const MotionRunKey& key, const CoveredTree& model, const Poses& poses,
                                const FollowRule& rule) {
  if (rule.kind != RuleKey::Kind::update) return std::nullopt;
  Body body(plan.body_of(key.source).mesh, model, rule.options);
  std::vector<double> times;
  for (const std::vector<Vec3>& positions : poses.motion.frames) {
    for (int repeat = 0; repeat < plan.measures.timed_updates; ++repeat) {
      Stopwatch watch;
      const UpdateStatus status = body.update(positions);
      times.push_back(watch.lap());
      if (!status) throw std::invalid_argument(message(status));
    }
  }
  return median(times);
}

Json stored_json(const MotionRun& cell) {
  Json samples = Json::array();
  for (const Sample& s : cell.samples) {
    Json levels = Json::array();
    for (const LevelFigures& l : s.levels) {
      const Coverage& c = l.coverage;
      Json stick_out = nullptr;
      if (l.protrusion) stick_out = {l.protrusion->worst, l.protrusion->mean};
      levels.push_back({{"level", l.level},
                        {"spheres", l.spheres},
                        {"diagonal", l.diagonal},
                        {"box_volume", l.box_volume},
                        {"grid", loose_json(l.grid)},
                        {"half_grid", loose_json(l.half_grid)},
                        {"lattice", loose_json(l.lattice)},
                        {"coverage",
                         {c.covered, c.uncovered_area, c.uncovered_distance, c.uncovered_distance_upper, c.tolerance,
                          c.worst_facet}},
                        {"protrusion", stick_out}});
      for (const std::optional<double>& m : l.metrics) levels.back()["metrics"].push_back(json_of(m));
    }
    samples.push_back({{"sample", s.sample}, {"parameter", s.parameter}, {"levels", levels}});
  }
  Json certificate = nullptr;
  if (cell.certificate)
    certificate = {cell.certificate->covered, cell.certificate->worst_excess, cell.certificate->worst_node};
  return {{"returns_to_rest", json_of(cell.returns_to_rest)}, {"certificate", certificate}, {"samples", samples}};
}

MotionRun cell_from_json(const Json& json) {
  MotionRun cell;
  cell.returns_to_rest = value_from<bool>(json.at("returns_to_rest"));
  if (const Json& c = json.at("certificate"); !c.is_null()) cell.certificate = Certificate{c.at(0), c.at(1), c.at(2)};
  for (const Json& s : json.at("samples")) {
    Sample sample{s.at("sample"), s.at("parameter"), {}};
    for (const Json& l : s.at("levels")) {
      const Json& c = l.at("coverage");
      LevelFigures figures{l.at("level"),
                           l.at("spheres"),
                           l.at("diagonal"),
                           l.at("box_volume"),
                           loose_from(l.at("grid")),
                           loose_from(l.at("half_grid")),
                           loose_from(l.at("lattice")),
                           {c.at(0), c.at(1), c.at(2), c.at(3), c.at(4), c.at(5)},
                           std::nullopt};
      if (const Json& p = l.at("protrusion"); !p.is_null()) figures.protrusion = Protrusion{p.at(0), p.at(1)};
      for (const Json& m : l.value("metrics", Json::array())) figures.metrics.push_back(value_from(m));
      sample.levels.push_back(figures);
    }
    cell.samples.push_back(std::move(sample));
  }
  return cell;
}

}  // namespace morula::study
