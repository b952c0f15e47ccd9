// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "study/cell.hpp"

#include <algorithm>
#include <morula/accuracy/coverage.hpp>
#include <morula/accuracy/protrusion.hpp>
#include <morula/update/body.hpp>
#include <morula/update/refit.hpp>
#include <stdexcept>

namespace morula::cli {
namespace {

Json number_json(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

std::optional<double> number_from(const Json& json) {
  return json.is_null() ? std::nullopt : std::optional(json.get<double>());
}

/// Follows a motion: positions in, the current tree out.
class Follower {
 public:
  virtual ~Follower() = default;
  virtual SphereTree follow(const std::vector<Vec3>& positions) = 0;
  virtual std::optional<std::uint64_t> hash() const = 0;
};

class UpdatedTree final : public Follower {
 public:
  UpdatedTree(const Mesh& mesh, const Built& built, const UpdateOptions& options) : body_(mesh, built, options) {}
  SphereTree follow(const std::vector<Vec3>& positions) override {
    if (!body_.update(positions)) throw std::logic_error("the study's own motion was refused by update");
    return body_.current_tree();
  }
  std::optional<std::uint64_t> hash() const override { return body_.hash(); }

 private:
  Body body_;
};

/// On the caller's thread, so that every run gives the same bits.
class RefittedTree final : public Follower {
 public:
  RefittedTree(const Mesh& mesh, const Built& built)
      : body_(mesh, built, {.check_every = 1, .thread = RefitThread::caller, .executor = {}}) {}
  SphereTree follow(const std::vector<Vec3>& positions) override {
    if (!body_.update(positions)) throw std::logic_error("the study's own motion was refused by update");
    return body_.body().current_tree();
  }
  std::optional<std::uint64_t> hash() const override { return body_.body().hash(); }

 private:
  RefittedBody body_;
};

class FreshTree final : public Follower {
 public:
  FreshTree(const Mesh& mesh, const Built& built, BuildOptions options)
      : mesh_(mesh), rest_(built.tree), options_(std::move(options)) {}
  SphereTree follow(const std::vector<Vec3>& positions) override {
    if (positions == mesh_.positions) return rest_;
    return build({positions, mesh_.facets}, options_).tree;
  }
  std::optional<std::uint64_t> hash() const override { return std::nullopt; }

 private:
  const Mesh& mesh_;
  const SphereTree& rest_;
  BuildOptions options_;
};

std::unique_ptr<Follower> make_follower(const StudyPlan& plan, const StudySource& source, const Built& built,
                                        const StudyRule& rule, const std::stop_token& stop) {
  const Mesh& mesh = plan.bodies[source.body].mesh;
  switch (rule.kind) {
    case StudyRule::Kind::refitted:
      return std::make_unique<RefittedTree>(mesh, built);
    case StudyRule::Kind::fresh: {
      BuildOptions options{.method = source.generator.value(),
                           .branching = plan.branching,
                           .depth = plan.depth,
                           .seed = plan.seed,
                           .stop = stop,
                           .progress = {}};
      return std::make_unique<FreshTree>(mesh, built, std::move(options));
    }
    case StudyRule::Kind::update:
      break;
  }
  return std::make_unique<UpdatedTree>(mesh, built, rule.options);
}

double box_volume(const Mesh& mesh) {
  const Vec3 extent = bounding_box(mesh).extent();
  return extent.x * extent.y * extent.z;
}

StudyLevel measure_level(const StudyPlan& plan, const Mesh& rest, const LoosenessMeter& meter, const Mesh& deformed,
                         const SphereTree& tree, std::size_t level, const SignedDistance* distance) {
  const double diagonal = bounding_box(rest).diagonal();
  const std::vector<Sphere> spheres = level_set_spheres(tree, std::min(level, tree.level_count() - 1));
  StudyLevel figures;
  figures.level = level;
  figures.spheres = spheres.size();
  const Looseness paper = meter.measure(
      deformed.positions, spheres, {.kind = VoxelGrid::Kind::level, .resolution = plan.resolution, .voxel_edge = 0});
  figures.looseness = paper.looseness;
  figures.missed_volume = paper.missed_volume;
  const double box = box_volume(rest);
  if (paper.looseness && box > 0) figures.looseness_box = paper.outside_volume / box;
  figures.looseness_fixed = meter
                                .measure(deformed.positions, spheres,
                                         {.kind = VoxelGrid::Kind::fixed, .voxel_edge = diagonal / plan.resolution})
                                .looseness;
  const Coverage cover = coverage(deformed, spheres);
  figures.bare_area = cover.bare_area;
  figures.gap = cover.gap / diagonal;
  if (distance != nullptr && distance->has_volume()) {
    const Protrusion stick_out = protrusion(*distance, spheres, plan.protrusion_tolerance);
    figures.protrusion_worst = stick_out.worst / diagonal;
    figures.protrusion_mean = stick_out.mean / diagonal;
  }
  return figures;
}

}  // namespace

const StudyLevel* StudyCell::at(std::size_t sample, std::size_t level) const {
  for (const StudySample& s : samples) {
    if (s.sample != sample) continue;
    for (const StudyLevel& l : s.levels)
      if (l.level == level) return &l;
  }
  return nullptr;
}

StudyCell run_cell(const StudyPlan& plan, const StudySource& source, const Built& built, const StudyPoses& poses,
                   const StudyRule& rule, bool with_protrusion, const std::stop_token& stop) {
  const NamedMesh& body = plan.bodies[source.body];
  StudyCell cell{body.name, source.method, poses.motion.name, rule.name, std::nullopt, {}};
  const std::unique_ptr<Follower> follower = make_follower(plan, source, built, rule, stop);
  const LoosenessMeter meter(body.mesh);
  const std::vector<double> parameters = plan.parameters();
  std::vector<std::size_t> wanted(plan.samples);
  for (std::size_t i = 0; i < wanted.size(); ++i) wanted[i] = i;
  if (rule.kind == StudyRule::Kind::fresh) wanted = plan.fresh_samples(source);
  std::optional<std::uint64_t> first_hash;
  Mesh deformed = body.mesh;
  for (const std::size_t i : wanted) {
    if (stop.stop_requested()) throw BuildStopped();
    deformed.positions = poses.motion.frames[i];
    const SphereTree tree = follower->follow(deformed.positions);
    if (i == 0) first_hash = follower->hash();
    StudySample sample{i, parameters[i], {}};
    const SignedDistance* distance = !with_protrusion || poses.distances.empty() ? nullptr : poses.distances[i].get();
    for (const std::size_t level : plan.levels())
      sample.levels.push_back(measure_level(plan, body.mesh, meter, deformed, tree, level, distance));
    cell.samples.push_back(std::move(sample));
  }
  if (first_hash) {
    follower->follow(poses.motion.frames.front());
    cell.returns_to_rest = follower->hash() == first_hash;
  }
  return cell;
}

Json cell_json(const StudyCell& cell) {
  Json samples = Json::array();
  for (const StudySample& s : cell.samples) {
    Json levels = Json::array();
    for (const StudyLevel& l : s.levels) {
      levels.push_back({{"level", l.level},
                        {"spheres", l.spheres},
                        {"looseness", number_json(l.looseness)},
                        {"looseness_box", number_json(l.looseness_box)},
                        {"looseness_fixed", number_json(l.looseness_fixed)},
                        {"missed_volume", number_json(l.missed_volume)},
                        {"bare_area", l.bare_area},
                        {"gap", l.gap},
                        {"protrusion_worst", number_json(l.protrusion_worst)},
                        {"protrusion_mean", number_json(l.protrusion_mean)}});
    }
    samples.push_back({{"sample", s.sample}, {"parameter", s.parameter}, {"levels", levels}});
  }
  return {{"body", cell.body},
          {"method", cell.method},
          {"motion", cell.motion},
          {"rule", cell.rule},
          {"returns_to_rest", cell.returns_to_rest ? Json(*cell.returns_to_rest) : Json(nullptr)},
          {"samples", samples}};
}

StudyCell cell_from_json(const Json& json) {
  StudyCell cell{json.at("body"), json.at("method"), json.at("motion"), json.at("rule"), std::nullopt, {}};
  if (!json.at("returns_to_rest").is_null()) cell.returns_to_rest = json.at("returns_to_rest").get<bool>();
  for (const Json& s : json.at("samples")) {
    StudySample sample{s.at("sample"), s.at("parameter"), {}};
    for (const Json& l : s.at("levels")) {
      sample.levels.push_back({l.at("level"), l.at("spheres"), number_from(l.at("looseness")),
                               number_from(l.at("looseness_box")), number_from(l.at("looseness_fixed")),
                               number_from(l.at("missed_volume")), l.at("bare_area"), l.at("gap"),
                               number_from(l.at("protrusion_worst")), number_from(l.at("protrusion_mean"))});
    }
    cell.samples.push_back(std::move(sample));
  }
  return cell;
}

}  // namespace morula::cli
