// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A stand-in for the glTF reader in builds without one.
#include <morula/io/skin_bounds_file.hpp>

#include "io/gltf/skin.hpp"
#include "io/mesh/formats.hpp"
#include "platform/path_text.hpp"

namespace morula::detail {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path) {
  throw FileError(platform::text_of(path) +
                  ": this build reads no glTF; install tinygltf (on Debian libtinygltf-dev), configure with "
                  "-D MORULA_GLTF=ON and build again");
}

}  // namespace

Mesh read_gltf(const std::filesystem::path& path, std::string_view, MeshReading&) {
  fail(path);
}

std::shared_ptr<const FrameSource> open_gltf_frames(const std::filesystem::path& path, const MotionOptions&) {
  fail(path);
}

Skin gltf_skin(const std::filesystem::path& path) {
  fail(path);
}

Modes gltf_targets(const std::filesystem::path& path) {
  fail(path);
}

BoneFrames gltf_bone_frames(const std::filesystem::path& path, bool, const MotionOptions&) {
  fail(path);
}

}  // namespace morula::detail

morula::GltfParts morula::read_gltf_parts(const std::filesystem::path& path) {
  detail::fail(path);
}
