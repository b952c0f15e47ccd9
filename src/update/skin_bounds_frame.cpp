// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bounds of one frame: characters are computed side by side, one per lane of a register.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <morula/update/skin_bounds.hpp>
#include <stdexcept>
#include <string>

#include "geometry/rounded_up.hpp"
#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"
#include "simd/float4.hpp"
#include "simd/processors.hpp"

namespace morula {
namespace detail {
namespace {

constexpr std::uint32_t skin_bone_words = 16, skin_bound_words = 10, most_lanes = 16;

struct SkinKernels {
  int lanes;
  void (*prepare_bones)(float* bones, std::uint32_t bone_count, float reach, float* size);
  void (*bound_cluster)(const float* bones, const float* size, const SkinBoundsCluster& cluster,
                        const SkinBoundsRow* rows, float* bounds);
};

namespace plain {

constexpr int lanes = 1;
using Wide = float;
inline Wide all(float x) {
  return x;
}
inline Wide max(Wide a, Wide b) {
  return a > b ? a : b;
}
inline Wide min(Wide a, Wide b) {
  return a < b ? a : b;
}
inline Wide root(Wide a) {
  return std::sqrt(a);
}
inline Wide load(const float* first) {
  return *first;
}
inline void store(Wide a, float* first) {
  *first = a;
}
#include "update/skin_bounds.inl"

}  // namespace plain

#define MORULA_KERNELS "update/skin_bounds.inl"
#include "simd/every_processor.inl"

constexpr KernelTable<SkinKernels> skin_table{MORULA_EVERY_KIND(skin_kernels)};

// The transforms of some characters in float, number by number; lanes without a character repeat the last one.
void narrow_transforms(std::span<const AffineTransform> transforms, std::size_t bone_count, std::size_t lanes,
                       float* bones) {
  const std::size_t characters = transforms.size() / bone_count;
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const AffineTransform* of_character = transforms.data() + std::min(lane, characters - 1) * bone_count;
    for (std::size_t b = 0; b < bone_count; ++b) {
      const AffineTransform& t = of_character[b];
      float* out = bones + b * skin_bone_words * lanes + lane;
      const auto write = [&](const Vec3& v) {
        for (int axis = 0; axis < 3; ++axis, out += lanes) *out = static_cast<float>(v[axis]);
      };
      for (const Vec3& column : t.columns) write(column);
      write(t.translation);
    }
  }
}

// One character's bounds of one cluster, and what they add to those of the whole.
struct WholeBounds {
  Boxf box{};
  bool is_empty = true;

  void add(const Boxf& other) {
    box = is_empty ? other : Boxf{min(box.lower, other.lower), max(box.upper, other.upper)};
    is_empty = false;
  }
};

}  // namespace
}  // namespace detail
using namespace detail;

namespace {

// About the middle of the box: no larger than needed for its corners, or for the spheres.
Spheref sphere_around(const Boxf& box, std::span<const Spheref> spheres, std::span<const SkinBoundsCluster> clusters) {
  const Vec3 middle = (Vec3(box.lower) + Vec3(box.upper)) * 0.5;
  const Vec3f center(middle);
  double farthest = 0;
  for (std::size_t k = 0; k < spheres.size(); ++k)
    if (clusters[k].row_count != 0)
      farthest =
          std::max(farthest, distance(Vec3(center), Vec3(spheres[k].center)) + static_cast<double>(spheres[k].radius));
  const double corner = length(max(Vec3(box.upper) - Vec3(center), Vec3(center) - Vec3(box.lower)));
  return {center, rounded_up(std::min(farthest, corner) * (1 + 0x1p-48))};
}

}  // namespace

Status SkinBounds::bounds(std::span<const AffineTransform> transforms, const SkinBoundsOutput& output,
                          Workers& workers) {
  const StandardFloats standard;
  const std::size_t bones = bone_count(), clusters = cluster_count();
  if (bones == 0 || transforms.size() % bones != 0) return {.code = Status::Code::wrong_transform_count};
  const std::size_t characters = transforms.size() / bones;
  const auto require = [](std::size_t have, std::size_t wanted, const char* what) {
    if (have != 0 && have != wanted)
      throw std::invalid_argument("there is room for " + std::to_string(have) + " " + what + ", not for " +
                                  std::to_string(wanted));
  };
  require(output.spheres.size(), characters * clusters, "spheres");
  require(output.boxes.size(), characters * clusters, "boxes");
  require(output.whole_spheres.size(), characters, "spheres of whole meshes");
  require(output.whole_boxes.size(), characters, "boxes of whole meshes");
  if (!output.whole_spheres.empty() && output.spheres.empty())
    throw std::invalid_argument("spheres of whole meshes need the spheres of clusters");
  for (std::size_t k = 0; k < transforms.size(); ++k) {
    const AffineTransform& t = transforms[k];
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis)
      sum = std::max(sum, std::abs(t.columns[0][axis]) + std::abs(t.columns[1][axis]) + std::abs(t.columns[2][axis]));
    const double size = sum * std::max(1.0, static_cast<double>(data_.reach)) + max_norm(t.translation);
    if (!is_finite(t) || !(size <= static_cast<double>(data_.largest_size)))
      return {.code = Status::Code::bad_transform, .index = k};
  }
  const SkinKernels& kernels = skin_table.widest();
  const auto lanes = static_cast<std::size_t>(kernels.lanes);
  const std::size_t groups = (characters + lanes - 1) / lanes;
  const std::size_t slots = std::min<std::size_t>(groups, workers.thread_count());
  const std::size_t words = bones * skin_bone_words * lanes;
  if (scratch_.size() < slots * words) scratch_.resize(slots * words);
  const Uninterrupted whole;
  const auto bound_group = [&](std::size_t first, float* at) {
    const std::size_t count = std::min(lanes, characters - first);
    narrow_transforms(transforms.subspan(first * bones, count * bones), bones, lanes, at);
    alignas(64) float size[most_lanes], bounds[most_lanes * skin_bound_words];
    WholeBounds wholes[most_lanes];
    kernels.prepare_bones(at, static_cast<std::uint32_t>(bones), data_.reach, size);
    for (std::size_t k = 0; k < clusters; ++k) {
      const SkinBoundsCluster& cluster = data_.clusters[k];
      if (cluster.row_count == 0)
        std::fill(std::begin(bounds), std::end(bounds), 0.0f);
      else
        kernels.bound_cluster(at, size, cluster, data_.rows.data() + cluster.first_row, bounds);
      for (std::size_t lane = 0; lane < count; ++lane) {
        const float* b = bounds + lane;
        const std::size_t place = (first + lane) * clusters + k;
        if (!output.spheres.empty()) output.spheres[place] = {{b[0], b[lanes], b[2 * lanes]}, b[3 * lanes]};
        const Boxf box{{b[4 * lanes], b[5 * lanes], b[6 * lanes]}, {b[7 * lanes], b[8 * lanes], b[9 * lanes]}};
        if (!output.boxes.empty()) output.boxes[place] = box;
        if (cluster.row_count != 0) wholes[lane].add(box);
      }
    }
    for (std::size_t lane = 0; lane < count; ++lane) {
      if (!output.whole_boxes.empty()) output.whole_boxes[first + lane] = wholes[lane].box;
      if (!output.whole_spheres.empty())
        output.whole_spheres[first + lane] = sphere_around(
            wholes[lane].box, output.spheres.subspan((first + lane) * clusters, clusters), data_.clusters);
    }
  };
  parallel_for(workers, slots, 1, [&](std::size_t slot, std::size_t) {
    for (std::size_t g = slot; g < groups; g += slots) bound_group(g * lanes, scratch_.data() + slot * words);
  });
  return {};
}

}  // namespace morula
