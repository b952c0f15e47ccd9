// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenario modal: the rule `modal` with either bound, and `exact` on the positions of the same modal model.
#include <cmath>
#include <morula/accuracy/measure.hpp>
#include <morula/generators/build.hpp>
#include <morula/update/body.hpp>
#include <numbers>

#include "scenario.hpp"

namespace morula::bench {
namespace {

constexpr std::size_t most_modes = 20;
constexpr std::size_t modal_frames = 9;

// Bending across the first axis, bending across the second, twist; then the same with one half wave more. Displacements
// of a unit coordinate are about a tenth of the body's length.
Modes bending_and_twist(const Mesh& mesh, std::size_t mode_count) {
  const Box box = bounding_box(mesh);
  const double size = box.upper.x - box.lower.x;
  Modes modes{mesh.vertex_count(), mode_count, {}};
  for (std::size_t j = 0; j < mode_count; ++j) {
    const double wave = std::numbers::pi * static_cast<double>(1 + j / 3);
    for (const Vec3& p : mesh.positions) {
      const double s = std::sin(wave * (p.x - box.lower.x) / size), c = std::cos(wave * (p.x - box.lower.x) / size);
      const Vec3 y{-0.1 * wave * c * p.y, 0.1 * size * s, 0}, z{-0.1 * wave * c * p.z, 0, 0.1 * size * s};
      modes.displacements.push_back(j % 3 == 0 ? y : j % 3 == 1 ? z : Vec3{0, -0.5 * s * p.z, 0.5 * s * p.y});
    }
  }
  return modes;
}

// Out and back, higher modes less: the first and the last frame are at rest.
std::vector<double> coordinates_of(std::size_t frame, std::size_t mode_count) {
  const double amplitude = std::sin(std::numbers::pi * static_cast<double>(frame) / (modal_frames - 1));
  std::vector<double> q;
  for (std::size_t j = 0; j < mode_count; ++j) {
    const double sign = j % 2 == 0 ? 1 : -0.8;
    q.push_back(frame + 1 == modal_frames ? 0 : amplitude * sign / static_cast<double>((1 + j / 3) * (1 + j / 3)));
  }
  return q;
}

double leaf_looseness(const Mesh& mesh, const Body& body, Workers& workers) {
  const SphereTree tree = body.current_tree();
  const VoxelGrid grid{.kind = VoxelGrid::Kind::fixed, .voxel_edge = bounding_box(mesh).diagonal() / 192};
  return looseness(mesh, level_set_spheres(tree, tree.level_count() - 1), grid, workers)
      .looseness.value_or(std::nan(""));
}

Result modal_by(const std::string& item, const UpdateOptions& options, const Input& input, const CoveredTree& model,
                const Settings& settings) {
  Result result{.scenario = "modal", .item = item, .mesh = input.name};
  Body body(input.mesh, model, options, *settings.workers);

  // What the timed frames have to reproduce, found on one thread.
  std::vector<std::vector<double>> frames;
  std::vector<std::uint64_t> hashes;
  std::vector<Sphere> spheres;
  UpdateStatus status;
  Mesh moved = input.mesh;
  double loosest = 0;
  for (std::size_t f = 0; f < modal_frames; ++f) {
    frames.push_back(coordinates_of(f, options.modes.mode_count));
    status = body.update_modal(frames.back());
    result.expect(static_cast<bool>(status), "an update was rejected");
    hashes.push_back(body.hash());
    move_by_modes(options.modes, input.mesh.positions, frames.back(), moved.positions);
    body.copy_spheres(spheres);
    result.expect(certify(body.cover(), moved.positions, spheres, *settings.workers).covered,
                  "surface outside the spheres");
    if (f == modal_frames / 2) loosest = leaf_looseness(moved, body, *settings.workers);
  }
  result.expect(hashes.front() == hashes.back(), "back at rest the spheres are not those of rest");

  bool same = true;
  timed(settings, [&] {
    for (std::size_t f = 0; f < frames.size(); ++f) {
      result.seconds.push_back(seconds_of([&] { require(body.update_modal(frames[f], *settings.workers)); }));
      same = same && body.hash() == hashes[f];
    }
  });
  result.expect(same, "other spheres than on one thread, or than before");
  const double nodes = static_cast<double>(status.nodes_updated);
  result.figures = {{"ns/sphere", 1e9 * median(result.seconds) / nodes},
                    {"spheres", nodes},
                    {"vertices read", static_cast<double>(status.vertices_read)},
                    {"leaf looseness farthest out", loosest}};
  return result;
}

}  // namespace

std::vector<Result> run_modal(const Input& input, const Settings& settings) {
  const CoveredTree model = build(input.mesh, tree_options(settings), *settings.workers);
  std::vector<Result> results;
  for (const std::size_t modes : {std::size_t{1}, std::size_t{5}, most_modes}) {
    UpdateOptions options{.rules = {Rule::modal}, .modes = bending_and_twist(input.mesh, modes)};
    const std::string count = ", " + std::to_string(modes) + (modes == 1 ? " mode" : " modes");
    options.details.modal_bound = RuleOptions::ModalBound::shift;
    results.push_back(modal_by("modal, shift" + count, options, input, model, settings));
    options.details.modal_bound = RuleOptions::ModalBound::gradient;
    results.push_back(modal_by("modal, gradient" + count, options, input, model, settings));
    options.rules = {Rule::exact};
    results.push_back(modal_by("exact" + count, options, input, model, settings));
  }
  return results;
}

}  // namespace morula::bench
