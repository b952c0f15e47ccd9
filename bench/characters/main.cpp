// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula_characters: covers skinned characters by the rule `skinned`, verifies the cover in every frame of their
// animations and in random poses, and compares radii and times with the rule `exact` and with a box per joint.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <morula/geometry/reproducible.hpp>
#include <morula/io/skin_file.hpp>
#include <morula/morula.hpp>
#include <nlohmann/json.hpp>
#include <numbers>
#include <toolbox/stopwatch.hpp>

#include "judge.hpp"
#include "peers.hpp"

namespace morula::characters {
namespace {

struct Character {
  Mesh mesh;
  Skin skin;
  std::vector<BoneFrames> animations;
};

Character read(const std::string& mesh_file, const std::string& skin_file, const std::string& bones_file,
               std::size_t animations) {
  Character character;
  if (constexpr std::string_view prefix = "sample:"; mesh_file.starts_with(prefix)) {
    constexpr int resolution = 64;
    constexpr std::size_t frames = 25;
    character.mesh = sample_body(std::string_view(mesh_file).substr(prefix.size()), resolution);
    character.skin = sample_skin(character.mesh.positions);
    character.animations = {{character.skin.bone_count, sample_bones(character.mesh.positions, frames)}};
    return character;
  }
  MeshInfo info;
  MeshWeld weld;
  const bool is_gltf = skin_file.empty();
  character.mesh = is_gltf ? read_mesh(mesh_file, info, weld) : read_mesh(mesh_file);
  character.skin = is_gltf ? read_skin(mesh_file, character.mesh, weld) : read_skin(skin_file, character.mesh);
  for (std::size_t i = 0; i < animations; ++i)
    character.animations.push_back(
        read_bone_frames(bones_file.empty() ? mesh_file : bones_file, character.skin.bone_count, {.animation = i}));
  return character;
}

/// The value below which a share of the values lies; 0 without values.
double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Rounds a time in microseconds, or a ratio, for the report.
double rounded(double value) {
  return std::round(value * 1e4) / 1e4;
}

/// The covers that were checked, and those that were bare by either judge.
struct Verdict {
  std::size_t frames = 0, judged = 0, bare = 0;
  double worst = -HUGE_VAL;

  void check(const Body& body, const std::vector<Vec3>& positions) {
    const Certificate certificate = body.certify(positions);
    ++frames;
    bare += !certificate.covered;
    worst = std::max(worst, certificate.worst_excess);
  }
  void judge(const Body& body, const Character& character, std::span<const AffineTransform> transforms) {
    const double excess = largest_excess(body, character.mesh, character.skin, transforms);
    ++judged;
    bare += !(excess <= 0);
    worst = std::max(worst, excess);
  }
};

/// Radii and times over all frames of the animations.
struct Comparison {
  std::vector<double> leaf_ratios, measured_ratios, inner_ratios, root_ratios, box_ratios, joint_box_ratios;
  std::vector<double> skinned_us, measured_us, exact_us, joint_box_us;
  std::size_t joint_boxes_bare = 0;  ///< frames in which the boxes per joint miss a vertex

  nlohmann::json json() const {
    return {{"frames", skinned_us.size()},
            {"leaf_median", rounded(quantile(leaf_ratios, 0.5))},
            {"leaf_95", rounded(quantile(leaf_ratios, 0.95))},
            {"leaf_largest", rounded(quantile(leaf_ratios, 1))},
            {"measured_median", rounded(quantile(measured_ratios, 0.5))},
            {"measured_95", rounded(quantile(measured_ratios, 0.95))},
            {"measured_largest", rounded(quantile(measured_ratios, 1))},
            {"measured_us", rounded(quantile(measured_us, 0.5))},
            {"inner_largest", rounded(quantile(inner_ratios, 1))},
            {"root", rounded(quantile(root_ratios, 0.5))},
            {"box", rounded(quantile(box_ratios, 0.5))},
            {"joint_boxes", rounded(quantile(joint_box_ratios, 0.5))},
            {"joint_boxes_bare", joint_boxes_bare},
            {"skinned_us", rounded(quantile(skinned_us, 0.5))},
            {"exact_us", rounded(quantile(exact_us, 0.5))},
            {"joint_boxes_us", rounded(quantile(joint_box_us, 0.5))}};
  }
};

/// The smallest of three times of a call, in microseconds.
template <class Call>
double microseconds(const Call& call) {
  double least = HUGE_VAL;
  for (int repeat = 0; repeat < 3; ++repeat) {
    toolbox::Stopwatch stopwatch;
    call();
    least = std::min(least, stopwatch.lap() * 1e6);
  }
  return least;
}

/// A body by bones alone, one with measured nodes, and one by all vertices.
struct Bodies {
  Body skinned, measured, exact;
};

void compare(const Bodies& bodies, const JointBoxes& joints, std::span<const AffineTransform> transforms,
             const std::vector<Vec3>& positions, Comparison& into) {
  const SphereTree& tree = bodies.skinned.rest_tree();
  for (std::uint32_t node = 0; node < tree.node_count(); ++node) {
    const double exact = bodies.exact.sphere(node).radius, ratio = bodies.skinned.sphere(node).radius / exact;
    if (!std::isfinite(ratio)) continue;
    if (tree.is_leaf(node)) {
      into.leaf_ratios.push_back(ratio);
      into.measured_ratios.push_back(bodies.measured.sphere(node).radius / exact);
    } else
      into.inner_ratios.push_back(ratio);
    if (node == 0) into.root_ratios.push_back(ratio);
  }
  Box points, spheres;
  for (const std::uint32_t v : joints.used_vertices()) points.add(positions[v]);
  for (std::uint32_t node = 0; node < tree.node_count(); ++node) {
    const Sphere s = bodies.skinned.sphere(node);
    if (!tree.is_leaf(node)) continue;
    spheres.add(s.center - Vec3{s.radius, s.radius, s.radius});
    spheres.add(s.center + Vec3{s.radius, s.radius, s.radius});
  }
  const Box boxes = joints.box(transforms);
  into.box_ratios.push_back(spheres.diagonal() / points.diagonal());
  into.joint_box_ratios.push_back(boxes.diagonal() / points.diagonal());
  const double allowance = 1e-9 * boxes.diagonal();
  into.joint_boxes_bare += std::any_of(joints.used_vertices().begin(), joints.used_vertices().end(), [&](auto v) {
    return squared_distance(boxes, positions[v]) > allowance * allowance;
  });
}

Comparison run_animations(const Character& character, Bodies& bodies, Verdict& verdict, std::size_t max_frames) {
  Comparison comparison;
  const JointBoxes joints(character.mesh, character.skin);
  std::vector<Vec3> positions(character.mesh.vertex_count());
  for (const BoneFrames& animation : character.animations)
    for (std::size_t i = 0; i < std::min(max_frames, animation.frame_count()); ++i) {
      const auto transforms = animation.frame(i);
      bool good = true;
      comparison.skinned_us.push_back(microseconds([&] { good &= bool(bodies.skinned.update_skinned(transforms)); }));
      comparison.measured_us.push_back(microseconds([&] { good &= bool(bodies.measured.update_skinned(transforms)); }));
      comparison.exact_us.push_back(microseconds([&] { good &= bool(bodies.exact.update_skinned(transforms)); }));
      double sum = 0;  // keeps the call
      comparison.joint_box_us.push_back(microseconds([&] { sum += joints.box(transforms).lower.x; }));
      good &= std::isfinite(sum);
      if (!good) throw std::runtime_error("a frame was rejected");
      move_by_skin(character.skin, character.mesh.positions, transforms, positions);
      for (const Body* body : {&bodies.skinned, &bodies.measured}) {
        verdict.check(*body, positions);
        if (i % 8 == 0) verdict.judge(*body, character, transforms);
      }
      compare(bodies, joints, transforms, positions, comparison);
    }
  return comparison;
}

Vec3 any_vector(Random& random, double size) {
  return {size * random.uniform(-1, 1), size * random.uniform(-1, 1), size * random.uniform(-1, 1)};
}

/// Rotations about points of the body, affine maps of any kind, mirrored and flat maps, and maps far away.
AffineTransform any_transform(Random& random, const Box& rest, int kind) {
  const double size = rest.diagonal();
  AffineTransform t;
  if (kind < 2) {
    const double largest = kind == 0 ? 0.5 : std::numbers::pi;
    const RigidTransform r = RigidTransform::from_axis(any_vector(random, 1), random.uniform(-largest, largest));
    t.columns = {r.rotate({1, 0, 0}), r.rotate({0, 1, 0}), r.rotate({0, 0, 1})};
    const Vec3 joint = rest.center() + any_vector(random, size / 2);
    t.translation = joint - t.linear(joint);
    return t;
  }
  for (Vec3& column : t.columns) column = any_vector(random, kind == 3 ? 50 : 1);
  if (kind == 4) t.columns = {Vec3{-1, 0, 0}, Vec3{0, random.uniform(0, 50), 0}, Vec3{}};
  t.translation = any_vector(random, size * (kind == 3 ? 1e6 : 1));
  return t;
}

void run_random(const Character& character, Bodies& bodies, std::size_t poses, std::uint64_t seed, Verdict& verdict) {
  Random random(seed);
  const Box rest = bounding_box(character.mesh);
  std::vector<AffineTransform> transforms(character.skin.bone_count);
  std::vector<Vec3> positions(character.mesh.vertex_count());
  for (std::size_t pose = 0; pose < poses; ++pose) {
    const int kind = static_cast<int>(pose % 6);
    for (AffineTransform& t : transforms)
      t = any_transform(random, rest, kind == 5 ? static_cast<int>(random.next() % 5) : kind);
    if (pose % 7 == 0) transforms[random.next() % transforms.size()] = {};
    // Every fourth pose goes to the body with measured nodes.
    Body& body = pose % 4 == 3 ? bodies.measured : bodies.skinned;
    if (!body.update_skinned(transforms)) throw std::runtime_error("a random pose was rejected");
    move_by_skin(character.skin, character.mesh.positions, transforms, positions);
    verdict.check(body, positions);
    if (pose % 64 == 0) verdict.judge(body, character, transforms);
  }
}

/// Some 20 frames, evenly over the animations.
std::vector<AffineTransform> training_of(const Character& character) {
  constexpr std::size_t wanted = 20;
  std::size_t frames = 0, number = 0;
  for (const BoneFrames& animation : character.animations) frames += animation.frame_count();
  std::vector<AffineTransform> training;
  for (const BoneFrames& animation : character.animations)
    for (std::size_t i = 0; i < animation.frame_count(); ++i)
      if (number++ % std::max<std::size_t>(1, frames / wanted) == 0)
        training.insert(training.end(), animation.frame(i).begin(), animation.frame(i).end());
  return training;
}

nlohmann::json sizes_of(const Character& character) {
  const Skin& skin = character.skin;
  std::size_t most = 0;
  for (std::size_t v = 0; v < skin.vertex_count(); ++v)
    most = std::max<std::size_t>(most, skin.begin[v + 1] - skin.begin[v]);
  return {{"vertices", character.mesh.vertex_count()},
          {"facets", character.mesh.facets.size()},
          {"bones", skin.bone_count},
          {"influences", most}};
}

int run(int argc, char** argv) {
  CLI::App app{"Covers a skinned character by its bones, and verifies the cover in every frame.", "morula_characters"};
  std::string mesh_file, skin_file, bones_file, peer_file;
  std::size_t animations = 1, poses = 1000, max_frames = 1000;
  std::uint64_t seed = 1;
  bool sizes = false;
  double budget = 0.2;
  app.add_option("MESH", mesh_file, "mesh at rest; .gltf and .glb have the skin also; sample:NAME for a sample body")
      ->required();
  app.add_option("--skin", skin_file, "weights, a .npy of shape (vertices, bones)");
  app.add_option("--bones", bones_file, "transforms, a .npy of shape (frames, bones, 3, 4)");
  app.add_flag("--sizes", sizes, "prints sizes only");
  app.add_option("--animations", animations, "animations of the file to run, from the first on (default 1)");
  app.add_option("--frames", max_frames, "most frames of an animation (default 1000)");
  app.add_option("--budget", budget, "RuleOptions::skinned_measured of the second body (default 0.2)");
  app.add_option("--poses", poses, "random poses (default 1000)");
  app.add_option("--seed", seed, "seed of the random poses (default 1)");
  app.add_option("--peer", peer_file, "writes mesh, skin and frames for another program: little-endian numbers");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  const Character character = read(mesh_file, skin_file, bones_file, animations);
  nlohmann::json row = sizes_of(character);
  if (sizes) {
    fmt::print("{}\n", row.dump());
    return 0;
  }
  const auto model = std::make_shared<const CoveredTree>(build(character.mesh));
  UpdateOptions by_bones{.rules = {Rule::skinned}, .skin = character.skin}, measured = by_bones;
  measured.training = training_of(character);
  measured.details.skinned_measured = measured.training.empty() ? 0 : budget;
  Bodies bodies{Body(character.mesh, model, by_bones), Body(character.mesh, model, measured),
                Body(character.mesh, model, {.rules = {Rule::exact}, .skin = character.skin})};
  if (!peer_file.empty()) write_peer_file(peer_file, character.mesh, character.skin, character.animations);
  Verdict animated, random;
  row.update(run_animations(character, bodies, animated, max_frames).json());
  run_random(character, bodies, poses, seed, random);
  row.update({{"nodes_measured", bodies.measured.bind_report().nodes_measured},
              {"spheres", model->tree.node_count()},
              {"poses", random.frames},
              {"judged", animated.judged + random.judged},
              {"bare", animated.bare + random.bare},
              {"worst_excess", std::max(animated.worst, random.worst)}});
  fmt::print("{}\n", row.dump());
  return animated.bare + random.bare == 0 ? 0 : 1;
}

}  // namespace
}  // namespace morula::characters

int main(int argc, char** argv) {
  try {
    return morula::characters::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "morula_characters: {}\n", error.what());
    return 2;
  }
}
