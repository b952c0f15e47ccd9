// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenario query: queries of builders and measures, in and around the box of a mesh, compared with brute force.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/query/signed_distance.hpp>
#include <scenes/brute_force.hpp>

#include "scenario.hpp"

namespace morula::bench {
namespace {

// Brute force looks at every facet: of all questions only these many, spread over the points, are checked twice.
constexpr std::size_t checked_balls = 64;

/// Uniform in the box grown by a tenth of its diagonal; the radii reach from the surface to a twentieth of it.
std::vector<Sphere> balls_about(const Mesh& mesh, std::size_t count) {
  const Box box = bounding_box(mesh);
  const double margin = 0.1 * box.diagonal();
  Random random(1);
  std::vector<Sphere> balls(count);
  for (Sphere& ball : balls) {
    for (int axis = 0; axis < 3; ++axis)
      ball.center[axis] = random.uniform(box.lower[axis] - margin, box.upper[axis] + margin);
    ball.radius = random.uniform(0.0, 0.05 * box.diagonal());
  }
  return balls;
}

/// Times answer(ball) over all balls, then has agrees(ball, answer) look at some of them.
template <class Answer, class Agrees>
Result run_query(std::string item, const Input& input, const std::vector<Sphere>& balls, const Settings& settings,
                 const Answer& answer, const Agrees& agrees) {
  using Value = decltype(answer(balls.front()));
  Result result{.scenario = "query", .item = std::move(item), .mesh = input.name};
  std::vector<Value> answers(balls.size());
  result.seconds = timed(settings, [&] {
    parallel_for(*settings.workers, balls.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) answers[i] = answer(balls[i]);
    });
  });
  const std::size_t step = std::max<std::size_t>(1, balls.size() / checked_balls);
  std::size_t wrong = 0, checked = 0;
  for (std::size_t i = 0; i < balls.size(); i += step, ++checked) wrong += !agrees(balls[i], answers[i]);
  if (wrong > 0)
    result.faults.push_back(std::to_string(wrong) + " of " + std::to_string(checked) +
                            " answers differ from brute force");
  result.figures = {{"questions", static_cast<double>(balls.size())},
                    {"ns/question", 1e9 * median(result.seconds) / static_cast<double>(balls.size())}};
  return result;
}

}  // namespace

std::vector<Result> run_query(const Input& input, const Settings& settings) {
  const Mesh& mesh = input.mesh;
  const std::vector<Sphere> balls = balls_about(mesh, settings.questions);
  const bool has_volume = inspect(mesh).has_volume();
  std::vector<Result> results;

  Result construction{.scenario = "query", .item = "make the index", .mesh = input.name};
  construction.seconds = timed(settings, [&] { TriangleBvh(mesh, *settings.workers); });
  const SignedDistance object(mesh, *settings.workers);
  const TriangleBvh& bvh = object.bvh();
  construction.expect(bvh.facet_count() == mesh.facet_count(), "facets are missing");
  construction.figures = {{"ns/facet", 1e9 * median(construction.seconds) / static_cast<double>(mesh.facet_count())}};
  results.push_back(std::move(construction));

  struct Closest {
    std::uint32_t facet;
    double squared_distance;
  };
  results.push_back(run_query(
      "closest point", input, balls, settings,
      [&](const Sphere& ball) {
        const auto found = bvh.closest_point(ball.center);
        return found ? Closest{found->facet, found->squared_distance} : Closest{~0u, -1.0};
      },
      [&](const Sphere& ball, const Closest& found) {
        const ClosestFacetPoint expected = brute_force::closest_point(mesh, ball.center);
        return found.facet == expected.facet && found.squared_distance == expected.squared_distance;
      }));

  results.push_back(run_query(
      "winding number", input, balls, settings, [&](const Sphere& ball) { return bvh.winding_number(ball.center); },
      [&](const Sphere& ball, double found) {
        return std::abs(found - brute_force::winding_number(mesh, ball.center)) < 0.05;
      }));

  results.push_back(run_query(
      "facets touching a ball", input, balls, settings,
      [&](const Sphere& ball) {
        thread_local std::vector<std::uint32_t> facets;
        bvh.facets_touching(ball, facets);
        // As one number: the list and its order.
        std::uint64_t hash = facets.size();
        for (const std::uint32_t f : facets) hash = (hash ^ f) * 0x100000001b3u;
        return hash;
      },
      [&](const Sphere& ball, std::uint64_t found) {
        const std::vector<std::uint32_t> facets = brute_force::facets_touching(mesh, ball);
        std::uint64_t hash = facets.size();
        for (const std::uint32_t f : facets) hash = (hash ^ f) * 0x100000001b3u;
        return found == hash;
      }));
  if (!has_volume) return results;

  const double inside = signed_volume(mesh) > 0 ? 1.0 : -1.0;
  results.push_back(run_query(
      "signed distance", input, balls, settings, [&](const Sphere& ball) { return object(ball.center); },
      [&](const Sphere& ball, double found) {
        const bool is_inside = inside * brute_force::winding_number(mesh, ball.center) > 0.5;
        const double distance = std::sqrt(brute_force::closest_point(mesh, ball.center).squared_distance);
        return std::abs(found) == distance && (found < 0) == is_inside;
      }));

  // Brute force samples the ball: a few hundred points for each, so the comparison is a coarse one.
  constexpr std::size_t samples = 400;
  results.push_back(run_query(
      "volume inside", input, balls, settings, [&](const Sphere& ball) { return inside_volume(object, ball); },
      [&](const Sphere& ball, double found) {
        const double share = found / volume(ball);
        const double expected = brute_force::inside_volume(mesh, ball, samples) / volume(ball);
        const double deviation = std::sqrt(std::max(share * (1 - share), 1e-3) / static_cast<double>(samples));
        return std::abs(share - expected) <= 5 * deviation;
      }));
  return results;
}

}  // namespace morula::bench
