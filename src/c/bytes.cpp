// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Meshes and models of the C interface from and to bytes in memory.
#include "c/handles.hpp"
#include "io/mesh/formats.hpp"
#include "io/mesh/reading.hpp"
#include "io/tree/formats.hpp"
#include "io/whole_file.hpp"
#include "parallel/float_environment.hpp"

using namespace morula;
using namespace morula::detail;

namespace {

std::string_view text_of(const void* bytes, std::size_t size) {
  if (size != 0) require_pointer(bytes, "bytes");
  return {static_cast<const char*>(bytes), size};
}

}  // namespace

morula_status morula_mesh_from_bytes(const char* name, const void* bytes, size_t size, morula_mesh** mesh) {
  return guarded([&] {
    require_pointer(mesh, "mesh");
    *mesh = nullptr;
    require_pointer(name, "name");
    const StandardFloats standard;
    if (mesh_format(lower_extension(path_of(name))) == nullptr)
      throw FileError(std::string(name) + ": its extension says no known mesh format; use one of " +
                      readable_mesh_extensions());
    MeshReading reading;
    *mesh = new morula_mesh{std::make_shared<const Mesh>(mesh_of_bytes(path_of(name), text_of(bytes, size), reading))};
    return MORULA_OK;
  });
}

morula_status morula_model_from_bytes(const void* bytes, size_t size, const morula_mesh* mesh, morula_model** model) {
  return guarded([&] {
    require_pointer(model, "model");
    *model = nullptr;
    require_pointer(mesh, "mesh");
    const StandardFloats standard;
    const std::filesystem::path name = "bytes";
    CoveredTree read = covered_by_file(name, read_native(name, text_of(bytes, size)), *mesh->mesh);
    *model = new morula_model{std::make_shared<const CoveredTree>(std::move(read))};
    return MORULA_OK;
  });
}

morula_status morula_model_to_bytes(const morula_model* model, void* bytes, size_t capacity, size_t* size) {
  return guarded([&] {
    require_pointer(size, "size");
    *size = 0;
    require_pointer(model, "model");
    if (capacity != 0) require_pointer(bytes, "bytes");
    const std::string written = native_bytes(*model->model);
    *size = written.size();
    if (capacity >= written.size()) std::memcpy(bytes, written.data(), written.size());
    return MORULA_OK;
  });
}
