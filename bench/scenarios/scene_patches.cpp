// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenario scene-patches: contact patches of 200 bodies that move and bend, in a millisecond of queries and to the end.
// In every frame the crossings of a scene without a budget are looked up: each must be in a facet of a patch, or in a
// contact of its pair.
#include <algorithm>
#include <cmath>
#include <memory>
#include <morula/geometry/reproducible.hpp>
#include <morula/scene/scene.hpp>
#include <morula/update/body.hpp>
#include <numbers>
#include <optional>
#include <span>

#include "frames.hpp"
#include "resources.hpp"
#include "scenario.hpp"

namespace morula::bench {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t mover_count = 200;

struct Mover {
  Body body;
  Collider collider;
  Vec3 middle, axis;
  double phase;
  Mover(const Mesh& mesh, const CoveredTree& model, Random& random, const Vec3& at)
      : body(mesh, model),
        collider(mesh, body),
        middle(at),
        axis{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)},
        phase(random.uniform(0, 6)) {}
};

bool lists(std::span<const std::uint32_t> facets, std::uint32_t facet) {
  return std::find(facets.begin(), facets.end(), facet) != facets.end();
}
bool lists(std::span<const PatchFacet> facets, std::uint32_t facet) {
  return std::any_of(facets.begin(), facets.end(), [&](const PatchFacet& f) { return f.facet == facet; });
}

bool is_found(const Crossing& crossing, const ScenePair& pair, const Collider& a, const Collider& b) {
  if (pair.has_patches)
    return std::any_of(pair.patches.begin(), pair.patches.end(), [&](const ContactPatch& patch) {
      return lists(patch.a.facets, crossing.facet_a) && lists(patch.b.facets, crossing.facet_b);
    });
  const Vec3 middle = (crossing.segment.from + crossing.segment.to) * 0.5;
  return std::any_of(pair.contacts.begin(), pair.contacts.end(), [&](const Contact& c) {
    return distance(middle, c.point) <= c.error_bound * (1 + 1e-9) && lists(a.facets(c.node_a), crossing.facet_a) &&
           lists(b.facets(c.node_b), crossing.facet_b);
  });
}

Result patches_of_many(const Input& input, const Settings& settings, std::optional<Budget> budget, const char* item) {
  Result result{.scenario = "scene-patches", .item = item, .mesh = input.name};
  const CoveredTree model = build(input.mesh, {}, *settings.workers);
  const std::vector<Frame> frames = bend_and_back(input.mesh);
  const double size = bounding_box(input.mesh).diagonal();
  Random random(1);
  std::vector<std::unique_ptr<Mover>> movers;
  SceneOptions options{.patches = true};
  if (budget) options.budget = *budget;
  Scene scene(options), whole({.find_crossings = true});
  for (std::size_t i = 0; i < mover_count; ++i) {
    const Vec3 at{static_cast<double>(i % 6), static_cast<double>(i / 6 % 6), static_cast<double>(i / 36)};
    movers.push_back(std::make_unique<Mover>(input.mesh, model, random, at * (0.5 * size)));
  }
  std::size_t lost = 0, crossings = 0, crossing_pairs = 0, with_patches = 0, complete = 0, frame = 0, late = 0;
  timed(settings, [&] {
    for (std::size_t f = 0; f < frames.size(); ++f, ++frame) {
      for (std::size_t i = 0; i < movers.size(); ++i) {
        Mover& m = *movers[i];
        require(m.body.update(frames[(f + 7 * i) % frames.size()], *settings.workers));
        const double t = 2 * std::numbers::pi * static_cast<double>(f) / static_cast<double>(frames.size()) + m.phase;
        const Vec3 sway{std::sin(t), std::cos(t), std::sin(2 * t)};
        m.collider.set_transform(RigidTransform::from_axis(m.axis, t, m.middle + sway * (0.05 * size)));
        if (frame == 0) scene.add(m.collider, {.user_data = i}), whole.add(m.collider);
      }
      // The first frame makes memory.
      if (frame == 0) result.expect(static_cast<bool>(scene.update(*settings.workers)), "the scene was rejected");
      SceneStatus status;
      result.seconds.push_back(seconds_of([&] { status = scene.update(*settings.workers); }));
      result.expect(static_cast<bool>(status), "the scene was rejected");
      late += result.seconds.back() > 1.1e-3;
      require(whole.update(*settings.workers));
      bool all = true;
      for (const ScenePair& truth : whole.pairs()) {
        if (truth.crossings.empty()) continue;
        const ScenePair* const pair = scene.find(truth.a, truth.b);
        ++crossing_pairs;
        if (pair != nullptr && pair->has_patches)
          ++with_patches;
        else
          all = false;
        crossings += truth.crossings.size();
        for (const Crossing& crossing : truth.crossings)
          lost += pair == nullptr || !is_found(crossing, *pair, scene.collider(truth.a), scene.collider(truth.b));
      }
      complete += all;
    }
  });
  const auto count = static_cast<double>(result.seconds.size());
  result.expect(lost == 0, std::to_string(lost) + " crossings are neither in a patch nor in a contact");
  result.expect(crossing_pairs > 0, "nothing crosses");
  std::vector<double> sorted = result.seconds;
  std::sort(sorted.begin(), sorted.end());
  result.figures = {
      {"crossing pairs", static_cast<double>(crossing_pairs) / count},
      {"crossings", static_cast<double>(crossings) / count},
      {"share of pairs with patches", static_cast<double>(with_patches) / static_cast<double>(crossing_pairs)},
      {"share of frames with all", static_cast<double>(complete) / count},
      {"share within 1.1 ms", 1 - static_cast<double>(late) / count},
      {"99.9 % us", 1e6 * sorted[static_cast<std::size_t>(0.999 * static_cast<double>(sorted.size() - 1))]}};
  return result;
}

}  // namespace

std::vector<Result> run_scene_patches(const Input& input, const Settings& settings) {
  std::vector<Result> results;
  results.push_back(patches_of_many(input, settings, Budget(1ms), "200 bodies, 1 ms"));
  results.push_back(patches_of_many(input, settings, std::nullopt, "200 bodies, to the end"));
  return results;
}

}  // namespace morula::bench
