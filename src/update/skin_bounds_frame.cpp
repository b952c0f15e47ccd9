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
constexpr double largest_morph = 0x1p127;  // in the range of float

// The characters that are computed side by side, number by number.
struct SkinFrame {
  float* bones;
  float* morphs;   // none: all are 0
  float* size;     // of the transforms
  float* row_sum;  // largest sum of |entries| of a row of the transforms, and at least 1
};

// Not spans, whose functions the kernels of each kind of processor would share.
struct SkinRows {
  const SkinBoundsRow *begin, *end;
};
struct SkinTargets {
  const SkinBoundsTarget *begin, *end;
};

struct SkinKernels {
  int lanes;
  void (*prepare_bones)(float* bones, std::uint32_t bone_count, float reach, float* size);
  void (*largest_row_sums)(const float* bones, std::uint32_t bone_count, float* result);
  void (*bound_cluster)(const SkinFrame& frame, const SkinBoundsCluster& cluster, const SkinRows& rows, float* bounds);
  void (*bound_morphed_cluster)(const SkinFrame& frame, const SkinBoundsCluster& cluster, const SkinRows& rows,
                                const SkinTargets& targets, float* bounds);
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

// The morphs of some characters in float, number by number.
void narrow_morphs(std::span<const double> morphs, std::size_t target_count, std::size_t lanes, float* out) {
  const std::size_t characters = morphs.size() / target_count;
  for (std::size_t j = 0; j < target_count; ++j)
    for (std::size_t lane = 0; lane < lanes; ++lane)
      *out++ = static_cast<float>(morphs[std::min(lane, characters - 1) * target_count + j]);
}

SkinTargets targets_of(const SkinBoundsData& data, std::size_t cluster) {
  const SkinBoundsTarget* all = data.targets.data();
  return {all + data.target_begin[cluster], all + data.target_begin[cluster + 1]};
}

// The box around the boxes of a character's clusters.
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

Status SkinBounds::check(std::span<const AffineTransform> transforms, std::span<const double> morphs) const {
  const std::size_t bones = bone_count(), targets = target_count();
  if (!morphs.empty() && morphs.size() != transforms.size() / bones * targets)
    return {.code = Status::Code::wrong_coordinate_count};
  for (std::size_t j = 0; j < morphs.size(); ++j)
    if (!(std::abs(morphs[j]) <= largest_morph))
      return {.code = Status::Code::bad_coordinate, .index = static_cast<std::uint32_t>(j)};
  const double limit = static_cast<double>(data_.largest_size), reach = std::max(1.0, static_cast<double>(data_.reach));
  double largest = 0, row_sum = 1;  // of a character
  for (std::size_t k = 0; k < transforms.size(); ++k) {
    if (k % bones == 0) largest = 0, row_sum = 1;
    const AffineTransform& t = transforms[k];
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis)
      sum = std::max(sum, std::abs(t.columns[0][axis]) + std::abs(t.columns[1][axis]) + std::abs(t.columns[2][axis]));
    const double size = sum * reach + max_norm(t.translation);
    if (!is_finite(t) || !(size <= limit)) return {.code = Status::Code::bad_transform, .index = k};
    largest = std::max(largest, size), row_sum = std::max(row_sum, sum);
    if (morphs.empty() || k % bones != bones - 1) continue;
    const std::span<const double> own = morphs.subspan(k / bones * targets, targets);
    const auto travel = [&](std::size_t j) { return std::abs(own[j]) * travels_[j]; };
    double sum_of_travels = 0;
    std::size_t farthest = 0;
    for (std::size_t j = 0; j < targets; ++j) {
      sum_of_travels += travel(j);
      if (travel(j) > travel(farthest)) farthest = j;
    }
    if (!(largest + sum_of_travels * row_sum <= limit))
      return {.code = Status::Code::bad_coordinate,
              .index = static_cast<std::uint32_t>(k / bones * targets + farthest)};
  }
  return {};
}

Status SkinBounds::bounds(std::span<const AffineTransform> transforms, const SkinBoundsOutput& output,
                          Workers& workers) {
  return bounds(transforms, {}, output, workers);
}

Status SkinBounds::bounds(std::span<const AffineTransform> transforms, std::span<const double> morphs,
                          const SkinBoundsOutput& output, Workers& workers) {
  const StandardFloats standard;
  const std::size_t bones = bone_count(), clusters = cluster_count(), targets = target_count();
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
  if (const Status status = check(transforms, morphs); !status) return status;
  const SkinKernels& kernels = skin_table.widest();
  const auto lanes = static_cast<std::size_t>(kernels.lanes);
  const std::size_t groups = (characters + lanes - 1) / lanes;
  const std::size_t slots = std::min<std::size_t>(groups, workers.thread_count());
  const bool has_whole = !output.whole_spheres.empty() || !output.whole_boxes.empty();
  const std::size_t bone_words = bones * skin_bone_words * lanes;
  const std::size_t words = bone_words + (morphs.empty() ? 0 : targets * lanes);
  if (scratch_.size() < slots * words) scratch_.resize(slots * words);
  const Uninterrupted whole;
  const auto bound_group = [&](std::size_t first, float* at) {
    const std::size_t count = std::min(lanes, characters - first);
    narrow_transforms(transforms.subspan(first * bones, count * bones), bones, lanes, at);
    alignas(64) float size[most_lanes], row_sum[most_lanes], bounds[most_lanes * skin_bound_words];
    WholeBounds wholes[most_lanes];
    kernels.prepare_bones(at, static_cast<std::uint32_t>(bones), data_.reach, size);
    const SkinFrame frame{at, morphs.empty() ? nullptr : at + bone_words, size, row_sum};
    if (frame.morphs != nullptr) {
      narrow_morphs(morphs.subspan(first * targets, count * targets), targets, lanes, frame.morphs);
      kernels.largest_row_sums(at, static_cast<std::uint32_t>(bones), row_sum);
    }
    for (std::size_t k = 0; k < clusters; ++k) {
      const SkinBoundsCluster& cluster = data_.clusters[k];
      const SkinBoundsRow* first_row = data_.rows.data() + cluster.first_row;
      const SkinRows rows{first_row, first_row + cluster.row_count};
      const SkinTargets moving = frame.morphs == nullptr ? SkinTargets{} : targets_of(data_, k);
      if (cluster.row_count == 0)
        std::fill(std::begin(bounds), std::end(bounds), 0.0f);
      else if (moving.begin == moving.end)
        kernels.bound_cluster(frame, cluster, rows, bounds);
      else
        kernels.bound_morphed_cluster(frame, cluster, rows, moving, bounds);
      for (std::size_t lane = 0; lane < count; ++lane) {
        const float* b = bounds + lane;
        const std::size_t place = (first + lane) * clusters + k;
        if (!output.spheres.empty()) output.spheres[place] = {{b[0], b[lanes], b[2 * lanes]}, b[3 * lanes]};
        const Boxf box{{b[4 * lanes], b[5 * lanes], b[6 * lanes]}, {b[7 * lanes], b[8 * lanes], b[9 * lanes]}};
        if (!output.boxes.empty()) output.boxes[place] = box;
        if (has_whole && cluster.row_count != 0) wholes[lane].add(box);
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
