// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Load and growth: memory over many bodies and frames, and time over bodies of up to ten million facets.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <morula/accuracy/measure.hpp>
#include <morula/collide/contact_query.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/update/body.hpp>
#include <optional>

#include "resources.hpp"
#include "scenario.hpp"

#ifndef _WIN32
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#endif

namespace morula::bench {
namespace {

// A body that sways, turns and swells, each in its own rhythm.
class Swaying {
 public:
  Swaying(const Mesh& mesh, std::shared_ptr<const CoveredTree> model, std::size_t number)
      : mesh_(&mesh),
        body_(mesh, std::move(model)),
        collider_(mesh, body_),
        positions_(mesh.vertex_count()),
        rhythm_(0.05 + 0.0007 * static_cast<double>(number % 97)) {
    RigidTransform place;
    place.translation = {2.2 * static_cast<double>(number % 40), 2.2 * static_cast<double>(number / 40), 0};
    collider_.set_transform(place);
  }
  // The collider has the addresses of its body and its positions.
  Swaying(const Swaying&) = delete;
  Swaying& operator=(const Swaying&) = delete;

  bool move(std::size_t frame) {
    const auto t = rhythm_ * static_cast<double>(frame);
    const SinCos sway = sin_cos(std::fmod(t, 628.0)), other = sin_cos(std::fmod(1.7 * t, 628.0));
    const Vec3 grow{1 + 0.3 * sway.sin, 1 + 0.25 * other.sin, 1 - 0.3 * sway.sin};
    for (std::size_t v = 0; v < positions_.size(); ++v) {
      const Vec3& p = mesh_->positions[v];
      positions_[v] = Vec3f(grow.x * p.x + 0.2 * other.cos * p.y * p.y, grow.y * p.y, grow.z * p.z + 0.1 * sway.cos);
    }
    if (!body_.update(positions_)) return false;
    collider_.set_positions(positions_);
    return true;
  }
  // Is a random point of the surface in some sphere of each level? By nothing but distances.
  bool covers_somewhere(Random& random) const {
    const Facet& facet = mesh_->facets[random.next() % mesh_->facet_count()];
    double u = random.uniform(), v = random.uniform();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const auto at = [&](int k) { return Vec3(positions_[facet[k]]); };
    const Vec3 point = at(0) + (at(1) - at(0)) * u + (at(2) - at(0)) * v;
    const SphereTree& tree = body_.rest_tree();
    for (std::size_t level = 0; level < tree.level_count(); ++level) {
      bool is_covered = false;
      for (std::uint32_t node = 0; node < tree.level_begin[level + 1] && !is_covered; ++node) {
        if (node < tree.level_begin[level] && !tree.is_leaf(node)) continue;
        const Sphere s = body_.sphere(node);
        // The point itself is rounded, some 1e-16 of coordinates below 4.
        is_covered = distance(s.center, point) <= s.radius + 1e-14;
      }
      if (!is_covered) return false;
    }
    return true;
  }
  bool is_certified() const {
    std::vector<Sphere> spheres;
    body_.copy_spheres(spheres);
    return certify(body_.cover(), positions_, spheres).covered;
  }
  const Collider& collider() const { return collider_; }

 private:
  const Mesh* mesh_;
  Body body_;
  Collider collider_;
  std::vector<Vec3f> positions_;
  double rhythm_;
};

// A stage of a body's life, in a process of its own, so that its memory is measured apart from that of others.
struct Stage {
  const char* name;
  /// What is timed, after `prepare`; returns whether the result is right.
  std::function<double(const Mesh&, Result&)> run;
};

double built_by(const Mesh& mesh, const BuildOptions& options, Result& result) {
  CoveredTree model;
  const double seconds = processor_seconds_of([&] { model = build(mesh, options, serial_workers()); });
  result.expect(certify(model.cover, mesh.positions, model.tree.spheres).covered, "surface outside the spheres");
  result.expect(model.tree.leaf_count() > 64, "hardly divided");
  return seconds;
}

std::vector<Stage> stages() {
  const BuildOptions octree{.method = Method::octree};
  return {
      {"info",
       [](const Mesh& mesh, Result& result) {
         MeshReport report;
         const double seconds = processor_seconds_of([&] { report = inspect(mesh); });
         result.expect(report.closed && report.oriented, "not closed");
         return seconds;
       }},
      {"octree", [=](const Mesh& mesh, Result& result) { return built_by(mesh, octree, result); }},
      {"grid", [](const Mesh& mesh, Result& result) { return built_by(mesh, {.method = Method::grid}, result); }},
      {"morula fast",
       [](const Mesh& mesh, Result& result) { return built_by(mesh, {.quality = Quality::fast}, result); }},
      {"validate",
       [=](const Mesh& mesh, Result& result) {
         const CoveredTree model = build(mesh, octree);
         return processor_seconds_of([&] { result.expect(validate(mesh, model).empty(), "faults"); });
       }},
      {"body",
       [=](const Mesh& mesh, Result& result) {
         CoveredTree model = build(mesh, octree);
         std::optional<Body> body;
         const double seconds = processor_seconds_of([&] { body.emplace(mesh, std::move(model)); });
         result.expect(body->spheres().size() > 64, "hardly divided");
         return seconds;
       }},
      {"update",
       [=](const Mesh& mesh, Result& result) {
         Body body(mesh, build(mesh, octree));
         std::vector<Vec3f> positions;
         for (const Vec3& p : mesh.positions) positions.emplace_back(1.2 * p.x, 0.8 * p.y + 0.1 * p.x * p.x, p.z);
         require(body.update(positions));
         const double seconds = processor_seconds_of([&] { require(body.update(positions)); });
         std::vector<Sphere> spheres;
         body.copy_spheres(spheres);
         result.expect(certify(body.cover(), positions, spheres).covered, "surface outside the spheres");
         return seconds;
       }},
      {"measure",
       [=](const Mesh& mesh, Result& result) {
         const CoveredTree model = build(mesh, octree);
         std::vector<LevelMeasure> levels;
         const double seconds = processor_seconds_of([&] { levels = measure(mesh, model.tree, {}, serial_workers()); });
         for (const LevelMeasure& level : levels) result.expect(level.coverage.covered, "surface is uncovered");
         return seconds;
       }},
  };
}

#ifndef _WIN32

struct Outcome {
  double seconds = 0;
  std::size_t faults = 0;
};

// Seconds and faults of a stage, and the most memory that its process had. Nothing when it did not end by itself.
std::optional<std::pair<Outcome, double>> in_a_process(const Mesh& mesh, const Stage& stage) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) return std::nullopt;
  const pid_t child = fork();
  if (child == 0) {
    Result result{.scenario = "growth", .item = stage.name, .mesh = ""};
    Outcome outcome;
    try {
      outcome.seconds = stage.run(mesh, result);
      outcome.faults = result.faults.size();
    } catch (const std::exception& error) {
      fmt::print(stderr, "{}: {}\n", stage.name, error.what());
      _exit(1);
    }
    _exit(write(ends[1], &outcome, sizeof outcome) == sizeof outcome ? 0 : 1);
  }
  close(ends[1]);
  Outcome outcome;
  const bool has_outcome = child > 0 && read(ends[0], &outcome, sizeof outcome) == sizeof outcome;
  close(ends[0]);
  int status = 0;
  rusage usage{};
  if (child < 0 || wait4(child, &status, 0, &usage) != child || status != 0 || !has_outcome) return std::nullopt;
  return std::pair(outcome, 1024.0 * static_cast<double>(usage.ru_maxrss));
}

#endif

}  // namespace

std::vector<Result> run_load(std::size_t body_count, std::size_t frames, const Settings& settings) {
  const Mesh mesh = sample_body("limb", 7);
  const auto model = std::make_shared<const CoveredTree>(build(mesh, {.method = Method::octree, .depth = 2}));
  std::vector<std::unique_ptr<Swaying>> bodies;
  for (std::size_t i = 0; i < body_count; ++i) bodies.push_back(std::make_unique<Swaying>(mesh, model, i));
  // Neighbors in rows touch now and then: fronts come, shrink and go.
  ContactQuery query({.budget = 4000});
  for (std::size_t i = 0; i + 1 < body_count; i += 10) query.add(bodies[i]->collider(), bodies[i + 1]->collider());

  Result result{.scenario = "load",
                .item = fmt::format("{} bodies, {} frames", body_count, frames),
                .mesh = fmt::format("limb of {} facets, {} nodes", mesh.facet_count(), model->tree.node_count())};
  Random random(1);
  std::size_t uncovered = 0, rejected = 0, not_certified = 0, samples = 0, contacts = 0;
  // Queries settle what they keep within the first frames.
  const std::size_t settled = frames / 10;
  std::optional<std::size_t> heap_before, memory_before;
  std::size_t memory_most = 0;
  const double wall = seconds_of([&] {
    for (std::size_t frame = 0; frame < frames; ++frame) {
      const double seconds = processor_seconds_of([&] {
        for (const auto& body : bodies) rejected += !body->move(frame);
      });
      result.seconds.push_back(seconds);
      const ContactStatus status = frame == 0 ? query.start(*settings.workers) : query.carry(*settings.workers);
      rejected += !status;
      contacts += query.contacts().contacts.size();
      for (int k = 0; k < 20; ++k, ++samples)
        uncovered += !bodies[random.next() % body_count]->covers_somewhere(random);
      not_certified += !bodies[frame % body_count]->is_certified();
      if (frame == settled) heap_before = allocated_bytes(), memory_before = resident_bytes();
      if (frame > settled && frame % 50 == 0) memory_most = std::max(memory_most, resident_bytes().value_or(0));
    }
  });
  const std::optional<std::size_t> heap_after = allocated_bytes();
  result.expect(rejected == 0, fmt::format("{} updates or queries rejected", rejected));
  result.expect(uncovered == 0, fmt::format("{} of {} points uncovered", uncovered, samples));
  result.expect(not_certified == 0, fmt::format("{} frames not certified", not_certified));
  const double count = static_cast<double>(body_count);
  result.figures = {{"us/body", 1e6 * median(result.seconds) / count},
                    {"wall seconds", wall},
                    {"points sampled", static_cast<double>(samples)},
                    {"frames certified", static_cast<double>(frames - not_certified)},
                    {"contacts/frame", static_cast<double>(contacts) / static_cast<double>(frames)}};
  constexpr double mib = 1 << 20;
  if (heap_before && heap_after) {
    const double gained = (static_cast<double>(*heap_after) - static_cast<double>(*heap_before)) / mib;
    result.figures.push_back({"heap grew by MiB", gained});
    // What is kept per frame in this report, and vectors of contacts that reach a new largest size.
    result.expect(gained < 1, "the heap grows");
  }
  if (memory_before) {
    const double before = static_cast<double>(*memory_before) / mib;
    result.figures.push_back({"memory MiB", before});
    result.figures.push_back({"at most later MiB", static_cast<double>(memory_most) / mib});
    result.expect(static_cast<double>(memory_most) / mib < before + 2, "memory grows");
  }
  return {result};
}

std::vector<Result> run_growth(std::size_t most_facets, const Settings&) {
  std::vector<Result> results;
#ifdef _WIN32
  (void)most_facets;
#else
  for (std::size_t facets = 10'000; facets <= most_facets; facets *= 10) {
    // A blob has 1.7 × resolution² facets.
    const int resolution = static_cast<int>(std::lround(std::sqrt(static_cast<double>(facets) / 1.7)));
    const Mesh mesh = sample_body("blob", resolution);
    for (const Stage& stage : stages()) {
      Result result{.scenario = "growth",
                    .item = fmt::format("{} of {}", stage.name, mesh.facet_count()),
                    .mesh = fmt::format("blob:{}", resolution)};
      const auto done = in_a_process(mesh, stage);
      result.expect(done.has_value(), "its process did not end well");
      if (done) {
        const auto& [outcome, memory] = *done;
        result.seconds = {outcome.seconds};
        result.expect(outcome.faults == 0, fmt::format("{} faults", outcome.faults));
        const double count = static_cast<double>(mesh.facet_count());
        result.figures = {
            {"us/facet", 1e6 * outcome.seconds / count}, {"peak MB", 1e-6 * memory}, {"bytes/facet", memory / count}};
      }
      results.push_back(std::move(result));
    }
  }
#endif
  return results;
}

}  // namespace morula::bench
