// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenario update: every rule over a bend and back, beside the least that any rule can do, which is to read the
// vertices.
#include <cstring>
#include <memory>
#include <morula/generators/build.hpp>
#include <morula/tree/cover.hpp>
#include <morula/update/body.hpp>
#include <span>

#include "frames.hpp"
#include "resources.hpp"

namespace morula::bench {
namespace {

/// Reads every coordinate and can be vectorized, which a sum of floats cannot.
std::uint32_t xor_of_coordinates(std::span<const Vec3f> vertices) {
  const std::byte* bytes = reinterpret_cast<const std::byte*>(vertices.data());
  std::uint32_t all = 0;
  for (std::size_t i = 0; i < 3 * vertices.size(); ++i) {
    std::uint32_t bits;
    std::memcpy(&bits, bytes + 4 * i, 4);
    all ^= bits;
  }
  return all;
}

/// The same by all workers: as much as a pass over the vertices can gain by them here and now.
std::uint32_t xor_of_coordinates(const Frame& frame, Workers& workers) {
  constexpr std::size_t vertices_per_chunk = 16384;
  std::vector<std::uint32_t> chunks((frame.size() + vertices_per_chunk - 1) / vertices_per_chunk);
  parallel_for(workers, frame.size(), vertices_per_chunk, [&](std::size_t begin, std::size_t end) {
    chunks[begin / vertices_per_chunk] = xor_of_coordinates(std::span(frame).subspan(begin, end - begin));
  });
  std::uint32_t all = 0;
  for (const std::uint32_t bits : chunks) all ^= bits;
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

Result update_by(Rule rule, const Input& input, const CoveredTree& model, const std::vector<Frame>& frames,
                 double floor, const Settings& settings) {
  Result result{.scenario = "update", .item = std::string(name(rule)), .mesh = input.name};
  Body body(input.mesh, model, {.rules = {rule}}, *settings.workers);

  // What the timed frames have to reproduce, found on one thread.
  std::vector<std::uint64_t> hashes;
  std::vector<Sphere> spheres;
  UpdateStatus status;
  bool covered = true;
  for (const Frame& frame : frames) {
    status = body.update(frame);
    result.expect(static_cast<bool>(status), "an update was rejected");
    hashes.push_back(body.hash());
    body.copy_spheres(spheres);
    covered = covered && certify(body.cover(), frame, spheres, *settings.workers).covered;
  }
  // The other rules promise nothing; how much they leave uncovered is for `measure` to say.
  if (rule == Rule::exact) result.expect(covered, "surface outside the spheres");
  result.expect(hashes.front() == hashes.back(), "back at rest the spheres are not those of rest");

  bool same = true;
  result.seconds = timed_frames(settings, frames.size(), [&](std::size_t f) {
    const double seconds = seconds_of([&] { require(body.update(frames[f], *settings.workers)); });
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

/// Bodies of one model, each in another frame of the motion: a body is a chunk, so workers share bodies, not vertices.
Result twenty_bodies(const Input& input, const CoveredTree& model, const std::vector<Frame>& frames,
                     const Settings& settings) {
  constexpr std::size_t count = 20;
  Result result{.scenario = "update", .item = "20 bodies, exact", .mesh = input.name};
  const auto shared = std::make_shared<const CoveredTree>(model);
  const Body first(input.mesh, shared);
  const auto before = allocated_bytes();
  std::vector<Body> bodies(count, first);
  const auto after = allocated_bytes();
  const auto frame_of = [&](std::size_t body) -> const Frame& { return frames[body % frames.size()]; };
  const auto update_all = [&](Workers& workers) {
    parallel_for(workers, count, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) require(bodies[i].update(frame_of(i)));
    });
  };
  std::vector<std::uint64_t> alone;
  UpdateStatus status;
  for (std::size_t i = 0; i < count; ++i) {
    Body body = first;
    status = body.update(frame_of(i));
    alone.push_back(body.hash());
  }
  std::vector<double> one_thread;
  result.seconds = timed(settings, [&] {  // in turn, so that both meet the machine in the same mood
    one_thread.push_back(seconds_of([&] { update_all(serial_workers()); }));
    update_all(*settings.workers);
  });
  for (std::size_t k = 0; k < one_thread.size(); ++k) result.seconds[k] -= one_thread[k];
  for (std::size_t i = 0; i < count; ++i)
    result.expect(bodies[i].hash() == alone[i], "a body among others has other spheres than alone");

  const double vertices = static_cast<double>(count * input.mesh.vertex_count());
  result.figures = {{"threads", static_cast<double>(settings.workers->thread_count())},
                    {"ns/vertex", 1e9 * median(result.seconds) / vertices},
                    {"times one thread", median(one_thread) / median(result.seconds)},
                    {"us a body, one thread", 1e6 * median(one_thread) / count}};
  if (before && after) {
    const double bytes = static_cast<double>(*after - *before) / count;
    const double allowed = 600.0 * static_cast<double>(model.tree.node_count()) +
                           24.0 * static_cast<double>(input.mesh.vertex_count()) +
                           40.0 * static_cast<double>(status.cut_points_moved);
    result.figures.push_back({"bytes of a body", bytes});
    result.figures.push_back({"of 600 a node + 24 a vertex + 40 a cut point", bytes / allowed});
  }
  return result;
}

/// One layout of the mesh, and what moves there.
struct Runner {
  Mesh mesh;
  std::vector<Frame> frames;
  Body body;
  std::vector<std::uint64_t> hashes{};
  std::vector<double> seconds{};

  Runner(const Mesh& its_mesh, const CoveredTree& model, Rule rule)
      : mesh(its_mesh), frames(bend_and_back(mesh)), body(mesh, model, {.rules = {rule}}) {
    for (const Frame& frame : frames) require(body.update(frame)), hashes.push_back(body.hash());
  }
  bool run_all() {
    bool same = true;
    for (std::size_t f = 0; f < frames.size(); ++f) {
      seconds.push_back(processor_seconds_of([&] { require(body.update(frames[f])); }));
      same = same && body.hash() == hashes[f];
    }
    return same;
  }
};

/// Ratios between what runs in turn, a motion each, so that a machine that is busy for a while is busy for all: the
/// rule beside approach 2 in the same layout, the file's order of vertices beside the leaves', one hundredth moved
/// beside all, and one body by all threads beside one (wall time), with what reading its vertices alone gains by them.
Result side_by_side(const Input& input, const CoveredTree& model, const Settings& settings) {
  Result result{.scenario = "update", .item = "exact between others", .mesh = input.name};
  const auto order = leaf_order(model);
  const Mesh in_order = renumbered(input.mesh, order);
  const CoveredTree built_in_order = renumbered(model, in_order, order);
  Runner file(input.mesh, model, Rule::exact), file_2(input.mesh, model, Rule::approach2);
  Runner leaf(in_order, built_in_order, Rule::exact), leaf_2(in_order, built_in_order, Rule::approach2);

  // A hundredth of the vertices of each frame, another one every time, moves back and forth; a body that is updated
  // whole says what is right.
  Body changing(in_order, built_in_order), whole(in_order, built_in_order);
  Frame moving = leaf.frames[leaf.frames.size() / 2];
  const auto count = static_cast<std::uint32_t>(std::max<std::size_t>(moving.size() / 100, 1));
  require(changing.update(moving));
  std::vector<double> changed_seconds, one_thread, all_threads, reading_alone, reading_by_all;
  std::uint32_t first = 0;
  bool same = true;
  // Timed as the others are, one update after the other; judged in another round.
  const auto change_some = [&](bool is_timed) {
    for (std::size_t k = 0; k < leaf.frames.size(); ++k) {
      const VertexRange range{first, first + count};
      for (std::uint32_t v = range.begin; v < range.end; ++v) moving[v].x += k % 2 == 0 ? 1e-3f : -1e-3f;
      const double seconds = processor_seconds_of([&] { require(changing.update(moving, std::span(&range, 1))); });
      if (is_timed) changed_seconds.push_back(seconds);
      if (!is_timed || k + 1 == leaf.frames.size()) {
        require(whole.update(moving));
        same = same && whole.hash() == changing.hash();
      }
      first = (first + 7 * count) % (static_cast<std::uint32_t>(moving.size()) - count + 1);
    }
  };
  timed(settings, [&] {
    for (Runner* runner : {&leaf, &leaf_2, &file, &file_2}) same = runner->run_all() && same;
    change_some(false);
    change_some(true);
    for (std::size_t f = 0; f < leaf.frames.size(); ++f) {
      one_thread.push_back(seconds_of([&] { require(whole.update(leaf.frames[f])); }));
      all_threads.push_back(seconds_of([&] { require(leaf.body.update(leaf.frames[f], *settings.workers)); }));
      std::uint32_t alone = 0, by_all = 0;
      reading_alone.push_back(seconds_of([&] { alone = xor_of_coordinates(leaf.frames[f], serial_workers()); }));
      reading_by_all.push_back(seconds_of([&] { by_all = xor_of_coordinates(leaf.frames[f], *settings.workers); }));
      same = same && leaf.body.hash() == leaf.hashes[f] && alone == by_all;
    }
  });
  result.expect(same, "other spheres than before, than on one thread, or than of a whole update");

  const auto over = [](const std::vector<double>& a, const std::vector<double>& b) { return median(a) / median(b); };
  result.seconds = leaf.seconds;
  result.figures = {{"ns/vertex, leaf order", nanoseconds_per_vertex(leaf.seconds, in_order)},
                    {"times approach2, leaf order", over(leaf.seconds, leaf_2.seconds)},
                    {"times approach2, file order", over(file.seconds, file_2.seconds)},
                    {"file order, times leaf order", over(file.seconds, leaf.seconds)},
                    {"1 % moved, of a whole update", over(changed_seconds, leaf.seconds)},
                    {"threads", static_cast<double>(settings.workers->thread_count())},
                    {"one body, times one thread", over(one_thread, all_threads)},
                    {"reading alone, times one thread", over(reading_alone, reading_by_all)}};
  return result;
}

}  // namespace

std::vector<Result> run_update(const Input& input, const Settings& settings) {
  const CoveredTree model = build(input.mesh, tree_options(settings), *settings.workers);
  const std::vector<Frame> frames = bend_and_back(input.mesh);
  std::vector<Result> results{floor_of_update(input, frames, settings)};
  const double floor = results.front().figures.front().value;
  for (const Rule rule : position_rules()) results.push_back(update_by(rule, input, model, frames, floor, settings));
  results.push_back(twenty_bodies(input, model, frames, settings));
  results.push_back(side_by_side(input, model, settings));
  return results;
}

}  // namespace morula::bench
