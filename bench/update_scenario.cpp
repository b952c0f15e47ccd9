// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenario update: every rule over a bend and back, beside the least that any rule can do, which is to read the
// vertices.
#include <cstring>
#include <morula/build/build.hpp>
#include <morula/update/body.hpp>

#include "frames.hpp"

namespace morula::bench {
namespace {

/// Reads every coordinate and can be vectorised, which a sum of floats cannot.
std::uint32_t xor_of_coordinates(const Frame& frame) {
  const std::byte* bytes = reinterpret_cast<const std::byte*>(frame.data());
  std::uint32_t all = 0;
  for (std::size_t i = 0; i < 3 * frame.size(); ++i) {
    std::uint32_t bits;
    std::memcpy(&bits, bytes + 4 * i, 4);
    all ^= bits;
  }
  return all;
}

Result floor_of_update(const Input& input, const std::vector<Frame>& frames, const Settings& settings) {
  Result result{.scenario = "update", .item = "read every vertex", .mesh = input.name};
  std::vector<std::uint32_t> first;
  for (const Frame& frame : frames) first.push_back(xor_of_coordinates(frame));
  bool same = true;
  result.seconds = timed_frames(settings, frames.size(), [&](std::size_t f) {
    std::uint32_t bits = 0;
    const double seconds = seconds_of([&] { bits = xor_of_coordinates(frames[f]); });
    same = same && bits == first[f];
    return seconds;
  });
  result.expect(same, "the vertices changed between repeats");
  result.figures = {{"ns/vertex", nanoseconds_per_vertex(result.seconds, input.mesh)}};
  return result;
}

Result update_by(Rule rule, const Input& input, const Built& built, const std::vector<Frame>& frames, double floor,
                 const Settings& settings) {
  Result result{.scenario = "update", .item = std::string(name(rule)), .mesh = input.name};
  Body body(input.mesh, built, {.rules = {rule}}, *settings.workers);

  // What the timed frames have to reproduce, found on one thread.
  std::vector<std::uint64_t> hashes;
  std::vector<Sphere> spheres;
  UpdateStatus status;
  bool covered = true;
  for (const Frame& frame : frames) {
    status = body.update(frame);
    result.expect(static_cast<bool>(status), "an update was refused");
    hashes.push_back(body.hash());
    body.copy_spheres(spheres);
    covered = covered && certify(body.cover(), frame, spheres, *settings.workers).covered;
  }
  // The other rules promise nothing; how much they leave bare is for `measure` to say.
  if (rule == Rule::exact) result.expect(covered, "surface outside the spheres");
  result.expect(hashes.front() == hashes.back(), "back at rest the spheres are not those of rest");

  bool same = true;
  result.seconds = timed_frames(settings, frames.size(), [&](std::size_t f) {
    const double seconds = seconds_of([&] { body.update(frames[f], *settings.workers); });
    same = same && body.hash() == hashes[f];
    return seconds;
  });
  result.expect(same, "other spheres than on one thread, or than before");

  const double per_vertex = nanoseconds_per_vertex(result.seconds, input.mesh);
  result.figures = {{"ns/vertex", per_vertex},
                    {"times the floor", per_vertex / floor},
                    {"spheres", static_cast<double>(status.nodes_updated)},
                    {"points tested", static_cast<double>(status.points_tested)},
                    {"cut points", static_cast<double>(status.cut_points_moved)},
                    {"covers all frames", covered ? 1.0 : 0.0}};
  return result;
}

}  // namespace

std::vector<Result> run_update(const Input& input, const Settings& settings) {
  const Built built = build(input.mesh, {.branching = 8, .depth = 3}, *settings.workers);
  const std::vector<Frame> frames = bend_and_back(input.mesh);
  std::vector<Result> results{floor_of_update(input, frames, settings)};
  const double floor = results.front().figures.front().value;
  for (const Rule rule : position_rules()) results.push_back(update_by(rule, input, built, frames, floor, settings));
  return results;
}

}  // namespace morula::bench
