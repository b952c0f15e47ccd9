// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "evaluator_texts.hpp"

#include <evaluators/skin_bounds.h>

#include <cstring>

#include "shader_types.hpp"

extern "C" skin_bounds skin_bounds_in_c(const skin_bounds_cluster*, const skin_bounds_row*, float, const float*);
extern "C" skin_bounds skin_bounds_morphed_in_c(const skin_bounds_cluster*, const skin_bounds_row*, float, const float*,
                                                const skin_bounds_target*, uint32_t, const float*);

namespace morula::test {
namespace glsl {

using namespace shader;
#include "skin_bounds_glsl.inl"

const SkinBoundsData* data = nullptr;
const std::vector<float>* bones = nullptr;

mat4 matrix_of(const float* m) {
  return {{m[0], m[4], m[8], 0}, {m[1], m[5], m[9], 0}, {m[2], m[6], m[10], 0}, {m[3], m[7], m[11], 1}};
}
SkinBoundsCluster skin_bounds_cluster(uint cluster) {
  const morula::SkinBoundsCluster& c = data->clusters[cluster];
  SkinBoundsCluster own;
  own.center = {c.center.x, c.center.y, c.center.z};
  own.radius = c.radius;
  own.half_extent = {c.half_extent.x, c.half_extent.y, c.half_extent.z};
  own.overhang = c.overhang;
  own.growth = c.growth;
  own.rounding = c.rounding;
  own.first_row = c.first_row;
  own.row_count = c.row_count;
  return own;
}
SkinBoundsRow skin_bounds_row(uint row) {
  const morula::SkinBoundsRow& r = data->rows[row];
  SkinBoundsRow own;
  own.bone = r.bone;
  own.weight = r.weight;
  own.weight_stray = r.weight_stray;
  own.moment_stray = r.moment_stray;
  own.center = {r.center.x, r.center.y, r.center.z};
  own.radius = r.radius;
  return own;
}
mat4 skin_bounds_bone(uint bone) {
  return matrix_of(bones->data() + 12 * bone);
}

}  // namespace glsl

namespace wgsl {

using namespace shader;
struct SkinBoundsCluster;
struct SkinBoundsRow;
// Buffers of the shader.
extern const SkinBoundsCluster* skin_bounds_clusters;
extern const SkinBoundsRow* skin_bounds_rows;
extern const mat4* skin_bounds_bones;
#include "skin_bounds_wgsl.inl"
const SkinBoundsCluster* skin_bounds_clusters = nullptr;
const SkinBoundsRow* skin_bounds_rows = nullptr;
const mat4* skin_bounds_bones = nullptr;
// Without the padding that a buffer has in neither language: the structures are those of the library, word for word.
static_assert(sizeof(SkinBoundsCluster) == sizeof(morula::SkinBoundsCluster));
static_assert(sizeof(SkinBoundsRow) == sizeof(morula::SkinBoundsRow));
static_assert(sizeof(SkinBoundsTarget) == sizeof(morula::SkinBoundsTarget));

}  // namespace wgsl

namespace {

template <class Result>
Evaluated as_evaluated(const Result& found) {
  return {{{found.sphere.x, found.sphere.y, found.sphere.z}, found.sphere.w},
          {{found.lower.x, found.lower.y, found.lower.z}, {found.upper.x, found.upper.y, found.upper.z}}};
}

std::vector<SkinBoundsTarget> targets_of(const SkinBoundsData& data, std::uint32_t cluster) {
  if (data.target_count == 0) return {};
  const auto at = [&](std::uint32_t k) { return data.targets.begin() + data.target_begin[k]; };
  return {at(cluster), at(cluster + 1)};
}

template <class To, class From>
std::vector<To> same_words(const std::vector<From>& from) {
  std::vector<To> to(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) std::memcpy(static_cast<void*>(&to[i]), &from[i], sizeof(To));
  return to;
}

}  // namespace

Evaluated evaluated_in_c(const SkinBoundsData& data, std::uint32_t cluster, const std::vector<float>& bones,
                         const std::vector<float>& morphs) {
  const auto clusters = same_words<skin_bounds_cluster>(data.clusters);
  const auto rows = same_words<skin_bounds_row>(data.rows);
  const auto targets = same_words<skin_bounds_target>(targets_of(data, cluster));
  const skin_bounds found =
      morphs.empty() ? skin_bounds_in_c(&clusters[cluster], rows.data(), data.reach, bones.data())
                     : skin_bounds_morphed_in_c(&clusters[cluster], rows.data(), data.reach, bones.data(),
                                                targets.data(), static_cast<uint32_t>(targets.size()), morphs.data());
  return {{{found.center[0], found.center[1], found.center[2]}, found.radius},
          {{found.lower[0], found.lower[1], found.lower[2]}, {found.upper[0], found.upper[1], found.upper[2]}}};
}

Evaluated evaluated_in_glsl(const SkinBoundsData& data, std::uint32_t cluster, const std::vector<float>& bones,
                            const std::vector<float>& morphs) {
  glsl::data = &data;
  glsl::bones = &bones;
  if (morphs.empty()) return as_evaluated(glsl::skin_bounds(cluster, data.reach));
  glsl::SkinBoundsMorph morph = glsl::skin_bounds_no_morph();
  for (const glsl::SkinBoundsTarget& t : same_words<glsl::SkinBoundsTarget>(targets_of(data, cluster)))
    morph = glsl::skin_bounds_add_target(morph, t, morphs[t.target]);
  return as_evaluated(glsl::skin_bounds_morphed(cluster, data.reach, morph));
}

Evaluated evaluated_in_wgsl(const SkinBoundsData& data, std::uint32_t cluster, const std::vector<float>& bones,
                            const std::vector<float>& morphs) {
  const auto clusters = same_words<wgsl::SkinBoundsCluster>(data.clusters);
  const auto rows = same_words<wgsl::SkinBoundsRow>(data.rows);
  std::vector<shader::mat4> matrices;
  for (std::size_t i = 0; i < bones.size(); i += 12) matrices.push_back(glsl::matrix_of(&bones[i]));
  wgsl::skin_bounds_clusters = clusters.data();
  wgsl::skin_bounds_rows = rows.data();
  wgsl::skin_bounds_bones = matrices.data();
  if (morphs.empty()) return as_evaluated(wgsl::skin_bounds(cluster, data.reach));
  wgsl::SkinBoundsMorph morph{};
  for (const wgsl::SkinBoundsTarget& t : same_words<wgsl::SkinBoundsTarget>(targets_of(data, cluster)))
    morph = wgsl::skin_bounds_add_target(morph, t, morphs[t.target_number]);
  return as_evaluated(wgsl::skin_bounds_morphed(cluster, data.reach, morph));
}

}  // namespace morula::test
