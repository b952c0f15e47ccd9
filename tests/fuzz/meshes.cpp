// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Mesh files: the first byte says which format, the others are the file. A mesh that is read is usable, and what is
// written of it reads back as the same bits.
#include <bit>
#include <cstring>
#include <morula/io/mesh_file.hpp>

#include "fuzz.hpp"
#include "io/mesh/formats.hpp"

namespace morula::fuzz {
using namespace detail;
namespace {

bool same_bits(const Mesh& a, const Mesh& b) {
  return a.facets == b.facets && a.vertex_count() == b.vertex_count() &&
         std::memcmp(a.positions.data(), b.positions.data(), a.vertex_count() * sizeof(Vec3)) == 0;
}

void require_round_trip(const Mesh& mesh) {
  for (const MeshFormat& format : mesh_formats) {
    if (format.write == nullptr || !format.keeps_vertices) continue;
    const std::string bytes = format.write(mesh);
    const std::string name = "again" + std::string(format.extension);
    MeshReading reading;
    require(same_bits(mesh_of_bytes(name, bytes, reading), mesh), "a mesh that was written reads back as another one");
  }
}

void try_mesh(const std::string& name, std::string_view bytes) {
  Mesh mesh;
  MeshReading reading;
  const MemoryMeter memory;
  try {
    mesh = mesh_of_bytes(name, bytes, reading);
  } catch (const FileError& error) {
    memory.require_modest(bytes.size());
    require_good_message(error.what(), name);
    return;
  }
  memory.require_modest(bytes.size());
  for (const std::string& note : reading.info.notes) require_good_message(note, {});
  require_usable(mesh);
  for (const Vec3& p : mesh.positions) require(is_finite(p), "a mesh was read that is not finite");
  require_round_trip(mesh);
}

}  // namespace
}  // namespace morula::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  morula::fuzz::Bytes in(data, size);
  // '0' is the first, however many there are: seeds stay what they were when formats are added.
  const auto& formats = morula::detail::mesh_formats;
  const auto& format = formats[static_cast<std::size_t>(in.byte() + 256 - '0') % formats.size()];
  morula::fuzz::try_mesh("mesh" + std::string(format.extension), in.rest());
  return 0;
}
