// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// glTF 2.0 as a mesh, as frames of it, and as a skin with its bones and morph targets.
#include <cmath>
#include <morula/io/skin_bounds_file.hpp>
#include <morula/io/skin_file.hpp>
#include <stdexcept>

#include "io/gltf/animation.hpp"
#include "io/gltf/skin.hpp"
#include "io/mesh/formats.hpp"
#include "io/whole_file.hpp"
#include "parallel/float_environment.hpp"

namespace morula::detail {
namespace {

namespace fs = std::filesystem;
using gltf::Document;

constexpr std::size_t most_frames = 10'000'000;

// One animation of a document, frame by frame; without any, its nodes as stored.
class Timeline {
 public:
  Timeline(const Document& document, const MotionOptions& options) : rate_(options.frames_per_second) {
    if (!(rate_ > 0 && std::isfinite(rate_)))
      throw std::invalid_argument("frames_per_second " + std::to_string(rate_) + " is not above 0");
    if (options.animation >= document.animations.size()) {
      if (options.animation == 0) return;
      document.fail("has " + std::to_string(document.animations.size()) + " animations; there is no animation " +
                    std::to_string(options.animation) + ", counted from 0");
    }
    channels_ = document.animations[options.animation];
    // A little slack, so that a last key at 0.3 s is frame 9 at 30 a second, although 0.3 x 30 may come out lower.
    const double last = gltf::duration(channels_) * rate_ * (1 + 0x1p-20);
    if (!(last < static_cast<double>(most_frames)))
      document.fail("is " + std::to_string(gltf::duration(channels_)) + " seconds long: too many frames at " +
                    std::to_string(rate_) + " a second");
    frame_count_ = static_cast<std::size_t>(last) + 1;
  }
  std::size_t frame_count() const { return frame_count_; }
  gltf::Moment frame(const Document& document, std::size_t i) const {
    return gltf::at_time(document, channels_, static_cast<double>(i) / rate_);
  }
  std::span<const gltf::Channel> channels() const { return channels_; }

 private:
  double rate_;
  std::vector<gltf::Channel> channels_{};
  std::size_t frame_count_ = 1;
};

class GltfFrames final : public FrameSource {
 public:
  GltfFrames(const fs::path& path, const MotionOptions& options)
      : document_(gltf::read_document(path, read_whole(path))),
        timeline_(document_, options),
        joined_(gltf::joined(document_)) {}

  std::size_t frame_count() const override { return timeline_.frame_count(); }
  const std::vector<Facet>& facets() const override { return joined_.facets; }
  std::size_t vertex_count() const override { return joined_.vertex_count; }
  std::vector<Vec3> frame(std::size_t i) const override {
    const StandardFloats standard;
    std::vector<Vec3> positions = gltf::posed(document_, timeline_.frame(document_, i));
    for (std::size_t v = 0; v < positions.size(); ++v)
      if (!is_finite(positions[v]))
        document_.fail("frame " + std::to_string(i) + ": vertex " + std::to_string(v) +
                       " has a coordinate that is not finite");
    return positions;
  }

 private:
  Document document_;
  Timeline timeline_;
  gltf::Joined joined_;
};

// Throws if morph targets move vertices over time: no bone can do that.
void require_no_morphing(const Document& document, const Timeline& timeline) {
  for (const gltf::Channel& channel : timeline.channels())
    if (channel.path == gltf::Channel::Path::weights)
      document.fail("node " + std::to_string(channel.node) +
                    " is moved by morph targets, which the bones alone do not follow; read the targets with "
                    "read_modes(), and their coordinates with the overload of read_bone_frames() that takes their "
                    "number");
}

}  // namespace

Mesh read_gltf(const fs::path& path, std::string_view bytes, MeshReading& reading) {
  const Document document = gltf::read_document(path, bytes);
  if (document.drawn.empty()) document.fail("its scene has no mesh");
  reading.info.notes = document.notes;
  if (reading.wants_labels) reading.labels = gltf::vertex_labels(document);
  Mesh mesh{gltf::bound(document, gltf::at_rest(document)), gltf::joined(document).facets};
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    if (!is_finite(mesh.positions[v]))
      document.fail("vertex " + std::to_string(v) + " has a coordinate that is not finite");
  return mesh;
}

std::shared_ptr<const FrameSource> open_gltf_frames(const fs::path& path, const MotionOptions& options) {
  return std::make_shared<GltfFrames>(path, options);
}

Skin gltf_skin(const fs::path& path) {
  return gltf::joined_skin(gltf::read_document(path, read_whole(path)));
}

Modes gltf_targets(const fs::path& path) {
  return gltf::joined_targets(gltf::read_document(path, read_whole(path)));
}

BoneFrames gltf_bone_frames(const fs::path& path, bool with_targets, const MotionOptions& options) {
  const Document document = gltf::read_document(path, read_whole(path));
  const Timeline timeline(document, options);
  if (!with_targets) require_no_morphing(document, timeline);
  const gltf::Moment rest = gltf::at_rest(document);
  BoneFrames result;
  for (std::size_t i = 0; i < timeline.frame_count(); ++i) {
    const gltf::Moment moment = timeline.frame(document, i);
    const std::vector<AffineTransform> transforms = gltf::bone_transforms(document, rest, moment);
    result.bone_count = transforms.size();
    result.transforms.insert(result.transforms.end(), transforms.begin(), transforms.end());
    if (!with_targets) continue;
    const std::vector<double> coordinates = gltf::target_coordinates(document, rest, moment);
    result.morphs.mode_count = coordinates.size();
    result.morphs.coordinates.insert(result.morphs.coordinates.end(), coordinates.begin(), coordinates.end());
  }
  return result;
}

}  // namespace morula::detail

namespace morula {

GltfParts read_gltf_parts(const std::filesystem::path& path) {
  const gltf::Document document = gltf::read_document(path, detail::read_whole(path));
  const gltf::Moment rest = gltf::at_rest(document);
  GltfParts parts;
  for (const std::uint32_t i : document.drawn) {
    const gltf::Node& node = document.nodes[i];
    if (node.skin == gltf::none) {
      parts.bones.push_back({.node = i, .name = node.name});
    } else {
      const std::vector<std::uint32_t>& joints = document.skins[node.skin].joints;
      for (std::uint32_t k = 0; k < joints.size(); ++k)
        parts.bones.push_back(
            {.node = joints[k], .name = document.nodes[joints[k]].name, .skin = node.skin, .joint = k, .mesh_node = i});
    }
    for (const gltf::Primitive& primitive : document.meshes[node.mesh].primitives)
      parts.primitives.push_back({i, node.mesh, static_cast<std::uint32_t>(primitive.index), primitive.facets.size()});
    const std::vector<double>& weights = rest.weights[i];
    for (std::uint32_t k = 0; k < weights.size(); ++k) parts.targets.push_back({i, node.mesh, k, weights[k]});
  }
  return parts;
}

}  // namespace morula
