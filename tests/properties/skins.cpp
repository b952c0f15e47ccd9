// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "skins.hpp"

#include <algorithm>
#include <cmath>

#include "shapes.hpp"

namespace morula::properties {
namespace {

Vec3 any_vector(Dice& dice) {
  return {dice.uniform(-1, 1), dice.uniform(-1, 1), dice.uniform(-1, 1)};
}

enum class Weights { smooth, joint, rough, sparse, negative, loose, one, kinds };

double weight_of(Weights kind, std::size_t k, const Vec3& place, Dice& dice) {
  switch (kind) {
    case Weights::joint:
      return k > 1 ? 0 : std::abs(static_cast<double>(k) - std::clamp(0.5 + 2 * place.x, 0.0, 1.0));
    case Weights::rough:
      return dice.uniform(0.01, 1);
    case Weights::sparse:
      return dice.chance(0.5) ? 0 : dice.logarithmic(1e-300, 1);
    case Weights::negative:
      return dice.uniform(-1, 1);
    default:
      return 1.1 + std::sin(static_cast<double>(3 * k) + 4 * place.x + 2 * place.y - place.z);
  }
}

AffineTransform turn_about(const Vec3& center, double angle, Dice& dice) {
  const Vec3 axis = normalized(any_vector(dice));
  AffineTransform t;
  for (Vec3& e : t.columns)
    e = e * std::cos(angle) + cross(axis, e) * std::sin(angle) + axis * (dot(axis, e) * (1 - std::cos(angle)));
  t.translation = center - t.linear(center);
  return t;
}

// About the center; the last kinds also push the body away.
AffineTransform any_transform(std::size_t kind, const Vec3& center, double size, Dice& dice) {
  AffineTransform t = turn_about(center, dice.logarithmic(1e-9, 3.2), dice);
  if (kind == 1) return {};
  if (kind == 2) t.columns[0] = -t.columns[0];
  if (kind == 3) t.columns[2] = t.columns[1];
  if (kind == 4) t.columns = {};
  if (kind == 5) t.columns[1] += t.columns[0] * dice.uniform(-20, 20);
  const double stretch = kind == 6 ? dice.logarithmic(1e-20, 1e9) : 1;
  for (Vec3& column : t.columns) column *= stretch;
  const double push = kind == 7 ? dice.logarithmic(1e-9, 1e9) : kind > 7 ? 1 : 0;
  t.translation = center - t.linear(center) + any_vector(dice) * (push * size);
  return t;
}

}  // namespace

Skin random_skin(const Mesh& mesh, Dice& dice) {
  Skin skin{.bone_count = static_cast<std::size_t>(dice.between(1, 9)), .begin = {0}};
  const auto kind = static_cast<Weights>(dice.below(static_cast<std::size_t>(Weights::kinds)));
  const std::size_t count = kind == Weights::one ? 1 : static_cast<std::size_t>(dice.between(1, 8));
  const std::vector<bool> used = used_vertices(mesh);
  const Box box = bounding_box(mesh);
  const double size = std::max(box.diagonal(), 1e-9);
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3 place = used[v] ? (mesh.positions[v] - box.center()) / size : Vec3{};
    const bool is_ordered = kind == Weights::smooth || kind == Weights::joint || kind == Weights::loose;
    std::vector<double> weights;
    double sum = 0;
    for (std::size_t k = 0; k < count; ++k) {
      weights.push_back(weight_of(kind, k, place, dice));
      skin.bones.push_back(static_cast<std::uint32_t>((is_ordered ? k : dice.below(1000)) % skin.bone_count));
      sum += weights.back();
    }
    // Far from zero, so that no weight becomes large.
    if (sum < 0.1) weights[0] += 2, sum += 2;
    const double wanted = kind == Weights::loose ? 1 + dice.uniform(-9e-7, 9e-7) : 1;
    for (const double weight : weights) skin.weights.push_back(weight / sum * wanted);
    skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
  }
  return skin;
}

std::vector<AffineTransform> random_transforms(const Mesh& mesh, std::size_t bones, Dice& dice) {
  constexpr std::size_t kinds = 10;
  const Box box = bounding_box(mesh);
  const Vec3 center = dice.chance(0.8) ? box.center() : Vec3{};
  const double size = std::max(box.diagonal(), 1e-9);
  const std::size_t of_all = dice.below(kinds);
  const bool are_mixed = dice.chance(0.5);
  std::vector<AffineTransform> transforms;
  for (std::size_t b = 0; b < bones; ++b)
    transforms.push_back(any_transform(are_mixed ? dice.below(kinds) : of_all, center, size, dice));
  if (dice.chance(0.1)) transforms.assign(bones, transforms[0]);
  return transforms;
}

double largest_term(const Mesh& mesh, const std::vector<AffineTransform>& transforms) {
  const std::vector<bool> used = used_vertices(mesh);
  double reach = 0, largest = 0;
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v]) reach = std::max(reach, max_norm(mesh.positions[v]));
  for (const AffineTransform& t : transforms) {
    double sum = max_norm(t.translation);
    for (const Vec3& column : t.columns) sum += (1 + max_norm(column)) * reach;
    largest = std::max(largest, sum);
  }
  return largest;
}

}  // namespace morula::properties
