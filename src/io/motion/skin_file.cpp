// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <morula/io/skin_file.hpp>
#include <morula/io/whole_output.hpp>
#include <stdexcept>

#include "io/array/npy.hpp"
#include "io/gltf/skin.hpp"
#include "io/mesh/formats.hpp"
#include "io/motion/array_motion.hpp"
#include "io/whole_file.hpp"
#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"
#include "platform/path_text.hpp"

namespace morula {
using namespace detail;
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_bones = 0xffffff;

/// The weights of one vertex, one per bone, add up to 1 as far as a file may say so.
bool is_row(std::span<const double> row, double& sum) {
  constexpr double tolerance = 1e-3;
  sum = 0;
  for (const double weight : row) sum += weight;
  return std::abs(sum - 1) <= tolerance;
}
std::string text_of_sum(std::size_t vertex, double sum) {
  return "the weights of vertex " + std::to_string(vertex) + " add up to " + std::to_string(sum) + ", not to 1";
}
std::string text_of_transform(std::size_t frame, std::size_t bone) {
  return "frame " + std::to_string(frame) + ": the transform of bone " + std::to_string(bone) + " is not finite";
}

/// Throws std::invalid_argument unless every index of the skin is in range.
void require_indices(const Skin& skin) {
  if (skin.begin.empty() || skin.begin.front() != 0 || skin.begin.back() != skin.bones.size() ||
      skin.bones.size() != skin.weights.size() || !std::is_sorted(skin.begin.begin(), skin.begin.end()))
    throw std::invalid_argument("the skin's influences do not fit its vertices");
  if (skin.bone_count == 0 || skin.bone_count > most_bones)
    throw std::invalid_argument("the skin has " + std::to_string(skin.bone_count) +
                                " bones; a file of a skin has 1 to " + std::to_string(most_bones));
  for (const std::uint32_t bone : skin.bones)
    if (bone >= skin.bone_count) throw std::invalid_argument("the skin names a bone that it does not have");
}

// Checks the frames of a glTF.
BoneFrames checked(const fs::path& path, BoneFrames frames, std::size_t bone_count) {
  if (frames.bone_count != bone_count)
    throw FileError(platform::text_of(path) + ": has " + std::to_string(frames.bone_count) +
                    " bones, but the skin has " + std::to_string(bone_count));
  for (std::size_t i = 0; i < frames.transforms.size(); ++i)
    if (!is_finite(frames.transforms[i]))
      throw FileError(platform::text_of(path) + ": " + text_of_transform(i / bone_count, i % bone_count));
  const std::vector<double>& coordinates = frames.morphs.coordinates;
  for (std::size_t i = 0; i < coordinates.size(); ++i)
    if (!std::isfinite(coordinates[i]))
      throw FileError(platform::text_of(path) + ": frame " + std::to_string(i / frames.morphs.mode_count) +
                      ": the weight of morph target " + std::to_string(i % frames.morphs.mode_count) +
                      " is not finite");
  return frames;
}

}  // namespace

Skin read_skin(const fs::path& path, const MeshView& mesh) {
  const StandardFloats standard;
  if (!is_gltf(path)) return skin_of(path, mesh);
  Skin skin = gltf_skin(path);
  if (skin.vertex_count() != mesh.vertex_count())
    throw FileError(platform::text_of(path) + ": has " + std::to_string(skin.vertex_count()) +
                    " vertices, but the mesh has " + std::to_string(mesh.vertex_count()));
  return skin;
}

Skin read_skin(const fs::path& path, const MeshView& mesh, const MeshWeld& weld) {
  if (weld.old_vertex.size() != mesh.vertex_count())
    throw std::invalid_argument("the weld makes " + std::to_string(weld.old_vertex.size()) +
                                " vertices, but the mesh has " + std::to_string(mesh.vertex_count()));
  const std::vector<Vec3> of_file(weld.new_vertex.size());
  const Skin skin = read_skin(path, MeshView{of_file, mesh.facets});
  const std::vector<std::uint32_t> labels = skin_labels(skin);
  for (std::uint32_t v = 0; v < labels.size(); ++v)
    if (const std::uint32_t first = weld.old_vertex[weld.new_vertex[v]]; labels[v] != labels[first])
      throw FileError(platform::text_of(path) + ": vertices " + std::to_string(first) + " and " + std::to_string(v) +
                      " of the unwelded mesh are merged, but they have different weights");
  return skin_of_vertices(skin, weld.old_vertex);
}

BoneFrames read_bone_frames(const fs::path& path, std::size_t bone_count, const MotionOptions& options) {
  const StandardFloats standard;
  if (!is_gltf(path)) return bone_frames_of(path, bone_count);
  return checked(path, gltf_bone_frames(path, false, options), bone_count);
}

BoneFrames detail::read_morphed_bone_frames(const fs::path& path, std::size_t bone_count, std::size_t mode_count,
                                            const MotionOptions& options) {
  const StandardFloats standard;
  BoneFrames frames = is_gltf(path) ? checked(path, gltf_bone_frames(path, true, options), bone_count)
                                    : bone_frames_of(path, bone_count);
  if (frames.morphs.mode_count != mode_count)
    throw FileError(platform::text_of(path) + ": has " + std::to_string(frames.morphs.mode_count) +
                    " morph targets, but " + std::to_string(mode_count) + " are needed");
  return frames;
}

void write_skin(const fs::path& path, const Skin& skin) {
  require_indices(skin);
  std::vector<double> values(skin.vertex_count() * skin.bone_count);
  for (std::size_t v = 0; v < skin.vertex_count(); ++v) {
    const std::span<double> row = std::span(values).subspan(v * skin.bone_count, skin.bone_count);
    for (std::uint32_t i = skin.begin[v]; i < skin.begin[v + 1]; ++i) row[skin.bones[i]] += skin.weights[i];
    if (double sum = 0; !is_row(row, sum))
      throw std::invalid_argument(text_of_sum(v, sum) + "; repair them where the skin is made");
  }
  write_whole(path, npy_bytes(values, std::array{skin.vertex_count(), skin.bone_count}));
}

void write_bone_frames(const fs::path& path, const BoneFrames& frames) {
  if (frames.transforms.size() != frames.frame_count() * frames.bone_count)
    throw std::invalid_argument("the transforms are not as many in every frame as there are bones");
  if (frames.frame_count() == 0)
    throw std::invalid_argument(
        "there is no frame to write: a file of transforms has one or more, of one bone or more");
  for (std::size_t i = 0; i < frames.transforms.size(); ++i)
    if (!is_finite(frames.transforms[i]))
      throw std::invalid_argument(text_of_transform(i / frames.bone_count, i % frames.bone_count) +
                                  "; repair it where the transforms are made");
  std::vector<double> values;
  values.reserve(12 * frames.transforms.size());
  for (const AffineTransform& t : frames.transforms)
    for (int row = 0; row < 3; ++row)
      values.insert(values.end(), {t.columns[0][row], t.columns[1][row], t.columns[2][row], t.translation[row]});
  write_whole(path,
              npy_bytes(values, std::array{frames.frame_count(), frames.bone_count, std::size_t{3}, std::size_t{4}}));
}

bool detail::is_gltf(const fs::path& path) {
  const MeshFormat* const format = mesh_format(lower_extension(path));
  return format != nullptr && format->read == read_gltf;
}

Skin detail::skin_of(const ByteSource& source, const MeshView& mesh) {
  const NpyArray array = read_npy_header(source, {{mesh.vertex_count(), 0}, "(vertices, bones)"});
  const std::string name = platform::text_of(source.name());
  const std::uint64_t bone_count = array.shape[1];
  if (array.shape[0] != mesh.vertex_count() || bone_count == 0 || bone_count > most_bones)
    throw FileError(name + ": the array's shape is " + array.shape_text + ", but (" +
                    std::to_string(mesh.vertex_count()) +
                    ", bones) for the vertices of the mesh, one bone or more, is needed");
  Skin skin{.bone_count = static_cast<std::size_t>(bone_count), .begin = {0}};
  const std::vector<double> values = read_npy_values(source, array, 0, mesh.vertex_count() * skin.bone_count);
  InterruptPoller poll_interrupt(4096);
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    poll_interrupt();
    const std::span<const double> row = std::span(values).subspan(v * skin.bone_count, skin.bone_count);
    double sum = 0;
    if (!is_row(row, sum))
      throw FileError(name + ": " + text_of_sum(v, sum) + "; repair them where the array was made");
    for (std::uint32_t bone = 0; bone < skin.bone_count; ++bone) {
      if (row[bone] == 0) continue;
      skin.bones.push_back(bone);
      skin.weights.push_back(row[bone] / sum);
    }
    if (skin.bones.size() >= 0xffffffff)
      throw FileError(name + ": has more weights than 32-bit indices can tell apart");
    skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
  }
  return skin;
}

BoneFrames detail::bone_frames_of(const ByteSource& source, std::size_t bone_count) {
  const NpyArray array = read_npy_header(source, {{0, bone_count, 3, 4}, "(frames, bones, 3, 4)"});
  const std::string name = platform::text_of(source.name());
  if (array.shape[0] == 0 || array.shape[1] != bone_count || array.shape[2] != 3)
    throw FileError(name + ": the array's shape is " + array.shape_text + ", but (frames, " +
                    std::to_string(bone_count) + ", 3, 4) for the bones of the skin, one frame or more, is needed");
  BoneFrames result{bone_count, {}};
  const std::vector<double> values = read_npy_values(source, array, 0, array.shape[0] * bone_count * 12);
  InterruptPoller poll_interrupt(1u << 14);
  for (std::size_t i = 0; i < array.shape[0] * bone_count; ++i) {
    poll_interrupt();
    const std::span<const double> m = std::span(values).subspan(12 * i, 12);
    AffineTransform t;
    for (std::size_t k = 0; k < 3; ++k) t.columns[k] = {m[k], m[4 + k], m[8 + k]};
    t.translation = {m[3], m[7], m[11]};
    if (!is_finite(t))
      throw FileError(name + ": " + text_of_transform(i / bone_count, i % bone_count) +
                      "; repair it where the array was made");
    result.transforms.push_back(t);
  }
  return result;
}

}  // namespace morula
