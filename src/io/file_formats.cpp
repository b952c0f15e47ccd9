// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/io/file_formats.hpp>

#include "io/mesh/formats.hpp"

namespace morula {

using namespace detail;

namespace {

std::string program_of(std::string_view extension) {
  constexpr std::pair<std::string_view, std::string_view> programs[] = {
      {".obj", "Wavefront"}, {".off", "Geomview"},     {".ply", "Stanford"},   {".stl", "Stereolithography"},
      {".gltf", "glTF 2.0"}, {".glb", "glTF 2.0"},     {".vtk", "VTK legacy"}, {".vtp", "VTK XML"},
      {".vtu", "VTK XML"},   {".msh", "Gmsh 2.2, 4.1"}};
  for (const auto& [known, program] : programs)
    if (known == extension) return std::string(program);
  return {};
}

}  // namespace

std::vector<FileFormat> file_formats() {
  std::vector<FileFormat> formats;
  const auto add = [&](const char* extension, const char* program, bool is_read, bool is_written, const char* purpose) {
    formats.push_back({extension, program, is_read, is_written, purpose});
  };
  for (const MeshFormat& format : mesh_formats) {
    formats.push_back(
        {std::string(format.extension), program_of(format.extension), true, format.write != nullptr, "meshes"});
  }
  for (const MeshFormat& format : mesh_formats) {
    const bool is_written = format.write != nullptr && format.keeps_vertices;
    formats.push_back({std::string(format.extension), program_of(format.extension), true, is_written,
                       format.open_frames != nullptr ? "motions" : "frames of motions"});
  }
  add(".npy", "NumPy", true, true, "motions");
  add(".npz", "NumPy", true, false, "motions");
  add(".pc2", "PointCache2", true, true, "motions");
  add(".mdd", "Motion Designer", true, true, "motions");
  add(".npy", "NumPy", true, true, "modal models");
  add(".npy", "NumPy", true, true, "skins");
  add(".gltf", "glTF 2.0", true, false, "skins");
  add(".glb", "glTF 2.0", true, false, "skins");
  add(".morula", "Morula", true, true, "trees with their covers");
  add(".sph", "the published toolkit", true, true, "spheres of a tree");
  add(".json", "Morula", true, true, "spheres of a tree");
  add(".npz", "NumPy", true, true, "spheres of a tree");
  add(".npz", "NumPy", true, true, "spheres of frames");
  add(".ply", "Stanford", true, true, "balls without a tree");
  add(".sph", "SOFA", false, true, "balls without a tree");
  add(".vtp", "VTK XML", false, true, "spheres, contacts and surfaces with numbers");
  add(".pvd", "ParaView", false, true, "spheres, contacts and surfaces with numbers");
  return formats;
}

}  // namespace morula
