// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/gltf/animation.hpp"

#include <algorithm>
#include <cmath>
#include <morula/geometry/reproducible.hpp>

#include "parallel/interruption.hpp"

namespace morula::gltf {
using namespace detail;
namespace {

using Quaternion = std::array<double, 4>;

// The same for a quaternion of any length; none for zero.
AffineTransform rotation_of(const Quaternion& q) {
  const auto [x, y, z, w] = q;
  const double squared = x * x + y * y + z * z + w * w;
  if (!(squared > 0)) return {};
  const double s = 2 / squared;
  return {{Vec3{1 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)},
           Vec3{s * (x * y - w * z), 1 - s * (x * x + z * z), s * (y * z + w * x)},
           Vec3{s * (x * z + w * y), s * (y * z - w * x), 1 - s * (x * x + y * y)}},
          {}};
}

AffineTransform local(const Node& node, const Pose& pose) {
  if (node.has_matrix) return node.matrix;
  AffineTransform t = rotation_of(pose.rotation);
  t.columns[0] *= pose.scale.x;
  t.columns[1] *= pose.scale.y;
  t.columns[2] *= pose.scale.z;
  t.translation = pose.translation;
  return t;
}

// Interpolates the shorter way round from a to b.
Quaternion between(const Quaternion& a, Quaternion b, double u) {
  double cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  if (cosine < 0) {
    cosine = -cosine;
    for (double& part : b) part = -part;
  }
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  double of_a = 1 - u, of_b = u;
  constexpr double nearly_none = 1e-6;  // below this, and for quaternions that are not of length 1, along the chord
  if (sine > nearly_none) {
    const double angle = angle_of(sine, cosine);
    of_a = sin_cos((1 - u) * angle).sin / sine;
    of_b = sin_cos(u * angle).sin / sine;
  }
  Quaternion result;
  for (std::size_t k = 0; k < 4; ++k) result[k] = of_a * a[k] + of_b * b[k];
  return result;
}

void sample(const Channel& channel, double seconds, std::span<double> out) {
  const std::vector<double>& times = channel.times;
  const std::size_t width = channel.width;
  const bool is_cubic = channel.interpolation == Channel::Interpolation::cubic;
  // Groups of `width` numbers: one per key, or three with its tangents.
  const auto group = [&](std::size_t key, std::size_t part) {
    return std::span(channel.values).subspan(((is_cubic ? 3 : 1) * key + part) * width, width);
  };
  const std::size_t value = is_cubic ? 1 : 0;
  // The times on both sides differ, also where keys have equal times: the last of these is the one before.
  // mutant gltf-later-key: `upper_bound` -> `lower_bound`
  const auto after = static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), seconds) - times.begin());
  if (after == 0 || after == times.size() || channel.interpolation == Channel::Interpolation::step) {
    const auto key = group(after == 0 ? 0 : after - 1, value);
    std::copy(key.begin(), key.end(), out.begin());
    return;
  }
  const std::size_t before = after - 1;
  const double span = times[after] - times[before], u = (seconds - times[before]) / span;
  const auto a = group(before, value), b = group(after, value);
  if (is_cubic) {
    const auto out_tangent = group(before, 2), in_tangent = group(after, 0);
    const double u2 = u * u, u3 = u2 * u;
    for (std::size_t k = 0; k < width; ++k)
      out[k] = (2 * u3 - 3 * u2 + 1) * a[k] + span * (u3 - 2 * u2 + u) * out_tangent[k] + (3 * u2 - 2 * u3) * b[k] +
               span * (u3 - u2) * in_tangent[k];
  } else if (channel.path == Channel::Path::rotation) {
    const Quaternion q = between({a[0], a[1], a[2], a[3]}, {b[0], b[1], b[2], b[3]}, u);
    std::copy(q.begin(), q.end(), out.begin());
  } else {
    for (std::size_t k = 0; k < width; ++k) out[k] = (1 - u) * a[k] + u * b[k];
  }
}

// Inverse of the linear part by cofactors; false if there is none.
bool invert(const AffineTransform& t, AffineTransform& inverse) {
  const auto& [a, b, c] = t.columns;
  const Vec3 rows[3]{cross(b, c), cross(c, a), cross(a, b)};
  const double determinant = dot(a, rows[0]);
  if (!(std::abs(determinant) > 0) || !std::isfinite(1 / determinant)) return false;
  for (int k = 0; k < 3; ++k)
    inverse.columns[static_cast<std::size_t>(k)] = Vec3{rows[0][k], rows[1][k], rows[2][k]} * (1 / determinant);
  inverse.translation = inverse.linear(t.translation) * -1.0;
  return is_finite(inverse);
}

bool mirrors(const AffineTransform& t) {
  return dot(t.columns[0], cross(t.columns[1], t.columns[2])) < 0;
}

std::vector<Vec3> morphed(const VertexSet& set, const std::vector<double>& weights) {
  std::vector<Vec3> positions = set.positions;
  InterruptPoller poll_interrupt(1u << 16);
  for (std::size_t k = 0; k < set.targets.size(); ++k) {
    if (set.targets[k].empty() || weights[k] == 0) continue;
    for (std::size_t v = 0; v < positions.size(); ++v) {
      poll_interrupt();
      positions[v] += weights[k] * set.targets[k][v];
    }
  }
  return positions;
}

AffineTransform joint_transform(const SkinData& skin, std::size_t joint, const Moment& moment) {
  return moment.of_node[skin.joints[joint]] * skin.inverse_bind[joint];
}

std::vector<Vec3> positions_of(const Document& document, const Moment& moment, bool with_skins) {
  std::vector<Vec3> positions;
  InterruptPoller poll_interrupt(1u << 14);
  for (const std::uint32_t i : document.drawn) {
    const Node& node = document.nodes[i];
    std::vector<AffineTransform> joints;
    if (node.skin != none && with_skins)
      for (std::size_t k = 0; k < document.skins[node.skin].joints.size(); ++k)
        joints.push_back(joint_transform(document.skins[node.skin], k, moment));
    for (const VertexSet& set : document.meshes[node.mesh].vertices) {
      std::vector<Vec3> own = morphed(set, moment.weights[i]);
      for (std::size_t v = 0; v < own.size(); ++v) {
        poll_interrupt();
        if (node.skin == none) {
          own[v] = moment.of_node[i](own[v]);
        } else if (with_skins) {
          Vec3 sum{};
          for (std::uint32_t k = set.begin[v]; k < set.begin[v + 1]; ++k)
            sum += set.weights[k] * joints[set.joints[k]](own[v]);
          own[v] = sum;
        }
      }
      make_room(positions, own.size());
      positions.insert(positions.end(), own.begin(), own.end());
    }
  }
  return positions;
}

}  // namespace

Moment at_rest(const Document& document) {
  return at_time(document, {}, 0);
}

Moment at_time(const Document& document, std::span<const Channel> channels, double seconds) {
  std::vector<Pose> poses;
  Moment moment;
  for (const Node& node : document.nodes) {
    poses.push_back(node.pose);
    moment.weights.push_back(!node.weights.empty() || node.mesh == none ? node.weights
                                                                        : document.meshes[node.mesh].weights);
  }
  for (const Channel& channel : channels) {
    Pose& pose = poses[channel.node];
    std::vector<double> values(channel.width);
    sample(channel, seconds, values);
    switch (channel.path) {
      case Channel::Path::translation:
        pose.translation = {values[0], values[1], values[2]};
        break;
      case Channel::Path::rotation:
        std::copy(values.begin(), values.end(), pose.rotation.begin());
        break;
      case Channel::Path::scale:
        pose.scale = {values[0], values[1], values[2]};
        break;
      case Channel::Path::weights:
        moment.weights[channel.node] = std::move(values);
        break;
    }
  }
  moment.of_node.resize(document.nodes.size());
  for (const std::uint32_t i : document.parents_first) {
    const Node& node = document.nodes[i];
    moment.of_node[i] = local(node, poses[i]);
    if (node.parent != none) moment.of_node[i] = moment.of_node[node.parent] * moment.of_node[i];
  }
  return moment;
}

double duration(std::span<const Channel> channels) {
  double longest = 0;
  for (const Channel& channel : channels) longest = std::max(longest, channel.times.back());
  return longest;
}

Joined joined(const Document& document) {
  Joined all;
  const Moment rest = at_rest(document);
  InterruptPoller poll_interrupt(1u << 16);
  for (const std::uint32_t i : document.drawn) {
    const Node& node = document.nodes[i];
    const MeshData& mesh = document.meshes[node.mesh];
    std::vector<std::size_t> first;
    for (const VertexSet& set : mesh.vertices) {
      first.push_back(all.vertex_count);
      all.vertex_count += set.positions.size();
      if (all.vertex_count >= none) document.fail("has more vertices than 32-bit indices can tell apart");
    }
    // A node that mirrors its mesh reverses facets.
    const bool turned_over = node.skin == none && mirrors(rest.of_node[i]);
    for (const Primitive& primitive : mesh.primitives)
      for (Facet facet : primitive.facets) {
        poll_interrupt();
        make_room(all.facets);
        for (std::uint32_t& v : facet) v += static_cast<std::uint32_t>(first[primitive.vertices]);
        if (turned_over) std::swap(facet[1], facet[2]);
        all.facets.push_back(facet);
      }
  }
  return all;
}

std::vector<Vec3> posed(const Document& document, const Moment& moment) {
  return positions_of(document, moment, true);
}

std::vector<Vec3> bound(const Document& document, const Moment& moment) {
  return positions_of(document, moment, false);
}

Skin joined_skin(const Document& document) {
  Skin skin{.begin = {0}};
  InterruptPoller poll_interrupt(1u << 14);
  for (const std::uint32_t i : document.drawn) {
    const Node& node = document.nodes[i];
    const auto first_bone = static_cast<std::uint32_t>(skin.bone_count);
    for (const VertexSet& set : document.meshes[node.mesh].vertices)
      for (std::size_t v = 0; v < set.positions.size(); ++v) {
        poll_interrupt();
        if (node.skin == none) {
          skin.bones.push_back(first_bone);
          skin.weights.push_back(1);
        } else {
          for (std::uint32_t k = set.begin[v]; k < set.begin[v + 1]; ++k) {
            skin.bones.push_back(first_bone + set.joints[k]);
            skin.weights.push_back(set.weights[k]);
          }
        }
        skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
      }
    skin.bone_count += node.skin == none ? 1 : document.skins[node.skin].joints.size();
  }
  return skin;
}

std::vector<AffineTransform> bone_transforms(const Document& document, const Moment& rest, const Moment& moment) {
  std::vector<AffineTransform> transforms;
  for (const std::uint32_t i : document.drawn) {
    const Node& node = document.nodes[i];
    if (node.skin != none) {
      for (std::size_t k = 0; k < document.skins[node.skin].joints.size(); ++k)
        transforms.push_back(joint_transform(document.skins[node.skin], k, moment));
      continue;
    }
    AffineTransform back;
    if (!invert(rest.of_node[i], back))
      document.fail("node " + std::to_string(i) + " flattens its mesh: no bone can take its place");
    transforms.push_back(moment.of_node[i] == rest.of_node[i] ? AffineTransform{} : moment.of_node[i] * back);
  }
  return transforms;
}

}  // namespace morula::gltf
