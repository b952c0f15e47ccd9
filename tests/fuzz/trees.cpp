// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Tree files: the first byte says which format, the others are the file; archives and balls say it themselves. A tree
// that is read is valid and reads back as it was; with a cover for our mesh it carries a body, and without one it is
// given a cover.
#include <array>
#include <cmath>
#include <morula/io/tree_file.hpp>
#include <morula/update/body.hpp>
#include <stdexcept>

#include "fuzz.hpp"
#include "io/byte_reader.hpp"
#include "io/tree/formats.hpp"
#include "specimens.hpp"

namespace morula::fuzz {
using namespace detail;
namespace {

// Damage that no checksum stops: the size and the checksum are made good.
std::string resealed(std::string bytes) {
  constexpr std::size_t size_at = 16, checksum_size = 8;
  if (bytes.size() < size_at + 8 + checksum_size) return bytes;
  std::string size, checksum;
  store(size, std::uint64_t{bytes.size()});
  bytes.replace(size_at, size.size(), size);
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (std::size_t i = 0; i + checksum_size < bytes.size(); ++i)
    hash = (hash ^ static_cast<unsigned char>(bytes[i])) * 0x100000001b3u;
  store(checksum, hash);
  return bytes.replace(bytes.size() - checksum_size, checksum_size, checksum);
}

void require_round_trip(const TreeFile& file) {
  const std::uint64_t hash = tree_hash(file.tree);
  const auto same = [&](const char* name, const std::string& bytes) {
    require(tree_hash(tree_of_bytes(name, bytes, {}).tree) == hash,
            "a tree that was written reads back as another one");
  };
  same("again.json", json_tree_text(file.tree));
  if (file.cover) same("again.morula", native_bytes({file.tree, *file.cover, file.report}));
  // Full trees of many levels take megabytes of unused lines.
  if (file.tree.level_count() > 4 || file.tree.branching > 8) return;
  try {
    same("again.sph", sph_text("again.sph", file.tree));
  } catch (const FileError&) {
    // A radius of 0, which the format has no way to say.
  }
}

// A foreign cover may be anything that passed the reader: bodies refuse it or keep their promise.
void try_body(const Mesh& mesh, const CoveredTree& model) {
  try {
    Body body(mesh, model);
    std::vector<Vec3> positions = mesh.positions;
    for (Vec3& p : positions) p = {1.5 * p.x + p.y, p.y * p.y, p.z - p.x};
    if (!body.update(positions)) return;
    std::vector<Sphere> spheres;
    body.copy_spheres(spheres);
    require(certify(body.cover(), positions, spheres).covered, "a body of a tree that was read does not cover");
  } catch (const std::invalid_argument&) {
  }
}

void try_tree(const char* name, const std::string& bytes, bool with_mesh) {
  try {
    const MemoryMeter memory;
    TreeFile file;
    try {
      file = tree_of_bytes(name, bytes, {});
    } catch (const FileError&) {
      memory.require_modest(bytes.size());
      throw;
    }
    memory.require_modest(bytes.size());
    require(validate(file.tree).empty(), "a tree was read that is not valid");
    require_round_trip(file);
    if (!with_mesh || file.tree.node_count() > 2000) return;
    const Mesh& mesh = specimen_mesh();
    const bool was_covered = file.cover.has_value();
    const CoveredTree model = built_of_file(name, std::move(file), mesh, serial_workers());
    require(certify(model.cover, mesh.positions, model.tree.spheres).covered, "a tree was read that does not cover");
    if (!was_covered)
      if (const auto faults = validate(mesh, model); !faults.empty())
        found("a cover was made that is not valid: " + faults.front());
    try_body(mesh, model);
  } catch (const FileError& error) {
    require_good_message(error.what(), name);
  }
}

}  // namespace
}  // namespace morula::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace morula::fuzz;
  Bytes in(data, size);
  const std::size_t how = in.below(8);
  const std::string bytes(in.rest());
  switch (how % 4) {
    case 0:
      try_tree("tree.morula", bytes, how >= 4);
      break;
    case 1:
      try_tree("tree.morula", resealed(bytes), how >= 4);
      break;
    case 2:
      try_tree("tree.sph", bytes, how >= 4);
      break;
    default:
      try_tree(bytes.rfind("PK", 0) == 0    ? "tree.npz"
               : bytes.rfind("ply", 0) == 0 ? "tree.ply"
                                            : "tree.json",
               bytes, how >= 4);
  }
  return 0;
}
